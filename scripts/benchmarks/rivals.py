"""Others on the same problem, in the same run: CasADi's virtual machine, SNOPT, and the floor that Pinocchio sets."""

from __future__ import annotations

import importlib.util
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks import snopt
from benchmarks.beside import Beside, said
from benchmarks.case import TOLERANCE, Case, repeat
from benchmarks.goals import Row
from benchmarks.scenarios import table5_paper
from benchmarks.solves import counts, spent
from liftopt.collocation.codegen import kernel_cache
from liftopt.collocation.motion import motion_at

BATCH = 50
PAPER, PAPER_INTERVALS = ("limits.balance_tolerance=1",), 7


def virtual_machine(repeats: int) -> Row:
    """Time IPOPT on the same problem with no kernel compiled."""
    varied = table5_paper()
    with _no_compiler():
        case = Case.of(varied.scenario(), varied.ends)
        solver = case.solver("ipopt")
        timing, result = repeat(repeats, case.solve, solver)
    note = "IPOPT, kernels in CasADi's virtual machine" + ("" if case.verified(result) else f"; {result.status}")
    return Row(1e3 * timing.median, note, counts(case, solver, result), timing.plain() | spent(result))


def through_snopt(seconds: float) -> tuple[Row, ...]:
    """Time SNOPT at the paper's size from the zero guess and from our start, and on the paper's lift from our start.

    The paper has 224 unknowns and tolerates 1 N and 1 Nm in the balance; 7 intervals come nearest to it. Its 898
    nonlinear rows are not listed one by one: ours are fewer.
    """
    if importlib.util.find_spec("pydrake") is None:
        return (Row(None, "skipped: Drake is not installed; pip install drake"),) * 3
    lift = table5_paper()
    small = Case.of(lift.scenario(*PAPER), lift.ends, PAPER_INTERVALS)
    full = Case.of(lift.scenario(), lift.ends)
    return tuple(_snopt_beside_ours(case, seconds) for case in (small.from_zero(), small, full))


def _snopt_beside_ours(case: Case, seconds: float) -> Row:
    beside = Beside(case)
    run = snopt.solve(case.problem, case.start, seconds)
    ours = beside.finish()
    rows, unknowns = case.problem.constraints.linear.shape
    note = (
        f"{unknowns} unknowns, {rows} rows, tolerance {TOLERANCE:g}: "
        f"{'converged' if run.converged else 'not converged'}, {run.status}, J {run.objective:.1f}; processor "
        f"{run.cpu:.1f} s, {run.points} points, evaluation {run.evaluation:.1f} s, handing over "
        f"{run.handing_over:.1f} s. Ours: {said(ours)}"
    )
    details = {
        "evaluation_ms": 1e3 * run.evaluation,
        "handing_over_ms": 1e3 * run.handing_over,
        "cpu_median_ms": 1e3 * run.cpu,
        "without_handing_over_ms": 1e3 * (run.seconds - run.handing_over),
        "beside": ours,
    }
    counted = {"points": run.points, "objective": run.objective}
    return Row(1e3 * run.seconds if run.converged else None, note, counted if run.converged else {}, details)


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
    package = kernel_cache.PACKAGE
    with tempfile.TemporaryDirectory() as folder:
        os.environ.update(CC="", LIFTOPT_CACHE=folder)
        kernel_cache.PACKAGE = Path(folder)
        try:
            yield
        finally:
            kernel_cache.PACKAGE = package
            for name, value in kept.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value
