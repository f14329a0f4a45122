"""Hands and grippers that close around the object's edge, frame by frame.

The models have a hand as one rigid body that touches the object at a point. What is drawn follows that body; palm,
fingers and jaws only lean and bend as far as the object's faces ask them to.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liftopt.multibody.dh import rotation_z, translation
from liftopt.multibody.edges import Hold
from liftopt.multibody.person.anthropometry import link_lengths
from liftopt.multibody.person.subject import Subject
from liftopt.types import Array
from liftopt.viz.digits import Digit, closed_on, distance_to_box
from liftopt.viz.scene_gripper import FLANGE, gripper_digits
from liftopt.viz.scene_hand import FINGERS, PALM, T_person_palm, hand_digits, palm_tilt

FLAT: tuple[Hold, ...] = ("bottom", "side")  # holds of a flat hand
TILTS = 41  # of the palm that are tried
TOUCHING = 1e-3  # [m]
PALM_LOOKED_AT = (0.6, 0.8, 1.0)  # as shares of the way from wrist to knuckles


def held_by_hand(
    hand: str, subject: Subject, side: float, hold: Hold, T_person_last: Array, T_world_last: Array,
    T_world_object: Array, half: Array,
) -> dict[str, Array]:  # fmt: skip
    """Return T_world_body (K, 4, 4) of palm and bones, by body.

    Args:
        hand: which one, ``"human_right"``; the bodies' names begin with it.
        subject: whose it is.
        side: ``RIGHT`` or ``LEFT``.
        hold: how it holds: flat on a side or under the bottom, as a fist in a handle, around an edge else.
        T_person_last: (4, 4) the frame of the wrist's last joint at zero, in the axes of the person upright.
        T_world_last: (K, 4, 4) that frame over the lift.
        T_world_object: (K, 4, 4) of the object's centre.
        half: (3,) half sizes of the object [m].
    """
    straight = T_world_last @ (np.linalg.inv(T_person_last) @ T_person_palm(subject, side))
    T_object_world = np.asarray(np.linalg.inv(T_world_object))
    palm = straight @ _tilts(subject, T_object_world @ straight, half)
    digits = hand_digits(subject, side, flat=hold in FLAT)
    bones = closed_bones(hand, digits, palm, T_object_world, half, FINGERS if hold == "handle" else ())
    return {f"{hand}_palm": palm, **bones}


def held_by_gripper(
    robot: str, length: float, T_world_grasp: Array, T_world_object: Array, half: Array
) -> dict[str, Array]:
    """Return T_world_body (K, 4, 4) of a gripper and its fingers, by body; nothing for the bare flange.

    Args:
        robot: its name, which the bodies' begin with.
        length: from the flange to the grasp point [m].
        T_world_grasp: (K, 4, 4) the frame that it holds with over the lift, z away from the flange.
        T_world_object: (K, 4, 4) of the object's centre.
        half: (3,) half sizes of the object [m].
    """
    if length <= 0.0:
        return {}
    tool = T_world_grasp @ translation(0.0, 0.0, -length - FLANGE)
    gripper = tool @ rotation_z(gripper_roll(tool, T_world_object))
    bones = closed_bones(robot, gripper_digits(length), gripper, np.asarray(np.linalg.inv(T_world_object)), half)
    return {f"{robot}_gripper": gripper, **bones}


def closed_bones(
    name: str, digits: tuple[Digit, ...], T_world_palm: Array, T_object_world: Array, half: Array,
    inside: Sequence[str] = (),
) -> dict[str, Array]:  # fmt: skip
    """Return T_world_bone (K, 4, 4) of all bones of digits that close on the object, ``<name>_index_1`` and so on.

    Digits named in ``inside`` reach into a handle: they close as far as they can.
    """
    bones = {}
    for digit in digits:
        if digit.name in inside:
            angles = np.tile(digit.closed, (len(T_world_palm), 1))
        else:
            angles = closed_on(digit, T_object_world @ T_world_palm, half)
        frames = digit.frames(angles)
        for j in range(len(digit.bones)):
            bones[f"{name}_{digit.name}_{j + 1}"] = T_world_palm @ frames[:, j]
    return bones


def gripper_roll(T_world_tool: Array, T_world_object: Array) -> float:
    """Return how a gripper is mounted about the tool's z axis so that it opens across the held face's edges [rad].

    The model's tool is round; of all mounts this is the one whose jaws, which part along the mounted gripper's y, part
    most along the object's vertical over the lift.
    """
    up = T_world_object[:, :3, 2]
    x, y = (np.einsum("ki,ki->k", T_world_tool[:, :3, i], up) for i in (0, 1))
    return float(0.5 * np.arctan2(-2.0 * np.sum(x * y), np.sum(y * y) - np.sum(x * x)))


def _tilts(subject: Subject, T_object_palm: Array, half: Array) -> Array:
    """Return turns (K, 4, 4) about the palm's y that take the palm out of the object, inside towards it.

    The bone of the model goes from the wrist to the grasp point; flesh lies around it.
    """
    reach, most = link_lengths(subject).l6, palm_tilt(subject)
    tried = np.linspace(most, -most, TILTS)
    shares = np.array(PALM_LOOKED_AT) * reach
    points = np.stack([np.outer(np.cos(tried), shares), np.zeros((TILTS, 3)), np.outer(-np.sin(tried), shares)], -1)
    seen = np.einsum("kij,tsj->ktsi", T_object_palm[:, :3, :3], points) + T_object_palm[:, None, None, :3, 3]
    apart = (distance_to_box(seen, half) - PALM).min(axis=-1)
    free = apart > -TOUCHING
    chosen = tried[np.where(free.any(axis=1), np.argmax(free, axis=1), np.argmax(apart, axis=1))]
    turns = np.tile(np.eye(4), (len(chosen), 1, 1))
    turns[:, 0, 0] = turns[:, 2, 2] = np.cos(chosen)
    turns[:, 0, 2], turns[:, 2, 0] = np.sin(chosen), -np.sin(chosen)
    return turns
