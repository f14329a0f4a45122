"""The playback in a real browser: what the scene tree holds against Pinocchio, and the controls by hand."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from liftopt.scene import agents_of
from liftopt.viz.viewer import view
from liftopt.viz.viewer_page import APART

CHEAP = ("solver.intervals=10", "solver.starts=1")
LARGEST = 15_000_000  # bytes
DRAWN = 2e-5  # [m], and as a cosine: the page rounds positions to 10 um, quaternions to 1e-6


@pytest.fixture(scope="module")
def lift(solved: Callable[..., Any]) -> Any:
    return solved("table5", *CHEAP)


@pytest.fixture(scope="module")
def opened(lift: Any, open_page: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> Any:
    file = tmp_path_factory.mktemp("page") / "lift.html"
    view(lift.folder, html=file, say=lambda line: None)
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
    table = _placement(opened, f"/lift/body/{solution.held.name}")
    np.testing.assert_allclose(table[:3, 3], solution.held.pose[knot, :3], atol=DRAWN)


def test_a_force_arrow_starts_at_the_hand_and_points_along_the_force(opened: Any, lift: Any) -> None:
    knot = 3
    opened.run(f"liftopt.seek({lift.solution.time[knot]})")
    for track in lift.solution.agents:
        arrow = _placement(opened, f"/lift/force/{track.name}")
        force = track.grasp_force[knot]
        np.testing.assert_allclose(arrow[:3, 3], track.grasp_position[knot], atol=DRAWN)
        np.testing.assert_allclose(arrow[:3, 2], force / np.linalg.norm(force), atol=1e-4)
        head = _placement(opened, f"/lift/force/{track.name}/head")
        tip = head[:3, 3] + 0.07 * head[:3, 2]
        length = np.linalg.norm(tip - arrow[:3, 3])
        assert length == pytest.approx(np.linalg.norm(force) * opened.run("liftopt.data.metres_per_newton"), abs=1e-4)


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
    page.fill("#timeline", str(0.5 * end))
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
    for switch, name in (("#forces", "force"), ("#paths", "path")):
        opened.page.uncheck(switch)
        assert opened.run(node.format(name)) is False
        opened.page.check(switch)
        assert opened.run(node.format(name)) is True


def test_every_camera_preset_shows_the_lift_upright(opened: Any) -> None:
    """A point above another must be above it on the screen: no preset rolls the camera."""
    for name in opened.run("liftopt.presets"):
        opened.page.click(f"#views button:text-is('{name}')")
        axes = np.array(opened.run("(liftopt.viewer.render(), liftopt.viewer.camera.matrixWorld.elements.slice())"))
        right, up = axes.reshape(4, 4)[:2, :3]  # the viewer's world has Y up
        assert abs(right[1]) < 1e-3, name
        if name != "top":
            assert up[1] > 0.8, name


def test_two_lifts_side_by_side_and_one_as_a_ghost(
    lift: Any, solved: Callable[..., Any], open_page: Callable[..., Any], tmp_path: Path
) -> None:
    heavy = solved("table5", *CHEAP, "table.mass=3")
    for ghost, aside in ((False, APART), (True, 0.0)):
        file = tmp_path / f"{ghost}.html"
        view(lift.folder, other=heavy.folder, ghost=ghost, html=file, say=lambda line: None)
        opened = open_page(file)
        opened.run(f"liftopt.seek({lift.solution.time[5]})")
        for root, solution, y in (("/lift", lift.solution, 0.0), ("/other", heavy.solution, aside)):
            shown = _placement(opened, f"{root}/body/{solution.held.name}")[:3, 3]
            np.testing.assert_allclose(shown, solution.held.pose[5, :3] + [0.0, y, 0.0], atol=DRAWN)
        material = "liftopt.viewer.scene_tree.find(['{}', 'body', 'table', 'top', '<object>']).object.material"
        assert opened.run(f"{material.format('lift')}.opacity") == 1
        assert (opened.run(f"{material.format('other')}.opacity") < 1) is ghost
        assert opened.complaints == []
        opened.page.close()
