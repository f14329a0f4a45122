"""What the viewer's camera can look at: presets for the lift as a whole, for every agent, and for the hands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from liftopt.assessment.who import who_is
from liftopt.ergonomics.lift import subject_in
from liftopt.ergonomics.limbs import has_legs
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array
from liftopt.viz.scene import Cast, obstacle_part
from liftopt.viz.scene_part import GROUND
from liftopt.viz.who import is_sawyer, lead_of

Box = list[list[float]]
# Around joints: what of a person, a robot and the hands is in view [m].
BODY, ROBOT, HANDS = 0.25, 0.05, 0.18
LINK = 0.1  # around the joints of a robot from outside [m]
NEARBY = 0.5  # of an obstacle, so much around everybody is in view [m]
SEAT = 0.14  # around the hips of one whose legs bend [m]
# A robot's pedestal ahead of its base, behind it and to its sides, and its head above it [m].
AHEAD, BEHIND, ASIDE, HEAD = 0.2, 0.5, 0.35, 0.65
# From where an agent is seen in its own preset: ahead of it, to its left, up.
OWN = {"person": (0.75, -1.0, 0.15), "robot": (0.45, 1.0, 0.2)}
CLEARER = 0.1  # rad: as much more room on the other side is worth going there
WHOLE = ("three-quarter", "side", "front", "top", "hands")


@dataclass(frozen=True)
class View:
    """One preset of the camera.

    Attributes:
        name: on its button.
        title: what it shows, in words.
        box: lowest and highest corner of what is in view, world axes [m].
        side: (3,) from which side, world axes.
        solid: bodies that stay solid while everything else is see-through; None where all is solid.
    """

    name: str
    title: str
    box: Box
    side: list[float]
    solid: list[str] | None = None

    def plain(self) -> dict[str, object]:
        """Return it ready for JSON."""
        return asdict(self)


def views_of(casts: Sequence[Cast]) -> list[View]:
    """Return the presets for one lift, or for two that are shown together."""
    agents = agents_in(casts)
    boxes = {agent.name: _agent_box(casts, agent) for agent in agents}
    around = np.vstack([*boxes.values(), *(_object_box(cast) for cast in casts)])
    whole = _plain(np.vstack([around, *_obstacle_boxes(casts, around)]))
    points = [force.point + cast.offset for cast in casts for force in cast.playback.forces.values()]
    first = lead_of(agents)
    aside = any(cast.offset != casts[0].offset for cast in casts)
    whose = f"{who_is(first, agents).called}'s"
    views = [
        View(
            "three-quarter",
            f"from {whose} right and ahead",
            whole,
            _from(casts, first, (0.5, -1.0, 0.55 if aside else 0.3)),
        ),
        View("side", f"from {whose} right", whole, _from(casts, first, (0.0, -1.0, 0.02))),
    ]
    if first.kind == "person":
        through = "the robot" if [one.kind for one in agents if one is not first] == ["robot"] else "everybody else"
        bodies = {
            body for cast in casts for body in (*cast.playback.joints.get(first.name, ()), cast.solution.object.name)
        }
        views.append(
            View(
                "front",
                f"straight at {whose} face, through {through}",
                _plain(boxes[first.name]),
                _from(casts, first, (1.0, 0.0, 0.04)),
                sorted(bodies),
            )
        )
    views.append(View("top", "from above", whole, _from(casts, first, (0.0, -0.001, 1.0))))
    for agent in agents:
        button = agent.kind if who_is(agent, agents).is_alone else agent.name
        views.append(
            View(
                button if button not in WHOLE else f"agent {button}",
                f"{who_is(agent, agents).called}, from head to foot",
                _plain(boxes[agent.name]),
                _clear(casts, agent, _from(casts, agent, OWN[agent.kind])),
            )
        )
    held = "hands, gripper and object" if any(agent.kind == "robot" for agent in agents) else "hands and object"
    return [*views, View("hands", held, _plain(np.vstack(points), HANDS), _from(casts, first, (-0.1, -1.0, 0.35)))]


def agents_in(casts: Sequence[Cast]) -> tuple[AgentTrajectory, ...]:
    """Return the agents of all lifts, one of each name."""
    named = {agent.name: agent for cast in reversed(casts) for agent in cast.solution.agents}
    order = dict.fromkeys(agent.name for cast in casts for agent in cast.solution.agents)
    return tuple(named[name] for name in order)


def head_of(cast: Cast, agent: AgentTrajectory) -> Array:
    """Return the top of an agent's head (3,), in the world, as it stands upright [m]."""
    base = cast.playback.bases[agent.name]
    if _is_from_outside(cast, agent):
        return np.array([*base[:2, 3], _standing(cast, agent)[1, 2]]) + cast.offset
    up = subject_in(cast.solution, agent.name).stature if agent.kind == "person" else HEAD
    head = base @ (0.0, 0.0, up, 1.0)
    return np.asarray(head[:3] + cast.offset)


def _is_from_outside(cast: Cast, agent: AgentTrajectory) -> bool:
    return agent.kind == "robot" and not is_sawyer(cast.solution.scenario, agent)


def _standing(cast: Cast, agent: AgentTrajectory) -> Array:
    """Return corners (2, 3) around where an agent stands, from foot to head [m].

    They are in the world, without the offset of the lift. Of a robot from outside they are around what of it does not
    move, its joints over the lift and the floor below its base.
    """
    base = cast.playback.bases[agent.name]
    if not _is_from_outside(cast, agent):
        ahead, behind, aside = (BODY, BODY, BODY) if agent.kind == "person" else (AHEAD, BEHIND, ASIDE)
        around = np.array([base @ (x, y, 0.0, 1.0) for x in (-behind, ahead) for y in (-aside, aside)])[:, :3]
        low, high = around.min(axis=0), around.max(axis=0)
        return np.array([(*low[:2], 0.0), (*high[:2], (head_of(cast, agent) - cast.offset)[2])])
    still = [part.mesh.vertices for part in cast.arms[agent.name] if part.body == GROUND]
    moving = [cast.playback.bodies[name].position for name in cast.playback.joints[agent.name]]
    points = np.vstack([base[:3, 3], base[:3, 3] * (1.0, 1.0, 0.0), *still, *moving])
    return np.array([points.min(axis=0), points.max(axis=0)])


def _clear(casts: Sequence[Cast], agent: AgentTrajectory, side: list[float]) -> list[float]:
    """Return the side (3,) that an agent is seen from, or its mirror image where others stand less in the way."""
    cast = next(cast for cast in casts if agent.name in cast.playback.bases)
    base = cast.playback.bases[agent.name]
    others = [other[:2, 3] - base[:2, 3] for name, other in cast.playback.bases.items() if name != agent.name]
    mirrored: list[float] = (base[:3, :3] @ (base[:3, :3].T @ side * (1.0, -1.0, 1.0))).tolist()
    one, other = (min((_angle(np.array(at[:2]), way) for way in others), default=0.0) for at in (side, mirrored))
    return mirrored if other > one + CLEARER else side


def _angle(a: Array, b: Array) -> float:
    """Return the angle between two directions (2,) [rad]."""
    return float(abs(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)))


def _agent_box(casts: Sequence[Cast], agent: AgentTrajectory) -> Array:
    """Return corners (2, 3) around an agent in all lifts: where it stands, its joints and its hand."""
    points = []
    here = [cast for cast in casts if agent.name in cast.playback.bases]
    for cast in here:
        playback = cast.playback
        points += list(_standing(cast, agent) + cast.offset)
        (own,) = (one for one in cast.solution.agents if one.name == agent.name)  # it may hold otherwise in this lift
        points += [row for grasp in own.grasps for row in playback.forces[grasp.name].point + cast.offset]
        points += [row for name in playback.joints[agent.name] for row in playback.bodies[name].position + cast.offset]
    if agent.kind == "person":
        room = np.array([SEAT, SEAT, 0.0]) if has_legs(agent) else np.zeros(3)
    else:
        room = np.full(3, LINK if any(_is_from_outside(cast, agent) for cast in here) else ROBOT)
    return np.array([np.min(points, axis=0) - room, np.max(points, axis=0) + room])


def _object_box(cast: Cast) -> Array:
    """Return corners (2, 3) around the object over a lift, level or nearly so."""
    lifted, track = cast.solution.scenario.object, cast.playback.bodies[cast.solution.object.name]
    half = np.array([lifted.depth, lifted.width, lifted.height]) / 2.0
    centre = track.position + cast.offset
    return np.array([centre.min(axis=0) - half, centre.max(axis=0) + half])


def _obstacle_boxes(casts: Sequence[Cast], around: Array) -> list[Array]:
    """Return corners (2, 3) of the obstacles of all lifts, cut off a little way from what ``around`` (n, 3) holds."""
    low, high = around.min(axis=0) - NEARBY, around.max(axis=0) + NEARBY
    found = []
    for cast in casts:
        for obstacle in cast.solution.scenario.obstacles:
            corners = obstacle_part(obstacle).mesh.vertices + cast.offset
            found.append(np.clip([corners.min(axis=0), corners.max(axis=0)], low, high))
    return found


def _plain(points: Array, room: float = 0.0) -> Box:
    """Return lowest and highest corner of what holds points (n, 3), with some room, ready for JSON."""
    corners: Box = np.round([points.min(axis=0) - room, points.max(axis=0) + room], 3).tolist()
    return corners


def _from(casts: Sequence[Cast], agent: AgentTrajectory, direction: tuple[float, float, float]) -> list[float]:
    """Return in the world a direction that is given as an agent sees it: ahead, to its left, up."""
    cast = next(cast for cast in casts if agent.name in cast.playback.bases)
    side: list[float] = (cast.playback.bases[agent.name][:3, :3] @ direction).tolist()
    return side
