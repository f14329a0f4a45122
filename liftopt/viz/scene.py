"""A lift, or two, as commands for the meshcat viewer: figures, force arrows, hand paths, floor and animation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from liftopt.multibody.dh import rotation_z, translation
from liftopt.multibody.subject import Subject
from liftopt.solution import Solution
from liftopt.viz.playback import Playback
from liftopt.viz.scene_arrow import arrow_commands, arrow_tracks
from liftopt.viz.scene_mesh import Mesh, Ring, block, tube
from liftopt.viz.scene_part import GROUND, Colour, Part
from liftopt.viz.scene_person import person_parts
from liftopt.viz.scene_sawyer import sawyer_parts

Array = npt.NDArray[np.float64]
Command = dict[str, Any]
WOOD: Colour = (0.78, 0.60, 0.38)
EDGE: Colour = (0.55, 0.40, 0.24)
PATH_COLOURS: dict[str, Colour] = {"human": (0.02, 0.45, 0.70), "robot": (0.90, 0.45, 0.0)}
PATH_RADIUS = 0.004  # [m]
GHOST_OPACITY = 0.32
DECIMALS = 4  # of a drawn length: 0.1 mm


@dataclass(frozen=True)
class Cast:
    """One lift on the stage.

    Attributes:
        solution: what was solved.
        playback: its frames.
        root: path of its node in the scene tree.
        offset: (3,) where it is put in the world [m].
        ghost: whether it is drawn see-through.
    """

    solution: Solution
    playback: Playback
    root: str
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ghost: bool = False


def lift_commands(cast: Cast, metres_per_newton: float) -> list[Command]:
    """Return the viewer's commands that build one lift, each body at its first frame."""
    commands = [_place(cast.root, translation(*cast.offset))]
    opacity = GHOST_OPACITY if cast.ghost else 1.0
    for part in _parts(cast):
        mesh = part.mesh
        if part.body != GROUND:
            mesh = mesh.seen_from(np.linalg.inv(cast.playback.zero[part.body]))
        commands.append(set_object(body_path(cast, part.body) + "/" + part.name, mesh, part.colour, part.shininess, opacity))
    for name, force in cast.playback.forces.items():
        root = f"{cast.root}/force/{name}"
        commands += arrow_commands(root, PATH_COLOURS[name], opacity)
        path = _path_mesh(force.point)
        if path is not None:
            commands.append(set_object(f"{cast.root}/path/{name}", path, PATH_COLOURS[name], 5.0, opacity))
    return commands


def lift_tracks(cast: Cast, metres_per_newton: float) -> list[Command]:
    """Return the animation of one lift: one clip for every node that moves."""
    time, clips = cast.playback.time, []
    drawn = {part.body for part in _parts(cast)} - {GROUND}
    for body in sorted(drawn):
        track = cast.playback.bodies[body]
        values = {"position": track.position, "quaternion": track.quaternion}
        clips.append(clip(body_path(cast, body), time, values))
    for name, force in cast.playback.forces.items():
        for path, values in arrow_tracks(f"{cast.root}/force/{name}", force, metres_per_newton).items():
            clips.append(clip(path, time, values))
    return clips


def body_path(cast: Cast, body: str) -> str:
    """Return the path of a body's node in the scene tree, such as ``/lift/body/human_Q8``."""
    return f"{cast.root}/body/{body}"


def clip(path: str, time: Array, values: dict[str, Array]) -> Command:
    """Return a node's animation: rows of ``values`` (K, 3 or 4) by property at ``time`` (K,) [s]."""
    tracks = [
        {
            "name": f".{name}",
            "type": "quaternion" if name == "quaternion" else "vector3",
            "times": np.round(time, 5).tolist(),
            "values": (np.round(rows, 6 if name == "quaternion" else DECIMALS + 1) + 0.0).ravel().tolist(),
        }
        for name, rows in values.items()
    ]
    return {"path": path, "clip": {"fps": 1, "name": "lift", "tracks": tracks}}


def set_object(path: str, mesh: Mesh, colour: Colour, shininess: float, opacity: float = 1.0) -> Command:
    """Return the command that draws ``mesh`` at ``path``, in three.js' own format."""
    red, green, blue = (round(255 * value) for value in colour)
    vertices = np.round(mesh.vertices, DECIMALS) + 0.0
    geometry = {
        "uuid": f"geometry{path}",
        "type": "BufferGeometry",
        "data": {
            "attributes": {"position": {"itemSize": 3, "type": "Float32Array", "array": vertices.ravel().tolist()}},
            "index": {"type": "Uint16Array", "array": mesh.triangles.ravel().tolist()},
        },
    }
    material = {
        "uuid": f"material{path}",
        "type": "MeshPhongMaterial",
        "color": (red << 16) + (green << 8) + blue,
        "specular": 0x333333 if shininess > 10.0 else 0x080808,
        "shininess": shininess,
        "transparent": opacity < 1.0,
        "opacity": opacity,
        "depthWrite": opacity >= 1.0,
    }
    item = {"uuid": f"mesh{path}", "type": "Mesh", "geometry": geometry["uuid"], "material": material["uuid"]}
    scene = {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [geometry],
        "materials": [material],
        "object": item,
    }
    return {"type": "set_object", "path": path, "object": scene}


def _place(path: str, transform: Array) -> Command:
    return {"type": "set_transform", "path": path, "matrix": transform.T.ravel().tolist()}


def _parts(cast: Cast) -> list[Part]:
    scenario = cast.solution.scenario
    human, robot, table = scenario.human, scenario.robot, scenario.table
    world_base = translation(scenario.task.standing_distance, 0.0, robot.base_height) @ rotation_z(np.pi)
    subject = Subject(human.stature, human.mass, "male" if human.sex == "male" else "female")
    name = cast.solution.held.name
    size = (table.depth, table.width, table.height)
    return [
        *person_parts(subject),
        *sawyer_parts(world_base, robot.base_height, robot.tool.length),
        Part(name, "top", WOOD, block((0.0, 0.0, 0.0), size, edge=0.003), 15.0),
    ]


def _path_mesh(points: Array) -> Mesh | None:
    """Return a thin tube along ``points`` (K, 3), or None if the hand stays where it is."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    if along[-1] < 10.0 * PATH_RADIUS:
        return None
    # Even steps: the hand rests at both ends, where the frames lie on top of each other.
    even = np.linspace(0.0, along[-1], 80)
    x, y, z = (np.interp(even, along, points[:, i]) for i in range(3))
    rings = [Ring((float(a), float(b), float(c)), PATH_RADIUS, PATH_RADIUS) for a, b, c in zip(x, y, z, strict=True)]
    return tube(rings, (0.31, 0.9, 0.29))
