"""One optimum continued on another mesh: the solver starts from the same motion and its multipliers."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from liftopt.collocation.problem import Problem
from liftopt.collocation.separating_planes import SeparatingPlanes
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import PRUNED, STOPPED, SolverResult
from liftopt.collocation.transfer import transfer, transfer_multipliers
from liftopt.errors import SolverError
from liftopt.scenario.model import Scenario
from liftopt.search.cache import BANDED, IPOPT, SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.make_clear import pairs_in, planes_along
from liftopt.types import Array, Progress

FASTEST_FIRST = (BANDED, IPOPT)
IPOPT_ITERATIONS = 200  # from each start, where it takes over from another solver
MESH = ", N = "  # between the name of a start and the mesh its motion was taken to
WITHOUT_MULTIPLIERS = ", without multipliers on "  # likewise, for the motion alone


def optimum_on_mesh(
    cache: SolverCache,
    candidate: Candidate,
    intervals: int,
    solvers: Sequence[str],
    deadline: Deadline,
    progress: Progress,
    incumbent: SolverResult | None = None,
    on_solve: Callable[[str, SolverResult], None] | None = None,
    without_multipliers: bool = False,
) -> Candidate | None:
    """Return the optimum on another mesh that a candidate leads to; None if no solver converges in time.

    Args:
        cache: where solvers come from.
        candidate: a converged one.
        intervals: of the other mesh.
        solvers: names, the first to be tried first.
        deadline: past which solvers stop.
        progress: called when kernels must be compiled.
        incumbent: an optimum on the other mesh; where nothing lower is in sight, or the solver fails, none is left.
        on_solve: called with the name of the start and its result, an optimum or given up for the incumbent.
        without_multipliers: start from the motion alone.
    """
    spline, scenario = candidate.spline.on(intervals), candidate.scenario
    problem = cache.problem(scenario, spline, progress)
    start = transfer(candidate.problem, candidate.spline, candidate.result.x, problem, spline)
    if candidate.problem.planes is not None:
        problem = problem.apart(planes_of(cache, candidate, scenario, problem, start))
    warm = None
    if not without_multipliers:
        warm = transfer_multipliers(candidate.problem, candidate.result.multipliers, problem)
    origin, asked = candidate.start.partition(MESH)[0], scenario.solver.intervals
    origin += f"{WITHOUT_MULTIPLIERS}{intervals}" if without_multipliers else ""
    start_name = origin if intervals == asked else f"{origin}{MESH}{intervals}"
    for name in solvers:
        try:
            solver = cache.solver(problem, scenario, name, progress)
        except SolverError:  # an extension that is missing: the next one does
            continue
        most = None if name == solvers[0] else IPOPT_ITERATIONS
        result = solver.solve(start, deadline=deadline, warm=warm, problem=problem, incumbent=incumbent, most=most)
        if on_solve and (result.converged or result.status == PRUNED):
            on_solve(start_name, result)
        if result.converged:
            return Candidate(scenario, problem, spline, start_name, result, origin=candidate)
        if incumbent is not None or result.status in (STOPPED, PRUNED):
            break
    return None


def planes_of(
    cache: SolverCache, candidate: Candidate, scenario: Scenario, problem: Problem, x: Array | None = None
) -> SeparatingPlanes:
    """Return planes for the pairs that a candidate has planes for, along its motion or along ``x`` (n_x,) of a problem.

    Args:
        cache: where solids come from.
        candidate: with planes.
        scenario: of the problem.
        problem: on the same mesh, or of ``x``.
        x: the motion; None: the candidate's.
    """
    solids, planes = cache.solids(scenario, problem.team), candidate.problem.planes
    clearance = scenario.limits.clearance or 0.0
    along, like = (candidate.result.x, planes) if x is None else (x, None)
    return planes_along(solids, problem, along, pairs_in(solids, planes), clearance, like=like)
