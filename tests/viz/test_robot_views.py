"""Lifts with robots from outside as page, picture and report show them, and which files may be read for that."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

pytest.importorskip("yourdfpy")

from liftopt.errors import InputError
from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.scenario.build import agents_of
from liftopt.solution.solution import Solution
from liftopt.viz.base import base_of
from liftopt.viz.own_meshes import figures_of
from liftopt.viz.picture import picture_of
from liftopt.viz.playback import playback_at
from liftopt.viz.plots import write_plots
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_joints import LONGEST, short
from liftopt.viz.plots_snapshots import snapshots
from liftopt.viz.report import write_report
from liftopt.viz.report_agents import team_words
from liftopt.viz.robot_words import a_robot, data_words, joint_words, models_words
from liftopt.viz.scene import Cast, parts_of
from liftopt.viz.scene_part import GROUND
from liftopt.viz.viewer_page import playback_page
from liftopt.viz.who import robot_of

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(share_folder() is None, reason="example-robot-data is not installed (it is in 'test')"),
]
DATA = r'type="application/json">(.*?)</script>'
MOST = 3e6  # characters that a robot may take of a page
CUBE = '<visual><geometry><mesh filename="cube.obj" scale="0.1 0.1 0.3"/></geometry></visual>'


@pytest.fixture(scope="module")
def lift(ur10: Any) -> Solution:
    found: Solution = ur10.solution
    return found


@pytest.fixture(scope="module")
def page(lift: Solution) -> str:
    return playback_page(lift)


def _parts(page: str) -> dict[str, Any]:
    """Return what the page draws, by path."""
    (text,) = re.findall(DATA, page, re.DOTALL)
    return {one["path"]: one["object"] for one in json.loads(text)["commands"] if one["type"] == "set_object"}


def test_the_page_has_the_robots_own_meshes_and_a_pedestal_and_needs_nothing_else(page: str, lift: Solution) -> None:
    parts = _parts(page)
    own = {path: part for path, part in parts.items() if "/mesh_" in path}
    assert len({path.split("/")[3] for path in own}) == 7  # six joints, and what stands still
    assert sum(len(json.dumps(part)) for part in own.values()) < MOST
    assert any(path.startswith("/lift/body/ground/") and "stand_column" in path for path in parts)
    outside = re.sub(DATA, "", page, flags=re.DOTALL)
    assert not re.search(r"""<(?:script|link|img|iframe)[^>]*(?:src|href)=["'](?!data:|#)""", outside)
    assert str(share_folder()) not in page


def test_meshes_move_with_their_joints(lift: Solution) -> None:
    """What hangs on the last joint is as far from the flange at the start as at zero (forward kinematics)."""
    playback = playback_at(lift, lift.time[[0, -1]])
    cast = Cast(lift, playback, "/lift", figures=figures_of(lift))
    last = playback.joints["robot"][-1]
    parts = [part for part in parts_of(cast) if part.body == last]
    assert parts
    here = playback.zero[last][:3, 3]
    assert max(np.linalg.norm(part.mesh.vertices - here, axis=1).max() for part in parts) < 0.15
    ground = np.vstack([part.mesh.vertices for part in parts_of(cast) if part.body == GROUND])
    assert ground[:, 2].min() == pytest.approx(0.0, abs=1e-3)
    assert ground[:, 2].max() > 0.8


def test_a_picture_shows_meshes_where_they_are_installed_and_solids_else(
    lift: Solution, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = picture_of(lift, 0.0, "robot", (80, 60))
    monkeypatch.setattr("liftopt.multibody.robots.known_robot.share_folder", lambda: None)
    assert figures_of(lift) == {}
    plain = picture_of(lift, 0.0, "robot", (80, 60))
    assert (own != plain).mean() > 0.01


@pytest.mark.parametrize(("module", "write"), [("report_figures", write_report), ("plots", write_plots)])
def test_snapshots_show_the_meshes_that_the_page_does(
    module: str, write: Any, lift: Solution, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lifts: list[Lift] = []

    def drawn(_: Any, drawn_of: Lift) -> Figure:
        lifts.append(drawn_of)
        return Figure()

    monkeypatch.setattr(f"liftopt.viz.{module}.drawn", drawn)
    monkeypatch.setattr("liftopt.viz.plots_snapshots.PANEL", (120, 95))
    write(lift, tmp_path / "written")
    own, plain = (snapshots(one).axes[0].images[0].get_array() for one in (lifts[0], replace(lifts[0], figures={})))
    assert (own != plain).mean() > 0.01


def test_words_name_the_robot(lift: Solution) -> None:
    assert "a man of 1.75 m and 75 kg and a UR10 (Universal Robots), 1.6 m apart," in team_words(lift).lower().replace(
        "ur10 (universal robots)", "UR10 (Universal Robots)"
    )
    (robot,) = lift.robots
    assert models_words(lift.scenario, lift.robots) == (
        "The robot is a UR10 (Universal Robots) with six joints on a fixed base. "
    )
    assert data_words(lift.scenario, lift.robots).endswith("come from the URDF of UR10 (Universal Robots).")
    assert "URDF" in joint_words(lift.scenario, robot)
    named = {model: a_robot(robot_of(lift.scenario, robot).model_copy(update={"model": model})) for model in (
        "sawyer", "icub_left", "so100", "xarm7", "/a/my_arm.urdf"
    )}  # fmt: skip
    assert named == {
        "sawyer": "a Sawyer robot", "icub_left": "an iCub, left arm (Istituto Italiano di Tecnologia)",
        "so100": "an SO-ARM100 (The Robot Studio)", "xarm7": "an xArm 7 (UFACTORY)", "/a/my_arm.urdf": "a robot my_arm",
    }  # fmt: skip
    long = "a_very_long_name_of_a_joint_that_no_panel_has_room_for_left"
    assert len(short(long)) == LONGEST
    assert short(long)[:10] + short(long)[-10:] == long[:10] + long[-10:]


def test_a_base_that_hangs_has_its_head_up(lift: Solution) -> None:
    scenario = lift.scenario.replace({"robot.base.roll_deg": 180.0, "robot.base.z": 2.2})
    base = base_of(agents_of(scenario)[1])
    np.testing.assert_allclose(base[:3, 2], [0.0, 0.0, 1.0], atol=1e-9)
    np.testing.assert_allclose(base[:3, 3], [1.6, 0.0, 2.2])


def test_a_file_that_a_result_names_is_read_only_if_that_is_asked_for(
    on_a_column: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lift = on_a_column.solution
    file = Path(robot_of(lift.scenario, lift.robots[0]).model)
    with monkeypatch.context() as forbidden:
        forbidden.setattr("liftopt.viz.own_meshes.read_robot", None)
        assert figures_of(lift) == {}
        assert picture_of(lift, 0.0, "robot", (40, 30)).shape == (30, 40, 3)
    text = file.read_text(encoding="utf-8")
    folder = tmp_path / "mine" / "urdf"
    folder.mkdir(parents=True)
    with_mesh = text.replace('<link name="turn_link">', f'<link name="turn_link">{CUBE}')
    (folder / file.name).write_text(with_mesh, encoding="utf-8")
    (folder / "cube.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", encoding="utf-8"
    )
    for given in (tmp_path / "mine", folder, folder / file.name):
        (piece,) = figures_of(lift, given)["robot"]
        assert (piece.joint, np.ptp(piece.mesh.vertices, axis=0).max()) == (1, pytest.approx(0.3))
    assert figures_of(lift, True) == {"robot": ()}  # the scenario's own file has no meshes: its solids are drawn
    (folder / "other.urdf").write_text(text.replace('xyz="0 0 0.45"', 'xyz="0 0 0.46"'), encoding="utf-8")
    (folder / "arm.xacro").write_text(text, encoding="utf-8")
    wrong = {"other.urdf": "another robot", "arm.xacro": "xacro is not expanded", "none.urdf": "no such"}
    for name, told in wrong.items():
        with pytest.raises(InputError, match=told):
            figures_of(lift, folder / name)
