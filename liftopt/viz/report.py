"""The report: one page that holds all there is to know of a lift, for someone who never saw the project."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

import liftopt
from liftopt.assessment.joints import NEAR_LIMIT
from liftopt.assessment.who import who_is
from liftopt.ergonomics.reba import ASSUMPTIONS as REBA_ASSUMPTIONS
from liftopt.ergonomics.rula import ASSUMPTIONS as RULA_ASSUMPTIONS
from liftopt.errors import InputError
from liftopt.multibody.agent import Kind
from liftopt.scenario.grasps import grasp_heights, height_words
from liftopt.solution.checks import TOUCH
from liftopt.solution.finding import Finding, percent
from liftopt.solution.solution import Solution
from liftopt.solution.summary import summary_dict
from liftopt.viz.own_meshes import Meshes, figures_of
from liftopt.viz.playback import playback_of
from liftopt.viz.plots_data import Lift
from liftopt.viz.report_agents import bodies_words, force_rows, means_words, reported, subject_words, team_words
from liftopt.viz.report_clearance import clearance_rows
from liftopt.viz.report_figures import inline_figures, section_figures
from liftopt.viz.report_section import ReportSection
from liftopt.viz.report_tables import Headline, check_rows, scenario_rows, source_rows
from liftopt.viz.robot_words import data_words, models_words
from liftopt.viz.scene import Cast
from liftopt.viz.viewer_page import page_of
from liftopt.viz.who import stand_opposite

CSS = "report.css"
TEMPLATE = "report.html.jinja"
# By the kind of agent and what was found of it: what is written below the number, and that where there are several of
# the kind.
HEADLINES: tuple[tuple[Kind, str, str, str], ...] = (
    ("person", "person.strength", "of the person's strength", "of {}'s strength"),
    ("person", "person.load_share", "of the load is on the person at most", "of the load is on {} at most"),
    ("person", "person.grasp_force", "on the person's hand at most", "on {}'s hand at most"),
    ("robot", "robot.torque", "of a robot joint's torque limit", "of the torque limit of a joint of {}"),
    (
        "person",
        "person.spine_compression",
        "presses on the lowest disc at most; 3400 N is the action limit",
        "presses on the lowest disc of {} at most",
    ),
    ("person", "person.posture", "RULA posture score at worst; 7 is bad", "RULA posture score of {}; 7 is bad"),
)


def write_report(
    solution: Solution, file: Path, sections: Sequence[ReportSection] = (), *, meshes: Meshes = False
) -> None:
    """Write the report to ``file``, with sections that others add; its folder is made if need be.

    Raises:
        InputError: the file cannot be written.
    """
    if file.is_dir():
        raise InputError("--html", str(file), "cannot be written: there is a folder of that name")
    text = report_html(solution, sections, meshes=meshes)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError("--html", str(file), f"cannot be written: {error.strerror or error}") from None


def report_html(solution: Solution, sections: Sequence[ReportSection] = (), *, meshes: Meshes = False) -> str:
    """Return the report as one HTML page that needs nothing else, with sections that others add before the scenario.

    Robots' own ``meshes`` are looked for as ``figures_of`` has it.
    """
    lift = Lift.of(solution, figures_of(solution, meshes))
    summary = summary_dict(solution)
    figures = inline_figures(lift)
    for section in sections:
        figures |= section_figures(section)
    context: dict[str, Any] = {
        "css": Markup((files("liftopt.viz.assets") / CSS).read_text(encoding="utf-8")),
        "version": liftopt.__version__,
        "solution": solution,
        "scenario": solution.scenario,
        "summary": summary,
        "assessment": solution.assessment,
        "headlines": _headlines(solution),
        "figures": {name: {"svg": Markup(figure.svg), "caption": figure.caption} for name, figure in figures.items()},
        "sections": sections,
        "playback": page_of([Cast(solution, playback_of(solution), "/lift", figures=lift.figures)]),
        "people": [reported(lift, agent) for agent in lift.dense.persons],
        "robots": [reported(lift, agent) for agent in lift.dense.robots],
        "team": team_words(solution),
        "means": means_words(solution.agents),
        "bodies": bodies_words(solution.persons),
        "machines": models_words(solution.scenario, solution.robots),
        "machine_data": data_words(solution.scenario, solution.robots),
        "holds": sum(len(agent.grasps) for agent in solution.agents),
        "heights": grasp_heights(solution.scenario),
        "height_of": height_words(solution.scenario),
        "paired": stand_opposite(solution.scenario),
        "about": lambda finding: subject_words(finding, solution.agents),
        "named": [agent.name for agent in solution.agents if not who_is(agent, solution.agents).is_alone],
        "forces": force_rows(lift, summary),
        "near_limit": 100 * NEAR_LIMIT,
        "apart": clearance_rows(lift.dense.clearance),
        "touch": 1e3 * TOUCH,
        "rula_assumptions": RULA_ASSUMPTIONS,
        "reba_assumptions": REBA_ASSUMPTIONS,
        "entries": scenario_rows(solution.scenario),
        "checks": check_rows(summary),
        "sources": source_rows(solution),
    }
    return _environment().get_template(TEMPLATE).render(context)


def _headlines(solution: Solution) -> list[Headline]:
    """Return the numbers that matter most, as the assessment has them; of what is no solution it has none."""
    agents, told = solution.agents, []
    for kind, code, label, named in HEADLINES:
        for agent in (agent for agent in agents if agent.kind == kind):
            alone = who_is(agent, agents).is_alone
            found = (one for one in solution.assessment if one.code == code and (alone or one.agent == agent.name))
            finding = next(found, None)
            if finding is not None and finding.value is not None:
                told.append(Headline(_number(finding), label if alone else named.format(agent.name), finding.message))
    return told


def _number(finding: Finding) -> str:
    """Return a value as a share of its limit; what has none is a share already, or a score."""
    value = finding.value or 0.0
    if finding.unit in ("N", "of 7"):
        return f"{value:.0f} {finding.unit}"
    return f"{percent(value / (finding.limit or 1.0))} %"


def _environment() -> Environment:
    return Environment(
        loader=PackageLoader("liftopt.viz", "assets"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
