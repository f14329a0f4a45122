"""Many starts of one problem, one after the other or several at a time, and starts that their results suggest."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.parallel_map import parallel_map
from liftopt.collocation.solvers.result import Solver, SolverResult
from liftopt.search.initial_guess import InitialGuess, recombined, turned_back
from liftopt.search.postures import rounded


def solve_all(
    solvers: Sequence[Solver],
    starts: Sequence[InitialGuess],
    deadline: Deadline,
    problem: Problem | None = None,
    margin: float = 1.0,
    most: int | None = None,
) -> Iterator[SolverResult]:
    """Solve from every start; yield the results in the order of the starts, whatever the number of solvers.

    The first start should be the most promising one. Its result is the incumbent of the others: they may be given up
    for it. The best result so far would depend on how many solve at a time. A start that joins no known moves, the
    naive one, has no incumbent: it is far from feasible for long, and its objective tells nothing.

    Args:
        solvers: one for each thread; with several they must let go of Python's lock at work.
        starts: where to start.
        deadline: past which solvers stop.
        problem: what is solved; None: what each solver was built for.
        margin: how many times the incumbent's objective is still of interest.
        most: iterations of each; None: as many as its solver takes.

    Raises:
        SolverError: a solver cannot run at all.
    """
    first, *others = starts
    (leader,) = solve_each(solvers[:1], [(first, None)], deadline, problem, most)
    yield leader
    incumbent = replace(leader, objective=margin * leader.objective)
    to_beat = [(start, incumbent if start.moves else None) for start in others]
    yield from solve_each(solvers, to_beat, deadline, problem, most)


def solve_each(
    solvers: Sequence[Solver],
    starts: Sequence[tuple[InitialGuess, SolverResult | None]],
    deadline: Deadline,
    problem: Problem | None = None,
    most: int | None = None,
) -> Iterator[SolverResult]:
    """Solve from every start, each with its own incumbent, if any; yield the results in their order.

    Args:
        solvers: one for each thread, as for ``solve_all``.
        starts: where to start, and the result that is to be beaten.
        deadline: past which solvers stop.
        problem: what is solved; None: what each solver was built for.
        most: iterations of each; None: as many as its solver takes.

    Raises:
        SolverError: a solver cannot run at all.
    """

    def job(start: InitialGuess, incumbent: SolverResult | None) -> Callable[[Solver], SolverResult]:
        def solve(solver: Solver) -> SolverResult:
            return solver.solve(rounded(start.x), deadline=deadline, problem=problem, incumbent=incumbent, most=most)

        return solve

    return parallel_map(solvers, [job(*start) for start in starts])


def follow_up(
    solver: Solver,
    starts: Sequence[InitialGuess],
    results: Sequence[SolverResult],
    deadline: Deadline,
    problem: Problem,
) -> Iterator[tuple[InitialGuess, SolverResult]]:
    """Solve from starts that the results of others suggest; yield each with its result.

    First from the best moves of all agents together, then from the best optimum with those joints turned back that
    press against a limit. The best optimum so far is the incumbent.

    Args:
        solver: for the problem.
        starts: what was solved from.
        results: where each of them led.
        deadline: past which solvers stop.
        problem: what is solved.
    """

    def together(best: SolverResult) -> InitialGuess | None:
        return recombined(problem, starts, results)

    def back(best: SolverResult) -> InitialGuess | None:
        return turned_back(problem, best.x)

    optima = [result for result in results if result.converged]
    for make in (together, back):
        if not optima:
            return
        best = min(optima, key=lambda result: result.objective)
        if (start := make(best)) is not None:
            result = solver.solve(rounded(start.x), deadline=deadline, problem=problem, incumbent=best)
            optima += [result] if result.converged else []
            yield start, result
