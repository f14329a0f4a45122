"""The accuracy of an optimum: how far it is from the lift in continuous time, by the same motion on another mesh.

The objective falls at second order in the step, J(h) = J(0) + c h**2, by the trapezoid rule and as forces are linear
between knots. With zero acceleration at both ends (eq. 19) it falls at first order: that costs a ramp over one
interval, and nothing in continuous time. The optima on two meshes of steps h and r h give, for the order p,
J(0) = J(h) - (J(r h) - J(h)) / (r**p - 1) (Richardson). On coarse meshes higher orders count as well, so the other mesh
is the finer one where it can be had (``TELLING``). The residuals between knots fall at second order (balance, torques)
and faster (closure).

Two optima can be compared only if they are the same motion. So the solver starts from one of them on the other mesh. If
it ends at another motion, there is no estimate.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.spline import FEWEST, FINEST
from liftopt.scenario.settings import Refine
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.optimum_on_mesh import FASTEST_FIRST, optimum_on_mesh
from liftopt.solution.accuracy import OTHER_MOTION, Accuracy
from liftopt.types import Progress

# Optima of one basin on several meshes are nearer to each other than this, those of others are not (docs/tuning.md).
SAME_MOTION = 0.4  # [rad, m]
# A coarser mesh than this tells little of the limit.
TELLING = 20


def estimate(cache: SolverCache, candidate: Candidate, deadline: Deadline, progress: Progress) -> Accuracy:
    """Return the accuracy of a verified candidate, from the same motion on twice or on half as many intervals.

    Args:
        cache: where solvers come from.
        candidate: solved.
        deadline: past which the objective is not estimated.
        progress: called when a solve on another mesh begins.
    """
    known, n = Accuracy.between_knots(candidate.verification), candidate.spline.intervals
    for intervals in (2 * n, n // 2):
        if FEWEST <= intervals <= FINEST and not deadline.passed:
            progress(f"estimating the error of the objective on {intervals} intervals")
            # IPOPT seldom mends what planes on another mesh ask for, and takes long.
            solvers = FASTEST_FIRST if candidate.problem.planes is None else FASTEST_FIRST[:1]
            other = optimum_on_mesh(cache, candidate, intervals, solvers, deadline, progress)
            known = compared(candidate, other) if other is not None else known
            if known.estimated:
                break
    return known


def compared(candidate: Candidate, other: Candidate) -> Accuracy:
    """Return the accuracy of a verified candidate, whose optimum on another mesh is ``other``."""
    known, apart = Accuracy.between_knots(candidate.verification), distance(candidate, other)
    known = replace(known, intervals=other.spline.intervals, apart=apart)
    here, there = candidate.result.objective, other.result.objective
    ratio = candidate.spline.intervals / other.spline.intervals
    limit = here - (there - here) / (ratio**candidate.spline.order - 1)
    if apart > SAME_MOTION or limit <= 0:
        return replace(known, remark=OTHER_MOTION.format(intervals=other.spline.intervals))
    on_finer = here if ratio > 1 else there
    return replace(
        known, objective_limit=limit, objective_error=here / limit - 1, objective_bar=abs(on_finer - limit), remark=""
    )


def distance(one: Candidate, other: Candidate) -> float:
    """Return how far two motions are apart: of what differs most, root mean square over time [rad, m]."""
    phase = np.linspace(0.0, 1.0, 4 * max(one.spline.intervals, other.spline.intervals) + 1)
    first, second = (
        candidate.spline.basis(phase) @ candidate.problem.unpack(candidate.result.x)[0] for candidate in (one, other)
    )
    return float(np.sqrt(np.mean((first - second) ** 2, axis=0)).max())


def unmet(accuracy: Accuracy, wanted: Refine) -> str:
    """Return what is not accurate enough, with its value and what is asked for, in one line; empty if all is."""
    figures = (
        ("estimated error of the objective", accuracy.objective_error, wanted.objective_error, 100.0, " %"),
        ("grasp closure between knots", accuracy.closure, wanted.closure, 1e3, " mm"),
        ("balance between knots", accuracy.balance, wanted.balance, 1.0, " N, Nm"),
        ("torque above its limit between knots", accuracy.torque_excess, wanted.torque_excess, 1.0, " Nm"),
        (
            "compression above its limit between knots",
            accuracy.compression_excess,
            wanted.compression_excess,
            1.0,
            " N",
        ),
    )
    # A NaN is not met.
    return "; ".join(
        f"{name} {'unknown' if np.isnan(value) else f'{factor * value:.2g}{unit}'} ({factor * most:g}{unit} asked)"
        for name, value, most, factor, unit in figures
        if not value <= most
    )
