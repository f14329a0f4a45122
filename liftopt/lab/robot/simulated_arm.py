"""Sawyer alone in MuJoCo: the solved URDF, joint servos at 1 kHz, friction, and the person's part as a wrench.

What stands between a command and the arm, which nobody outside the manufacturer knows, is modelled as one servo with
a reference that moves at the commanded velocity:

    torque = P e + D de/dt + I int(e) + M(q) a + gravity and Coriolis of the bare arm,   e = reference - q

In velocity mode this is a velocity loop. P and D are those of the position controller in the manufacturer's own
simulator; its velocity controller (0.05 Nm s/rad at joints with 2 Nm of friction) could not move the arm. I is an
estimate: there it is without effect (no i_clamp is given, which control_toolbox takes for 0), and the arm would end
33 mm off under the load of the paper's lift. Gravity compensation knows the gripper, not the object. Everything is in
the signs of Table 3.

How much hangs on these numbers, on the paper's lift: with P and D halved or doubled, I or friction left out or doubled,
or the load left out, the hand is led off by 261 to 264 mm at most in velocity mode, where the server's own law decides,
and by 16 to 51 mm in position_w_id mode, where they do: an order of magnitude.
"""

from __future__ import annotations

import numpy as np

from liftopt.lab.meant import the_robot
from liftopt.multibody.mujoco_model import import_mujoco, spec_of
from liftopt.solution.solution import Solution
from liftopt.types import Array

STEP = 1e-3  # [s]: the arm's motor loop runs at 1 kHz (manufacturer's page "Arm Control Systems")
# sawyer_simulator, commit 156bf12, sawyer_sim_controllers.yaml: position controllers [Nm/rad, Nm s/rad] (Apache-2.0).
STIFFNESS = np.array([500.0, 400.0, 250.0, 300.0, 300.0, 100.0, 50.0])
DAMPING = np.array([25.0, 30.0, 30.0, 50.0, 8.0, 5.0, 4.0])
RESET = 2.0  # I / P [1/s]; estimate
# sawyer_robot, commit d1ef3d0, sawyer_base.urdf.xacro, tuned for that simulator; no measured figures are published.
FRICTION = np.array([5.0, 2.0, 2.0, 0.5, 1.0, 0.5, 0.5])  # dry [Nm]
VISCOUS = np.array([10.0, 5.0, 5.0, 1.0, 2.0, 1.0, 1.0])  # [Nm s/rad]
NONE = np.zeros(3)


class SimulatedArm:
    """The arm at one moment; ``advance`` takes it on."""

    def __init__(self, solution: Solution, friction: Array, stiff: bool, robot: str | None = None) -> None:
        """Build the arm.

        Args:
            solution: whose robot it is.
            friction: (7,) how much of FRICTION and VISCOUS there is.
            stiff: whether the servo is on; without it the arm follows torques alone.
            robot: its name; None where there is only one.

        Raises:
            InputError: MuJoCo is not installed, or too old, or no robot is the one that is meant.
        """
        self._mujoco = import_mujoco()
        arm = the_robot(solution, robot)
        locked = [name for name, moves in zip(arm.joint_names, arm.moving, strict=True) if not moves]
        spec, limits = spec_of([solution.urdfs[arm.name]], locked), arm.limits
        for j, name in enumerate(arm.moving_joints):
            servo = spec.add_actuator(name=name, target=name, trntype=self._mujoco.mjtTrn.mjTRN_JOINT)
            servo.gainprm[0], servo.biastype = 1.0, self._mujoco.mjtBias.mjBIAS_AFFINE
            servo.biasprm[1], servo.biasprm[2] = -STIFFNESS[j] * stiff, -DAMPING[j] * stiff
            servo.forcelimited, servo.forcerange = True, [limits.tau_lower[j], limits.tau_upper[j]]
        # Implicit in the servo's damping: at the wrist it outweighs the inertia of a step many times over.
        spec.option.integrator = self._mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.timestep = STEP
        self._model = spec.compile()
        self._model.dof_damping[:], self._model.dof_frictionloss[:] = VISCOUS * friction, FRICTION * friction
        self._data = self._mujoco.MjData(self._model)
        self._tip = self._model.body(f"{arm.name}_grasp").id
        self._stiff = float(stiff)
        self.torque = np.zeros(7)
        self.reference = np.zeros(7)
        self._holding = np.zeros(7)

    @property
    def position(self) -> Array:
        """(7,) joint angles [rad]."""
        return np.array(self._data.qpos)

    @property
    def velocity(self) -> Array:
        """(7,) [rad/s]."""
        return np.array(self._data.qvel)

    @property
    def tip(self) -> Array:
        """(3,) the grasp point in the world at the last step's start [m]."""
        return np.array(self._data.xpos[self._tip])

    def gravity(self, q: Array) -> Array:
        """Return the torques (7,) that hold the bare arm at ``q`` (7,) [Nm]."""
        data = self._mujoco.MjData(self._model)
        data.qpos[:] = q
        self._mujoco.mj_forward(self._model, data)
        return np.array(data.qfrc_bias)

    def rest(self, q: Array, force: Array, moment: Array = NONE) -> None:
        """Put the arm at rest at ``q`` (7,), its servo settled under ``force`` and ``moment`` as in ``advance``."""
        self._mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[:] = self.reference = q
        self._mujoco.mj_forward(self._model, self._data)
        self._holding = -self._pull(force, moment)
        self.torque = self._data.qfrc_bias + self._holding

    def advance(self, rate: Array, acceleration: Array, torque: Array, force: Array, moment: Array = NONE) -> None:
        """Go on by ``STEP``.

        Args:
            rate: (7,) of the servo's reference [rad/s].
            acceleration: (7,) fed forward through the arm's own inertia [rad/s^2].
            torque: (7,) on top of all that [Nm].
            force: (3,) on the gripper at the grasp point, world axes [N].
            moment: (3,) about that point, world axes [Nm].
        """
        mujoco, model, data = self._mujoco, self._model, self._data
        self.reference = self.reference + STEP * rate
        self._holding += STEP * RESET * STIFFNESS * (self.reference - data.qpos)
        mujoco.mj_step1(model, data)  # what depends on position and velocity, where the arm is now
        data.qfrc_applied[:] = self._pull(force, moment)
        forward = np.zeros(7)
        mujoco.mj_mulM(model, data, forward, acceleration)
        servo = STIFFNESS * self.reference + DAMPING * rate + forward + self._holding
        data.ctrl[:] = data.qfrc_bias + self._stiff * servo + torque
        before = data.qvel.copy()
        mujoco.mj_step2(model, data)
        # What the joint passes on to the link, friction taken off: the arm measures it by a spring behind the gear.
        inertial = np.zeros(7)
        mujoco.mj_mulM(model, data, inertial, (data.qvel - before) / STEP)
        self.torque = inertial + data.qfrc_bias - data.qfrc_applied

    def _pull(self, force: Array, moment: Array) -> Array:
        """Return a force and a moment on the gripper as joint torques (7,)."""
        pull = np.zeros(7)
        self._mujoco.mj_applyFT(self._model, self._data, force, moment, self.tip, self._tip, pull)
        return pull
