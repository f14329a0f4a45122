"""Robots with their own meshes. Oracles: yourdfpy's kinematics of the meshes themselves, and closed form."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

pytest.importorskip("yourdfpy")

from scipy.spatial import cKDTree

from liftopt.multibody.agent import Agent
from liftopt.multibody.dh import rotation_z
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.multibody.robots.chosen_robot import chosen_robot
from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.viz.robot_figure import MOST_TRIANGLES, figure_of
from liftopt.viz.robot_picture import robot_bodies, robot_picture
from liftopt.viz.scene_mesh import Mesh, ball, merged
from liftopt.viz.simplified_mesh import creased, simplified

NOT_INSTALLED = "example-robot-data is not installed (it is in 'test')"
# [m]: a vertex stays in its cell, of 3 mm or some steps coarser, and a triangle between two may cut a bend.
NEAR, COVERED = 0.011, 0.02


@pytest.mark.skipif(share_folder() is None, reason=NOT_INSTALLED)
@pytest.mark.parametrize("name", ["ur10", "tiago_no_hand"])
def test_meshes_are_where_the_urdf_has_them(
    name: str, known_agent: Callable[..., Agent], rng: np.random.Generator
) -> None:
    import trimesh
    import yourdfpy

    known = known_robots()[name]
    T_world_base = rotation_z(0.5)
    T_world_base[:3, 3] = 1.9, -0.2, 0.0
    agent = known_agent(name, name="ann", T_world_base=T_world_base)
    q = rng.uniform(agent.limits.q_lower, agent.limits.q_upper)
    figure = figure_of(chosen_robot(name).examination().chain)
    assert 1000 < sum(len(piece.mesh.triangles) for piece in figure) <= MOST_TRIANGLES
    drawn = [body.mesh for body in robot_bodies(agent, figure, q)]
    robot = yourdfpy.URDF.load(
        known.path, filename_handler=lambda fname: str(share_folder().parent / fname.removeprefix("package://"))
    )
    own = [joint.removeprefix("ann_") for joint in agent.model.names[1:]]
    robot.update_cfg({**dict.fromkeys(robot.actuated_joint_names, 0.0), **dict(zip(own, q, strict=True))})
    whole = robot.scene.to_geometry()
    sampled = trimesh.sample.sample_surface
    samples = sampled(whole, 60_000, seed=1)[0] @ T_world_base[:3, :3].T + T_world_base[:3, 3]
    vertices = whole.vertices @ T_world_base[:3, :3].T + T_world_base[:3, 3]
    mine = merged(drawn)
    assert cKDTree(np.vstack([samples, vertices])).query(mine.vertices)[0].max() < NEAR
    shown, _ = sampled(trimesh.Trimesh(mine.vertices, mine.triangles, process=False), 60_000, seed=2)
    assert np.quantile(cKDTree(shown).query(samples)[0], 0.99) < COVERED


@pytest.mark.skipif(share_folder() is None, reason=NOT_INSTALLED)
def test_a_picture_of_a_robot_alone_shows_it_and_without_meshes_its_solids(known_agent: Callable[..., Agent]) -> None:
    agent, meshes = known_agent("ur5", name="ann"), figure_of(chosen_robot("ur5").examination().chain)
    with_meshes, plain = (robot_picture(agent, figure, size=(60, 60)) for figure in (meshes, ()))
    for image in (with_meshes, plain):
        assert image.shape == (60, 60, 3)
        assert 0.03 < (image < 120).all(axis=2).mean() < 0.6  # what is dark is the robot
    assert (with_meshes != plain).any()


def test_a_finer_grid_keeps_the_shape_and_a_coarse_one_its_flat_faces() -> None:
    """A box whose sides are cut into many triangles: flat faces stay where they are (closed form)."""
    import trimesh

    box = trimesh.creation.box(extents=(0.3, 0.2, 0.1)).subdivide_to_size(0.01)
    mesh = Mesh(np.asarray(box.vertices), np.asarray(box.faces, np.int64))
    fewer = simplified(mesh, 0.047)
    assert len(fewer.triangles) < 0.2 * len(mesh.triangles)
    off = (np.array([0.15, 0.1, 0.05]) - np.abs(fewer.vertices)).min(axis=1)
    assert np.abs(off).max() < 1e-4  # on a face, edge or corner, as far as the pull to the mean lets them
    closed = trimesh.Trimesh(fewer.vertices, fewer.triangles, process=False)
    assert closed.volume == pytest.approx(0.006, rel=1e-3)
    assert not len(simplified(mesh, 1.0).triangles)  # all in one cell


def test_light_sees_edges_of_a_box_and_none_on_a_ball() -> None:
    import trimesh

    box = trimesh.creation.box(extents=(1.0, 1.0, 1.0))
    assert len(creased(Mesh(np.asarray(box.vertices), np.asarray(box.faces, np.int64))).vertices) == 24
    smooth = simplified(ball((0.0, 0.0, 0.0), (0.1, 0.1, 0.1)), 1e-4)
    assert len(creased(smooth).vertices) == len(smooth.vertices)


@pytest.mark.skipif(share_folder() is None, reason=NOT_INSTALLED)
def test_a_piece_that_is_gone_before_there_are_few_enough_triangles_is_left_out() -> None:
    """Baxter with its left arm held has pieces so small that nothing is left of them on the way."""
    found = figure_of(chosen_robot("baxter_right").examination().chain)
    assert found and all(len(piece.mesh.triangles) for piece in found)
