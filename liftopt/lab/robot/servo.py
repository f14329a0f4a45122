"""The servo of an arm's joints, and the friction in them: Sawyer's, and a rule for any other arm.

Sawyer's P and D are those of the position controller in the manufacturer's own simulator; its velocity controller
(0.05 Nm s/rad at joints with 2 Nm of friction) could not move the arm. I is an estimate: there it is without effect
(no i_clamp is given, which control_toolbox takes for 0), and the arm would end 33 mm off under the load of the paper's
lift.

Of no other arm here are the gains known. The rule: each joint alone, with the inertia M that it has at the start of the
lift (the diagonal of the bare arm's mass matrix there, its tool included), swings at 5 Hz and is critically damped:
P = w^2 M and D = 2 P / w, with w = 2 pi 5 /s. A URDF does not tell the rotors' inertia, which is most of what a wrist
has; so P is at least the torque limit over 0.2 rad (0.1 m where a joint slides), D still 2 P / w, which is more than
critical. Sawyer's own gains are like that: P is 5 to 33 limits per rad, D / P is 0.03 to 0.17 s, beside 5 and 0.064 s.
Dry friction is taken for 3 % of each joint's torque limit. All of that is estimate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.lab.robot.joint_map import JointMap
from liftopt.types import Array

# sawyer_simulator, commit 156bf12, sawyer_sim_controllers.yaml: position controllers [Nm/rad, Nm s/rad] (Apache-2.0).
STIFFNESS = np.array([500.0, 400.0, 250.0, 300.0, 300.0, 100.0, 50.0])
DAMPING = np.array([25.0, 30.0, 30.0, 50.0, 8.0, 5.0, 4.0])
# sawyer_robot, commit d1ef3d0, sawyer_base.urdf.xacro, tuned for that simulator; no measured figures are published.
FRICTION = np.array([5.0, 2.0, 2.0, 0.5, 1.0, 0.5, 0.5])  # dry [Nm]
VISCOUS = np.array([10.0, 5.0, 5.0, 1.0, 2.0, 1.0, 1.0])  # [Nm s/rad]
RESET = 2.0  # I / P [1/s]; estimate
FREQUENCY = 2.0 * np.pi * 5.0  # [rad/s]
WHOLE_TORQUE, WHOLE_FORCE = 0.2, 0.1  # [rad, m] off, at the latest: P alone asks for all that the joint has
FRICTION_SHARE = 0.03  # of the torque limit


@dataclass(frozen=True)
class Servo:
    """What drives and brakes the n joints, in the units of each; all (n,).

    Attributes:
        stiffness: P [Nm/rad].
        damping: D [Nm s/rad].
        friction: dry [Nm].
        viscous: [Nm s/rad].
    """

    stiffness: Array
    damping: Array
    friction: Array
    viscous: Array

    @classmethod
    def of(cls, joints: JointMap, inertia: Array) -> Servo:
        """Return the servo of an arm.

        Args:
            joints: of the arm.
            inertia: (n,) diagonal of its mass matrix at the start of the lift [kg m^2, kg].
        """
        if joints.is_sawyer:
            return cls(STIFFNESS, DAMPING, FRICTION, VISCOUS)
        most = np.abs(joints.effort).max(axis=0)
        stiffness = np.maximum(FREQUENCY**2 * inertia, most / np.where(joints.sliding, WHOLE_FORCE, WHOLE_TORQUE))
        return cls(stiffness, 2.0 * stiffness / FREQUENCY, FRICTION_SHARE * most, np.zeros_like(inertia))
