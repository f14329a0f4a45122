"""With which link a robot could hold: candidates by name and by where they are, the likeliest first."""

from __future__ import annotations

import re
from dataclasses import dataclass

from liftopt.multibody.robots.description import ONE_AXIS, RobotDescription, RobotJoint

# Words in names of links, the likeliest first.
WORDS = (
    ("tcp", "tool0"),
    ("tool",),
    ("ee", "eef", "effector"),
    ("grasp",),
    ("flange",),
    ("gripper",),
    ("hand",),
    ("palm",),
)
NOT = {
    "camera", "range", "imu", "sensor", "optical", "accelerometer", "axis", "visual", "collision", "skin", "dh",
    "finger", "fingertip", "leftfinger", "rightfinger", "thumb", "index", "middle", "ring", "little", "mrl", "motor",
    "led", "knuckle", "mover", "sole", "foot",
}  # fmt: skip
FINGER = re.compile(r"finger|thumb|jaw|knuckle|grip|hand_", re.IGNORECASE)
AN_ARM = 3  # joints that move, from which a leaf of the tree may be the end of an arm


@dataclass(frozen=True)
class GraspCandidate:
    """A link that a robot could hold with.

    Attributes:
        frame: its name.
        joints: number of joints that move it.
        arm: the first and the last of them: candidates of other arms have others.
        rank: of the word in its name, 0 for the likeliest.
        why: what speaks for it, in words.
    """

    frame: str
    joints: int
    arm: tuple[str, str]
    rank: int
    why: str


def grasp_candidates(description: RobotDescription, base: str) -> tuple[GraspCandidate, ...]:
    """Return the best candidate of each arm on a base, the likeliest first; none where nothing moves."""
    found = [c for link in description.links if (c := _candidate(description, base, link.name)) is not None]
    found.sort(key=lambda c: (c.rank, -c.joints, -_depth(description, c.frame)))
    best: dict[tuple[str, str], GraspCandidate] = {}
    for candidate in found:
        best.setdefault(candidate.arm, candidate)
    return tuple(best.values())


def rivals(candidates: tuple[GraspCandidate, ...]) -> tuple[GraspCandidate, ...]:
    """Return those that are as likely as the first, which is not among them."""
    return tuple(c for c in candidates[1:] if (c.rank, c.joints) == (candidates[0].rank, candidates[0].joints))


def _candidate(description: RobotDescription, base: str, link: str) -> GraspCandidate | None:
    path = description.joints_between(base, link) or ()
    moving = [joint for joint in path if joint.kind in ONE_AXIS]
    words = [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])\d*|[A-Z]?[a-z]+\d*", link)]
    if not moving or any(_is_finger(joint, moving) for joint in moving) or NOT & set(words):
        return None
    arm = (moving[0].name, moving[-1].name)
    for rank, likely in enumerate(WORDS):
        said = next((word for word in words if word in likely), None)
        if said is not None:
            why = f"its name has {said!r} and {len(moving)} joints move it"
            return GraspCandidate(link, len(moving), arm, rank, why)
    if len(moving) >= AN_ARM and link in description.leaves:
        why = f"it is the end of {len(moving)} joints"
        return GraspCandidate(link, len(moving), arm, len(WORDS), why)
    return None


def _is_finger(joint: RobotJoint, path: list[RobotJoint]) -> bool:
    """Return whether a joint moves a finger; an elbow may follow a joint before it, a finger follows one beside it."""
    follows = joint.mimic is not None and all(joint.mimic.joint != other.name for other in path)
    return follows or FINGER.search(joint.name) is not None


def _depth(description: RobotDescription, link: str) -> int:
    return sum(1 for _ in description.above(link))
