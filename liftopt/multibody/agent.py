"""What the optimal-control core knows of the world: agents that hold, and one object that is held."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.errors import ModelError
from liftopt.multibody.disc import Disc
from liftopt.multibody.joint_units import JointUnits, units_of
from liftopt.multibody.robots.data_finding import DataFinding
from liftopt.types import Array

Kind = Literal["person", "robot"]
KINDS: tuple[Kind, ...] = ("person", "robot")
# Grasp points nearer to each other, or to a line, than this are at one point, or on that line [m].
SAME_PLACE = 1e-6


@dataclass(frozen=True)
class JointLimits:
    """Limits of an agent's moving joints, in the joint order of its reduced model; all arrays (n,).

    Attributes:
        q_lower, q_upper: position [rad, m].
        velocity: speed, both directions [rad/s, m/s].
        tau_lower, tau_upper: torque or force, each direction apart [Nm, N]; ``tau_lower`` is negative.
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
    """One hold of an agent on the object; by default it transmits a force at a point, in any direction (the paper's).

    Where it transmits moments, the hand cannot turn freely on the object: its orientation has a limit too, counted from
    the one in which the hand's grip axes are the object's axes.

    Attributes:
        name: what results call it: the agent's name, or agent and hand (``"human_right"``).
        frame: name of the agent's frame that coincides with the object's grasp point.
        moments: whether it transmits a moment too.
        max_moment: largest norm of the moment about the grasp point [Nm].
        max_turn: largest angle of the hand from its reference orientation on the object, about any axis [rad]; around a
            bar, of the hand from the bar.
        R_hand_object: (3, 3) the object's axes in the axes of the agent's grasp frame, at the reference orientation.
        breadth: of what holds [m]: a moment m takes contact forces of m / breadth in it, which count in the objective
            like the force itself; and how far the pressure under a flat hand can move.
        friction: None for a grip; else a flat hand that only pushes along the object's z axis, with this coefficient.
        bar: (3,) direction in the object's axes of a bar that the hand is closed around, and turns about freely; None
            for a hand that does not.
    """

    name: str
    frame: str
    moments: bool = False
    max_moment: float = 0.0
    max_turn: float = np.pi
    R_hand_object: Array = field(default_factory=lambda: np.eye(3))
    breadth: float = 0.085
    friction: float | None = None
    bar: Array | None = None

    @property
    def R_hand_measured(self) -> Array:
        """(3, 3) by which kernels take the angle of the hand on the object: they know (tr(R_object_grip) - 1) / 2.

        Without a bar that is the angle's cosine, by ``R_hand_object``. With one, b^T R b takes the place of the trace,
        the cosine between the bar and where the hand has it: a turn about the bar leaves it as it is.
        """
        return self.R_hand_object if self.bar is None else self.R_hand_object @ np.outer(self.bar, self.bar)

    @property
    def least_cosine(self) -> float:
        """Least of what kernels know of that angle."""
        most = float(np.cos(self.max_turn))
        return most if self.bar is None else (most - 1.0) / 2.0

    def turn_beyond(self, missing: Array) -> Array:
        """Return by how much the hand is turned too far [rad], where so much is missing to ``least_cosine``."""
        beyond = self.least_cosine - missing
        cosine = beyond if self.bar is None else 2.0 * beyond + 1.0
        return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)) - self.max_turn)

    @property
    def size(self) -> int:
        """Number of components that it transmits."""
        return 6 if self.moments else 3

    @property
    def is_point_contact(self) -> bool:
        """Whether it is a force at a point and no more."""
        return not self.moments and self.friction is None


@dataclass(frozen=True)
class Stance:
    """How an agent stands that is not bolted down: on two soles that rest on the floor.

    Axes are those of its base: the feet's origin on the floor, X ahead, Y to the left.

    Attributes:
        soles: of each sole, where it begins behind and ends ahead along X, and how far it reaches along Y [m].
        friction: coefficient between soles and floor.
        mass: of what rests on the floor and does not move, the feet [kg].
        p_base_com: (3,) its centre of mass [m].
        sway: how far within the rectangle around both soles a plan keeps the centre of pressure [m].
    """

    soles: tuple[tuple[float, float, float], ...]
    friction: float
    mass: float
    p_base_com: Array
    sway: float = 0.0

    @property
    def support(self) -> tuple[float, float, float]:
        """Rectangle around both soles: where it begins and ends along X, and how far it reaches along Y [m]."""
        back, ahead, aside = zip(*self.soles, strict=True)
        return min(back), max(ahead), max(aside)


@dataclass(frozen=True)
class Lean:
    """How far an agent's trunk may lean from the vertical.

    Where it leans by an angle theta it costs ``((1 - cos theta) / (1 - cos room))^2``: nothing upright, about the
    fourth power of the angle near it, one at the end of the room; as much as a joint there, see ``Comfort``.

    Attributes:
        joint: name of the joint that carries the trunk.
        room: comfortable angle in any direction [rad].
        most: largest angle [rad].
    """

    joint: str
    room: float
    most: float

    def cost(self, tilt: Array) -> Array:
        """Return what leaning costs, where ``tilt`` is 1 - cos theta of any shape."""
        return np.asarray((tilt / (1.0 - np.cos(self.room))) ** 2)


@dataclass(frozen=True)
class Agent:
    """One who holds the object: a tree of links on a base, with a grasp or several.

    Attributes:
        name: prefix of its joint names (``"human"``, ``"robot"``).
        kind: what it is; the optimal-control core carries it and never asks.
        urdf: the very URDF text that the model was loaded from.
        model: Pinocchio model of that URDF, all joints; the base placement is in its root's fixed joint.
        locked_joints: names of the virtual joints held at zero (eq. 13); they are eliminated from the optimisation.
        grasps: how it holds the object, one for each hand that does.
        hands: names of all frames with which it could hold; what is generated for it has room for each of them.
        limits: of the joints that are not locked.
        posture: (n,) comfortable posture of those joints, a seed for inverse kinematics [rad].
        workspace: half-space that its grasp points must stay in, or None.
        comfort: where its joints are at ease, or None for one who does not mind.
        spine: (2, n) what one Nm of each joint's torque, below and above zero, adds to the load on its spine, as a
            share of what counts as one [1/Nm]; None of one who has none.
        stance: how it stands; None where its base holds it whatever it does.
        lean: how far its trunk may lean, or None for one without a trunk that does.
        disc: of its spine that must not be pressed too much, or None where nothing is asked of it.
        joint_weights: (n,) factors of the joints' squared torques in the objective, or None where all are one.
        remarks: what was noticed about the data that it was made of.
        shares_kernels: whether it is a serial arm, simple, whose joints turn about or slide along their z axes, and has
            what is generated for all of them with the same kinds of joints.
    """

    name: str
    kind: Kind
    urdf: str
    model: pin.Model
    locked_joints: tuple[str, ...]
    grasps: tuple[Grasp, ...]
    hands: tuple[str, ...]
    limits: JointLimits
    posture: Array
    workspace: HalfSpace | None = None
    comfort: Comfort | None = None
    spine: Array | None = None
    stance: Stance | None = None
    lean: Lean | None = None
    disc: Disc | None = None
    joint_weights: Array | None = None
    remarks: tuple[DataFinding, ...] = ()
    shares_kernels: bool = False

    @property
    def is_simple(self) -> bool:
        """Whether it is bolted down and has one hand, as the paper's agents."""
        return len(self.hands) == 1 and self.stance is None

    @property
    def pushes_at_a_point(self) -> bool:
        """Whether it is simple, its hold a force at a point, and what is generated for it has room for no more."""
        return self.is_simple and not self.shares_kernels and all(grasp.is_point_contact for grasp in self.grasps)

    @property
    def moving_joints(self) -> tuple[str, ...]:
        """Names of the joints that are not locked, in the model's order."""
        return tuple(name for name in list(self.model.names)[1:] if name not in self.locked_joints)

    @property
    def sliding(self) -> npt.NDArray[np.bool_]:
        """(all joints,) True for those that slide, whose position is in m and whose effort is in N; others turn."""
        return slides(self.model)

    @property
    def units(self) -> dict[str, JointUnits]:
        """Units of the joints that are not locked, by name."""
        slides = dict(zip(list(self.model.names)[1:], self.sliding, strict=True))
        return {name: units_of(bool(slides[name])) for name in self.moving_joints}

    @property
    def T_world_base(self) -> Array:
        """(4, 4) placement of the link that carries its first joint: of one who stands, the feet's origin and axes."""
        first = self.model.frames[self.model.getFrameId(self.model.names[1])]
        return np.asarray(self.model.frames[first.parentFrame].placement.homogeneous)

    def reduced(self) -> pin.Model:
        """Return the model without the locked joints, which stay at zero."""
        ids = [self.model.getJointId(name) for name in self.locked_joints]
        return pin.buildReducedModel(self.model, ids, np.zeros(self.model.nq))


@dataclass(frozen=True)
class LiftedObject:
    """The object: one rigid body with a free-flyer and a grasp frame for each grasp of each agent.

    Attributes:
        name: of the object (``"table"``).
        urdf: the very URDF text that the model was loaded from.
        model: Pinocchio model of that URDF with a free-flyer root; the body frame is at the centre of mass.
        grasp_frames: names of the frames on the body, in the order of the agents and of their grasps.
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


def slides(model: pin.Model) -> npt.NDArray[np.bool_]:
    """Return (n,) which joints of a model slide; the others turn."""
    return np.array([joint.shortname().startswith("JointModelP") for joint in list(model.joints)[1:]])
