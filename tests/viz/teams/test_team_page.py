"""The page of other teams: rows, names above heads and presets for everybody, in a real browser too."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.viz.viewer_page import playback_page

SIZES = ((420, 760), (800, 500), (1400, 850))
DRAWN = 2e-5  # [m], and as a cosine: the page rounds positions to 10 um, quaternions to 1e-6


def _data(page: str) -> Any:
    (text,) = re.findall(r'type="application/json">(.*?)</script>', page, re.DOTALL)
    return json.loads(text)


@pytest.fixture(scope="module")
def pages(two_people: Any, two_robots: Any) -> dict[str, str]:
    """Return the page of either team, by the name of its scenario."""
    return {one.solution.scenario.name: playback_page(one.solution) for one in (two_people, two_robots)}


def test_two_people_are_told_by_name(pages: dict[str, str]) -> None:
    data = _data(pages["two_people"])
    assert [view["name"] for view in data["views"]] == ["three-quarter", "side", "front", "top", "anna", "ben", "hands"]
    titles = {view["name"]: view["title"] for view in data["views"]}
    assert titles["front"] == "straight at anna's face, through everybody else"
    assert titles["ben"] == "ben, from head to foot"
    assert titles["hands"] == "hands and object"
    assert [hand["who"] for hand in data["hands"]] == ["anna", "ben"]
    assert len({hand["colour"] for hand in data["hands"]}) == 2
    assert [label["text"] for label in data["labels"]] == ["anna", "ben"]
    # Above the heads: the statures of the scenario and 10 cm, where they stand.
    np.testing.assert_allclose([label["at"] for label in data["labels"]], [[0, 0, 1.72], [1.3, 0, 1.92]], atol=1e-9)


def test_only_agents_of_a_kind_that_there_are_several_of_have_names(pages: dict[str, str]) -> None:
    data = _data(pages["two_robots"])
    names = [view["name"] for view in data["views"]]
    assert names == ["three-quarter", "side", "front", "top", "person", "near", "far", "hands"]
    assert [hand["who"] for hand in data["hands"]] == ["the human", "near", "far"]
    assert [label["text"] for label in data["labels"]] == ["near", "far"]
    assert data["object"] == "plank"


def test_a_preset_of_an_agent_faces_it(pages: dict[str, str]) -> None:
    """Who looks along -X is seen from the other side: both from ahead, and from the right."""
    sides = {view["name"]: np.array(view["side"]) for view in _data(pages["two_people"])["views"]}
    np.testing.assert_allclose(sides["ben"], sides["anna"] * [-1, -1, 1], atol=1e-9)


def test_a_preset_looks_past_those_who_stand_beside(pages: dict[str, str]) -> None:
    """Both robots are seen from ahead and from outside, where the other one is behind and not before them."""
    sides = {view["name"]: view["side"] for view in _data(pages["two_robots"])["views"]}
    np.testing.assert_allclose(sides["near"], [-0.45, -1.0, 0.2], atol=1e-9)
    np.testing.assert_allclose(sides["far"], [-0.45, 1.0, 0.2], atol=1e-9)


def test_everything_that_an_agent_moves_is_in_its_preset(team: Any, pages: dict[str, str]) -> None:
    views = {view["name"]: view for view in _data(pages[team.solution.scenario.name])["views"]}
    for agent, track in zip(team.agents, team.solution.agents, strict=True):
        low, high = views[agent.name if agent.name in views else "person"]["box"]
        data = agent.model.createData()
        for q in track.q:
            pin.forwardKinematics(agent.model, data, q)
            points = np.array([data.oMi[j].translation for j in range(1, agent.model.njoints)])
            assert np.all(points >= np.array(low) - 1e-3)
            assert np.all(points <= np.array(high) + 1e-3)
        assert np.all(np.array(views["three-quarter"]["box"][0]) <= np.array(low))
        assert np.all(np.array(views["three-quarter"]["box"][1]) >= np.array(high))


def test_a_lift_beside_one_of_another_team(two_people: Any, two_robots: Any) -> None:
    """Rows for everybody in either; a label for each lift, and for those that a lift has several of."""
    data = _data(playback_page(two_people.solution, two_robots.solution))
    assert [hand["name"] for hand in data["hands"]] == ["anna", "ben", "human", "near", "far"]
    assert [label["text"] for label in data["labels"]] == ["two_people", "anna", "ben", "two_robots", "near", "far"]


@pytest.fixture(scope="module")
def opened(pages: dict[str, str], open_page: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> Any:
    file = tmp_path_factory.mktemp("page") / "robots.html"
    file.write_text(pages["two_robots"], encoding="utf-8")
    return open_page(file)


def test_a_browser_shows_both_robots_where_forward_kinematics_puts_them(opened: Any, two_robots: Any) -> None:
    opened.run(f"liftopt.seek({two_robots.solution.time[-1]})")
    for agent, track in zip(two_robots.agents, two_robots.solution.agents, strict=True):
        data = agent.model.createData()
        pin.forwardKinematics(agent.model, data, track.q[-1])
        for j, name in enumerate(list(agent.model.names)[1:], start=1):
            if name.endswith(("_Q3", "_Q6")):
                shown = np.array(opened.run(f"liftopt.placement('/lift/body/{name}')")).reshape(4, 4).T
                np.testing.assert_allclose(shown, data.oMi[j].homogeneous, atol=DRAWN)
    assert opened.complaints == []


def test_the_table_tells_everybodys_force(opened: Any, two_robots: Any) -> None:
    opened.run("liftopt.seek(0)")
    rows = opened.page.eval_on_selector_all("#facts tr", "all => all.map((each) => each.innerText.trim())")
    words = [re.split(r"\s*\t\s*", row) for row in rows[1:]]
    forces = [np.linalg.norm(track.load[0]) for track in two_robots.solution.agents]
    assert [row[0] for row in words][:5] == [
        "force of the human", "force of near", "force of far", "height of the plank's centre", "nearest two bodies",
    ]  # fmt: skip
    for row, force in zip(words, forces, strict=False):
        assert row[1] == f"{force:.1f} N"


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_presets_show_whom_they_say_and_names_are_apart(opened: Any, width: int, height: int) -> None:
    """Base and head of everybody between the panels in the presets of all, and of one in that one's own."""
    opened.page.set_viewport_size({"width": width, "height": height})
    opened.page.wait_for_function(f"Math.abs(liftopt.viewer.camera.aspect - {width / height}) < 0.01")
    people = {"person": [[0.0, 0.0, 0.0], [0.0, 0.0, 1.75]]}
    people |= {name: [[1.75, y, 0.0], [1.75, y, 1.5]] for name, y in (("near", -0.55), ("far", 0.55))}
    everybody = [point for points in people.values() for point in points]
    for name, points in (people | {"three-quarter": everybody, "side": everybody, "top": everybody}).items():
        opened.page.click(f"#views button:text-is('{name}')")
        opened.run("liftopt.viewer.render()")
        seen = opened.page.evaluate(
            """(points) => points.map(([x, y, z]) => {
                const at = new MeshCat.THREE.Vector3(x, z, -y).project(liftopt.viewer.camera);
                return [((at.x + 1) / 2) * window.innerWidth, ((1 - at.y) / 2) * window.innerHeight];
            })""",
            points,
        )
        panels = [
            opened.page.evaluate("(id) => document.querySelector(id).getBoundingClientRect().toJSON()", panel)
            for panel in ("#facts", "#views", "#bar")
        ]
        assert all(panel["left"] >= 0 and panel["right"] <= width for panel in panels)
        for x, y in seen:
            assert 0 < x < width, name
            assert panels[1]["bottom"] < y or not panels[1]["left"] < x < panels[1]["right"], name
            assert y < panels[2]["top"], name
        names = opened.page.eval_on_selector_all(
            ".name", "all => all.map((each) => each.getBoundingClientRect().toJSON())"
        )
        one, other = names
        apart = one["right"] <= other["left"] or other["right"] <= one["left"]
        assert apart or one["bottom"] <= other["top"] or other["bottom"] <= one["top"], name


def test_front_makes_everybody_else_see_through(opened: Any) -> None:
    opened.run("liftopt.look('front')")
    solid = "liftopt.viewer.scene_tree.find(['lift', 'body', '{}', '{}', '<object>']).object.material.opacity"
    parts = (
        ("near_Q1", "l0_shoulder"),
        ("far_Q1", "l0_shoulder"),
        ("ground", "near_pedestal_column"),
        ("ground", "far_pedestal_column"),
        ("human_Q3", "trunk"),
        ("plank", "top"),
    )
    assert [opened.run(solid.format(*part)) < 0.3 for part in parts] == [True, True, True, True, False, False]
    opened.run("liftopt.look('side')")
    assert [opened.run(solid.format(*part)) for part in parts] == [1] * 6
