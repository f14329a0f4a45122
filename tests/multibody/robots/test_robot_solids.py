"""Solids of robots hold their meshes. Oracles: yourdfpy's kinematics and trimesh, closed form, and the URDF's text."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytest.importorskip("yourdfpy")

from liftopt.errors import InputError
from liftopt.multibody.agent import Agent
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.multibody.robots.examination import examined
from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.multibody.robots.fitted_solids import MOVING, STANDING, FittedBox, Surface
from liftopt.multibody.robots.mesh_file import read_mesh
from liftopt.multibody.robots.read_robot import read_robot
from liftopt.multibody.robots.robot_agent import robot_agent
from liftopt.multibody.robots.robot_stand import robot_stand
from liftopt.multibody.robots.smallest_capsule import FittedCapsule, smallest_capsule
from liftopt.multibody.shapes import Box, Cylinder
from liftopt.multibody.solids import Solid, solids_of

NOT_INSTALLED = "example-robot-data is not installed (it is in 'test')"
MOST = {"ur10": 14, "panda": 15, "tiago_dual_left": 25}  # solids, all together


def _gap(solid: Solid, T_world_joint: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return how far points (n, 3) are outside a capsule or box, negative within a capsule."""
    T_world_solid = T_world_joint @ solid.T_joint_solid
    own = (points - T_world_solid[:3, 3]) @ T_world_solid[:3, :3]
    half = np.array(solid.size) / 2.0 if solid.kind == "box" else np.array([0.0, 0.0, solid.size[1] / 2.0])
    return np.linalg.norm(own - np.clip(own, -half, half), axis=1) - solid.radius


@pytest.mark.skipif(share_folder() is None, reason=NOT_INSTALLED)
@pytest.mark.parametrize("name", list(MOST))
def test_every_vertex_of_the_collision_meshes_is_inside(
    name: str, known_agent: Callable[..., Agent], coal_distance: ModuleType
) -> None:
    import yourdfpy

    T_world_base = np.eye(4)
    T_world_base[:3, 3] = 1.5, -0.3, 0.4
    agent = known_agent(name, name="ann", T_world_base=T_world_base)
    robot = yourdfpy.URDF.load(
        known_robots()[name].path, build_collision_scene_graph=True, load_collision_meshes=True, load_meshes=False,
        filename_handler=lambda fname: str(share_folder().parent / fname.removeprefix("package://")),
    )  # fmt: skip
    own = [joint.removeprefix("ann_") for joint in agent.model.names[1:]]
    q = agent.limits.q_lower + 0.3 * (agent.limits.q_upper - agent.limits.q_lower)
    robot.update_cfg({**dict.fromkeys(robot.actuated_joint_names, 0.0), **dict(zip(own, q, strict=True))})
    places = coal_distance.joint_placements(agent, q)
    solids = [solid for solid in solids_of(agent) if not solid.name.startswith("stand")]
    assert len(solids) <= MOST[name]
    scene, nodes = robot.collision_scene, 0
    for node in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[node]
        points = scene.geometry[geometry].vertices @ transform[:3, :3].T + transform[:3, 3]
        points = points @ T_world_base[:3, :3].T + T_world_base[:3, 3]
        gaps = np.min([_gap(solid, places[solid.joint], points) for solid in solids], axis=0)
        assert gaps.max() < 1e-5, (node, gaps.max())
        nodes += 1
    assert nodes > 6


def _outside(solid: FittedCapsule | FittedBox, points: np.ndarray) -> np.ndarray:
    """Return how far points (n, 3) are outside [m], 0 within a box and negative within a capsule."""
    if isinstance(solid, FittedBox):
        own = np.abs((points - solid.placement[:3, 3]) @ solid.placement[:3, :3]) - solid.size / 2.0
        return np.linalg.norm(np.maximum(own, 0.0), axis=1)
    along = solid.end - solid.start
    share = np.clip((points - solid.start) @ along / max(float(along @ along), 1e-18), 0.0, 1.0)
    return np.linalg.norm(points - solid.start - share[:, None] * along, axis=1) - solid.radius


def test_a_capsule_is_as_small_as_can_be(rng: np.random.Generator) -> None:
    """Points on a capsule: none is smaller than that one (closed form)."""
    axis = np.array([0.6, 0.0, 0.8])
    directions = rng.normal(size=(400, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = 0.05 * directions + 0.3 * (directions @ axis > 0.0)[:, None] * axis + (1.0, 2.0, 3.0)
    found = smallest_capsule(points)
    assert _outside(found, points).max() < 1e-9
    assert found.radius == pytest.approx(0.05, rel=0.02)
    assert found.volume == pytest.approx(np.pi * 0.05**2 * (0.3 + 4.0 / 3.0 * 0.05), rel=0.04)
    np.testing.assert_allclose(
        np.abs((found.end - found.start) / np.linalg.norm(found.end - found.start)), axis, atol=0.02
    )


def _prism(low: tuple[float, ...], high: tuple[float, ...]) -> np.ndarray:
    """Return the triangles (12, 3, 3) of a box along the axes."""
    import trimesh

    box = trimesh.creation.box(bounds=[low, high])
    return np.asarray(box.vertices[box.faces], dtype=np.float64)


def test_a_bent_link_gets_a_capsule_for_each_part_and_a_cut_loses_nothing() -> None:
    """Two bars at a right angle; their area is what is on both sides of a cut (closed form)."""
    corners = np.concatenate([_prism((0, 0, 0), (0.5, 0.06, 0.06)), _prism((0, 0, 0.06), (0.06, 0.06, 0.5))])
    surface = Surface(corners, np.zeros(24, dtype=np.int64))
    sides = surface.cut(np.array([0.6, 0.0, 0.8]), 0.2)
    assert sides is not None
    assert sum(_area(side.corners) for side in sides) == pytest.approx(_area(corners), rel=1e-12)
    found = [solid for solid, _ in MOVING.solids(surface)]
    assert 2 <= len(found) <= 3
    assert sum(solid.volume for solid in found) < 0.35 * smallest_capsule(surface.points).volume
    assert np.min([_outside(solid, surface.points) for solid in found], axis=0).max() < 1e-9
    (block,) = STANDING.solids(Surface(_prism((0, 0, 0), (0.4, 0.3, 0.2)), np.zeros(12, dtype=np.int64)))
    assert block[0].volume == pytest.approx(0.024)  # a box is a box


def _area(corners: np.ndarray) -> float:
    return float(np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum())


def test_shapes_of_the_urdf_are_solids_and_tubes_stand_for_those_it_has_not(arm) -> None:
    shape = '<collision><origin xyz="0 0 0.1"/><geometry><cylinder radius="0.05" length="0.2"/></geometry></collision>'
    text = arm(('<link name="l2">', f'<link name="l2">{shape}'))
    agent = robot_agent(read_robot(text), name="ann", T_world_base=np.eye(4))
    second, third = (next(one for one in solids_of(agent) if one.name == name) for name in ("l2", "l3"))
    assert 0.05 <= second.radius < 0.07
    assert third.size[1] == pytest.approx(0.3)  # to the next joint
    (told,) = (one for one in examined(read_robot(text)).findings if one.code == "solids.tubes")
    assert told.value == 3
    assert "l1, l3, l4" in told.message


def test_a_robot_stands_on_the_floor_on_a_pedestal_or_hangs_on_a_plate() -> None:
    base = np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (-0.05, 0.2)])
    floor, high, hanging = np.eye(4), np.eye(4), np.diag([1.0, -1.0, -1.0, 1.0])
    floor[2, 3], high[:3, 3], hanging[2, 3] = 0.05, (0.5, 0.2, 0.8), 2.0
    assert robot_stand(floor, base) == ()
    foot, column = robot_stand(high, base)
    assert isinstance(foot, Box)
    assert isinstance(column, Cylinder)
    np.testing.assert_allclose((high @ [*column.end, 1.0])[:3], [0.5, 0.2, 0.75])
    assert (high @ foot.placement)[2, 3] == pytest.approx(foot.size[2] / 2.0)
    (plate,) = robot_stand(hanging, base)
    assert isinstance(plate, Box)
    top = (hanging @ plate.placement)[2, 3]
    assert top == pytest.approx(2.05 + plate.size[2] / 2.0)  # above the base, which hangs down


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("a.ply", b"ply", "must be one of stl, obj, dae"),
        ("a.stl", b"", "cannot be read as STL|0 triangles"),
        ("a.dae", b"<!DOCTYPE x><COLLADA/>", "declares a document type"),
        ("a.dae", b"<COLLADA", "cannot be read as DAE"),
        ("a.obj", b"v 0 0 0\nv 1e9 0 0\nv 0 1 0\nf 1 2 3\n", "farther off than 100 m"),
        ("a.obj", b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "no number"),
    ],
)
def test_what_is_no_mesh_is_refused_in_one_line(name: str, content: bytes, told: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=told) as refused:
        read_mesh(tmp_path / name)
    assert "\n" not in str(refused.value)
    with pytest.raises(InputError):
        read_mesh(tmp_path / "none.stl")


def test_a_mesh_names_no_other_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.obj").write_text("mtllib secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    (tmp_path / "secret.mtl").write_text("newmtl red\nKd 1 0 0\n")
    monkeypatch.chdir(tmp_path)
    (piece,) = read_mesh(tmp_path / "a.obj", (2.0, 1.0, -1.0))
    assert piece.colour != (1.0, 0.0, 0.0)
    assert piece.vertices.max() == 2.0
    normal = np.cross(*(piece.vertices[piece.triangles[0]][1:] - piece.vertices[piece.triangles[0]][0]))
    assert normal[2] < 0.0  # mirrored, its outside is still outside
