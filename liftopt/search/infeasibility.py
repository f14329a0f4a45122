"""Why there is no solution, in words: what the best motion would break, ranked, by name, amount and time."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from liftopt.collocation.elastic_mode import Elastic, Violation, elastic
from liftopt.collocation.problem import Problem
from liftopt.solution.infeasibility_report import Obstacle

Array = npt.NDArray[np.float64]
MOST = 5  # reasons that are told
# Starts, and iterations of IPOPT for all of them: what converges takes fewer than so many in all.
TRIES, ITERATIONS = 3, 300


@dataclass(frozen=True)
class Finding:
    """The motion that breaks least.

    Attributes:
        x: (n_x,) its unknowns.
        reasons: what it breaks, the costliest first; empty if it breaks nothing, so that there is a lift near it.
        sure: it is a local optimum: no motion near it breaks less.
    """

    x: Array
    reasons: tuple[Obstacle, ...]
    sure: bool


def find(problem: Problem, starts: Sequence[Array], deadline: float) -> Finding | None:
    """Return the motion that breaks least, of those found from ``starts``; None if there was no time.

    Raises:
        SolverError: IPOPT cannot run.
    """
    found: list[Elastic] = []
    left = ITERATIONS
    for x in starts[:TRIES]:
        if time.monotonic() > deadline:
            break
        found.append(elastic(problem, x, deadline, left))
        left -= found[-1].iterations
        if found[-1].possible or left <= 0:
            break
    if not found:
        return None
    best = min(found, key=lambda motion: (not motion.converged, sum(v.price for v in motion.violations)))
    return Finding(best.x, tuple(_named(problem, v) for v in best.violations[:MOST]), best.converged)


def _named(problem: Problem, violation: Violation) -> Obstacle:
    """Return a violation as an obstacle, in words."""
    who, amount, at = violation.who, violation.amount, f"at {violation.time:.2f} s"
    share, held = f"{100 * violation.share:.0f} %", problem.team.object.name
    words = {
        "closure": f"the {who}'s grasp stays {amount:.3f} m off the {held} {at}",
        "keep_in": f"the {who}'s grasp lies {amount:.3f} m outside its half-space {at}",
        "torque": f"{who} needs {amount:.3g} Nm ({share}) more than its torque limit {at}",
        "grasp_force": f"the {who}'s grasp needs {amount:.3g} N ({share}) more than its cap {at}",
        "grasp_moment": f"the {who}'s grasp needs {amount:.3g} Nm ({share}) more than its cap {at}",
        "grasp_turn": f"the {who}'s hand turns {amount:.0f} deg farther on the {held} than it may {at}",
        "friction": f"flat hand: {who} it slides or lifts, {amount:.3g} N short of its friction {at}",
        "pressure": f"flat hand: {who} it tips or turns, {amount:.3g} Nm beyond its breadth {at}",
        "velocity": f"{who} has to be {amount:.2g} {violation.unit} ({share}) faster than its speed limit {at}",
    }
    beyond = 0.0 if violation.unit == "m" else violation.share
    text = words[violation.constraint]
    return Obstacle(violation.constraint, who, amount, violation.unit, text, violation.time, share=beyond)
