"""A serial arm in the frames that need the fewest numbers, so that one kernel serves all arms with the same joints.

Torques do not depend on the frames that links are given. Here a joint turns about the z axis of its link's frame or
slides along it, and ``T_j_next = Rx(alpha) Trans(a, b, 0) Rz(offset + q)``: the origin is where the next axis comes
nearest to the origin before, and x is square to both axes. Unlike the feet of the common normal, as Denavit and
Hartenberg have them, such an origin is near its link whether axes are parallel, nearly parallel, skew or meet. The
first frame is placed in the world as a whole, which takes gravity along, and the grasp in the last one.

Nor do torques tell all mass properties of a link from those of the link before: of what is symmetric about a joint's
axis only the moment of inertia about it counts with the link behind the joint. The rest is moved to the link before
it. Gautier and Khalil, Direct calculation of minimum set of inertial parameters of serial robots (1990).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

from liftopt.errors import ModelError
from liftopt.types import Array

KINDS = {"JointModelRZ": "R", "JointModelPZ": "P"}


@dataclass(frozen=True)
class LinkBody:
    """What a link adds to torques: ``mass``, ``first`` (3,) moment, ``inertia`` (3, 3) about its frame's origin."""

    mass: float
    first: Array
    inertia: Array

    def __add__(self, other: LinkBody) -> LinkBody:
        return LinkBody(self.mass + other.mass, self.first + other.first, self.inertia + other.inertia)

    def __sub__(self, other: LinkBody) -> LinkBody:
        return LinkBody(self.mass - other.mass, self.first - other.first, self.inertia - other.inertia)

    def seen(self, place: pin.SE3) -> LinkBody:
        """Return the same body in the axes of another frame and about its origin, which sees this one at ``place``."""
        turn, far = place.rotation, place.translation
        first = turn @ self.first
        mixed = np.outer(first, far)
        second = 2.0 * (first @ far) * np.eye(3) - mixed - mixed.T
        steiner = self.mass * (far @ far * np.eye(3) - np.outer(far, far))
        return LinkBody(self.mass, first + self.mass * far, turn @ self.inertia @ turn.T + second + steiner)


@dataclass(frozen=True)
class Step:
    """From one joint's frame to the next one's: ``alpha`` and ``offset`` [rad], ``a`` and ``b`` [m]; see the module.

    Attributes:
        cosine, sine: of alpha.
        a, b: zero where the next joint slides.
        offset: zero for the last joint.
    """

    cosine: float
    sine: float
    a: float
    b: float
    offset: float

    @property
    def placement(self) -> pin.SE3:
        """Of the next frame where its joint is at zero."""
        tilt = np.array([[1.0, 0.0, 0.0], [0.0, self.cosine, -self.sine], [0.0, self.sine, self.cosine]])
        turned = pin.utils.rotate("z", self.offset)
        return pin.SE3(tilt @ turned, tilt @ np.array([self.a, self.b, 0.0]))


@dataclass(frozen=True)
class ArmFrames:
    """A serial arm as its kernels see it.

    Attributes:
        kinds: of the joints from the base on, R for one that turns and P for one that slides.
        base: placement of the first frame in the world, where its joint is at zero.
        steps: to the second joint's frame, and on.
        own: of each joint, its frame here in the frame that the model gives its link.
        bodies: of the links.
    """

    kinds: str
    base: pin.SE3
    steps: tuple[Step, ...]
    own: tuple[pin.SE3, ...]
    bodies: tuple[LinkBody, ...]

    @staticmethod
    def of(model: pin.Model) -> ArmFrames:
        """Read them out of a Pinocchio model.

        Raises:
            ModelError: it is no serial arm of joints that turn about or slide along their z axes.
        """
        kinds = arm_kinds(model)
        own, steps, origin = [], [], np.zeros(3)
        for j in range(1, model.njoints - 1):
            after = model.jointPlacements[j + 1]
            axis = after.rotation[:, 2]
            # x is square to both axes; where they are parallel, any x square to them serves.
            here = pin.SE3(pin.utils.rotate("z", np.arctan2(axis[0], -axis[1])), origin)
            own.append(here)
            seen = after.actInv(origin)
            origin = seen if kinds[j] == "P" else np.array([0.0, 0.0, seen[2]])
            across = here.inverse() * after * pin.SE3(np.eye(3), origin)
            steps.append(_step(across))
        # The last x axis is free: it takes its joint's offset away.
        turned = pin.utils.rotate("z", -steps[-1].offset) if steps else np.eye(3)
        own.append(pin.SE3(turned, origin))
        for j, (here, step) in enumerate(zip(own[1:], steps, strict=True)):
            steps[j] = replace(step, offset=_turned_about_z(pin.utils.rotate("z", step.offset) @ here.rotation))
        if steps:
            steps[-1] = replace(steps[-1], offset=0.0)
        bodies = [_body(model.inertias[j], own[j - 1]) for j in range(1, model.njoints)]
        return ArmFrames(
            kinds, model.jointPlacements[1] * own[0], tuple(steps), tuple(own), tuple(grouped(kinds, steps, bodies))
        )


def arm_kinds(model: pin.Model) -> str:
    """Return the kinds of the joints of a serial arm from the base on, R and P.

    Raises:
        ModelError: it is none, or a joint neither turns about nor slides along its z axis.
    """
    names = [joint.shortname() for joint in list(model.joints)[1:]]
    serial = [int(parent) for parent in model.parents] == [0, *range(model.njoints - 1)]
    if not serial or not names or not {*names} <= {*KINDS} or np.any(model.armature):
        raise ModelError(f"{model.name}: must be a serial arm whose joints turn about or slide along their z axes")
    return "".join(KINDS[name] for name in names)


def grouped(kinds: str, steps: list[Step], bodies: list[LinkBody]) -> list[LinkBody]:
    """Return bodies that take the same torques, with no more numbers than count; see ``counts``."""
    bodies = [*bodies]
    for j in reversed(range(len(kinds))):
        body, counted = bodies[j], counts(kinds, j)
        if kinds[j] == "R":
            moved = LinkBody(body.mass, body.first * [0, 0, 1], body.inertia[1, 1] * np.diag([1.0, 1.0, 0.0]))
        else:
            moved = LinkBody(0.0, np.zeros(3), body.inertia)
        if j:
            bodies[j - 1] += moved.seen(steps[j - 1].placement)
        body -= moved
        kept = np.zeros((3, 3))
        for row, column in counted.inertia:
            kept[row, column] = kept[column, row] = body.inertia[row, column]
        first = np.array([body.first[axis] if axis in counted.first else 0.0 for axis in range(3)])
        bodies[j] = LinkBody(body.mass if counted.mass else 0.0, first, kept)
    return bodies


@dataclass(frozen=True)
class Counted:
    """Which numbers of a link's body count: its mass, axes of its first moment, entries of its inertia."""

    mass: bool
    first: tuple[int, ...]
    inertia: tuple[tuple[int, int], ...]


def counts(kinds: str, j: int) -> Counted:
    """Return which numbers of the body of joint j (0 is the first) count, once the others have been moved."""
    turns = "R" in kinds[:j]
    if kinds[j] == "P":
        return Counted(True, (0, 1, 2) if turns else (), ())
    return Counted(False, (0, 1), ((0, 0), (0, 1), (0, 2), (1, 2), (2, 2)) if turns else ((2, 2),))


def _step(across: pin.SE3) -> Step:
    """Return the step of a placement whose z axis has no part along x."""
    sine, cosine = -across.rotation[1, 2], across.rotation[2, 2]
    back = np.array([[1.0, 0.0, 0.0], [0.0, cosine, sine], [0.0, -sine, cosine]])
    at = back @ across.translation
    return Step(float(cosine), float(sine), float(at[0]), float(at[1]), _turned_about_z(back @ across.rotation))


def _turned_about_z(rotation: Array) -> float:
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))


def _body(inertia: pin.Inertia, own: pin.SE3) -> LinkBody:
    """Return a link's body in its frame here."""
    centred = LinkBody(inertia.mass, np.zeros(3), np.asarray(inertia.inertia))
    place = own.inverse() * pin.SE3(np.eye(3), inertia.lever)
    return centred.seen(place)
