"""The page of a person with legs and two hands in a real browser: parts where Pinocchio puts them, a row a hand."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.viz.viewer_page import playback_page

DRAWN = 2e-5  # [m], and as a cosine: the page rounds positions to 10 um, quaternions to 1e-6


@pytest.fixture(scope="module")
def team(team_solution: Callable[[str], Any]) -> Any:
    return team_solution("squat")


@pytest.fixture(scope="module")
def two_robots(team_solution: Callable[[str], Any]) -> Any:
    return team_solution("two_robots")


@pytest.fixture(scope="module")
def opened(team: Any, open_page: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> Any:
    file = tmp_path_factory.mktemp("page") / "squat.html"
    file.write_text(playback_page(team.solution), encoding="utf-8")
    return open_page(file)


def _placement(opened: Any, body: str) -> np.ndarray:
    return np.array(opened.run(f"liftopt.placement('/lift/body/{body}')")).reshape(4, 4).T


@pytest.mark.parametrize("knot", [0, -1])
def test_legs_and_arms_are_where_forward_kinematics_puts_them(opened: Any, team: Any, knot: int) -> None:
    (agent,), (track,) = team.agents, team.solution.agents
    opened.run(f"liftopt.seek({team.solution.time[knot]})")
    data = agent.model.createData()
    pin.forwardKinematics(agent.model, data, track.q[knot])
    for j, name in enumerate(list(agent.model.names)[1:], start=1):
        np.testing.assert_allclose(_placement(opened, name), data.oMi[j].homogeneous, atol=DRAWN)
    np.testing.assert_allclose(_placement(opened, "human_feet"), np.eye(4), atol=DRAWN)
    pressure = track.centre_of_pressure
    assert pressure is not None
    np.testing.assert_allclose(_placement(opened, "human_pressure")[:3, 3], pressure[knot], atol=DRAWN)
    assert opened.complaints == []


def test_each_hand_has_a_row_of_its_own(opened: Any, team: Any) -> None:
    opened.run("liftopt.seek(0)")
    rows = opened.page.eval_on_selector_all("#facts tr", "all => all.map((each) => each.innerText.trim())")
    words = [re.split(r"\s*\t\s*", row) for row in rows[1:3]]
    forces = np.linalg.norm(team.solution.agents[0].grasp_force[0], axis=1)
    assert words == [
        ["force of the human's right hand", f"{forces[0]:.1f} N"],
        ["force of the human's left hand", f"{forces[1]:.1f} N"],
    ]


def test_seen_from_ahead_the_person_is_solid_from_the_feet_to_the_head(opened: Any) -> None:
    opened.run("liftopt.look('front')")
    solid = "liftopt.viewer.scene_tree.find(['lift', 'body', '{}', '{}', '<object>']).object.material.opacity"
    for body, part in (
        ("human_feet", "left_shoe"),
        ("human_ankle", "left_shank"),
        ("human_bent_knee", "right_knee"),
        ("human_waist", "waist"),
        ("human_left_palm", "palm"),
    ):
        assert opened.run(solid.format(body, part)) == 1, part


def test_a_lift_with_two_hands_stands_beside_one_with_one(
    team: Any, two_robots: Any, open_page: Callable[..., Any], tmp_path: Path
) -> None:
    """Each lift fills the rows of the hands that it has."""
    file = tmp_path / "both.html"
    file.write_text(playback_page(team.solution, two_robots.solution), encoding="utf-8")
    opened = open_page(file)
    opened.run("liftopt.seek(1)")
    rows = opened.page.eval_on_selector_all(
        "#facts tr", "all => all.map((each) => [...each.children].map((cell) => cell.innerText.trim()))"
    )
    words = {row[0]: row[1:] for row in rows if row[0].startswith("force of")}
    shown = {name: [bool(cell) for cell in cells] for name, cells in words.items()}
    assert shown == {
        "force of the human's right hand": [True, False],
        "force of the human's left hand": [True, False],
        "force of the human": [False, True],
        "force of near": [False, True],
        "force of far": [False, True],
    }
    assert opened.complaints == []
