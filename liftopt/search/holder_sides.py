"""On which side of the object parts of those who hold it belong.

A hand that holds an object by its side leaves its forearm outside that side; where the two overlap, that is the way
out, although another one may be shorter. A hand underneath leaves it below, or on the side of whoever holds it. A hand
at an edge may come from either face, so nothing is known of its arm. Legs and trunk are behind what is held.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from liftopt.collocation.problem import Team
from liftopt.collocation.separating_planes import Body
from liftopt.multibody.solids import Solid
from liftopt.types import Array

ON_FACE = 1e-3  # [m]
LEVEL = 0.9  # cosine of the angle of a face's normal from the vertical, of which it counts as level


@dataclass(frozen=True)
class HolderSide:
    """Where a part of a holder belongs.

    Attributes:
        normals: (S, 3) unit vectors from the second solid of the pair to the first, in the object's axes; any will do.
        object_is_first: whether the object is the first solid of the pair.
    """

    normals: Array
    object_is_first: bool


def holder_sides(
    team: Team, solids: Sequence[Solid], bodies: Sequence[Body], ends: npt.NDArray[np.int64]
) -> dict[int, HolderSide]:
    """Return what is known of the sides, by number of the pair of a holder's part and the object.

    It is known of those who have several arms, and stand.

    Args:
        team: who holds what.
        solids: of the team and of what stands around.
        bodies: that carry them.
        ends: (P, 2) numbers of the solids of each pair.
    """
    found: dict[int, HolderSide] = {}
    own = len(team.agents)
    known: dict[Body, Array | None] = {}
    for p, (one, other) in enumerate(ends.tolist()):
        first = bodies[one].part == own
        part, box = (other, one) if first else (one, other)
        body = bodies[part]
        if bodies[box].part != own or not 0 <= body.part < own or solids[box].kind != "box":
            continue
        if body not in known:
            known[body] = _side_of(team, body, solids[box])
        if (side := known[body]) is not None:
            found[p] = HolderSide(-side if first else side, first)
    return found


def _side_of(team: Team, body: Body, box: Solid) -> Array | None:
    """Return the directions (S, 3) from the object in which a holder's body belongs, in the object's axes, or None."""
    agent = team.agents[body.part]
    behind = None if agent.stance is None else -agent.T_world_base[:3, 0]
    if not is_of_an_arm(team, body):
        return None if behind is None else behind[None]
    face = _face(team, box, held_by(team, body))
    if face is None:
        return None
    underneath = face[2] < -LEVEL
    return np.array([face] if behind is None or not underneath else [face, behind])


def is_of_an_arm(team: Team, body: Body) -> bool:
    """Whether an agent's body moves with one of its hands only."""
    return len(_hands_beyond(team, body)) == 1 < len(team.agents[body.part].hands)


def held_by(team: Team, body: Body) -> str | None:
    """Return the object's frame that the arm with a body holds; None if the body is no arm's, or the arm is free."""
    if not is_of_an_arm(team, body):
        return None
    (hand,) = _hands_beyond(team, body)
    frames = iter(team.object.grasp_frames)
    for part, agent in enumerate(team.agents):
        for grasp in agent.grasps:
            frame = next(frames)
            if part == body.part and grasp.frame == hand:
                return frame
    return None


def _hands_beyond(team: Team, body: Body) -> list[str]:
    agent = team.agents[body.part]
    model = agent.reduced()
    carriers = {hand: model.frames[model.getFrameId(hand)].parentJoint for hand in agent.hands}
    return [hand for hand, carrier in carriers.items() if body.joint in model.supports[carrier].tolist()]


def _face(team: Team, solid: Solid, frame: str | None) -> Array | None:
    """Return the outward normal (3,) of the one face of a box that a grasp frame of the object is on, or None."""
    if frame is None:
        return None
    model = team.object.model
    point = model.frames[model.getFrameId(frame)].placement.translation
    inside = solid.T_joint_solid[:3, :3].T @ (point - solid.T_joint_solid[:3, 3])
    faces = np.flatnonzero(np.abs(inside) > np.array(solid.size) / 2.0 - ON_FACE)
    if len(faces) != 1:
        return None
    axis = int(faces[0])
    return np.asarray(np.sign(inside[axis]) * solid.T_joint_solid[:3, axis])
