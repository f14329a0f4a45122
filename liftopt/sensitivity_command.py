"""``liftopt sensitivity``: what a lift depends on, as a table, JSON or a plot."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftopt.errors import InputError, LiftoptError
from liftopt.scenario import Scenario, load_scenario, scenario_to_dict, with_overrides
from liftopt.viz import FORMATS
from liftopt.whole_file import write_whole

if TYPE_CHECKING:
    from liftopt.plan import Plan
    from liftopt.sensitivity import Sensitivity, Study
    from liftopt.workshop import Workshop

SHARP = 1e-8  # KKT error to which the optimum is polished before it is differentiated


def add_sensitivity_parser(commands: Any, run: Callable[[argparse.Namespace], int]) -> None:
    """Add the command to the subparsers ``commands``; ``run`` carries it out."""
    parser = commands.add_parser(
        "sensitivity",
        help="what effort, peak torques and load share depend on",
        description="Solve a scenario, or that of a result anew, and differentiate its optimum by stature, masses, "
        "heights, distances and duration; everybody re-plans as they change.",
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
    parser.add_argument("--json", action="store_true", help="print all derivatives as one JSON object")
    parser.add_argument("--plot", metavar="FILE", help="write a figure: .svg, .png or .pdf")
    parser.set_defaults(run=run)


def sensitivity(args: argparse.Namespace, say: Callable[[str], None] | None = None) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: the scenario or an option is wrong, or the plot cannot be written.
        LiftoptError: the scenario has no verified solution.
    """
    plot = None if args.plot is None else Path(args.plot)
    if plot is not None and plot.suffix[1:] not in FORMATS:
        raise InputError("--plot", args.plot, "must end in .svg, .png or .pdf")
    scenario = load_scenario(args.scenario, args.overrides)
    from liftopt.sensitivity import study

    plan, workshop = _sharp_plan(scenario, say)
    found = study(plan, workshop, say=say)
    if plot is not None:
        _write_plot(found, plot)
    if args.json:
        return json.dumps(study_dict(found), allow_nan=False) + "\n"
    return _table(found) + ("" if plot is None else f"Written to {plot}\n")


def study_dict(study: Study) -> dict[str, Any]:
    """Return a study ready for JSON: slopes in the figures' units over the parameter's, infinite reaches as None."""
    return {
        "scenario": scenario_to_dict(study.plan.scenario),
        "figures": study.figures,
        "parameters": [
            {
                "name": s.parameter.name,
                "keys": list(s.parameter.keys),
                "unit": s.parameter.unit,
                "value": s.value,
                "change": s.parameter.change,
                "slopes": s.slopes,
                "objective_by_envelope": s.envelope,
                "slopes_hold_to": s.reach if math.isfinite(s.reach) else None,
                "limit_there": s.limit,
            }
            for s in study.sensitivities
        ],
        "left_out": [{"name": parameter.name, "why": why} for parameter, why in study.left_out],
    }


def _sharp_plan(scenario: Scenario, say: Callable[[str], None] | None) -> tuple[Plan, Workshop]:
    """Return the best plan, polished as far as the solver goes, and the workshop it comes from."""
    from liftopt.replan import Replanner
    from liftopt.workshop import Workshop

    workshop = Workshop()
    replanner = Replanner(say, workshop)
    solution = replanner.solve(scenario)
    plan = replanner.latest
    if plan is None:
        raise LiftoptError(f"no verified solution to differentiate: {solution.status}")
    sharp = min(SHARP, scenario.solver.tolerance)
    polished = replanner.replan(with_overrides(scenario, [f"solver.tolerance={sharp!r}"]))
    return (plan if polished is None or not polished.solved else polished), workshop


def _write_plot(study: Study, path: Path) -> None:
    from matplotlib import rc_context

    from liftopt.viz.plots import rendered
    from liftopt.viz.plots_sensitivity import sensitivity_figure
    from liftopt.viz.plots_style import STYLE

    with rc_context(STYLE):
        figure = sensitivity_figure(study)
    write_whole("--plot", path, rendered(figure, path.suffix[1:]))


def _table(study: Study) -> str:
    human, robot = study.plan.problem.team.agents
    busiest = [_busiest(study, i) for i in range(2)]
    now = study.figures
    joints = [name.partition("_")[2] for name in busiest]
    lines = [
        f"{study.plan.scenario.name}: J = {now['objective']:.5g}, effort of the person "
        f"{now[f'effort {human.name}']:.4g}, of the robot {now[f'effort {robot.name}']:.4g} N2 m2 s,",
        f"peaks {busiest[0]} {now[f'peak {busiest[0]}']:.2f} Nm and {busiest[1]} {now[f'peak {busiest[1]}']:.2f} Nm, "
        f"the nearest to their limits; the person bears {100 * now[f'share {human.name}']:.1f} %.",
        "",
        f"{'':17} {'':>11} {'J':>7} {'J':>7} {'person':>7} {'robot':>7} {joints[0]:>6} {joints[1]:>6} {'load':>6}",
        f"{'what a change of':17} {'does':>11} {'% /+1%':>7} {'%':>7} {'%':>7} {'%':>7} {'Nm':>6} {'Nm':>6} {'%':>6}",
    ]
    for s in sorted(study.sensitivities, key=lambda s: -abs(s.slopes["objective"] * s.parameter.change)):
        change = s.parameter.change
        shown = f"+{change:g} {s.parameter.unit}"
        relative = {name: 100 * s.slopes[name] / now[name] for name in now}
        efforts = [change * relative[f"effort {agent.name}"] for agent in (human, robot)]
        peaks = [change * s.slopes[f"peak {name}"] for name in busiest]
        lines.append(
            f"{s.parameter.name:17} {shown:>9}{'' if s.holds else ' !':2} "
            f"{relative['objective'] * s.value / 100:+7.2f} {change * relative['objective']:+7.2f} "
            f"{efforts[0]:+7.2f} {efforts[1]:+7.2f} {peaks[0]:+6.2f} {peaks[1]:+6.2f} "
            f"{100 * change * s.slopes[f'share {human.name}']:+6.2f}"
        )
    return "\n".join([*lines, *_remarks(study)]) + "\n"


def _remarks(study: Study) -> list[str]:
    lines = []
    near = [s for s in study.sensitivities if not s.holds]
    if near:
        lines += [
            "",
            "! to first order only: within the change a limit becomes active or ceases to be. The slope of J does not",
            "jump there; those of its parts, of torques and of the load do:",
        ]
        lines += [f"  {s.parameter.name} at {_reach(s)}: {s.limit}" for s in near]
    return lines + [f"{parameter.name} is left out: {why}" for parameter, why in study.left_out]


def _reach(s: Sensitivity) -> str:
    return f"{s.reach:.2g} {s.parameter.unit}"


def _busiest(study: Study, i: int) -> str:
    """Return the joint of an agent whose peak is nearest to its limit."""
    agent = study.plan.problem.team.agents[i]
    limits = zip(agent.moving_joints, agent.limits.effort, strict=True)
    shares = {name: study.figures[f"peak {name}"] / limit for name, limit in limits}
    return max(shares, key=lambda name: shares[name])
