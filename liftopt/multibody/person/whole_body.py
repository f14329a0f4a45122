"""The whole person: feet that stay, legs, trunk and two arms, 20 joints, as a URDF and an agent.

Both legs move as one in the sagittal plane, with the mass and the strength of two. Trunk and arms are those of Table 2;
the left arm is the right one's mirror image, so that equal angles on both sides are mirror images of each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import radians

import numpy as np

from liftopt.multibody.agent import Agent, Grasp, HalfSpace
from liftopt.multibody.dh import BodyInertia, frame_transforms
from liftopt.multibody.person.anthropometry import landmarks
from liftopt.multibody.person.bodies import whole_bodies
from liftopt.multibody.person.comfort import human_lean, whole_comfort
from liftopt.multibody.person.human import NAME, ORIGIN, POSTURE_DEG, human_chain, human_root, joint_bounds
from liftopt.multibody.person.human_shapes import whole_shapes
from liftopt.multibody.person.lumbar_levers import spine_shares
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
    """
    text, ahead = urdf or whole_human_urdf(subject, name, place), place.ahead
    degrees = POSTURE_DEG | LEG_POSTURE_DEG
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
    )


def grasp_frame(name: str, hand: str) -> str:
    """Return the name of the frame with which a hand holds, ``"human_right_grasp"``."""
    return f"{name}_{hand}_grasp"


def whole_human_urdf(subject: Subject, name: str = NAME, place: Placement = ORIGIN) -> str:
    """Return the subject's URDF; arguments as ``whole_human_agent``."""
    bodies, shapes = whole_bodies(subject), whole_shapes(subject)
    bounds = joint_bounds(JOINTS, whole_limits(subject))
    segments, grasps = _segments(subject)
    # A URDF reader takes the joints of a branching by name, and "left" comes before "right": the left arm stands on a
    # link of its own, whose joint human_shoulder_left_fixed comes after human_right_Q4, so that the right arm is first.
    base, shoulder = f"{name}_base", f"{name}_shoulder_left"
    at = {"": np.eye(4)} | {item.joint: item.placement for item in segments}
    links = {joint: link_name(name, joint) if joint else base for joint in at}
    first_left = f"left_{ARM[0]}"
    at[shoulder], links[shoulder] = at[first_left], shoulder
    moving = []
    for item in segments:
        parent = shoulder if item.joint == first_left else item.parent
        to_link = np.asarray(np.linalg.inv(item.placement), dtype=np.float64)
        moving.append(
            MovingLink(
                joint_name(name, item.joint),
                links[item.joint],
                links[parent],
                "revolute",
                _between(at[parent], item.placement),
                bounds[item.joint],
                _on_link(bodies.get(item.joint), item.placement),
                tuple(shape.seen_from(to_link) for shape in shapes.get(item.joint, ())),
            )
        )
    feet = bodies["feet"].rounded()
    fixed = [
        FixedLink(base, "world", place.T_world_base, feet, shapes["feet"]),
        FixedLink(shoulder, links[TRUNK[-1]], _between(at[TRUNK[-1]], at[first_left])),
    ]
    for hand in HANDS:
        carrier = f"{hand}_{ARM[-1]}"
        fixed.append(FixedLink(grasp_frame(name, hand), links[carrier], _between(at[carrier], grasps[hand])))
    return urdf_text(tree_robot(name, moving, fixed))


def _segments(subject: Subject) -> tuple[list[_Segment], dict[str, Array]]:
    """Return the tree's links, parents first, and T_feet_grasp of each hand, all joints at zero."""
    heights, chain = landmarks(subject), human_chain(subject)
    legs = {"ankle": heights.ankle, "knee": heights.knee, "hip": heights.hip}
    segments, parent = [], ""
    for joint, height in legs.items():
        segments.append(_Segment(joint, parent, _sagittal(height, forward=joint != "knee")))
        parent = joint
    table = link_placements(chain, human_root())
    for joint in TRUNK:
        segments.append(_Segment(joint, parent, table[joint]))
        parent = joint
    hand = human_root() @ frame_transforms(chain, np.zeros(len(chain.rows)))[-1]
    for side in HANDS:
        above = parent
        for joint in ARM:
            at = table[joint] if side == "right" else mirrored(table[joint])
            segments.append(_Segment(f"{side}_{joint}", above, at))
            above = f"{side}_{joint}"
    return segments, {"right": hand, "left": mirrored(hand)}


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


def _on_link(body: BodyInertia | None, placement: Array) -> BodyInertia:
    """Return a body, given in the axes of the feet, in the frame of its link; massless where there is none."""
    if body is None:
        return BodyInertia.zero()
    rotation = placement[:3, :3].T
    return body.transformed(rotation, -rotation @ placement[:3, 3]).rounded()
