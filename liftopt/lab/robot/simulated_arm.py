"""A robot alone in MuJoCo: the solved URDF, joint servos at 1 kHz, friction, and the person's part as a wrench.

What stands between a command and the arm, which nobody outside the manufacturer knows, is modelled as one servo with
a reference that moves at the commanded velocity:

    torque = P e + D de/dt + I int(e) + M(q) a + gravity and Coriolis of the bare arm,   e = reference - q

In Sawyer's velocity mode this is a velocity loop. P, D, I and friction are those of ``servo``. Torques end at the
limits of the URDF. Gravity compensation knows the gripper, not the object. Everything is in the signs of the solved
model, Sawyer's those of Table 3.

How much hangs on these numbers, on the paper's lift: with P and D halved or doubled, I or friction left out or doubled,
or the load left out, the hand is led off by 261 to 264 mm at most in velocity mode, where the server's own law decides,
and by 16 to 51 mm in position_w_id mode, where they do: an order of magnitude.
"""

from __future__ import annotations

import numpy as np

from liftopt.lab.meant import the_robot
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.servo import RESET, Servo
from liftopt.multibody.mujoco_model import import_mujoco, spec_of
from liftopt.solution.solution import Solution
from liftopt.types import Array

STEP = 1e-3  # [s]: the arm's motor loop runs at 1 kHz (manufacturer's page "Arm Control Systems")
NONE = np.zeros(3)


class SimulatedArm:
    """The arm at one moment; ``advance`` takes it on."""

    def __init__(self, solution: Solution, friction: Array, stiff: bool, robot: str | None = None) -> None:
        """Build the arm.

        Args:
            solution: whose robot it is.
            friction: (n,) how much of the servo's friction there is.
            stiff: whether the servo is on; without it the arm follows torques alone.
            robot: its name; None where there is only one.

        Raises:
            InputError: MuJoCo is not installed, or too old, or no robot is the one that is meant.
        """
        self._mujoco = import_mujoco()
        arm, joints = the_robot(solution, robot), JointMap.of(solution, robot)
        locked = [name for name, moves in zip(arm.joint_names, arm.moving, strict=True) if not moves]
        spec, limits = spec_of([solution.urdfs[arm.name]], locked), arm.limits
        for j, name in enumerate(arm.moving_joints):
            servo = spec.add_actuator(name=name, target=name, trntype=self._mujoco.mjtTrn.mjTRN_JOINT)
            servo.gainprm[0], servo.biastype = 1.0, self._mujoco.mjtBias.mjBIAS_AFFINE
            servo.forcelimited, servo.forcerange = True, [limits.tau_lower[j], limits.tau_upper[j]]
        # Implicit in the servo's damping: at the wrist it outweighs the inertia of a step many times over.
        spec.option.integrator = self._mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        spec.option.timestep = STEP
        self._model = spec.compile()
        self._data = self._mujoco.MjData(self._model)
        self._n = len(arm.moving_joints)
        self.servo = Servo.of(joints, self._inertia(arm.q[0, arm.moving]))
        self._model.actuator_biasprm[:, 1] = -self.servo.stiffness * stiff
        self._model.actuator_biasprm[:, 2] = -self.servo.damping * stiff
        self._model.dof_damping[:] = self.servo.viscous * friction
        self._model.dof_frictionloss[:] = self.servo.friction * friction
        self._tip = self._model.body(f"{arm.name}_grasp").id
        self._stiff = float(stiff)
        self.torque = np.zeros(self._n)
        self.reference = np.zeros(self._n)
        self._holding = np.zeros(self._n)

    @property
    def position(self) -> Array:
        """(n,) joint angles [rad]."""
        return np.array(self._data.qpos)

    @property
    def velocity(self) -> Array:
        """(n,) [rad/s]."""
        return np.array(self._data.qvel)

    @property
    def tip(self) -> Array:
        """(3,) the grasp point in the world at the last step's start [m]."""
        return np.array(self._data.xpos[self._tip])

    def gravity(self, q: Array) -> Array:
        """Return the torques (n,) that hold the bare arm at ``q`` (n,) [Nm]."""
        data = self._mujoco.MjData(self._model)
        data.qpos[:] = q
        self._mujoco.mj_forward(self._model, data)
        return np.array(data.qfrc_bias)

    def rest(self, q: Array, force: Array, moment: Array = NONE) -> None:
        """Put the arm at rest at ``q`` (n,), its servo settled under ``force`` and ``moment`` as in ``advance``."""
        self._mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[:] = self.reference = q
        self._mujoco.mj_forward(self._model, self._data)
        self._holding = -self._pull(force, moment)
        self.torque = self._data.qfrc_bias + self._holding

    def advance(self, rate: Array, acceleration: Array, torque: Array, force: Array, moment: Array = NONE) -> None:
        """Go on by ``STEP``.

        Args:
            rate: (n,) of the servo's reference [rad/s].
            acceleration: (n,) fed forward through the arm's own inertia [rad/s^2].
            torque: (n,) on top of all that [Nm].
            force: (3,) on the gripper at the grasp point, world axes [N].
            moment: (3,) about that point, world axes [Nm].
        """
        mujoco, model, data = self._mujoco, self._model, self._data
        self.reference = self.reference + STEP * rate
        self._holding += STEP * RESET * self.servo.stiffness * (self.reference - data.qpos)
        mujoco.mj_step1(model, data)  # what depends on position and velocity, where the arm is now
        data.qfrc_applied[:] = self._pull(force, moment)
        forward = np.zeros(self._n)
        mujoco.mj_mulM(model, data, forward, acceleration)
        servo = self.servo.stiffness * self.reference + self.servo.damping * rate + forward + self._holding
        data.ctrl[:] = data.qfrc_bias + self._stiff * servo + torque
        before = data.qvel.copy()
        mujoco.mj_step2(model, data)
        # What the joint passes on to the link, friction taken off: the arm measures it by a spring behind the gear.
        inertial = np.zeros(self._n)
        mujoco.mj_mulM(model, data, inertial, (data.qvel - before) / STEP)
        self.torque = inertial + data.qfrc_bias - data.qfrc_applied

    def _inertia(self, q: Array) -> Array:
        """Return the diagonal (n,) of the mass matrix at ``q`` (n,)."""
        data, mass = self._mujoco.MjData(self._model), np.zeros((self._n, self._n))
        data.qpos[:] = q
        self._mujoco.mj_forward(self._model, data)
        for j, column in enumerate(np.eye(self._n)):
            self._mujoco.mj_mulM(self._model, data, mass[j], column)
        return np.array(np.diag(mass))

    def _pull(self, force: Array, moment: Array) -> Array:
        """Return a force and a moment on the gripper as joint torques (n,)."""
        pull = np.zeros(self._n)
        self._mujoco.mj_applyFT(self._model, self._data, force, moment, self.tip, self._tip, pull)
        return pull
