"""Single solves of the paper's lift: cold from a given start, warm from a neighbouring optimum, on finer meshes."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.case import PATIENCE, Case, Timing, measure, repeat
from benchmarks.goals import Row
from benchmarks.scenarios import Varied, table5_paper, varied_scenarios
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import FEWEST
from liftopt.control.replanning import Replanner
from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.scenario.keys import changes_in
from liftopt.scenario.model import Scenario
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.mesh_refinement import meshes_below
from liftopt.search.optimum_on_mesh import optimum_on_mesh

MASS, HEIGHT, STATURE = 0.1, 0.02, 0.02  # share; [m]; [m]
MIXES, MIXES_SEED = 100, 3
MESHES = (10, 20, 40, 80, 160)
SCALED = 5  # lifts on all of them


def cold(name: str, case: Case, repeats: int) -> Row:
    """Time one solve from the given start."""
    solver = case.solver(name)
    timing, result = repeat(repeats, case.solve, solver)
    note = "" if case.verified(result) else f"not verified ({result.status})"
    return Row(1e3 * timing.median, note, counts(case, solver, result), timing.plain() | spent(result))


def warm_named(case: Case, repeats: int) -> Row:
    """Time IPOPT's re-solve after each of the three changes and after all of them; the slowest counts."""
    scenario = case.scenario
    changes: dict[str, tuple[str, ...]] = {
        "mass +10 %": (f"object.mass={scenario.object.mass * (1 + MASS)}",),
        "final height +2 cm": (f"task.end.height={scenario.task.end.height + HEIGHT}",),
        "subject +2 cm": (f"human.stature={scenario.first('person').stature + STATURE}",),
    }
    changes["all three"] = tuple(override for change in changes.values() for override in change)
    solver = case.solver("ipopt")
    optimum = case.solve(solver)
    details: dict[str, Any] = {}
    iterations, failed = {}, []
    for name, overrides in changes.items():
        near = _changed(case, scenario.replace(dict(changes_in(overrides))), optimum)
        timing, result = repeat(repeats, near.solve, solver, warm=optimum.multipliers, problem=near.problem)
        details[name] = timing.plain() | spent(result)
        iterations[name] = result.iterations
        if not near.verified(result):
            failed.append(f"{name} not verified ({result.status})")
    slowest = max(details, key=lambda name: float(details[name]["median_ms"]))
    note = "; ".join([f"slowest: {slowest}", *failed])
    return Row(float(details[slowest]["median_ms"]), note, {"iterations": iterations}, details)


def warm_mixes(case: Case, mixes: int) -> Row:
    """Time the banded solver's re-solve after random mixes of the three changes, each up to its full size."""
    solver = case.solver("banded")
    optimum = case.solve(solver)
    replanner = Replanner()
    replanner.solve(case.scenario.replace({"solver.name": "banded", "solver.starts": 1}))
    first = replanner.latest
    took, whole, iterations, failed = [], [], [], 0
    cpu: list[float] = []
    for scenario in _mixes(case.scenario, mixes):
        near = _changed(case, scenario, optimum)
        timing, result = repeat(1, near.solve, solver, warm=optimum.multipliers, problem=near.problem)
        took.append(1e3 * timing.median)
        cpu += timing.cpu
        iterations.append(result.iterations)
        failed += not near.verified(result)
        replanner.latest = first
        whole.append(1e3 * measure(1, replanner.replan, scenario.replace({"solver.name": "banded"}))[0].median)
    p90 = float(np.percentile(took, 90))
    in_all = float(np.percentile(whole, 90))
    note = f"{failed} of {mixes} not verified; from a changed scenario, models included: p90 {in_all:.1f} ms"
    counted = {"iterations_mean": float(np.mean(iterations)), "iterations_most": max(iterations), "failed": failed}
    details = {
        "median_ms": float(np.median(took)),
        "most_ms": max(took),
        "cpu_p90_ms": 1e3 * float(np.percentile(cpu, 90)),
        "replan_median_ms": float(np.median(whole)),
        "replan_p90_ms": in_all,
    }
    return Row(p90, note, counted, details)


def scaling(repeats: int, meshes: tuple[int, ...] = MESHES, solvers: tuple[str, ...] = ("banded", "ipopt")) -> Row:
    """Time both solvers on ever finer meshes; the banded one's time an interval should stay the same.

    Where a solve goes on its way to an optimum depends on the mesh, so several lifts are taken together. Beside a solve
    from the start on the mesh itself, the banded one is timed from a coarse mesh to ever finer ones.
    """
    lifts = (table5_paper(), *varied_scenarios()[: SCALED - 1])
    details: dict[str, Any] = {"N": list(meshes), "lifts": len(lifts)}
    for name in solvers:
        times, per, failed = [], [], []
        for intervals in meshes:
            spent_here, iterations = 0.0, 0
            for varied in lifts:
                case = Case.of(varied.scenario(), varied.ends, intervals)
                timing, result = repeat(repeats, case.solve, case.solver(name))
                spent_here += 1e3 * timing.median / len(lifts)
                iterations += result.iterations
                failed += [] if result.converged else [intervals]
            times.append(spent_here)
            per.append(iterations / len(lifts))
        details[name] = {"ms": times, "iterations": per, "not_converged": failed}
    found = details["banded"]
    found |= {"stepwise_ms": [], "stepwise_iterations": []}
    for intervals in meshes:
        steps = [_stepwise(varied, intervals, repeats) for varied in lifts]
        found["stepwise_ms"].append(float(np.mean([1e3 * timing.median for timing, _ in steps])))
        last = [candidate.result.iterations for _, candidate in steps if candidate]
        found["stepwise_iterations"].append(float(np.mean(last)))
        found["not_converged"] += [intervals] * (len(steps) - len(last))
    an_interval = np.array(found["ms"]) / np.array(meshes)
    an_iteration = an_interval / np.array(found["iterations"])
    ratio, clean = (float(values.max() / values.min()) for values in (an_interval, an_iteration))
    note = f"{', '.join(f'{t:.0f}' for t in found['ms'])} ms, mean of {len(lifts)} lifts; "
    note += f"{', '.join(f'{n:.0f}' for n in found['iterations'])} iterations; by iteration and interval "
    note += f"max / min {clean:.2f}; "
    note += f"from mesh to mesh {', '.join(f'{t:.0f}' for t in found['stepwise_ms'])} ms in all, "
    note += f"the last in {', '.join(f'{n:.0f}' for n in found['stepwise_iterations'])} iterations"
    if found["not_converged"]:
        note += f"; not converged at N = {found['not_converged']}"
    counted = {name: details[name]["iterations"] for name in solvers} | {"stepwise": found["stepwise_iterations"]}
    return Row(ratio, note, {"iterations": counted}, details)


def _stepwise(varied: Varied, intervals: int, repeats: int) -> tuple[Timing, Candidate | None]:
    """Time the banded solver from the coarsest mesh below to the one that is wanted, each from the optimum before.

    Returns:
        the times of all together, and the optimum on the last; None where one mesh has none.
    """
    coarsest, *finer = (n for n in (*meshes_below(intervals), intervals) if n >= FEWEST)
    case, cache = Case.of(varied.scenario(), varied.ends, coarsest), SolverCache()
    solver = case.solver("banded")

    def solve() -> Candidate | None:
        result = case.solve(solver)
        candidate = Candidate(case.scenario, case.problem, case.spline, "given", result) if result.converged else None
        for n in finer:
            candidate = candidate and optimum_on_mesh(cache, candidate, n, ("banded",), Deadline.after(PATIENCE), print)
        return candidate

    return repeat(repeats, solve)


def counts(case: Case, solver: Any, result: SolverResult) -> dict[str, Any]:
    """Return what a solve took that depends on no machine."""
    found: dict[str, Any] = {
        "iterations": result.iterations,
        "objective": result.objective,
        "unknowns": case.problem.layout.n_x,
        "rows": case.problem.constraints.linear.shape[0],
        "jacobian_nonzeros": case.problem.nlp.jac_g.nnz_out(1),
        "hessian_nonzeros": case.problem.nlp.hess_lag.nnz_out(0),
    }
    details = getattr(solver, "details", {})
    found |= {key: details[key] for key in ("factorisations", "refinements", "evaluations") if key in details}
    if hasattr(solver, "multiplications"):
        found["multiplications_a_factorisation"] = solver.multiplications
    return found


def spent(result: SolverResult) -> dict[str, float]:
    """Return where a solve's time went, as the solver has it [ms]."""
    return {"solver_ms": 1e3 * result.seconds, "evaluation_ms": 1e3 * result.evaluation_seconds}


def _changed(case: Case, scenario: Scenario, optimum: SolverResult) -> Case:
    """Return the case of a changed scenario, to be solved from an optimum."""
    team = Team.of(agents_of(scenario), object_of(scenario))
    return Case(scenario, case.spline, Problem(team, task_of(scenario), case.problem.mesh), optimum.x)


def _mixes(scenario: Scenario, count: int) -> list[Scenario]:
    """Return scenarios with all three changed at random, either way, each by at most its full size."""
    rng = np.random.default_rng(MIXES_SEED)
    found = []
    for share in rng.uniform(-1.0, 1.0, (count, 3)):
        overrides = (
            f"object.mass={scenario.object.mass * (1 + MASS * share[0]):.4f}",
            f"task.end.height={scenario.task.end.height + HEIGHT * share[1]:.4f}",
            f"human.stature={scenario.first('person').stature + STATURE * share[2]:.4f}",
        )
        found.append(scenario.replace(dict(changes_in(overrides))))
    return found
