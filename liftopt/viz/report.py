"""The report: one page that holds all there is to know of a lift, for someone who never saw the project."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

import liftopt
from liftopt.ergonomics.assessment import Assessment, assess
from liftopt.ergonomics.rula import ASSUMPTIONS
from liftopt.errors import InputError
from liftopt.solution import Solution
from liftopt.summary import GRAVITY, shares, summary_dict
from liftopt.viz.anatomy import JointCurve, human_curves, robot_curves
from liftopt.viz.plots_comparison import experiment_tables
from liftopt.viz.plots_data import Lift
from liftopt.viz.report_figures import inline_comparisons, inline_figures
from liftopt.viz.report_findings import NEAR_LIMIT, findings
from liftopt.viz.report_tables import Headline, check_rows, joint_rows, scenario_rows, source_rows
from liftopt.viz.viewer_page import playback_page

if TYPE_CHECKING:
    from liftopt.lab.experiment import Experiment

CSS = "report.css"
TEMPLATE = "report.html.jinja"


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
    dense, ergonomics = lift.dense, assess(lift.dense)
    human = human_curves(dense.agents[0])
    robot = robot_curves(dense.agents[1], solution.scenario.robot.model)
    summary = summary_dict(solution)
    figures = inline_figures(lift)
    compared = inline_comparisons(experiment) if experiment else {}
    context: dict[str, Any] = {
        "css": Markup((files("liftopt.viz.assets") / CSS).read_text(encoding="utf-8")),
        "version": liftopt.__version__,
        "solution": solution,
        "scenario": solution.scenario,
        "summary": summary,
        "findings": findings(dense, human, robot, ergonomics),
        "headlines": _headlines(dense, human, robot, ergonomics),
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


def _headlines(
    dense: Solution, human: tuple[JointCurve, ...], robot: tuple[JointCurve, ...], ergonomics: Assessment
) -> list[Headline]:
    share = shares(dense.agents)[0]
    share = share[np.isfinite(share)]
    force = np.linalg.norm(dense.agents[0].grasp_force, axis=1)
    k, grand = int(np.argmax(force)), ergonomics.rula.grand
    carried = Headline("\N{EM DASH}", "of the load is on the person", "there is no load to share")
    if len(share):
        remark = f"on average; between {100 * share.min():.0f} and {100 * share.max():.0f} % along the way"
        carried = Headline(f"{100 * share.mean():.0f} %", "of the load is on the person", remark)
    return [
        _largest_share("of the person's strength", human, dense),
        carried,
        Headline(
            f"{force[k]:.0f} N",
            "on the person's hand at most",
            f"at {dense.time[k]:.2f} s; {force[k] / GRAVITY:.1f} kg",
        ),
        _largest_share("of a robot joint's torque limit", robot, dense),
        Headline(f"{grand.max()} of 7", "RULA posture score at worst", f"{grand.min()} at best; 1 is good, 7 is bad"),
    ]


def _largest_share(label: str, curves: tuple[JointCurve, ...], dense: Solution) -> Headline:
    worst = max(curves, key=lambda curve: float(curve.share.max()))
    k = int(np.argmax(worst.share))
    return Headline(f"{100 * worst.share[k]:.0f} %", label, f"{worst.label} at {dense.time[k]:.2f} s")


def _environment() -> Environment:
    return Environment(
        loader=PackageLoader("liftopt.viz", "assets"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
