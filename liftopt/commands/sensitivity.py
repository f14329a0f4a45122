"""``liftopt sensitivity``: what a lift depends on, as a table, JSON or a plot."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from liftopt.commands.terminal import telling
from liftopt.errors import InputError
from liftopt.files.atomic_file import write_whole
from liftopt.storage.solved_scenario import scenario_or_solved
from liftopt.types import Progress
from liftopt.viz import FORMATS

if TYPE_CHECKING:
    from liftopt.studies.sensitivity import Sensitivity, SensitivityStudy


def add_sensitivity_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "sensitivity",
        help="what effort, peak torques and load share depend on",
        description="Solve a scenario, or that of a result anew, and again with stature, masses, heights, distances "
        "and duration a little changed up and down; everybody re-plans. The changes are as large as what they do stays "
        "in proportion.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "scenario",
        nargs="?",
        metavar="SCENARIO",
        help="a TOML file, a result folder, or a scenario that is shipped (default: table5)",
    )
    parser.add_argument(
        "--set", action="append", default=[], dest="overrides", metavar="KEY=VALUE", help="as with solve"
    )
    parser.add_argument("--json", action="store_true", help="print all slopes as one JSON object")
    parser.add_argument("--plot", metavar="FILE", help="write a figure: .svg, .png or .pdf")
    parser.set_defaults(run=telling(sensitivity))


def sensitivity(args: argparse.Namespace, progress: Progress | None = None) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: the scenario or an option is wrong, or the plot cannot be written.
        LiftoptError: the scenario has no verified solution.
    """
    plot = None if args.plot is None else Path(args.plot)
    if plot is not None and plot.suffix[1:] not in FORMATS:
        raise InputError("--plot", args.plot, "must end in .svg, .png or .pdf")
    scenario = scenario_or_solved(args.scenario, args.overrides)
    from liftopt.studies import sensitivity as studies

    found = studies.sensitivity(scenario, progress)
    if plot is not None:
        _write_plot(found, plot)
    if args.json:
        return json.dumps(study_dict(found), allow_nan=False) + "\n"
    return table(found) + ("" if plot is None else f"Written to {plot}\n")


def study_dict(study: SensitivityStudy) -> dict[str, Any]:
    """Return a study ready for JSON: slopes in the figures' units over the parameter's."""
    return {
        "scenario": study.candidate.scenario.to_dict(),
        "figures": study.figures,
        "busiest": list(study.busiest),
        "parameters": [
            {
                "name": s.parameter.name,
                "keys": list(s.parameter.keys),
                "unit": s.parameter.unit,
                "value": s.value,
                "change": s.change,
                "slopes": s.slopes,
                "objective_by_envelope": s.envelope,
                "reliable": s.is_reliable,
                "doubt": s.doubt or None,
                "not_larger_because": s.beyond or None,
            }
            for s in study.sensitivities
        ],
        "left_out": [{"name": parameter.name, "why": why} for parameter, why in study.left_out],
    }


def _write_plot(study: SensitivityStudy, path: Path) -> None:
    from matplotlib import rc_context

    from liftopt.studies.sensitivity_plot import sensitivity_figure
    from liftopt.viz.plots import rendered
    from liftopt.viz.plots_style import STYLE

    with rc_context(STYLE):
        figure = sensitivity_figure(study)
    write_whole("--plot", path, rendered(figure, path.suffix[1:]))


def table(study: SensitivityStudy) -> str:
    """Return the table that the command prints."""
    from liftopt.assessment.who import who_is
    from liftopt.solution.effort import effort_in
    from liftopt.studies.sensitivity import bearers

    agents, effort = study.candidate.problem.team.agents, effort_in(study.candidate.scenario)
    told = {agent.name: who_is(agent, agents) for agent in agents}
    now, bearing = study.figures, bearers(study)
    efforts = ", ".join(f"of {who.called} {now[f'effort {name}']:.4g}" for name, who in told.items())
    borne = [f"{100 * now[f'share {name}']:.1f} %" for name in bearing]
    others = [f"{told[name].called} {share}" for name, share in zip(bearing[1:], borne[1:], strict=True)]
    limits = [f"{name} with {100 * now[f'used {name}']:.1f} % of its torque" for name in study.busiest]
    lines = [
        f"{study.candidate.scenario.name}: J = {now['objective']:.5g}, effort {efforts} {effort.unit}; "
        f"{told[bearing[0]].called} bears",
        f"{', '.join([borne[0], *others])}. Nearest to their limits: {' and '.join(limits)}.",
        "",
    ]
    columns = _columns(study)
    name = max([17, *(len(s.parameter.name) for s in study.sensitivities)])
    groups = {column.group: [one for one in columns if one.group == column.group] for column in columns}
    head = [f"{group:>{sum(one.width for one in some) + len(some) - 1}}" for group, some in groups.items()]
    lines += [
        f"{'':{name}} {'':>12} {'':>7} " + " ".join(head),
        f"{'if this':{name}} {'':>12} {'J':>7} " + " ".join(f"{c.label:>{c.width}}" for c in columns) + f" {'J':>7}",
        f"{'changes':{name}} {'by':>12} {'%':>7} " + " ".join(f"{'%':>{c.width}}" for c in columns) + f" {'%/+1%':>7}",
    ]
    for s in sorted(study.sensitivities, key=lambda s: -abs(s.slopes["objective"] * s.change)):
        relative = 100 * s.slopes["objective"] / now["objective"]
        cells = [f"{s.change * c.scale * s.slopes[c.figure]:+{c.width}.2f}" for c in columns]
        lines.append(
            f"{s.parameter.name:{name}} {_change(s):>10}{'' if s.is_reliable else ' !':2} "
            f"{s.change * relative:+7.2f} " + " ".join(cells) + f" {relative * s.value / 100:+7.2f}"
        )
    return "\n".join([*lines, *_remarks(study)]) + "\n"


class _Column(NamedTuple):
    """A column of the table: the figure, what takes its slope to percent, and its head."""

    figure: str
    scale: float
    group: str
    label: str
    width: int


def _columns(study: SensitivityStudy) -> list[_Column]:
    """Return the columns of efforts, loads and torques: everybody's, by name where there are several of a kind."""
    from liftopt.assessment.who import who_is
    from liftopt.studies.sensitivity import bearers

    agents, bearing = study.candidate.problem.team.agents, bearers(study)
    labels = {agent.name: who_is(agent, agents).label for agent in agents}
    columns = []
    for name, label in labels.items():
        figure = f"effort {name}"
        columns.append(_Column(figure, 100 / study.figures[figure], "effort", label, max(7, len(label))))
    for name in bearing:
        group, label = ("", "load") if len(bearing) == 1 else ("load", labels[name])
        columns.append(_Column(f"share {name}", 100.0, group, label, max(6, len(label))))
    for agent, joint in zip(agents, study.busiest, strict=True):
        short = joint.removeprefix(f"{agent.name}_")
        label = short if len(agents) == 2 else f"{agent.name} {short}"
        columns.append(_Column(f"used {joint}", 100.0, "torque used", label, max(7, len(label))))
    return columns


def _remarks(study: SensitivityStudy) -> list[str]:
    """Return the lines below the table: what it says, and where it cannot be relied on."""
    lines = [
        "",
        "Everybody re-plans, following the motion found. Half the change does half as much, and less the opposite of",
        "more; J, efforts in percent of now; load that the person bears and share of the torque limit in points.",
    ]
    if doubted := [s for s in study.sensitivities if not s.is_reliable]:
        lines += ["", "! not so here, a trend at best:"]
        lines += [f"  {s.parameter.name} {_change(s)}: {s.doubt}" for s in doubted]
    if shorter := [s for s in study.sensitivities if s.is_reliable and s.beyond]:
        lines += ["", "Shown for a smaller change than usual, as a larger one is not in proportion:"]
        lines += [f"  {s.parameter.name} {s.parameter.change:g} {s.parameter.unit}: {s.beyond}" for s in shorter]
    if study.left_out:
        lines.append("")
    return lines + [f"{parameter.name} is left out: {why}" for parameter, why in study.left_out]


def _change(s: Sensitivity) -> str:
    return f"+{s.change:.3g} {s.parameter.unit}"
