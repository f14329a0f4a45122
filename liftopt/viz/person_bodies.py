"""Which body of the playback carries which part of a person, and bodies half way between two where a joint bends.

What is drawn on a body half way is turned half as far as the joint: it fills what two rigid parts leave open.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from liftopt.ergonomics.limbs import Arm, arms_of, grasps_of, has_legs
from liftopt.ergonomics.posture import TRUNK
from liftopt.multibody.dh import translation
from liftopt.multibody.person.anthropometry import landmarks
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array
from liftopt.viz.scene_hand import LEFT, RIGHT

UPPER_ARM, FOREARM, HAND = "Q6", "Q8", "Q10"  # joints whose links are these
FREE_ARM, FEET = "free_arm", "feet"  # end the names of the bodies of an arm that has no joints, and of what stands


@dataclass(frozen=True)
class ArmBodies:
    """Bodies of one arm.

    Attributes:
        word: ``"right"`` or ``"left"``.
        side: ``RIGHT`` or ``LEFT``.
        upper, forearm, wrist: that carry upper arm, forearm and a hand that holds nothing.
        hand: begins the names of palm and bones of one that holds, ``"human_right"``; empty where it holds nothing.
        grasp: number of the agent's grasp with which it holds, -1 where it holds nothing.
        moves: whether its joints move it.
    """

    word: str
    side: float
    upper: str
    forearm: str
    wrist: str
    hand: str
    grasp: int
    moves: bool = True


@dataclass(frozen=True)
class PersonBodies:
    """Bodies of one person.

    Attributes:
        feet, shank, thigh, pelvis, trunk: that carry these; the same where they do not move against each other.
        knee, groin, waist: half way between the two at this joint; the same as both where it does not move.
        arms: the right one first.
    """

    feet: str
    shank: str
    thigh: str
    pelvis: str
    trunk: str
    knee: str
    groin: str
    waist: str
    arms: tuple[ArmBodies, ...]

    @staticmethod
    def of(person: AgentTrajectory) -> PersonBodies:
        """Return the bodies of a person."""
        name, arms = person.name, tuple(_arm(person, arm) for arm in arms_of(person))
        trunk, waist = f"{name}_{TRUNK}", f"{name}_waist"
        if has_legs(person):
            shank, thigh, pelvis = (f"{name}_{joint}" for joint in ("ankle", "knee", "hip"))
            feet, knee, groin = (f"{name}_{word}" for word in (FEET, "bent_knee", "groin"))
            return PersonBodies(feet, shank, thigh, pelvis, trunk, knee, groin, waist, arms)
        legs, free = f"{name}_GT3", f"{name}_{FREE_ARM}"
        left = ArmBodies("left", LEFT, free, free, free, "", -1, moves=False)
        return PersonBodies(legs, legs, legs, legs, trunk, legs, legs, waist, (*arms, left))


@dataclass(frozen=True)
class Between:
    """A body half way between two links.

    Attributes:
        below, above: the links, the one nearer to the feet first.
        T_base_joint: (4, 4) its frame at zero, at the joint, in the axes of the person upright.
    """

    below: str
    above: str
    T_base_joint: Array


def bodies_between(bodies: PersonBodies, subject: Subject) -> dict[str, Between]:
    """Return the bodies half way that a subject has, by name."""
    at = landmarks(subject)
    found = {
        bodies.knee: Between(bodies.shank, bodies.thigh, translation(0.0, 0.0, at.knee)),
        bodies.groin: Between(bodies.thigh, bodies.pelvis, translation(0.0, 0.0, at.hip)),
        bodies.waist: Between(bodies.pelvis, bodies.trunk, translation(0.0, 0.0, at.omphalion)),
    }
    return {name: between for name, between in found.items() if between.below != between.above}


def half_way(between: Between, T_base_link: Mapping[str, Array], T_world_link: Mapping[str, Array]) -> Array:
    """Return T_world_body (K, 4, 4) of a body half way.

    Args:
        between: what it is between.
        T_base_link: (4, 4) the links' joints at zero, in the axes of the person upright.
        T_world_link: (K, 4, 4) those joints over the lift.
    """
    lower, upper = (
        T_world_link[link] @ (np.linalg.inv(T_base_link[link]) @ between.T_base_joint)
        for link in (between.below, between.above)
    )
    bend = Rotation.from_matrix(lower[:, :3, :3].swapaxes(1, 2) @ upper[:, :3, :3])
    half = np.array(lower)
    half[:, :3, :3] = lower[:, :3, :3] @ Rotation.from_rotvec(0.5 * bend.as_rotvec()).as_matrix()
    return half


def _arm(person: AgentTrajectory, arm: Arm) -> ArmBodies:
    held = grasps_of(person, arm)
    upper, forearm, wrist = (f"{arm.prefix}{joint}" for joint in (UPPER_ARM, FOREARM, HAND))
    side = RIGHT if arm.side == "right" else LEFT
    hand, grasp = (f"{person.name}_{arm.side}", held[0]) if held else ("", -1)
    return ArmBodies(arm.side, side, upper, forearm, wrist, hand, grasp)
