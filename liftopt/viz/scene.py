"""A lift, or two, as commands for the meshcat viewer: figures, force arrows, hand paths, floor and animation."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from liftopt.multibody.dh import rotation_z, translation
from liftopt.scenario.build import subject_of
from liftopt.scenario.placement import stand_of
from liftopt.solution.solution import Solution
from liftopt.viz.playback import Playback
from liftopt.viz.scene_arrow import arrow_commands, arrow_values
from liftopt.viz.scene_commands import Command, clip, place, set_object
from liftopt.viz.scene_mesh import Mesh, Ring, block, tube
from liftopt.viz.scene_part import GROUND, Colour, Part
from liftopt.viz.scene_person import SHIRT, person_parts
from liftopt.viz.scene_sawyer import gripper_parts, sawyer_parts
from liftopt.viz.scene_sawyer_meshes import sawyer_mesh_parts
from liftopt.viz.scene_shadow import shadow_commands

Array = npt.NDArray[np.float64]
WOOD: Colour = (0.78, 0.60, 0.38)
PATH_COLOURS: dict[str, Colour] = {"human": (0.02, 0.45, 0.70), "robot": (0.90, 0.45, 0.0)}
PATH_RADIUS = 0.004  # [m]
SAME = 1e-4  # distance below which two parts are in one place [m]
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
        shirt: colour by which the person is told from another.
    """

    solution: Solution
    playback: Playback
    root: str
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ghost: bool = False
    sawyer: Path | None = None
    shirt: Colour = SHIRT

    @property
    def colour(self) -> Colour:
        """By which this lift is told from another: that of the shirt, or of a ghost."""
        return GHOST_COLOUR if self.ghost else self.shirt


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
        commands.append(set_object(body_path(cast, part.body) + "/" + part.name, mesh, colour, opacity))
    for name, force in cast.playback.forces.items():
        root = f"{cast.root}/force/{name}"
        commands += arrow_commands(root, PATH_COLOURS[name], opacity)
        path = _path_mesh(force.point)
        if path is not None:
            commands.append(set_object(f"{cast.root}/path/{name}", path, PATH_COLOURS[name], opacity))
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
    return clips


def body_path(cast: Cast, body: str) -> str:
    """Return the path of a body's node in the scene tree, such as ``/lift/body/human_Q8``."""
    return f"{cast.root}/body/{body}"


def parts_of(cast: Cast) -> list[Part]:
    """Return everything that is drawn of the person, the robot and the object, at zero."""
    scenario = cast.solution.scenario
    robot, table = scenario.first("robot"), scenario.object
    stand = stand_of(scenario, cast.solution.robots[0].name)
    world_base = translation(stand.x, stand.y, robot.height) @ rotation_z(np.radians(stand.yaw_deg))
    name = cast.solution.object.name
    size = (table.depth, table.width, table.height)
    meshes = cast.sawyer
    arm = sawyer_parts(world_base, robot.height) if meshes is None else sawyer_mesh_parts(meshes, world_base)
    return [
        *person_parts(subject_of(scenario.first("person")), cast.shirt),
        *arm,
        *gripper_parts(world_base, robot.tool.length),
        Part(name, "top", WOOD, block((0.0, 0.0, 0.0), size, edge=0.003)),
    ]


def _stands_still(part: Part, cast: Cast) -> bool:
    if part.body in (GROUND, cast.solution.object.name):
        return part.body == GROUND
    return bool(np.ptp(cast.playback.bodies[part.body].position, axis=0).max() < SAME)


def _is_same(part: Part, cast: Cast, twin: Part | None, first: Cast) -> bool:
    """Whether a part has the shape of another lift's and is where that one is all the time."""
    if twin is None or part.mesh.vertices.shape != twin.mesh.vertices.shape:
        return False
    if not np.allclose(part.mesh.vertices, twin.mesh.vertices, rtol=0.0, atol=SAME):
        return False
    if part.body == GROUND:
        return True
    here, there = cast.playback.bodies[part.body], first.playback.bodies[part.body]
    return here.position.shape == there.position.shape and all(
        np.allclose(a, b, rtol=0.0, atol=SAME)
        for a, b in ((here.position, there.position), (here.quaternion, there.quaternion))
    )


def _tinted(colour: Colour) -> Colour:
    red, green, blue = (a + GHOST_TINT * (b - a) for a, b in zip(colour, GHOST_COLOUR, strict=True))
    return (red, green, blue)


def _path_mesh(points: Array) -> Mesh | None:
    """Return a thin tube along ``points`` (K, 3), or None if the hand stays where it is."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    if along[-1] < 10.0 * PATH_RADIUS:
        return None
    # Even steps: the hand rests at both ends, where the frames lie on top of each other.
    even = np.linspace(0.0, along[-1], 50)
    x, y, z = (np.interp(even, along, points[:, i]) for i in range(3))
    rings = [Ring((float(a), float(b), float(c)), PATH_RADIUS, PATH_RADIUS) for a, b, c in zip(x, y, z, strict=True)]
    return tube(rings, (0.31, 0.9, 0.29))
