"""What is to be said of the solve itself: whether it is a solution, how exact it is, and what it was like to find."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, isfinite

from liftopt.solution.checks import BETWEEN_KNOTS
from liftopt.solution.finding import CAUTION, ERROR, INFO, MATHEMATICS, VERDICT, Finding
from liftopt.solution.infeasibility_report import SuggestedChange
from liftopt.solution.solution import CUT_SHORT, Solution

LARGE_ERROR = 0.05  # of the objective; more is a caution
EXCEEDED = 1e-3  # excess between knots worth a word, in its unit
SPREAD = 0.01  # relative difference of two optima worth a word
# The findings on person and robot tell of these.
OF_AGENTS = ("torque limits", "speed limits", "position limits", "grasp force cap")


def verdict(solution: Solution) -> Finding:
    """Return whether it is a solution."""
    if not solution.solved:
        return Finding(f"{VERDICT}.{MATHEMATICS}", ERROR, "not solved", f"Not solved: {solution.status}.")
    text = "Solved and verified: the motion meets every requirement at the knots, and no motion near it takes less."
    return Finding(f"{VERDICT}.{MATHEMATICS}", INFO, "solved and verified", text)


def failure_findings(solution: Solution) -> Iterator[Finding]:
    """Give what is in the way of a solution, and what would give one."""
    for reason in solution.reasons:
        title = f"in the way: {reason.who}"
        yield Finding(f"{MATHEMATICS}.in_the_way", ERROR, title, _sentence(reason.message), time=reason.time)
    for change in solution.suggested_changes:
        settings = setting(change)
        text = f"With {settings} it was solved and verified: {change.message}."
        yield Finding(f"{MATHEMATICS}.suggested_change", INFO, f"possible with {settings}", text)
    yield from _notes(solution)


def mathematics_findings(solution: Solution) -> Iterator[Finding]:
    """Give how exact a solution is, and what the user should know of how it was found."""
    yield from _mesh(solution)
    yield from _accuracy(solution)
    yield from _between(solution)
    yield from _starts(solution)
    yield from _notes(solution)


def setting(change: SuggestedChange) -> str:
    """Return a suggested change as keys of the scenario with their values, ``"task.standing_distance = 1.80"``."""
    return ", ".join(f"{key} = {value:.2f}" for key, value in zip(change.keys, change.values, strict=True))


def _mesh(solution: Solution) -> Iterator[Finding]:
    asked, n = solution.scenario.solver.intervals, solution.intervals
    if n != asked:
        text = f"Solved on {n} intervals, not the {asked} asked for: the coarser mesh was not exact enough."
        yield Finding(f"{MATHEMATICS}.mesh", INFO, f"mesh refined from N = {asked} to {n}", text)


def _accuracy(solution: Solution) -> Iterator[Finding]:
    accuracy, code = solution.accuracy, f"{MATHEMATICS}.objective_error"
    if accuracy is None:
        return
    if not accuracy.estimated:
        text = f"How far the objective is from that on ever finer meshes is not known: {accuracy.remark}."
        yield Finding(code, CAUTION, "the objective's error is not known", text)
        return
    error, bar = float(accuracy.objective_error), float(accuracy.objective_bar)
    bounds = f" +- {bar:.2g}" if isfinite(bar) else ""
    yield Finding(
        code,
        CAUTION if error > LARGE_ERROR else INFO,
        f"objective {solution.objective:.4g}, {100 * error:.1f} % above its limit of {accuracy.objective_limit:.4g}"
        f"{bounds} on ever finer meshes",
        f"The objective of {solution.objective:.4g} on {solution.intervals} intervals is {100 * error:.1f} % above "
        f"what ever finer meshes tend to, {accuracy.objective_limit:.4g}{bounds}. The "
        "option --refine solves on finer ones.",
        value=float(solution.objective),
        limit=float(accuracy.objective_limit),
        source=f"Richardson extrapolation from {solution.intervals} and {accuracy.intervals} intervals",
    )


def _between(solution: Solution) -> Iterator[Finding]:
    agents = tuple(agent.name for agent in solution.agents)
    for check in solution.verification.checks:
        what = check.name.removesuffix(BETWEEN_KNOTS)
        reported = check.name != what and check.limit == inf and what != "balance"
        if not reported or not EXCEEDED < check.value < inf or (what in OF_AGENTS and check.where.startswith(agents)):
            continue
        yield Finding(
            f"{MATHEMATICS}.between_knots",
            CAUTION,
            f"{what} exceeded between knots by {check.value:.2g} {check.unit}",
            f"{what.capitalize()} exceeded between knots by {check.value:.2g} {check.unit} ({check.where}). Limits "
            "hold at the knots; more solver.intervals bring them closer.",
            value=float(check.value),
            unit=check.unit,
        )


def _starts(solution: Solution) -> Iterator[Finding]:
    ends = [start.objective for start in solution.starts if start.status == "converged"]
    if len(ends) > 1 and max(ends) > (1 + SPREAD) * min(ends):
        text = f"{len(ends)} starts ended between {min(ends):.4g} and {max(ends):.4g}; the best is shown."
        yield Finding(f"{MATHEMATICS}.local_optima", INFO, "more than one local optimum", text)


def _notes(solution: Solution) -> Iterator[Finding]:
    for note in solution.notes:
        if CUT_SHORT in note:
            yield Finding(f"{MATHEMATICS}.time_limit", CAUTION, f"time {CUT_SHORT}", _sentence(note))
        else:
            yield Finding(f"{MATHEMATICS}.note", INFO, "from the solver", _sentence(note))


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:].rstrip('.')}."
