"""On which side of the object the arms are that hold it: outside the face that their hand lies on.

A hand that holds an object by its side leaves its forearm beside that side; where the two overlap, that is the way out,
although another one may be shorter. A hand at an edge may come from either face, so nothing is known of its arm.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from liftopt.collocation.problem import Team
from liftopt.collocation.separating_planes import Body
from liftopt.multibody.solids import Solid
from liftopt.types import Array

ON_FACE = 1e-3  # [m]


def outward_normals(
    team: Team, solids: Sequence[Solid], bodies: Sequence[Body], ends: npt.NDArray[np.int64]
) -> dict[int, Array]:
    """Return the outward normal (3,) of the held face, in the object's axes, by number of the pair of arm and object.

    It points from the second solid of the pair to the first. Only arms of those who have several are in it: of others
    the trunk moves with the arm.

    Args:
        team: who holds what.
        solids: of the team and of what stands around.
        bodies: that carry them.
        ends: (P, 2) numbers of the solids of each pair.
    """
    found: dict[int, Array] = {}
    own, held = len(team.agents), {}
    for p, pair in enumerate(ends.tolist()):
        for sign, (arm, box) in ((1.0, pair), (-1.0, pair[::-1])):
            body = bodies[arm]
            if bodies[box].part != own or not 0 <= body.part < own or solids[box].kind != "box":
                continue
            if body not in held:
                held[body] = held_by(team, body)
            outward = _face(team, solids[box], held[body])
            if outward is not None:
                found[p] = sign * outward
    return found


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
