"""The film of a lift against Pinocchio's kinematics and the spline's own definition."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.errors import InputError
from liftopt.multibody.person.human import human_agent
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.scenario.build import agents_of
from liftopt.viz.person_bodies import PersonBodies
from liftopt.viz.playback import Playback, continuous, playback_of
from liftopt.viz.scene import Cast, lift_commands, parts_of
from liftopt.viz.scene_arrow import arrow_values
from liftopt.viz.scene_mesh import Mesh, ball, block, capsule, cylinder
from liftopt.viz.scene_person import person_parts

CHEAP = ("solver.intervals=10", "solver.starts=1")
CLOSURE = 1e-3  # [m]: what a verified solution allows between knots


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Any:
    return solved("table5", *CHEAP).solution


@pytest.fixture(scope="module")
def playback(solution: Any) -> Playback:
    return playback_of(solution)


def _between(knots: np.ndarray, q: np.ndarray, v: np.ndarray, a: np.ndarray, t: float) -> np.ndarray:
    """Integrate twice an acceleration that is linear between knots: what a cubic spline is."""
    k = min(int(np.searchsorted(knots, t, side="right")) - 1, len(knots) - 2)
    h, step = t - knots[k], knots[k + 1] - knots[k]
    return q[k] + v[k] * h + a[k] * h**2 / 2 + (a[k + 1] - a[k]) * h**3 / (6 * step)


def test_bodies_are_where_pinocchio_puts_the_splines_joints(solution: Any, playback: Playback) -> None:
    for agent, track in zip(agents_of(solution.scenario), solution.agents, strict=True):
        data = agent.model.createData()
        for k in range(0, len(playback.time), 7):
            q = _between(solution.time, track.q, track.v, track.a, playback.time[k])
            pin.forwardKinematics(agent.model, data, q)
            for j, name in enumerate(list(agent.model.names)[1:], start=1):
                body = playback.bodies[name]
                np.testing.assert_allclose(body.position[k], data.oMi[j].translation, atol=1e-9)
                turn = pin.Quaternion(body.quaternion[k]).toRotationMatrix()
                np.testing.assert_allclose(turn, data.oMi[j].rotation, atol=1e-9)


def test_the_table_follows_its_own_spline(solution: Any, playback: Playback) -> None:
    lifted, track = solution.object, playback.bodies[solution.object.name]
    for k in range(0, len(playback.time), 7):
        pose = _between(solution.time, lifted.pose, lifted.pose_velocity, lifted.pose_acceleration, playback.time[k])
        roll, pitch, yaw = (pin.utils.rotate(axis, angle) for axis, angle in zip("xyz", pose[3:], strict=True))
        np.testing.assert_allclose(track.position[k], pose[:3], atol=1e-9)
        np.testing.assert_allclose(
            pin.Quaternion(track.quaternion[k]).toRotationMatrix(), roll @ pitch @ yaw, atol=1e-9
        )


def test_hands_stay_on_the_table(solution: Any, playback: Playback) -> None:
    table = solution.scenario.object
    track = playback.bodies[solution.object.name]
    for side, force in zip((-1.0, 1.0), playback.forces.values(), strict=True):
        edge = np.array([side * table.depth / 2, 0.0, -table.height / 2])
        grasp = [p + pin.Quaternion(u).toRotationMatrix() @ edge for p, u in zip(*_rows(track), strict=True)]
        assert np.linalg.norm(force.point - grasp, axis=1).max() < CLOSURE


def _rows(track: Any) -> tuple[np.ndarray, np.ndarray]:
    return track.position, track.quaternion


def test_it_lasts_as_long_as_the_lift_and_forces_are_linear_between_knots(solution: Any, playback: Playback) -> None:
    assert playback.time[0] == 0.0
    assert playback.time[-1] == pytest.approx(solution.scenario.duration, abs=1e-12)
    for track in solution.agents:
        middle = (solution.time[:-1] + solution.time[1:]) / 2
        mean = (track.load[:-1] + track.load[1:]) / 2
        shown = playback.forces[track.name].force
        at = np.stack([np.interp(middle, playback.time, shown[:, i]) for i in range(3)], axis=1)
        np.testing.assert_allclose(at, mean, atol=1e-9)


@pytest.mark.parametrize("times", [[0.0, np.nan, 1.0], [0.0, 1.0, 1.0], [0.0]])
def test_a_time_that_cannot_be_played_is_refused(solution: Any, times: list[float]) -> None:
    with pytest.raises(InputError, match="cannot be shown"):
        playback_of(replace(solution, time=np.array(times)))


def test_quaternions_do_not_jump() -> None:
    angles = np.linspace(0.0, 4.0 * np.pi, 200)
    turns = np.array([pin.Quaternion(pin.utils.rotate("y", angle)).coeffs() for angle in angles])
    smooth = continuous(turns)
    assert np.sum(smooth[1:] * smooth[:-1], axis=1).min() > 0.99
    np.testing.assert_allclose(np.abs(np.sum(smooth * turns, axis=1)), 1.0, atol=1e-12)


def test_arrows_point_along_the_force_and_are_as_long(playback: Playback) -> None:
    for force in playback.forces.values():
        values = arrow_values("/a", force, 0.01)
        head = values["/a/head"]["position"][:, 2] + 0.07 * values["/a/head"]["scale"][:, 2]
        np.testing.assert_allclose(head, 0.01 * np.linalg.norm(force.force, axis=1), atol=1e-5)
        turned = [pin.Quaternion(u).toRotationMatrix()[:, 2] for u in values["/a"]["quaternion"]]
        unit = force.force / np.linalg.norm(force.force, axis=1, keepdims=True)
        np.testing.assert_allclose(turned, unit, atol=1e-9)


def _volume(mesh: Mesh) -> float:
    """Return the volume by the divergence theorem: positive if triangles turn counter-clockwise seen from outside."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6.0)


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (ball((0.3, 0.0, 1.0), (0.1, 0.2, 0.3)), 4 / 3 * np.pi * 0.1 * 0.2 * 0.3),
        (capsule((0, 0, 0), (0, 1, 0), 0.1), np.pi * 0.01 + 4 / 3 * np.pi * 0.001),
        (cylinder((0, 0, 0), (1, 0, 0), 0.1, edge=0.0005), np.pi * 0.01),
        (block((1, 2, 3), (0.2, 0.3, 0.4), edge=0.001), 0.2 * 0.3 * 0.4),
    ],
    ids=["ball", "capsule", "cylinder", "block"],
)
def test_primitives_are_closed_and_hold_what_the_closed_form_says(mesh: Mesh, volume: float) -> None:
    # A ring of twenty sides holds 1.6 % less than its circle.
    assert _volume(mesh) == pytest.approx(volume, rel=0.06)


def test_every_part_is_a_closed_body_seen_from_outside(solution: Any, playback: Playback) -> None:
    parts = parts_of(Cast(solution, playback, "/lift"))
    assert len({(part.body, part.name) for part in parts}) == len(parts)
    assert {part.name: round(_volume(part.mesh), 9) for part in parts if _volume(part.mesh) <= 0.0} == {}
    moved = {part.body for part in parts} - {"ground"}
    assert moved <= set(playback.bodies)
    assert {"human_GT3", "human_Q3", "human_Q6", "human_Q8", "human_right_palm", "table"} <= moved
    assert {f"robot_Q{i}" for i in range(1, 8)} <= moved


def test_the_floor_is_dark_under_all_that_stands_on_it_and_nothing_else(solution: Any, playback: Playback) -> None:
    """Soles and the pedestal's feet: their lowest vertices against the corners of the dark mesh, which is 3 mm high."""
    cast = Cast(solution, playback, "/lift")
    (shadow,) = (command for command in lift_commands(cast) if command["path"] == "/lift/shadow")
    attributes = shadow["object"]["geometries"][0]["data"]["attributes"]
    corners = np.reshape(attributes["position"]["array"], (-1, 3))
    dark = np.reshape(attributes["color"]["array"], (-1, 4))[:, 3]
    assert np.all(corners[:, 2] == 0.003)
    parts = [part for part in parts_of(cast) if part.name.endswith("_sole") or part.name == "pedestal_legs"]
    assert len(parts) == 3
    low = np.vstack([part.mesh.vertices[part.mesh.vertices[:, 2] < 0.02, :2] for part in parts])
    near = np.linalg.norm(low[:, None] - corners[None, :, :2], axis=2)
    assert np.where(near < 0.05, dark, 0.0).max(axis=1).min() > 0.3
    assert near.min(axis=0).max() < 0.2  # nor far from them
    assert near.min(axis=0)[dark > 0.3].max() < 0.06


def test_a_ghost_is_drawn_where_it_differs_only(solution: Any, playback: Playback) -> None:
    """Of a ghost that moves alike nothing; of one in which the robot stands elsewhere all of the robot."""
    first = Cast(solution, playback, "/lift")
    same = Cast(solution, playback, "/other", ghost=True)
    assert [path for path in _drawn(lift_commands(same, first)) if "/body/" in path] == []
    aside = {
        name: replace(track, position=track.position + 0.1) if name.startswith("robot") else track
        for name, track in playback.bodies.items()
    }
    other = Cast(solution, replace(playback, bodies=aside), "/other", ghost=True)
    bodies = {path.split("/")[3] for path in _drawn(lift_commands(other, first)) if "/body/" in path}
    assert bodies == set(playback.joints["robot"]) - {"robot_GT1", "robot_GT2", "robot_GT3"}
    moved = [part.name for part in parts_of(first) if part.body == "robot_Q7"]
    assert {f"/other/body/robot_Q7/{name}" for name in moved} <= _drawn(lift_commands(other, first))


def _drawn(commands: list[dict[str, Any]]) -> set[str]:
    return {command["path"] for command in commands if command["type"] == "set_object"}


@pytest.mark.parametrize(
    "subject", [Subject(1.75, 75.0, "male"), Subject(1.6, 60.0, "female"), Subject(2.0, 60.0, "male")]
)
@pytest.mark.parametrize("make", [human_agent, whole_human_agent])
def test_the_person_is_as_tall_as_the_subject_and_stands_on_the_floor(subject: Subject, make: Any) -> None:
    agent = make(subject)
    person = SimpleNamespace(name=agent.name, joint_names=tuple(agent.model.names)[1:], grasps=agent.grasps)
    vertices = np.vstack([part.mesh.vertices for part in person_parts(PersonBodies.of(person), subject)])
    assert vertices[:, 2].max() == pytest.approx(subject.stature, abs=0.03)  # with hair
    assert vertices[:, 2].min() == pytest.approx(0.0, abs=0.005)
