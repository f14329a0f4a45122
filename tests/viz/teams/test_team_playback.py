"""The film of other teams: everybody is where Pinocchio and the scenario put them, and nobody is drawn twice."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.scenario.placement import stand_of
from liftopt.viz.playback import Playback, playback_of
from liftopt.viz.scene import Cast, parts_of
from liftopt.viz.scene_sawyer_meshes import DESCRIPTION
from liftopt.viz.who import COLOURS

CLOSURE = 2e-3  # [m]: what the motions were made with, and a millimetre between knots


@pytest.fixture(scope="module")
def playback(team: Any) -> Playback:
    return playback_of(team.solution)


def test_bodies_are_where_pinocchio_puts_the_joints(team: Any, playback: Playback) -> None:
    for agent, track in zip(team.agents, team.solution.agents, strict=True):
        data = agent.model.createData()
        for knot in (0, -1):  # the film's first and last frames are knots
            pin.forwardKinematics(agent.model, data, track.q[knot])
            for j, name in enumerate(list(agent.model.names)[1:], start=1):
                body = playback.bodies[name]
                np.testing.assert_allclose(body.position[knot], data.oMi[j].translation, atol=1e-9)
                turn = pin.Quaternion(body.quaternion[knot]).toRotationMatrix()
                np.testing.assert_allclose(turn, data.oMi[j].rotation, atol=1e-9)


def test_hands_hold_the_object_where_the_scenario_says(team: Any, playback: Playback) -> None:
    lifted = playback.bodies[team.solution.object.name]
    for i, agent in enumerate(team.agents):
        at_start = team.solution.object.grasp_position[0, i] - lifted.position[0]
        moved = lifted.position + at_start  # it stays level
        assert np.linalg.norm(playback.forces[agent.name].point - moved, axis=1).max() < CLOSURE


def test_everybody_stands_where_the_scenario_says(team: Any, playback: Playback) -> None:
    """Base and heading of the scenario against T_world_base, and against the shoes that are drawn."""
    parts = parts_of(Cast(team.solution, playback, "/lift"))
    for agent in team.agents:
        stand, base = stand_of(team.solution.scenario, agent.name), playback.bases[agent.name]
        ahead = np.array([np.cos(np.radians(stand.yaw_deg)), np.sin(np.radians(stand.yaw_deg)), 0.0])
        np.testing.assert_allclose(base[:2, 3], [stand.x, stand.y], atol=1e-9)
        np.testing.assert_allclose(base[:3, 0], ahead, atol=1e-9)
        np.testing.assert_allclose(base[:3, 2], [0.0, 0.0, 1.0], atol=1e-9)
        if agent.kind == "robot":
            assert base[2, 3] == pytest.approx(team.solution.scenario.agents[agent.name].height)
            continue
        (sole,) = (p.mesh.vertices for p in parts if (p.body, p.name) == (f"{agent.name}_GT3", "left_sole"))
        middle = (sole.min(axis=0) + sole.max(axis=0)) / 2 - base[:3, 3]
        assert middle @ ahead > 0.02  # a foot is longer ahead of the ankle
        assert middle @ base[:3, 1] > 0.05  # and the left one on the left


def test_no_part_is_there_twice_and_each_is_moved_by_its_own_agent(team: Any, playback: Playback) -> None:
    parts = parts_of(Cast(team.solution, playback, "/lift"))
    assert len({(part.body, part.name) for part in parts}) == len(parts)
    moved = {part.body for part in parts} - {"ground"}
    assert moved <= set(playback.bodies)
    for agent in team.agents:
        own = {body for body in moved if body in playback.joints[agent.name]}
        assert own == {body for body in moved if body.startswith(f"{agent.name}_")}
        assert len(own) >= 5


def test_people_wear_different_shirts(two_people: Any) -> None:
    parts = parts_of(Cast(two_people.solution, playback_of(two_people.solution), "/lift"))
    shirts = {part.body: part.colour for part in parts if part.name == "trunk"}
    assert set(shirts) == {"anna_Q3", "ben_Q3"}
    assert np.linalg.norm(np.subtract(*shirts.values())) > 0.3


def test_four_agents_have_colours_that_differ() -> None:
    assert len(COLOURS) == 4
    assert min(float(np.linalg.norm(np.subtract(a, b))) for a, b in combinations(COLOURS, 2)) > 0.3


def test_the_manufacturers_meshes_are_drawn_for_each_robot(two_robots: Any, tmp_path: Path) -> None:
    """A description made here, of cubes."""
    import trimesh

    names = ["pedestal", "right_arm_base_link", "head", *(f"right_l{i}" for i in range(7))]
    (tmp_path / "urdf").mkdir()
    (tmp_path / "meshes").mkdir()
    links = ""
    for name in names:
        trimesh.creation.box((0.1, 0.1, 0.1)).export(tmp_path / "meshes" / f"{name}.STL")
        mesh = f'<mesh filename="package://sawyer_description/meshes/{name}.DAE"/>'
        links += f'<link name="{name}"><visual><geometry>{mesh}</geometry></visual></link>'
    (tmp_path / DESCRIPTION).write_text(f"<robot>{links}</robot>", encoding="utf-8")
    parts = parts_of(Cast(two_robots.solution, playback_of(two_robots.solution), "/lift", sawyer=tmp_path))
    assert len({(part.body, part.name) for part in parts}) == len(parts)
    placed = {(part.body, part.name): part.mesh.vertices.mean(axis=0) for part in parts}
    for name, y in (("near", -0.55), ("far", 0.55)):
        assert {f"{name}_Q{i}" for i in range(1, 8)} <= {body for body, _ in placed}
        np.testing.assert_allclose(placed["ground", f"{name}_pedestal"], [1.75, y, 0.915], atol=1e-9)
