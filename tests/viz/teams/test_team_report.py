"""The report of other teams, and sections that others add to any report."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from html import unescape
from typing import Any

import pytest
from matplotlib.figure import Figure

from liftopt.viz.report import report_html
from liftopt.viz.report_section import ReportSection, SectionFigure, SectionTable

pytestmark = pytest.mark.long


def _page(solution: Any, *sections: ReportSection) -> str:
    """Return the page without the playback and the drawings inside it."""
    page = re.sub(r'srcdoc="[^"]*"', "", report_html(solution, sections))
    return re.sub(r"<svg.*?</svg>", "<svg></svg>", page, flags=re.DOTALL)


def _section(page: str, name: str) -> str:
    (found,) = re.findall(rf'<section id="{name}">(.*?)</section>', page, re.DOTALL)
    return unescape(re.sub(r"<[^>]*>", " ", found))


@pytest.fixture(scope="module", autouse=True)
def undrawn() -> Iterator[None]:
    """Leave figures empty, which ``_page`` leaves out and which take most of the time; others' tests draw them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("liftopt.viz.report_figures.drawn", lambda *_: Figure())
        yield


@pytest.fixture(scope="module")
def people(two_people: Any) -> str:
    return _page(two_people.solution)


@pytest.fixture(scope="module")
def robots(two_robots: Any) -> str:
    return _page(two_robots.solution)


def test_addresses_are_there_once_and_lead_somewhere(people: str, robots: str) -> None:
    for page in (people, robots):
        ids = re.findall(r'\bid="([^"]*)"', page)
        assert len(ids) == len(set(ids))
        assert set(re.findall(r'href="#([^"]*)"', page)) <= set(ids)


def test_two_people_have_sections_of_their_own(people: str) -> None:
    first = " ".join(unescape(re.sub(r"<[^>]*>", " ", people)).split())
    assert (
        "A woman of 1.62 m and 58 kg (anna) and a man of 1.82 m and 84 kg (ben), 1.3 m apart, lift a box of 8 kg "
        "together from 0.8 to 1.15 m" in first
    )
    assert "each person with the right hand. " in first
    for name, sex in (("anna", "woman"), ("ben", "man")):
        assert f"Person: {name}" in _section(people, f"person-{name}")
        assert f"a typical {sex} in that direction" in _section(people, f"ergonomics-{name}")
        for what in ("arm", "angles", "torques", "ground_reaction", "strength_used", "spine_load", "posture_score"):
            assert people.count(f'id="plot-{name}_{what}"') == 1
        assert f"ground reaction on {name}, vertical" in _section(people, "forces")
    assert 'id="robot' not in people
    assert "Sawyer" not in _section(people, "method").partition("Prediction.")[0]
    assert people.count("What the method leaves open was decided so") == 1


def test_two_robots_have_sections_of_their_own(robots: str) -> None:
    text = " ".join(unescape(re.sub(r"<[^>]*>", " ", robots)).split())
    assert "A man of 1.75 m and 75 kg, a Sawyer robot (near) and a Sawyer robot (far) lift a plank of 6 kg" in text
    assert "the person with the right hand, each robot with its gripper" in text
    assert text.count(" is a Rethink Sawyer with seven joints on a fixed base.") == 2
    assert "<h2>Person</h2>" in robots
    for name in ("near", "far"):
        assert f"Robot: {name}" in _section(robots, f"robot-{name}")
        assert f'id="plot-{name}_torques"' in robots


def test_every_number_and_finding_says_whose_it_is(two_people: Any, two_robots: Any, people: str, robots: str) -> None:
    for page, solution in ((people, two_people.solution), (robots, two_robots.solution)):
        header = unescape(page[page.index('id="result"') : page.index('id="warnings"')])
        for agent in solution.agents:
            code, words = {
                "person": ("person.strength", f"of {agent.name}'s strength"),
                "robot": ("robot.torque", f"of the torque limit of a joint of {agent.name}"),
            }[agent.kind]
            words = "of the person's strength" if agent.name == "human" else words
            (finding, *_) = (one for one in solution.assessment if (one.code, one.agent) == (code, agent.name))
            (shown,) = re.findall(r"<b>([^<]*)</b><span>" + re.escape(words), header)
            assert shown == f"{100 * finding.value / (finding.limit or 1.0):.0f} %"
            verdict = _section(page, "warnings")
            assert ("the person " if agent.name == "human" else f"{agent.name} ") in verdict


def test_a_section_that_is_added_is_whole_and_told_at_the_top(two_people: Any) -> None:
    figure = Figure(figsize=(2.0, 1.0))
    figure.subplots().plot([0, 1], [0, 1])
    section = ReportSection(
        name="trial",
        title="Trial <1>",
        holds="what was seen",
        text="Text & more.",
        tables=(SectionTable(("thing", "unit", "number"), (("way", "m", "1.5"),), words=2),),
        figures=(SectionFigure("seen", "What it shows.", figure),),
        notes_title="To know",
        notes=("A note.",),
    )
    page = _page(two_people.solution, section)
    assert 'what was seen stands under <a href="#trial">Trial &lt;1&gt;</a>.' in page
    assert "nothing here was measured" not in page
    assert '<li><a href="#trial">Trial &lt;1&gt;</a></li>' in page
    assert '<th>thing</th><th>unit</th><th class="n">number</th>' in page
    assert '<td class="name">way</td><td>m</td><td class="n">1.5</td>' in page
    assert page.count('id="plot-seen"') == 1
    assert " ".join(_section(page, "trial").split()).startswith("Trial <1> Text & more. thing unit number way m 1.5")
    assert _section(page, "trial").rstrip().endswith("A note.")


def test_heights_of_an_object_that_has_a_place_of_its_own_are_those_of_where_it_is_held(two_people: Any) -> None:
    """The centre at 1 and 1.3 m of a box 0.25 m high, which is held at its lower edges."""
    places = {end: {"x": 0.65, "z": z} for end, z in (("start", 1.0), ("end", 1.3))}
    scenario = two_people.solution.scenario.replace({f"task.{end}": place for end, place in places.items()})
    page = _page(replace(two_people.solution, scenario=scenario))
    assert "from 0.875 to 1.175 m (height of the edges they hold) in" in page
