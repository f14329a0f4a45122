"""The report: self-contained, true to the summary, and warning of what was put into it to be warned of."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from liftopt.assessment.assess import assessed
from liftopt.commands.cli import main
from liftopt.solution.summary import summary_dict
from liftopt.viz.report import report_html
from liftopt.viz.report_tables import check_rows

pytestmark = pytest.mark.long
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
    for heading in (
        "Verdicts and warnings",
        "Playback",
        "Ergonomics",
        "Scenario",
        "Objective",
        "Verification",
        "obtained",
    ):
        assert heading in text
    summary = summary_dict(result.solution)
    assert "solved and verified" in text
    assert f"{summary['objective']['total']:.5g}" in text
    for check in summary["verification"]["checks"]:
        assert check["name"] in text
    for key in ("human.stature", "task.standing_distance", "limits.max_grasp_force", "solver.seed"):
        assert key in text
    assert "not for one-handed lifts" in text
    assert "starts at 3 kg" in text


def test_page_tells_the_assessment_and_nothing_else(page: str, result: Any) -> None:
    """Every finding, with the words and the severity that terminal, JSON and solution.nc have."""
    items = re.findall(r'<li class="(\w+)"><b>[^<]*</b> ?<span>(.*?)</span></li>', page)
    style = {"stop": "error", "warning": "warning", "caution": "caution", "note": "info"}
    told = {(style[kind], unescape(re.sub(r" <small>.*</small>", "", text))) for kind, text in items}
    verdicts = result.solution.assessment.verdicts
    assert told == {(f.severity, f.message) for f in result.solution.assessment if f not in verdicts}
    for verdict in verdicts:
        assert verdict.message in unescape(page)


def test_clearance_has_a_table_by_pair_and_time_and_no_claim_of_safety(page: str, result: Any, undrawn: None) -> None:
    section = re.search(r'<section id="clearance">.*?</section>', page, re.DOTALL)
    assert section is not None
    rows = re.findall(
        r'<td class="name">(.*?)</td><td>.*?</td><td class="n">(.*?)</td><td class="n">(.*?) s', section[0]
    )
    clearance = result.solution.clearance
    assert [row[0] for row in rows] == [item.pair.told for item in clearance.closest[: len(rows)]]
    for (_, distance, when), item in zip(rows, clearance.closest, strict=False):
        assert float(distance.replace("\N{MINUS SIGN}", "-")) == pytest.approx(1e3 * item.distance, abs=0.051)
        assert float(when) == pytest.approx(item.time, abs=0.0051)
    assert "nothing on this page says that the lift is safe" in section[0]
    off = report_html(assessed(replace(result.solution, scenario=_without_clearance(result.solution.scenario))))
    assert "Clearance is off: nothing keeps bodies apart." in off


def _without_clearance(scenario: Any) -> Any:
    return scenario.replace({"limits.clearance": "off"})


def test_a_value_without_a_limit_is_never_ok(solved: Callable[..., Any]) -> None:
    """Point grasps on one line leave a moment that nobody serves."""
    rows = {row["name"]: row for row in check_rows(summary_dict(solved("table5_paper", *CHEAP).solution))}
    assert rows["balance between knots"]["state"] == rows["unserved moment"]["state"] == "no limit"
    assert rows["grasp closure at the knots"]["state"] == rows["first-order optimality (KKT error)"]["state"] == "ok"


def test_an_unsolved_result_is_no_prediction(result: Any, undrawn: None) -> None:
    failed = assessed(replace(result.solution, outcome="time limit reached"))
    page = re.sub(r'srcdoc="[^"]*"', "", report_html(failed))
    header = page[page.index('id="result"') : page.index('id="warnings"')]
    assert header.index("not solved") < header.index("person: not assessed")
    assert "It is no prediction" in header
    assert "of the person's strength" not in header  # and none of the numbers that matter
    assert "time limit reached" in page[page.index('id="warnings"') :]


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
    assert len(sizes) == 14
    assert min(sizes) > 150
    assert complaints == []
    assert [url for url in requests if not url.startswith(("data:", "blob:", "about:"))] == [file.as_uri()]
    tab.close()
