"""A lift, or two, as commands for the meshcat viewer: figures, force arrows, hand paths, floor and animation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from liftopt.assessment.who import who_is
from liftopt.ergonomics.lift import subject_in
from liftopt.multibody.dh import rotation_z, translation
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.build import agent_of
from liftopt.scenario.obstacles import Obstacle
from liftopt.solution.solution import Solution
from liftopt.types import Array
from liftopt.viz.person_bodies import PersonBodies
from liftopt.viz.playback import Playback
from liftopt.viz.robot_figure import FigurePiece
from liftopt.viz.scene_arrow import arrow_commands, arrow_values
from liftopt.viz.scene_clearance import line_commands, line_values, nearest_at
from liftopt.viz.scene_commands import Command, clip, place, set_object
from liftopt.viz.scene_gripper import gripper_parts
from liftopt.viz.scene_mesh import Mesh, Ring, block, tube
from liftopt.viz.scene_object import object_parts
from liftopt.viz.scene_part import GROUND, Colour, Part
from liftopt.viz.scene_person import SHIRT, hand_parts, person_parts
from liftopt.viz.scene_pressure import pressure_body, pressure_part
from liftopt.viz.scene_robot import robot_parts
from liftopt.viz.scene_sawyer import sawyer_parts
from liftopt.viz.scene_sawyer_meshes import sawyer_mesh_parts
from liftopt.viz.scene_shadow import shadow_commands
from liftopt.viz.who import colour_of, is_sawyer, robot_of

CONCRETE: Colour = (0.42, 0.48, 0.58)
SEE_THROUGH, GHOSTLY = 0.55, 0.15  # opacity of an obstacle, and of what a preset looks through
SHADE = 0.75  # of a shirt against the arrows of who wears it
PATH_RADIUS = 0.004  # [m]
SAME_POINT = 1e-4  # distance below which two parts are in one place [m]
GHOST_COLOUR, GHOST_TINT, GHOST_OPACITY = (0.45, 0.25, 0.80), 0.65, 0.40


@dataclass(frozen=True)
class Cast:
    """One lift on the stage.

    Attributes:
        solution: what was solved.
        playback: its frames.
        root: path of its node in the scene tree.
        offset: (3,) where it is put in the world [m].
        ghost: whether it is drawn see-through.
        sawyer: the manufacturer's ``sawyer_description`` folder, or None for our own primitives.
        figures: own meshes of other robots, by agent; who is not in it is drawn with the shapes of its model.
        shirt: of the first person, by which this lift is told from another; the others wear the colour of their arrows.
    """

    solution: Solution
    playback: Playback
    root: str
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ghost: bool = False
    sawyer: Path | None = None
    shirt: Colour = SHIRT
    figures: Mapping[str, Sequence[FigurePiece]] = field(default_factory=dict)

    @property
    def colour(self) -> Colour:
        """By which this lift is told from another: that of the shirt, or of a ghost."""
        return GHOST_COLOUR if self.ghost else self.shirt

    @cached_property
    def arms(self) -> dict[str, list[Part]]:
        """What is drawn of each robot, without its gripper, where it stands and at zero."""
        return {robot.name: self._arm(robot) for robot in self.solution.robots}

    def _arm(self, robot: AgentTrajectory) -> list[Part]:
        base = self.playback.bases[robot.name]
        if not is_sawyer(self.solution.scenario, robot):
            model = agent_of(self.solution.scenario, robot.name, self.solution.urdfs)
            return robot_parts(model, self.figures.get(robot.name, ()))
        if self.sawyer is None:
            return sawyer_parts(robot.name, base)
        return sawyer_mesh_parts(self.sawyer, robot.name, base)


def lift_commands(cast: Cast, first: Cast | None = None) -> list[Command]:
    """Return the viewer's commands that build one lift.

    Args:
        cast: the lift.
        first: another in the same place; what does the same in both is not drawn again.
    """
    commands = [place(cast.root, translation(*cast.offset))]
    opacity = GHOST_OPACITY if cast.ghost else 1.0
    parts, others = parts_of(cast), [] if first is None else parts_of(first)
    twins = {(part.body, part.name): part for part in others}
    if first is None:
        commands += shadow_commands(cast.root, [part for part in parts if _stands_still(part, cast)])
    for part in parts:
        if first is not None and _is_same(part, cast, twins.get((part.body, part.name)), first):
            continue
        mesh, colour = part.mesh, _tinted(part.colour) if cast.ghost else part.colour
        if part.body != GROUND:
            mesh = mesh.seen_from(np.asarray(np.linalg.inv(cast.playback.zero[part.body])))
        path = body_path(cast, part.body) + "/" + part.name
        commands.append(set_object(path, mesh, colour, opacity * part.opacity))
    for agent in cast.solution.agents:
        colour = colour_of(cast.solution.agents, agent)
        for name in (grasp.name for grasp in agent.grasps):
            commands += arrow_commands(f"{cast.root}/force/{name}", colour, opacity)
            along = path_mesh(cast.playback.forces[name].point)
            if along is not None:
                commands.append(set_object(f"{cast.root}/path/{name}", along, colour, opacity))
    if nearest_at(cast.solution.clearance, cast.playback.time) is not None:
        commands += line_commands(f"{cast.root}/nearest", opacity)
    return commands


def lift_tracks(cast: Cast, metres_per_newton: float) -> list[Command]:
    """Return the animation of one lift: one clip for every node that moves."""
    time, clips = cast.playback.time, []
    for body, track in cast.playback.bodies.items():
        values = {"position": track.position, "quaternion": track.quaternion}
        clips.append(clip(body_path(cast, body), time, values))
    for name, force in cast.playback.forces.items():
        for path, values in arrow_values(f"{cast.root}/force/{name}", force, metres_per_newton).items():
            clips.append(clip(path, time, values))
    nearest = nearest_at(cast.solution.clearance, time)
    if nearest is not None:
        for path, values in line_values(f"{cast.root}/nearest", nearest["points"]).items():
            clips.append(clip(path, time, values))
    return clips


def body_path(cast: Cast, body: str) -> str:
    """Return the path of a body's node in the scene tree, such as ``/lift/body/human_Q8``."""
    return f"{cast.root}/body/{body}"


def parts_of(cast: Cast) -> list[Part]:
    """Return everything that is drawn of the agents, the object and the obstacles, at zero."""
    scenario = cast.solution.scenario
    parts = [part for agent in cast.solution.agents for part in _figure(cast, agent)]
    return parts + object_parts(scenario) + [obstacle_part(obstacle) for obstacle in scenario.obstacles]


def obstacle_part(obstacle: Obstacle) -> Part:
    """Return a box that stands in the way; see-through, so that it hides nobody."""
    placed = translation(*obstacle.position) @ rotation_z(np.radians(obstacle.yaw_deg))
    mesh = block((0.0, 0.0, 0.0), obstacle.box, edge=0.004).seen_from(placed)
    return Part(GROUND, f"obstacle_{obstacle.name}", CONCRETE, mesh, SEE_THROUGH)


def _figure(cast: Cast, agent: AgentTrajectory) -> list[Part]:
    """Return the parts of one agent, where it stands."""
    solution, world_base = cast.solution, cast.playback.bases[agent.name]
    if agent.kind == "person":
        subject = subject_in(solution, agent.name)
        bodies = PersonBodies.of(agent)
        figure = person_parts(bodies, subject, _shirt(cast, agent))
        if pressure_body(agent.name) in cast.playback.bodies:
            figure.append(pressure_part(agent.name, colour_of(solution.agents, agent)))
        figure = [part.placed(world_base) for part in figure]
        hands = (hand_parts(arm.hand, subject, arm.side) for arm in bodies.arms if arm.hand)
        return figure + [part for hand in hands for part in hand]
    arm = cast.arms[agent.name]
    if not who_is(agent, solution.agents).is_alone:  # on the ground each needs names of its own
        arm = [replace(part, name=f"{agent.name}_{part.name}") if part.body == GROUND else part for part in arm]
    return [*arm, *gripper_parts(agent.name, robot_of(solution.scenario, agent).tool.length)]


def _shirt(cast: Cast, person: AgentTrajectory) -> Colour:
    if person.name == cast.solution.persons[0].name:
        return cast.shirt
    red, green, blue = colour_of(cast.solution.agents, person)
    return (SHADE * red, SHADE * green, SHADE * blue)


def _stands_still(part: Part, cast: Cast) -> bool:
    if part.opacity < 1.0:
        return False
    if part.body in (GROUND, cast.solution.object.name):
        return part.body == GROUND
    return bool(np.ptp(cast.playback.bodies[part.body].position, axis=0).max() < SAME_POINT)


def _is_same(part: Part, cast: Cast, twin: Part | None, first: Cast) -> bool:
    """Whether a part has the shape of another lift's and is where that one is all the time."""
    if twin is None or part.mesh.vertices.shape != twin.mesh.vertices.shape:
        return False
    if not np.allclose(part.mesh.vertices, twin.mesh.vertices, rtol=0.0, atol=SAME_POINT):
        return False
    if part.body == GROUND:
        return True
    here, there = cast.playback.bodies[part.body], first.playback.bodies[part.body]
    return here.position.shape == there.position.shape and all(
        np.allclose(a, b, rtol=0.0, atol=SAME_POINT)
        for a, b in ((here.position, there.position), (here.quaternion, there.quaternion))
    )


def _tinted(colour: Colour) -> Colour:
    red, green, blue = (a + GHOST_TINT * (b - a) for a, b in zip(colour, GHOST_COLOUR, strict=True))
    return (red, green, blue)


def path_mesh(points: Array) -> Mesh | None:
    """Return a thin tube along ``points`` (K, 3), or None if the hand stays where it is."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    if along[-1] < 10.0 * PATH_RADIUS:
        return None
    # Even steps: the hand rests at both ends, where the frames lie on top of each other.
    even = np.linspace(0.0, along[-1], 50)
    x, y, z = (np.interp(even, along, points[:, i]) for i in range(3))
    rings = [Ring((float(a), float(b), float(c)), PATH_RADIUS, PATH_RADIUS) for a, b, c in zip(x, y, z, strict=True)]
    return tube(rings, (0.31, 0.9, 0.29))
