"""Why there is no solution, in words: what the best motion would break, ranked, by name, amount and time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from liftopt.assessment.who import whose_hold
from liftopt.collocation.elastic_mode import ElasticMotion, Violation, solve_elastic
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.multibody.joint_units import SLIDES
from liftopt.scenario.model import Scenario
from liftopt.search.candidate import Candidate
from liftopt.search.feasibility_screen import screen_ends, too_fast
from liftopt.search.initial_guess import InitialGuess, blend
from liftopt.search.postures import PostureSolver
from liftopt.solution.infeasibility_report import InfeasibilityReason
from liftopt.types import Array

MOST_REASONS = 5
# Starts, and iterations of IPOPT for all of them: what converges takes fewer than so many in all.
TRIES, ITERATIONS = 3, 300


@dataclass(frozen=True)
class LeastViolation:
    """The motion that breaks least.

    Attributes:
        x: (n_x,) its unknowns.
        reasons: what it breaks, the costliest first; empty if it breaks nothing, so that there is a lift near it.
        sure: it is a local optimum: no motion near it breaks less.
        price: of all that it breaks, to compare by.
    """

    x: Array
    reasons: tuple[InfeasibilityReason, ...]
    sure: bool
    price: float


def find_least_violation(problem: Problem, starts: Sequence[Array], deadline: Deadline) -> LeastViolation | None:
    """Return the motion that breaks least, of those found from ``starts``; None if there was no time.

    Raises:
        SolverError: IPOPT cannot run.
    """
    found: list[ElasticMotion] = []
    left = ITERATIONS
    for x in starts[:TRIES]:
        if deadline.passed:
            break
        found.append(solve_elastic(problem, x, deadline, left))
        left -= found[-1].iterations
        if found[-1].possible or left <= 0:
            break
    if not found:
        return None
    best = min(found, key=lambda motion: (not motion.converged, sum(v.price for v in motion.violations)))
    reasons = tuple(_in_words(problem, violation) for violation in best.violations[:MOST_REASONS])
    return LeastViolation(best.x, reasons, best.converged, sum(v.price for v in best.violations))


def nearest_motion(
    problem: Problem, seed: int, deadline: Deadline, postures: PostureSolver
) -> tuple[InitialGuess, tuple[InfeasibilityReason, ...]]:
    """Return the motion between the nearest postures that can be had at the ends, and what is in the way.

    Args:
        problem: the lift.
        seed: of the random seeds.
        deadline: past which no more is tried.
        postures: solver of static postures of its team.
    """
    reasons, (first, last) = screen_ends(problem, seed, deadline, postures)
    if reason := too_fast(problem):
        reasons.append(reason)
    return InitialGuess("nearest postures", blend(problem, first, last)), tuple(reasons)


def infeasible_candidate(
    scenario: Scenario,
    problem: Problem,
    spline: RestToRestSpline,
    start: InitialGuess,
    reasons: Sequence[InfeasibilityReason],
) -> Candidate:
    """Return a motion that no solver improved, with why it is no solution."""
    nothing = Multipliers(np.zeros(problem.layout.n_x), np.zeros(problem.constraints.linear.shape[0]))
    result = SolverResult(start.x, nothing, np.nan, 0, False, "infeasible", 0.0, 0.0)
    why = "; ".join(dict.fromkeys(reason.message for reason in reasons))
    return Candidate(scenario, problem, spline, start.name, result, why)


def _in_words(problem: Problem, violation: Violation) -> InfeasibilityReason:
    """Return a violation as a reason, in words."""
    who, amount, at = violation.who, violation.amount, f"at {violation.time:.2f} s"
    share, lifted = f"{100 * violation.share:.0f} %", problem.team.object.name
    grasps = {grasp.name for grasp in problem.team.grasps}
    whose = whose_hold(who, problem.team.agents) if who in grasps else ""
    words = {
        "grasp_closure": f"{whose} grasp stays {amount:.3f} m off the {lifted} {at}",
        "clearance": f"{who} come {amount:.3f} m too near each other {at}",
        "workspace": f"{whose} grasp lies {amount:.3f} m outside its half-space {at}",
        "torque": f"{who} needs {amount:.3g} {violation.unit} ({share}) more than its "
        f"{'force' if violation.unit == SLIDES.tau else 'torque'} limit {at}",
        "grasp_force": f"{whose} grasp needs {amount:.3g} N ({share}) more than its cap {at}",
        "grasp_moment": f"{whose} grasp needs {amount:.3g} Nm ({share}) more than its cap {at}",
        "grasp_turn": f"{whose} hand turns {amount:.0f} deg farther on the {lifted} than it may {at}",
        "friction": f"flat hand: {who} it slides or lifts, {amount:.3g} N short of its friction {at}",
        "pressure": f"flat hand: {who} it tips or turns, {amount:.3g} Nm beyond its breadth {at}",
        "sole_friction": f"the feet of {who} slip, {amount:.3g} N beyond their friction on the floor {at}",
        "sole_pressure": f"{who}, {amount:.3f} m beyond the soles {at}: the feet leave the floor",
        "lean": f"{who} leans {amount:.0f} deg farther than it may {at}",
        "compression": f"the lumbar spine of {who} is pressed with {amount:.3g} N ({share}) more than its limit {at}",
        "velocity": f"{who} has to be {amount:.2g} {violation.unit} ({share}) faster than its speed limit {at}",
    }
    beyond = 0.0 if violation.unit == "m" else violation.share
    text = words[violation.constraint]
    return InfeasibilityReason(violation.constraint, who, amount, violation.unit, text, violation.time, share=beyond)
