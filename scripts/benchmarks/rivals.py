"""Others on the same problem, in the same run: CasADi's virtual machine, SNOPT, and the floor that Pinocchio sets."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks import snopt
from benchmarks.case import Case, repeat
from benchmarks.goals import Row
from benchmarks.scenarios import table5
from benchmarks.solves import counts, spent
from liftopt.collocation import libraries
from liftopt.collocation.motion import motion_at

BATCH = 50


def virtual_machine(repeats: int) -> Row:
    """Time IPOPT on the same problem with no kernel compiled."""
    varied = table5()
    with _no_compiler():
        case = Case.of(varied.scenario(), varied.ends)
        solver = case.solver("ipopt")
        timing, result = repeat(repeats, case.solve, solver)
    note = "IPOPT, kernels in CasADi's virtual machine" + ("" if case.verified(result) else f"; {result.status}")
    return Row(1e3 * timing.median, note, counts(case, solver, result), timing.plain() | spent(result))


def through_snopt(case: Case, seconds: float) -> Row:
    """Time SNOPT on the same problem from the same start; with what it had after ``seconds`` if it was not done."""
    try:
        run = snopt.solve(case.problem, case.start, seconds)
    except ImportError as error:
        return Row(None, f"skipped: Drake is not installed ({error}); pip install drake")
    ours = case.solve(case.solver("banded")).objective
    note = (
        f"{'converged' if run.converged else 'not converged'}, {run.status}; evaluation "
        f"{1e3 * run.evaluation:.0f} ms at {run.points} points, handing over {1e3 * run.handing_over:.0f} ms; "
        f"J {run.objective:.2f}, banded {ours:.2f}"
    )
    details = {
        "evaluation_ms": 1e3 * run.evaluation,
        "handing_over_ms": 1e3 * run.handing_over,
        "cpu_median_ms": 1e3 * run.cpu,
        "without_handing_over_ms": 1e3 * (run.seconds - run.handing_over),
    }
    return Row(1e3 * run.seconds, note, {"points": run.points, "objective": run.objective}, details)


def floor(case: Case, repeats: int) -> Row:
    """Time Pinocchio's derivatives of the inverse dynamics of every agent at all knots, and what calls cost."""
    solver = case.solver("banded")
    result = case.solve(solver)
    motion = motion_at(case.problem, case.spline, result.x, case.spline.phase)
    jobs: list[tuple[Any, Any, list[tuple[Any, ...]]]] = []
    for agent, moved in zip(case.problem.team.agents, motion.agents, strict=True):
        model = agent.reduced()
        states = zip(*(np.ascontiguousarray(x[:, moved.moving]) for x in (moved.q, moved.v, moved.a)), strict=True)
        jobs.append((model, model.createData(), list(states)))
    empty = pin.Model()
    nothing, data = np.zeros(0), empty.createData()

    def derivatives() -> None:
        for model, memory, states in jobs:
            for q, v, a in states:
                pin.computeRNEADerivatives(model, memory, q, v, a)

    def calls() -> None:
        for _, _, states in jobs:
            for _ in states:
                pin.computeRNEADerivatives(empty, data, nothing, nothing, nothing)

    all_knots, _ = repeat(BATCH * repeats, derivatives)
    overhead, _ = repeat(BATCH * repeats, calls)
    jacobian, _ = repeat(BATCH * repeats, case.problem.nlp.jac_g, case.start, case.problem.parameters)
    net = 1e3 * (all_knots.median - overhead.median)
    iteration = 1e3 * result.evaluation_seconds / max(1, result.iterations)
    note = (
        f"{len(jobs)} agents, {len(motion.time)} knots; {1e3 * overhead.median:.3f} ms of calls taken off; ours: g and "
        f"Jacobian {1e3 * jacobian.median:.3f} ms, an iteration's evaluation in banded (Hessian too) {iteration:.3f} ms"
    )
    details = {
        "cpu_median_ms": 1e3 * float(np.median(all_knots.cpu) - np.median(overhead.cpu)),
        "with_calls_ms": 1e3 * all_knots.median,
        "jacobian_ms": 1e3 * jacobian.median,
        "banded_evaluation_an_iteration_ms": iteration,
    }
    return Row(net, note, {}, details)


@contextmanager
def _no_compiler() -> Iterator[None]:
    """Let nothing be compiled, or found in the cache or the package."""
    kept = {name: os.environ.get(name) for name in ("CC", "LIFTOPT_CACHE")}
    package = libraries.PACKAGE
    with tempfile.TemporaryDirectory() as folder:
        os.environ.update(CC="", LIFTOPT_CACHE=folder)
        libraries.PACKAGE = Path(folder)
        try:
            yield
        finally:
            libraries.PACKAGE = package
            for name, value in kept.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value
