"""The report: self-contained, true to the summary, and warning of what was put into it to be warned of."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.cli import main
from liftopt.ergonomics.assessment import assess
from liftopt.interpolation import refined
from liftopt.solution import Solution
from liftopt.summary import summary_dict
from liftopt.viz.anatomy import human_curves, robot_curves
from liftopt.viz.report_findings import Finding, findings

CHEAP = ("solver.intervals=10", "solver.starts=1")
LARGEST = 15_000_000  # bytes


@pytest.fixture(scope="module")
def result(solved: Callable[..., Any]) -> Any:
    return solved("table5", *CHEAP)


@pytest.fixture(scope="module")
def file(result: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("report") / "new" / "lift.html"
    assert main(["report", str(result.folder), "--html", str(path)]) == 0
    return path


@pytest.fixture(scope="module")
def page(file: Path) -> str:
    """The page without the playback inside it."""
    return re.sub(r'srcdoc="[^"]*"', "", file.read_text(encoding="utf-8"))


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.ids: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        found = dict(attributes)
        self.ids += [found["id"]] if found.get("id") else []
        self.links += [found[key] for key in ("src", "href", "xlink:href", "data") if found.get(key)]
        if tag in ("section", "table", "figure", "svg", "tr", "ul"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag in ("section", "table", "figure", "svg", "tr", "ul"):
            assert self.open.pop() == tag


def test_page_is_whole_and_needs_nothing_else(file: Path, page: str) -> None:
    assert file.stat().st_size < LARGEST
    reader = _Reader()
    reader.feed(page)
    assert reader.open == []
    assert len(reader.ids) == len(set(reader.ids))
    assert {link[1:] for link in reader.links if link.startswith("#")} <= set(reader.ids)
    outside = {link for link in reader.links if not link.startswith(("#", "data:"))}
    assert outside == {"https://doi.org/10.1007/s10846-023-02013-y"}
    assert "@import" not in page
    assert not re.search(r"url\((?!#)", page)


def test_page_holds_what_an_engineer_asks_for(page: str, result: Any) -> None:
    text = unescape(re.sub(r"<[^>]*>", " ", page))
    for heading in ("Warnings", "Playback", "Ergonomics", "Scenario", "Objective", "Verification", "obtained"):
        assert heading in text
    summary = summary_dict(result.solution)
    assert "solved and verified" in text
    assert f"{summary['objective']['total']:.5g}" in text
    for check in summary["verification"]["checks"]:
        assert check["name"].removesuffix(" between knots") in text
    for key in ("human.stature", "task.standing_distance", "limits.max_grasp_force", "solver.seed"):
        assert key in text
    assert "not for one-handed lifts" in text
    assert "starts at 3 kg" in text


def _found(solution: Solution) -> dict[str, Finding]:
    dense = refined(solution, 4)
    human, robot = human_curves(dense.agents[0]), robot_curves(dense.agents[1], "sawyer")
    return {finding.title: finding for finding in findings(dense, human, robot, assess(dense))}


def _titles(solution: Solution, pattern: str) -> list[Finding]:
    return [finding for title, finding in _found(solution).items() if re.search(pattern, title)]


def test_a_joint_near_its_torque_limit_is_named(result: Any) -> None:
    """With strength cut to the peak torque over 0.9, the joint must be reported at 90 %."""
    dense = refined(result.solution, 4)
    curve = human_curves(dense.agents[0])[4]
    direction = "tau_upper" if curve.tau[np.argmax(curve.share)] > 0 else "tau_lower"
    human = dense.agents[0]
    limit = getattr(human.limits, direction).copy()
    limit[4] *= curve.share.max() / 0.9
    weak = replace(dense, agents=(replace(human, limits=replace(human.limits, **{direction: limit})), dense.agents[1]))
    found = findings(weak, human_curves(weak.agents[0]), (), assess(weak))
    title = "Person: Shoulder flexion (Q5) uses 90 % of its torque limit"
    assert [f.level for f in found if f.title == title] == ["warning"]
    assert not _titles(result.solution, "Shoulder flexion .* uses")


def test_grasp_force_at_its_cap_is_named(result: Any) -> None:
    solution: Solution = result.solution
    largest = max(np.linalg.norm(agent.grasp_force, axis=1).max() for agent in solution.agents)
    limits = replace(solution.scenario.limits, max_grasp_force=float(largest))
    capped = replace(solution, scenario=replace(solution.scenario, limits=limits))
    (finding,) = _titles(capped, "at its cap")
    assert finding.level == "warning"
    assert not _titles(solution, "at its cap")


def test_a_limit_that_is_active_all_along_is_told_from_one_that_is_touched(result: Any) -> None:
    solution: Solution = result.solution
    pose = solution.held.pose.copy()
    limit = np.radians(solution.scenario.limits.table_pitch_deg)
    flat = {name: np.zeros_like(pose) for name in ("pose_velocity", "pose_acceleration")}
    pose[:, 4] = limit
    (always,) = _titles(replace(solution, held=replace(solution.held, pose=pose, **flat)), "pitch at its limit")
    pose = pose.copy()
    pose[2:, 4] = 0.0
    (sometimes,) = _titles(replace(solution, held=replace(solution.held, pose=pose, **flat)), "pitch at its limit")
    assert (always.level, sometimes.level) == ("warning", "note")
    assert "all along" in always.detail


def test_forces_that_only_fight_each_other_are_named(result: Any) -> None:
    solution: Solution = result.solution
    push = np.array([50.0, 0.0, 10.0])
    agents = tuple(
        replace(agent, grasp_force=np.tile(push * [sign, 1, 1], (len(solution.time), 1)))
        for agent, sign in zip(solution.agents, (1, -1), strict=True)
    )
    (finding,) = _titles(replace(solution, agents=agents), "work against each other")
    assert "press it together" in finding.detail


def test_an_unsolved_result_is_no_prediction(result: Any) -> None:
    first = next(iter(_found(replace(result.solution, outcome="time limit reached")).values()))
    assert (first.level, first.title) == ("stop", "Not a solution")
    assert "time limit reached" in first.detail


@pytest.mark.parametrize("command", [["report", "--html"], ["plot", "--out"]], ids=lambda command: command[0])
@pytest.mark.parametrize("what", ["missing", "cut short", "something else"])
def test_no_result_gets_a_clear_error(
    command: list[str], what: str, result: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "result"
    if what != "missing":
        folder.mkdir()
        (folder / "scenario.toml").write_bytes((result.folder / "scenario.toml").read_bytes())
        whole = (result.folder / "solution.nc").read_bytes()
        (folder / "solution.nc").write_bytes(whole[: len(whole) // 3] if what == "cut short" else b"no result")
    assert main([command[0], str(folder), command[1], str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert told.startswith("liftopt: error: ")
    assert str(folder) in told
    assert told.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_report_cannot_be_written_over_a_folder(
    result: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", str(result.folder), "--html", str(tmp_path)]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_report_in_a_browser(file: Path, chromium: Any) -> None:
    """Chromium shows every section, plays the lift inside the page, asks for nothing and complains of nothing."""
    complaints: list[str] = []
    requests: list[str] = []
    tab = chromium.new_page(viewport={"width": 1200, "height": 800})
    tab.set_default_timeout(60_000)
    tab.on("pageerror", lambda error: complaints.append(str(error)))
    tab.on("console", lambda message: complaints.append(message.text) if message.type == "error" else None)
    tab.on("request", lambda request: requests.append(request.url))
    tab.goto(file.as_uri())
    (player,) = (frame for frame in tab.frames if frame.parent_frame is not None)
    player.wait_for_function("window.liftopt && window.liftopt.ready")
    assert tab.evaluate("document.documentElement.scrollWidth") <= 1200
    sizes = tab.evaluate("[...document.querySelectorAll('figure svg')].map(s => s.getBoundingClientRect().height)")
    assert len(sizes) == 11
    assert min(sizes) > 150
    assert complaints == []
    assert [url for url in requests if not url.startswith(("data:", "blob:", "about:"))] == [file.as_uri()]
    tab.close()
