"""The whole person: feet that stay, legs, trunk and two arms, 20 joints, as a URDF and an agent.

Both legs move as one in the sagittal plane, with the mass and the strength of two. Trunk and arms are those of Table 2;
the left arm is the right one's mirror image, so that equal angles on both sides are mirror images of each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import radians

import numpy as np

from liftopt.multibody.agent import Agent, Grasp, HalfSpace
from liftopt.multibody.dh import BodyInertia, DHChain, frame_transforms, human_rows
from liftopt.multibody.person.anthropometry import LinkLengths, landmarks, link_lengths
from liftopt.multibody.person.bodies import whole_bodies
from liftopt.multibody.person.comfort import human_lean, whole_comfort
from liftopt.multibody.person.human import NAME, ORIGIN, POSTURE_DEG, human_root, joint_bounds
from liftopt.multibody.person.human_shapes import whole_shapes
from liftopt.multibody.person.lumbar_levers import BEND, spine_shares
from liftopt.multibody.person.lumbosacral import pressed_disc
from liftopt.multibody.person.stance import human_stance
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_joints import ARM, HANDS, JOINTS, TRUNK, table_joint, whole_limits
from liftopt.multibody.placement import Placement
from liftopt.multibody.urdf import (
    FixedLink,
    MovingLink,
    joint_name,
    link_name,
    link_placements,
    load_model,
    tree_robot,
    urdf_text,
)
from liftopt.types import Array

LEG_POSTURE_DEG = {"ankle": 10.0, "knee": 20.0, "hip": 10.0}
# Reflections: of the world in the body's median plane, and of a frame's own z axis, about which its joint turns.
MIRRORED_WORLD, MIRRORED_AXIS = np.diag([1.0, -1.0, 1.0, 1.0]), np.diag([1.0, 1.0, -1.0, 1.0])


@dataclass(frozen=True)
class WholeLengths:
    """Where the joints of an upright person are.

    Attributes:
        links: L1 to L6 of Table 2 with the right arm; L1 is the height of the spine's base [m].
        left: the same with the left arm.
        ankle, knee, hip: heights of the joints [m].
        ahead: how far the spine's base, and with it trunk and arms, is ahead of the hip [m].
    """

    links: LinkLengths
    left: LinkLengths
    ankle: float
    knee: float
    hip: float
    ahead: float = 0.0

    @staticmethod
    def of(subject: Subject) -> WholeLengths:
        """Return those of the subject."""
        heights, links = landmarks(subject), link_lengths(subject)
        return WholeLengths(links, links, heights.ankle, heights.knee, heights.hip)

    @property
    def arms(self) -> dict[str, LinkLengths]:
        """L1 to L6 by side."""
        return dict(zip(HANDS, (self.links, self.left), strict=True))

    @property
    def limbs(self) -> dict[str, float]:
        """Length of every limb by the joint that moves it [m]."""
        found = {"ankle": self.knee - self.ankle, "knee": self.hip - self.knee}
        for side, links in self.arms.items():
            found |= {f"{side}_Q6": links.l4, f"{side}_Q8": links.l5, f"{side}_Q10": links.l6}
        return found


@dataclass(frozen=True)
class _Segment:
    """A link of the tree: its joint, the joint that carries it ("" for the feet), and T_feet_link (4, 4) at zero."""

    joint: str
    parent: str
    placement: Array


def mirrored(placement: Array) -> Array:
    """Return the mirror image (..., 4, 4) of placements of the right arm's frames: those of the left arm's.

    With M the reflection in the median plane and N that of the frame's z axis it is M T N. A turn about z is the same
    on both sides, N Rz(q) N = Rz(q), so an angle keeps its sign.
    """
    return np.asarray(MIRRORED_WORLD @ placement @ MIRRORED_AXIS)


def whole_human_agent(
    subject: Subject,
    urdf: str | None = None,
    *,
    name: str = NAME,
    place: Placement = ORIGIN,
    hands: Sequence[str] = HANDS,
    compression: float | None = None,
) -> Agent:
    """Return the subject as an agent that stands on two feet and holds with one hand or both.

    Joints are in the order of ``JOINTS``. Both arms always move: the effort of one that is free counts, so it hangs.
    Grasp points stay ahead of the feet's origin.

    Args:
        subject: who it is.
        urdf: the subject's URDF if it was written before; None writes it.
        name: begins the names of its joints and links.
        place: of the feet.
        hands: that hold, ``"right"``, ``"left"`` or both, in the order of the results.
        compression: largest of the lumbar spine at L5/S1 [N]; None where nothing is asked of it.
    """
    text, ahead = urdf or whole_human_urdf(subject, name, place), place.ahead
    degrees, upright = POSTURE_DEG | LEG_POSTURE_DEG, place.T_world_base[:3, :3]
    base = joint_name(name, BEND)
    return Agent(
        name=name,
        kind="person",
        urdf=text,
        model=load_model(text),
        locked_joints=(),
        grasps=tuple(Grasp(f"{name}_{hand}", grasp_frame(name, hand)) for hand in hands),
        hands=tuple(grasp_frame(name, hand) for hand in HANDS),
        limits=whole_limits(subject),
        posture=np.array([radians(degrees.get(table_joint(joint), 0.0)) for joint in JOINTS]),
        workspace=HalfSpace(ahead, float(ahead @ (place.x, place.y, 0.0))),
        comfort=whole_comfort(),
        spine=spine_shares(JOINTS),
        stance=human_stance(subject),
        lean=human_lean(joint_name(name, TRUNK[-1])),
        disc=None if compression is None else pressed_disc(subject, base, upright, compression),
    )


def grasp_frame(name: str, hand: str) -> str:
    """Return the name of the frame with which a hand holds, ``"human_right_grasp"``."""
    return f"{name}_{hand}_grasp"


def whole_human_urdf(
    subject: Subject, name: str = NAME, place: Placement = ORIGIN, measured: WholeLengths | None = None
) -> str:
    """Return the subject's URDF; arguments as ``whole_human_agent``.

    With measured lengths the joints are where these have them, and the bodies are the subject's: those of the limbs
    keep their mass and are stretched to the measured length, the pelvis' keeps its place above the hip, the trunk's
    above the base of the spine. Shapes are the subject's own, as they are only looked at.
    """
    shapes, bounds = whole_shapes(subject), joint_bounds(JOINTS, whole_limits(subject))
    own, lengths = WholeLengths.of(subject), measured or WholeLengths.of(subject)
    bodies = _bodies(subject, _segments(own)[0])
    segments, grasps = _segments(lengths)
    if measured:
        bodies = _with_lengths(bodies, own, measured)
    # A URDF reader takes the joints of a branching by name, and "left" comes before "right": the left arm stands on a
    # link of its own, whose joint human_shoulder_left_fixed comes after human_right_Q4, so that the right arm is first.
    base, shoulder = f"{name}_base", f"{name}_shoulder_left"
    at = {"": np.eye(4)} | {item.joint: item.placement for item in segments}
    links = {joint: link_name(name, joint) if joint else base for joint in at}
    first_left = f"left_{ARM[0]}"
    at[shoulder], links[shoulder] = at[first_left], shoulder
    of_subject = {item.joint: item.placement for item in _segments(own)[0]}
    moving = []
    for item in segments:
        parent = shoulder if item.joint == first_left else item.parent
        to_link = np.asarray(np.linalg.inv(of_subject[item.joint]), dtype=np.float64)
        moving.append(
            MovingLink(
                joint_name(name, item.joint),
                links[item.joint],
                links[parent],
                "revolute",
                _between(at[parent], item.placement),
                bounds[item.joint],
                bodies[item.joint],
                tuple(shape.seen_from(to_link) for shape in shapes.get(item.joint, ())),
            )
        )
    feet = whole_bodies(subject)["feet"].rounded()
    fixed = [
        FixedLink(base, "world", place.T_world_base, feet, shapes["feet"]),
        FixedLink(shoulder, links[TRUNK[-1]], _between(at[TRUNK[-1]], at[first_left])),
    ]
    for hand in HANDS:
        carrier = f"{hand}_{ARM[-1]}"
        fixed.append(FixedLink(grasp_frame(name, hand), links[carrier], _between(at[carrier], grasps[hand])))
    return urdf_text(tree_robot(name, moving, fixed))


def _segments(lengths: WholeLengths) -> tuple[list[_Segment], dict[str, Array]]:
    """Return the tree's links, parents first, and T_feet_grasp of each hand, all joints at zero."""
    legs = {"ankle": lengths.ankle, "knee": lengths.knee, "hip": lengths.hip}
    segments, parent = [], ""
    for joint, height in legs.items():
        segments.append(_Segment(joint, parent, _sagittal(height, forward=joint != "knee")))
        parent = joint
    table, grasps = _table(lengths.links, lengths.ahead)[0], {}
    for joint in TRUNK:
        segments.append(_Segment(joint, parent, table[joint]))
        parent = joint
    for side, links in lengths.arms.items():
        (table, hand), above = _table(links, lengths.ahead), parent
        for joint in ARM:
            at = table[joint] if side == "right" else mirrored(table[joint])
            segments.append(_Segment(f"{side}_{joint}", above, at))
            above = f"{side}_{joint}"
        grasps[side] = hand if side == "right" else mirrored(hand)
    return segments, grasps


def _table(links: LinkLengths, ahead: float) -> tuple[dict[str, Array], Array]:
    """Return T_feet_link of Table 2's joints by name, and T_feet_grasp, of a right arm whose spine is ahead so far."""
    rows = human_rows(*vars(links).values())
    chain = DHChain(NAME, rows, tuple(BodyInertia.zero() for _ in rows))
    table = link_placements(chain, human_root())
    hand = human_root() @ frame_transforms(chain, np.zeros(len(rows)))[-1]
    if ahead:
        for placement in (*table.values(), hand):
            placement[0, 3] += ahead
    return table, hand


def _sagittal(height: float, *, forward: bool) -> Array:
    """Return a frame above the feet's origin with x up and z along the axis about which flexion is positive.

    Args:
        height: of the joint [m].
        forward: whether flexion takes what is above the joint forward (ankle, hip) or back (knee).
    """
    sign = 1.0 if forward else -1.0
    placement = np.eye(4)
    placement[:3, :3] = np.array([[0.0, 0.0, 1.0], [sign, 0.0, 0.0], [0.0, sign, 0.0]]).T
    placement[2, 3] = height
    return placement


def _between(first: Array, second: Array) -> Array:
    """Return T_first_second (4, 4) of two placements; turns by quarters stay exact."""
    placement = np.eye(4)
    placement[:3, :3] = first[:3, :3].T @ second[:3, :3]
    placement[:3, 3] = first[:3, :3].T @ (second[:3, 3] - first[:3, 3])
    return placement


def _bodies(subject: Subject, segments: Sequence[_Segment]) -> dict[str, BodyInertia]:
    """Return the subject's bodies in the frames of the links; massless where there is none."""
    bodies = whole_bodies(subject)
    return {item.joint: _on_link(bodies.get(item.joint), item.placement) for item in segments}


def _with_lengths(bodies: dict[str, BodyInertia], own: WholeLengths, measured: WholeLengths) -> dict[str, BodyInertia]:
    """Return bodies, in the frames of their links, of one whose joints are elsewhere."""
    changed, limbs = dict(bodies), own.limbs
    for joint, length in measured.limbs.items():
        factor, body = length / limbs[joint], bodies[joint]
        changed[joint] = BodyInertia(body.mass, factor * body.com, factor**2 * body.inertia).rounded()
    before, after = ({item.joint: item.placement for item in _segments(one)[0]} for one in (own, measured))
    last, body = TRUNK[-1], bodies[TRUNK[-1]]
    base = np.array([measured.ahead - own.ahead, 0.0, measured.links.l1 - own.links.l1])
    moved = base - (after[last][:3, 3] - before[last][:3, 3])
    changed[last] = replace(body, com=body.com + after[last][:3, :3].T @ moved).rounded()
    return changed


def _on_link(body: BodyInertia | None, placement: Array) -> BodyInertia:
    """Return a body, given in the axes of the feet, in the frame of its link; massless where there is none."""
    if body is None:
        return BodyInertia.zero()
    rotation = placement[:3, :3].T
    return body.transformed(rotation, -rotation @ placement[:3, 3]).rounded()
