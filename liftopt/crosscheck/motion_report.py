"""The truth about one result: MuJoCo's inverse and forward dynamics and the energy, against stated bounds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from io import StringIO

import numpy as np
from rich.console import Console
from rich.table import Table

from liftopt.crosscheck.energy import energy_books, turned_in_hands, unexplained
from liftopt.crosscheck.mujoco_dynamics import inverse_dynamics
from liftopt.crosscheck.mujoco_forward import BANDWIDTH, WINDOW, Deviation, Simulation
from liftopt.crosscheck.transcriptions import mesh_study
from liftopt.crosscheck.transcriptions import render as render_study
from liftopt.errors import InputError
from liftopt.multibody.joint_units import SLIDES, TURNS
from liftopt.multibody.trajectory import grasps_of
from liftopt.solution.checks import Check
from liftopt.solution.solution import Solution
from liftopt.types import Progress

INVERSE_DYNAMICS = 1e-6  # relative
# A simulation keeps the grasps together at all times, a solution at its knots: bounds are for closure to 1 mm between.
JOINT, POSITION, TURN = 0.02, 2e-3, 0.02  # [rad; m of a joint that slides], [m], [rad]
GRASP_FORCE = 0.1  # of the largest
FEEDBACK = 0.1  # of a joint's torque limit
BOOKS, PANELS = 1e-6, 8  # relative, panels of Simpson's rule between two knots
UNEXPLAINED = 1e-2  # of the largest change of energy


def motion_report(solution: Solution, progress: Progress | None = None) -> tuple[Check, ...]:
    """Return all checks of a solution.

    Args:
        solution: a solved lift.
        progress: called with one line at each stage.

    Raises:
        InputError: MuJoCo is not installed.
    """
    progress = progress or (lambda line: None)
    progress("inverse dynamics in MuJoCo")
    checks = list(_inverse(solution))
    progress("forward simulation in MuJoCo")
    checks += _forward(solution)
    progress("energy")
    return (*checks, *_energy(solution))


def result_report(solution: Solution, transcription: bool, progress: Progress | None = None) -> tuple[str, bool]:
    """Return the report on a solution as text, and whether all of it passed.

    Args:
        solution: a solved lift.
        transcription: whether to solve it again by two transcriptions on five meshes, which takes minutes.
        progress: called with one line at each stage.

    Raises:
        InputError: the solution is not solved, or MuJoCo is not installed.
        SolverError: IPOPT cannot run.
    """
    if not solution.solved:
        raise InputError("RESULT", solution.status, "must be a solved and verified lift")
    checks = motion_report(solution, progress)
    text, passed = render(checks), all(check.passed for check in checks)
    if transcription:
        study = mesh_study(solution, progress=progress)
        text, passed = f"{text}\n\n{render_study(study)}", passed and study.approaching
        if solution.scenario.limits.clearance is not None:
            text += "\nBoth leave clearance out: what it costs is in neither."
    return text, passed


def _inverse(solution: Solution) -> Iterator[Check]:
    for found in inverse_dynamics(solution):
        yield Check(f"MuJoCo inverse dynamics, {found.name}", found.relative, INVERSE_DYNAMICS, "relative", found.worst)


def _forward(solution: Solution) -> Iterator[Check]:
    simulation, name = Simulation(solution), solution.object.name
    windows, whole = simulation.windows(), simulation.follow()
    units = [unit for agent in solution.agents for unit in agent.units]
    unit = " or ".join(dict.fromkeys(each.q for each in units))
    where = f"{windows.count} windows of {1e3 * WINDOW:g} ms"
    yield from _deviation(f"MuJoCo open loop, {name}", windows.deviation, where, unit)
    yield Check("MuJoCo open loop, grasp forces", windows.force, GRASP_FORCE, "of the largest", where)
    if not any(grasp.moments for *_, grasp in grasps_of(solution.agents)):
        unserved, turn = f"{name} turned, unserved moment left out", simulation.windows(serve=False).deviation.turn
        yield Check(f"MuJoCo open loop, {unserved}", turn, np.inf, "rad", where)
    yield from _deviation(f"MuJoCo with feedback, {name}", whole.deviation, f"whole lift, {BANDWIDTH:g} rad/s", unit)
    worst = int(np.argmax(whole.share))
    share = float(whole.share[worst]) if np.isfinite(whole.deviation.joint) else np.inf
    most = f"{whole.joints[worst]}, {whole.torque[worst]:.3f} {units[worst].tau}; at most " + ", ".join(
        f"{whole.torque[[each is one for each in units]].max():.3f} {one.tau} in any joint{kind}"
        for one, kind in ((TURNS, ""), (SLIDES, " that slides")) if one in units
    )  # fmt: skip
    yield Check("MuJoCo with feedback, torque added", share, FEEDBACK, "of its limit", most)
    yield Check(f"MuJoCo with feedback, moment added on the {name}", whole.moment, np.inf, "Nm", simulation.about)


def _deviation(what: str, deviation: Deviation, where: str, unit: str) -> Iterator[Check]:
    stem, name = what.rsplit(", ", 1)
    yield Check(f"{stem}, joints", deviation.joint, JOINT, unit, where)
    yield Check(f"{stem}, {name} displaced", deviation.position, POSITION, "m", where)
    yield Check(f"{stem}, {name} turned", deviation.turn, TURN, "rad", where)


def _energy(solution: Solution) -> Iterator[Check]:
    coarse, books = energy_books(solution, PANELS // 2), energy_books(solution, PANELS)
    for before, now in zip(coarse, books, strict=True):
        order = f"1/{before.error / now.error:.1f} of that on half the panels" if now.error > 0.0 else ""
        yield Check(f"energy, work of torques and forces, {now.name}", now.relative, BOOKS, "relative", order)
    if any(grasp.moments for *_, grasp in grasps_of(solution.agents)):
        share = turned_in_hands(books)
        yield Check(
            "energy, moments on hands that turn", share, np.inf, "relative", "within their limits on the object"
        )
    where = "balance and closure between the knots"
    yield Check("energy, left by the transcription", unexplained(books), UNEXPLAINED, "relative", where)


def render(checks: Sequence[Check]) -> str:
    """Return the checks as a plain text table and a verdict."""
    table = Table(box=None, pad_edge=False)
    table.add_column("check", no_wrap=True)
    for heading in ("worst", "allowed"):
        table.add_column(heading, no_wrap=True, justify="right")
    for heading in ("unit", "", "where"):
        table.add_column(heading, no_wrap=True)
    for check in checks:
        bounded = np.isfinite(check.limit)
        verdict = "" if not bounded else "ok" if check.passed else "FAIL"
        allowed = f"{check.limit:.1e}" if bounded else "-"
        table.add_row(check.name, f"{check.value:.1e}", allowed, check.unit, verdict, check.where)
    text = StringIO()
    console = Console(file=text, width=200, color_system=None, force_terminal=False, markup=False, highlight=False)
    console.print(table)
    failed = sum(not check.passed for check in checks)
    console.print("The solved motion holds." if failed == 0 else f"Checks that FAILED: {failed}.")
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines())
