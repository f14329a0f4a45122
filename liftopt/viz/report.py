"""The report: one page that holds all there is to know of a lift, for someone who never saw the project."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

import liftopt
from liftopt.assessment.joints import NEAR_LIMIT
from liftopt.ergonomics.measures import ergonomics_of
from liftopt.ergonomics.rula import ASSUMPTIONS
from liftopt.errors import InputError
from liftopt.lab.comparison.plots import experiment_tables
from liftopt.solution.finding import Finding, percent
from liftopt.solution.solution import Solution
from liftopt.solution.summary import summary_dict
from liftopt.viz.anatomy import human_curves, robot_curves
from liftopt.viz.plots_data import Lift
from liftopt.viz.report_figures import inline_comparisons, inline_figures
from liftopt.viz.report_tables import Headline, check_rows, joint_rows, scenario_rows, source_rows
from liftopt.viz.viewer_page import playback_page

if TYPE_CHECKING:
    from liftopt.lab.comparison.experiment import Experiment

CSS = "report.css"
TEMPLATE = "report.html.jinja"
HEADLINES = {
    "person.strength": "of the person's strength",
    "person.load_share": "of the load is on the person at most",
    "person.grasp_force": "on the person's hand at most",
    "robot.torque": "of a robot joint's torque limit",
    "person.posture": "RULA posture score at worst; 7 is bad",
}


def write_report(solution: Solution, file: Path, experiment: Experiment | None = None) -> None:
    """Write the report to ``file``, with the experiment if there is one; its folder is made if need be.

    Raises:
        InputError: the file cannot be written.
    """
    if file.is_dir():
        raise InputError("--html", str(file), "cannot be written: there is a folder of that name")
    text = report_html(solution, experiment)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError("--html", str(file), f"cannot be written: {error.strerror or error}") from None


def report_html(solution: Solution, experiment: Experiment | None = None) -> str:
    """Return the report as one HTML page that needs nothing else; with what was recorded, if it was."""
    lift = Lift.of(solution)
    dense, ergonomics = lift.dense, ergonomics_of(lift.dense)
    human = human_curves(dense.agents[0])
    robot = robot_curves(dense.agents[1], solution.scenario.first("robot").model)
    summary = summary_dict(solution)
    figures = inline_figures(lift)
    compared = inline_comparisons(experiment) if experiment else {}
    context: dict[str, Any] = {
        "css": Markup((files("liftopt.viz.assets") / CSS).read_text(encoding="utf-8")),
        "version": liftopt.__version__,
        "solution": solution,
        "scenario": solution.scenario,
        "summary": summary,
        "assessment": solution.assessment,
        "headlines": _headlines(solution),
        "figures": {
            name: {"svg": Markup(figure.svg), "caption": figure.caption}
            for name, figure in (figures | compared).items()
        },
        "experiment": experiment,
        "experiment_tables": experiment_tables(experiment) if experiment else {},
        "compared": list(compared),
        "playback": playback_page(solution),
        "joints": {"person": joint_rows(human, dense), "robot": joint_rows(robot, dense)},
        "near_limit": 100 * NEAR_LIMIT,
        "ergonomics": ergonomics,
        "rula_assumptions": ASSUMPTIONS,
        "labels": {curve.joint: curve.label for curve in human},
        "entries": scenario_rows(solution.scenario),
        "checks": check_rows(summary),
        "sources": source_rows(solution.scenario),
    }
    return _environment().get_template(TEMPLATE).render(context)


def _headlines(solution: Solution) -> list[Headline]:
    """Return the numbers that matter most, as the assessment has them; of what is no solution it has none."""
    told = []
    for code, label in HEADLINES.items():
        finding = next((finding for finding in solution.assessment if finding.code == code), None)
        if finding is not None and finding.value is not None:
            told.append(Headline(_number(finding), label, finding.message))
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
