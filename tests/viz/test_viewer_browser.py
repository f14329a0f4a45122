"""The playback in a real browser: what the scene tree holds against Pinocchio, and the controls by hand."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.scenario.build import agents_of
from liftopt.viz.viewer import view
from liftopt.viz.viewer_page import APART

CHEAP = ("solver.intervals=10", "solver.starts=1")
LONG_NAME = "what is heavier and has one of the longest names there may be"
LARGEST = 15_000_000  # bytes
DRAWN = 2e-5  # [m], and as a cosine: the page rounds positions to 10 um, quaternions to 1e-6


@pytest.fixture(scope="module")
def lift(solved: Callable[..., Any]) -> Any:
    return solved("table5", *CHEAP)


@pytest.fixture(scope="module")
def opened(lift: Any, open_page: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> Any:
    file = tmp_path_factory.mktemp("page") / "lift.html"
    view(lift.folder, html=file, progress=lambda line: None)
    assert file.stat().st_size < LARGEST
    return open_page(file)


def _placement(opened: Any, path: str) -> np.ndarray:
    return np.array(opened.run(f"liftopt.placement('{path}')")).reshape(4, 4).T


def _picture(opened: Any) -> np.ndarray:
    from PIL import Image

    opened.run("liftopt.viewer.render()")
    return np.asarray(Image.open(io.BytesIO(opened.page.screenshot())).convert("RGB")).astype(int)


def test_the_page_needs_nothing_else_and_complains_about_nothing(opened: Any) -> None:
    assert [url for url in opened.requests if not url.startswith(("data:", "blob:"))] == [opened.page.url]
    assert opened.complaints == []


@pytest.mark.parametrize("knot", [0, 5, 10])
def test_parts_are_where_forward_kinematics_puts_them(opened: Any, lift: Any, knot: int) -> None:
    solution = lift.solution
    opened.run(f"liftopt.seek({solution.time[knot]})")
    for agent, track in zip(agents_of(solution.scenario), solution.agents, strict=True):
        data = agent.model.createData()
        pin.forwardKinematics(agent.model, data, track.q[knot])
        for j, name in enumerate(list(agent.model.names)[1:], start=1):
            shown = _placement(opened, f"/lift/body/{name}")
            np.testing.assert_allclose(shown, data.oMi[j].homogeneous, atol=DRAWN, err_msg=name)
    table = _placement(opened, f"/lift/body/{solution.object.name}")
    np.testing.assert_allclose(table[:3, 3], solution.object.pose[knot, :3], atol=DRAWN)


def test_a_force_arrow_starts_at_the_hand_and_points_along_the_force(opened: Any, lift: Any) -> None:
    knot = 3
    opened.run(f"liftopt.seek({lift.solution.time[knot]})")
    for track in lift.solution.agents:
        arrow = _placement(opened, f"/lift/force/{track.name}")
        force = track.load[knot]
        np.testing.assert_allclose(arrow[:3, 3], track.p_world_hold[knot], atol=DRAWN)
        np.testing.assert_allclose(arrow[:3, 2], force / np.linalg.norm(force), atol=1e-4)
        head = _placement(opened, f"/lift/force/{track.name}/head")
        tip = head[:3, 3] + 0.07 * head[:3, 2]
        length = np.linalg.norm(tip - arrow[:3, 3])
        assert length == pytest.approx(np.linalg.norm(force) * opened.run("liftopt.data.metres_per_newton"), abs=1e-4)


def test_the_nearest_two_bodies_are_told_and_a_line_is_between_them(opened: Any, lift: Any) -> None:
    clearance = lift.solution.clearance
    for k in (0, len(clearance.time) // 2, len(clearance.time) - 1):
        opened.run(f"liftopt.seek({clearance.time[k]})")
        nearest = clearance.between_bodies
        apart = 1e3 * nearest.distance[k]
        told = f"{abs(apart):.0f} mm {'deep' if apart < 0 else 'apart'}"
        assert opened.page.inner_text("#nearest-0") == told
        assert opened.page.text_content("#pair-0") == clearance.pairs[nearest.pair[k]].told
        np.testing.assert_allclose(_placement(opened, "/lift/nearest")[:3, 3], nearest.points[k, 0], atol=DRAWN)


def test_the_picture_shows_something_and_the_animation_moves_it(opened: Any, lift: Any) -> None:
    pictures = []
    for share in (0.0, 0.5, 1.0):
        opened.run(f"liftopt.look('three-quarter'); liftopt.seek({share * lift.solution.time[-1]})")
        pictures.append(_picture(opened)[100:450])  # between the panels of the page
    first = pictures[0].reshape(-1, 3)
    assert len(np.unique(first, axis=0)) > 300
    robot, shirt = (np.sum(first[:, i] > 1.4 * np.maximum(first[:, j], first[:, 1])) for i, j in ((0, 2), (2, 0)))
    assert robot > 2000
    assert shirt > 1000
    for one, other in ((0, 1), (1, 2), (0, 2)):
        assert np.mean(np.abs(pictures[one] - pictures[other]).max(axis=2) > 30) > 0.005


def test_play_pause_speed_and_scrubbing(opened: Any, lift: Any) -> None:
    page, end = opened.page, float(lift.solution.time[-1])
    opened.run("liftopt.seek(0)")
    page.click("#play")
    page.wait_for_function("liftopt.state.time > 0.1")
    page.click("#play")
    stopped = opened.run("liftopt.state.time")
    page.wait_for_timeout(200)
    assert opened.run("liftopt.state.time") == stopped
    page.select_option("#speed", "0.25")
    assert opened.run("liftopt.state.speed") == 0.25
    page.fill("#timeline", f"{0.5 * end:g}")
    assert opened.run("liftopt.state.time") == pytest.approx(0.5 * end)
    assert page.inner_text("#clock") == f"{0.5 * end:.2f} s of {end:.2f} s"
    page.select_option("#speed", "1")
    page.locator("#meshcat-pane").click(position={"x": 400, "y": 250})
    opened.run("document.activeElement.blur()")
    page.keyboard.press("End")
    assert opened.run("liftopt.state.time") == pytest.approx(end)
    page.keyboard.press("Home")
    assert opened.run("liftopt.state.time") == 0.0


def test_at_the_end_it_repeats_or_stops(opened: Any, lift: Any) -> None:
    page, end = opened.page, float(lift.solution.time[-1])
    page.uncheck("#repeat")
    opened.run(f"liftopt.seek({end - 0.02}); liftopt.play(true)")
    page.wait_for_function("!liftopt.state.playing")
    assert opened.run("liftopt.state.time") == pytest.approx(end)
    page.check("#repeat")
    opened.run(f"liftopt.seek({end - 0.02}); liftopt.play(true)")
    page.wait_for_function(f"liftopt.state.time < {end / 2}")
    opened.run("liftopt.play(false)")


def test_switches_hide_forces_and_hand_paths(opened: Any) -> None:
    node = "liftopt.viewer.scene_tree.find(['lift', '{}']).object.visible"
    for switch, name in (("#forces", "force"), ("#paths", "path"), ("#nearest", "nearest")):
        opened.page.uncheck(switch)
        assert opened.run(node.format(name)) is False
        opened.page.check(switch)
        assert opened.run(node.format(name)) is True


def _seen(opened: Any, points: list[list[float]]) -> np.ndarray:
    """Where world points (K, 3) are on the screen [px]; the viewer's own camera projects them."""
    script = """(points) => points.map(([x, y, z]) => {
        const at = new MeshCat.THREE.Vector3(x, z, -y).project(liftopt.viewer.camera);
        return [((at.x + 1) / 2) * window.innerWidth, ((1 - at.y) / 2) * window.innerHeight];
    })"""
    return np.array(opened.page.evaluate(script, points))


def _boxes(opened: Any, *ids: str) -> list[tuple[float, float, float, float]]:
    """Left, top, right and bottom of elements [px]."""
    script = "(id) => document.querySelector(id).getBoundingClientRect().toJSON()"
    found = [opened.page.evaluate(script, each) for each in ids]
    return [(box["left"], box["top"], box["right"], box["bottom"]) for box in found]


def _resize(opened: Any, width: int, height: int) -> None:
    opened.page.set_viewport_size({"width": width, "height": height})
    opened.page.wait_for_function(f"Math.abs(liftopt.viewer.camera.aspect - {width / height}) < 0.01")


def _overlap(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


SIZES = ((420, 760), (800, 500), (1400, 850))
PERSON = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.75]]


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_panels_cover_neither_each_other_nor_the_edge(opened: Any, width: int, height: int) -> None:
    _resize(opened, width, height)
    panels = _boxes(opened, "#facts", "#views", "#bar")
    for i, panel in enumerate(panels):
        assert panel[0] >= 0
        assert panel[1] >= 0
        assert panel[2] <= width
        assert panel[3] <= height
        assert not any(_overlap(panel, other) for other in panels[:i])


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_every_camera_preset_shows_what_it_says_upright(opened: Any, lift: Any, width: int, height: int) -> None:
    """A point above another must be above it on the screen, and what a preset is for between the panels."""
    base = lift.solution.scenario.task.standing_distance
    hands = [track.p_world_hold[k].tolist() for track in lift.solution.agents for k in (0, 5, 10)]
    robot = [[base, 0.0, 0.0], [base, 0.0, lift.solution.scenario.first("robot").base_height]]
    for name, points in {
        "three-quarter": PERSON + robot + hands,
        "side": PERSON + robot + hands,
        "front": PERSON,
        "top": PERSON + robot + hands,
        "person": PERSON,
        "robot": robot,
        "hands": hands,
    }.items():
        _resize(opened, width, height)
        opened.page.click(f"#views button:text-is('{name}')")
        axes = np.array(opened.run("(liftopt.viewer.render(), liftopt.viewer.camera.matrixWorld.elements.slice())"))
        right, up = axes.reshape(4, 4)[:2, :3]  # the viewer's world has Y up
        assert abs(right[1]) < 1e-3, name
        if name != "top":
            assert up[1] > 0.8, name
        seen = _seen(opened, points)
        panels = _boxes(opened, "#facts", "#views", "#bar")
        assert np.all((seen > 0) & (seen < [width, height])), name
        for x, y in seen:
            assert not any(_overlap((x, y, x, y), panel) for panel in panels), (name, x, y)
    assert set(opened.run("liftopt.presets")) == {
        "three-quarter", "side", "front", "top", "person", "robot", "hands",
    }  # fmt: skip
    _resize(opened, 800, 500)


def test_front_faces_the_person_through_the_robot(opened: Any) -> None:
    """From ahead, along -X to 0.1 deg, level to 5 deg; the robot in between is see-through and elsewhere solid."""
    solid = "liftopt.viewer.scene_tree.find(['lift', 'body', '{}', '{}', '<object>']).object.material.opacity"
    parts = (("robot_Q1", "l0_shoulder"), ("ground", "pedestal_column"), ("human_Q3", "trunk"))
    opened.run("liftopt.look('front')")
    x, y, z = np.array(opened.run("liftopt.viewer.camera.matrixWorld.elements.slice(8, 11)"))  # from target to camera
    assert abs(np.degrees(np.arctan2(z, x))) < 0.1
    assert abs(np.degrees(np.arcsin(y))) < 5.0
    assert [opened.run(solid.format(*part)) < 0.3 for part in parts] == [True, True, False]
    opened.run("liftopt.look('side')")
    assert [opened.run(solid.format(*part)) for part in parts] == [1, 1, 1]


def test_the_person_is_seen_from_head_to_foot_and_large(opened: Any) -> None:
    _resize(opened, 800, 500)
    opened.run("liftopt.look('person')")
    foot, head = _seen(opened, PERSON)
    free = _boxes(opened, "#bar")[0][1] - _boxes(opened, "#top")[0][3]
    assert foot[1] - head[1] > 0.75 * free


def test_the_floor_is_darker_beside_feet_and_pedestal(opened: Any) -> None:
    """The same picture with and without what is drawn there."""
    _resize(opened, 800, 500)
    opened.run("liftopt.look('three-quarter'); liftopt.seek(0)")
    feet = _seen(opened, [[0.245, -0.09, 0.0], [1.9 + 0.46, -0.345, 0.0]]).round().astype(int)
    with_, property_ = _picture(opened), "path: '/lift/shadow', property: 'visible', value: "
    opened.run(f"liftopt.viewer.handle_command({{ type: 'set_property', {property_} false }})")
    without = _picture(opened)
    opened.run(f"liftopt.viewer.handle_command({{ type: 'set_property', {property_} true }})")
    for x, y in feet:
        assert with_[y - 4 : y + 5, x - 4 : x + 5].mean() < 0.93 * without[y - 4 : y + 5, x - 4 : x + 5].mean()
    assert np.mean(with_ != without) < 0.05


def test_two_lifts_side_by_side_and_one_as_a_ghost(
    lift: Any, solved: Callable[..., Any], open_page: Callable[..., Any], tmp_path: Path
) -> None:
    heavy = solved("table5", *CHEAP, "object.mass=3", f"name={LONG_NAME}")
    for ghost, aside in ((False, APART), (True, 0.0)):
        file = tmp_path / f"{ghost}.html"
        view(lift.folder, other=heavy.folder, ghost=ghost, html=file, progress=lambda line: None)
        opened = open_page(file)
        opened.run(f"liftopt.seek({lift.solution.time[5]})")
        for root, solution, y in (("/lift", lift.solution, 0.0), ("/other", heavy.solution, aside)):
            shown = _placement(opened, f"{root}/body/{solution.object.name}")[:3, 3]
            np.testing.assert_allclose(shown, solution.object.pose[5, :3] + [0.0, y, 0.0], atol=DRAWN)
        _names_tell_the_lifts_apart(opened, ghost)
        material = "liftopt.viewer.scene_tree.find(['{}', 'body', 'table', 'top', '<object>']).object.material"
        assert opened.run(f"{material.format('lift')}.opacity") == 1
        assert (opened.run(f"{material.format('other')}.opacity") < 1) is ghost
        assert opened.complaints == []
        opened.page.close()


def _names_tell_the_lifts_apart(opened: Any, ghost: bool) -> None:
    """Names above the heads and in the table, in the colour of shirt or ghost, none above another or a panel."""
    material = "liftopt.viewer.scene_tree.find(['{}', 'body', 'human_Q3', 'trunk', '<object>']).object.material.color"
    shirts = ["#" + opened.run(f"{material.format(root)}.getHexString()") for root in ("lift", "other")]
    colours = opened.run("liftopt.data.lifts.map((lift) => lift.colour)")
    assert colours[0] == shirts[0]
    assert (colours[1] == shirts[1]) is not ghost
    assert shirts[0] != shirts[1]
    called = ["table5", LONG_NAME + ghost * " (ghost)"]
    for where in (".name", "#facts th:not(:first-child)"):
        assert opened.page.eval_on_selector_all(where, "all => all.map((each) => each.textContent)") == called
        chips = "all => all.map((each) => getComputedStyle(each.querySelector('.chip')).backgroundColor)"
        shown = opened.page.eval_on_selector_all(where, chips)
        assert shown == [f"rgb({', '.join(str(int(c[i : i + 2], 16)) for i in (1, 3, 5))})" for c in colours]
    for width, height in SIZES:
        _resize(opened, width, height)
        for preset in ("three-quarter", "side", "front", "person"):
            opened.run(f"liftopt.look('{preset}')")
            boxes = _boxes(opened, "#facts", "#views", "#bar", ".name:nth-child(1)", ".name:nth-child(2)")
            heads = _seen(opened, [[0.0, y, 1.75] for y in (0.0, 0.0 if ghost else APART)])
            for i, (box, head) in enumerate(zip(boxes[3:], heads, strict=True)):
                assert not any(_overlap(box, other) for other in boxes[: 3 + i]), (width, preset, boxes)
                assert 0.0 <= box[0] <= box[2] <= width
                assert box[0] - 8.0 < head[0] < box[2] + 8.0
                assert 0.0 < head[1] - box[3] < 100.0
