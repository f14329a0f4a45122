"""What the optimal-control core knows of the world: agents that hold, and one object that is held."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import pinocchio as pin

from liftopt.errors import ModelError
from liftopt.types import Array

Kind = Literal["person", "robot"]
KINDS: tuple[Kind, ...] = ("person", "robot")
# Grasp points nearer to each other, or to a line, than this are at one point, or on that line [m].
SAME_PLACE = 1e-6


@dataclass(frozen=True)
class JointLimits:
    """Limits of an agent's moving joints, in the joint order of its reduced model; all arrays (n,).

    Attributes:
        q_lower, q_upper: position [rad].
        velocity: speed, both directions [rad/s].
        tau_lower, tau_upper: torque, each direction apart [Nm]; ``tau_lower`` is negative.
    """

    q_lower: Array
    q_upper: Array
    velocity: Array
    tau_lower: Array
    tau_upper: Array

    @property
    def effort(self) -> Array:
        """Larger of the two torque limits (n,), in either direction [Nm]."""
        return np.maximum(-self.tau_lower, self.tau_upper)


@dataclass(frozen=True)
class Comfort:
    """Where an agent's moving joints are at ease, in the joint order of its reduced model; all arrays (n,).

    A joint at q costs weight u^4 + square_weight u^2, where u is the share of the room on that side of its neutral
    angle that it has used: nothing at the neutral angle, one weight at the end of the room, much more beyond it.

    Attributes:
        neutral: angle that costs nothing [rad].
        room_lower, room_upper: comfortable way from there down and up, both positive [rad].
        weight: of u^4.
        square_weight: of u^2.
    """

    neutral: Array
    room_lower: Array
    room_upper: Array
    weight: Array
    square_weight: Array

    def cost(self, q: Array) -> Array:
        """Return what joint angles (..., n) cost, all joints together (...)."""
        away = q - self.neutral
        squared = (away / np.where(away > 0.0, self.room_upper, self.room_lower)) ** 2
        return np.asarray(squared**2 @ self.weight + squared @ self.square_weight)


@dataclass(frozen=True)
class HalfSpace:
    """The set ``normal . p_world >= offset`` that an agent's grasp point must stay in (eq. 14).

    Attributes:
        normal: (3,) unit vector, world axes.
        offset: [m].
    """

    normal: Array
    offset: float


@dataclass(frozen=True)
class Grasp:
    """What an agent's hold on the object transmits; by default a force at a point, in any direction (the paper's).

    Where it transmits moments, the hand cannot turn freely on the object: its orientation has a limit too, counted from
    the one in which the hand's grip axes are the object's axes.

    Attributes:
        moments: whether it transmits a moment too.
        max_moment: largest norm of the moment about the grasp point [Nm].
        max_turn: largest angle of the hand from its reference orientation on the object, about any axis [rad].
        R_hand_object: (3, 3) the object's axes in the axes of the agent's grasp frame, at the reference orientation.
        breadth: of what holds [m]: a moment m takes contact forces of m / breadth in it, which count in the objective
            like the force itself; and how far the pressure under a flat hand can move.
        friction: None for a grip; else a flat hand that only pushes along the object's z axis, with this coefficient.
    """

    moments: bool = False
    max_moment: float = 0.0
    max_turn: float = np.pi
    R_hand_object: Array = field(default_factory=lambda: np.eye(3))
    breadth: float = 0.085
    friction: float | None = None

    @property
    def size(self) -> int:
        """Number of components that it transmits."""
        return 6 if self.moments else 3

    @property
    def is_point_contact(self) -> bool:
        """Whether it is a force at a point and no more."""
        return not self.moments and self.friction is None


@dataclass(frozen=True)
class Agent:
    """One who holds the object: a fixed-base chain that grasps it at a point.

    Attributes:
        name: prefix of its joint names (``"human"``, ``"robot"``).
        kind: what it is; the optimal-control core carries it and never asks.
        urdf: the very URDF text that the model was loaded from.
        model: Pinocchio model of that URDF, all joints; the base placement is in its root's fixed joint.
        locked_joints: names of the virtual joints held at zero (eq. 13); they are eliminated from the optimisation.
        grasp_frame: name of the frame that coincides with the object's grasp point.
        limits: of the joints that are not locked.
        posture: (n,) comfortable posture of those joints, a seed for inverse kinematics [rad].
        workspace: half-space that the grasp point must stay in, or None.
        grasp: what its hold transmits.
        comfort: where its joints are at ease, or None for one who does not mind.
    """

    name: str
    kind: Kind
    urdf: str
    model: pin.Model
    locked_joints: tuple[str, ...]
    grasp_frame: str
    limits: JointLimits
    posture: Array
    workspace: HalfSpace | None = None
    grasp: Grasp = Grasp()
    comfort: Comfort | None = None

    @property
    def moving_joints(self) -> tuple[str, ...]:
        """Names of the joints that are not locked, in the model's order."""
        return tuple(name for name in list(self.model.names)[1:] if name not in self.locked_joints)

    def reduced(self) -> pin.Model:
        """Return the model without the locked joints, which stay at zero."""
        ids = [self.model.getJointId(name) for name in self.locked_joints]
        return pin.buildReducedModel(self.model, ids, np.zeros(self.model.nq))


@dataclass(frozen=True)
class LiftedObject:
    """The object: one rigid body with a free-flyer and one grasp frame for each agent, in the agents' order.

    Attributes:
        name: of the object (``"table"``).
        urdf: the very URDF text that the model was loaded from.
        model: Pinocchio model of that URDF with a free-flyer root; the body frame is at the centre of mass.
        grasp_frames: names of the frames on the body, one for each agent.
    """

    name: str
    urdf: str
    model: pin.Model
    grasp_frames: tuple[str, ...]

    def unserved_row(self) -> int | None:
        """Return which of the six rows of balance the point grasps cannot serve; None if they serve them all.

        It is the rank of the grasp map, which takes their forces to force and moment on the body: 6 in general; 5 for
        points on one line, about which they cannot turn the body; 3 for a single point, about which they cannot at all.

        Raises:
            ModelError: the points are one point, or lie on a line that is not parallel to an axis of the body.
        """
        points = [self.model.frames[self.model.getFrameId(name)].placement.translation for name in self.grasp_frames]
        _, extents, axes = np.linalg.svd(np.array(points) - np.mean(points, axis=0))
        apart = int(np.count_nonzero(extents > SAME_PLACE))
        if apart > 1:
            return None
        if apart == 0:
            held = "held at one point only" if len(points) == 1 else f"held by {len(points)} grasps at one point"
            raise ModelError(
                f"{self.name}: {held}, where forces cannot turn it: nothing holds its moments about x, y and z; hold "
                "it at points apart, or let a grasp transmit moments too (grasp = 'wrench')"
            )
        along = np.flatnonzero(np.abs(axes[0]) > SAME_PLACE)
        if len(along) > 1:
            raise ModelError(
                f"{self.name}: the grasp points lie on a line along {np.round(axes[0], 3).tolist()} in the body; "
                "turn the body's frame so that this is one of its axes"
            )
        return 3 + int(along[0])
