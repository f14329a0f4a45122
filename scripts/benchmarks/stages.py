"""Where the time goes: each stage of a lift, each function of a solve, each module's import."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from benchmarks.case import PATIENCE, TOLERANCE, Case, measure, repeat
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import SolverResult
from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.search.initial_guess import posture_starts
from liftopt.search.solve import solve
from liftopt.solution.verify import verify
from liftopt.storage import writer as result_writer

MODULES = (
    "numpy",
    "scipy.sparse",
    "casadi",
    "pinocchio",
    "liftopt.commands.cli",
    "liftopt.search.solve",
    "liftopt.storage.writer",
)
SLOW = 3  # repeats of what takes long
SOLVERS = ("ipopt", "banded")


def profile(case: Case, repeats: int) -> dict[str, dict[str, float]]:
    """Return milliseconds by stage, for the whole and for each solver."""
    found = {"import, fresh process": _imports(), "a lift": _stages(case, repeats)}
    found["one call of a function of the problem"] = _functions(case, repeats)
    for name in SOLVERS:
        solver = case.solver(name)
        case.solve(solver)
        began = time.perf_counter()
        result = case.solve(solver)
        found[f"one solve, {name}"] = _solve(result, 1e3 * (time.perf_counter() - began), solver)
    return found


def _stages(case: Case, repeats: int) -> dict[str, float]:
    scenario, spline = case.scenario, case.spline

    def fresh() -> Problem:
        return Problem(team, task_of(scenario), spline.mesh())

    models, (agents, lifted) = repeat(repeats, lambda: (agents_of(scenario), object_of(scenario)))
    kernels, team = repeat(repeats, Team.of, agents, lifted)
    programme, _ = repeat(repeats, lambda: fresh().nlp)
    rows, _ = repeat(repeats, lambda: fresh().constraints)
    starts, _ = measure(min(SLOW, repeats), posture_starts, case.problem, 3, 0, Deadline.after(SLOW * PATIENCE))
    found = {
        "models of the agents and the object": models.median,
        "kernels, from the cache": kernels.median,
        "problem assembled (rows and functions)": programme.median,
        "of which rows": rows.median,
        "search for 3 starts": starts.median,
    }
    for name in SOLVERS:
        setup, solver = repeat(repeats, case.solver, name)
        first, result = measure(1, case.solve, solver)
        found[f"{name} set up"], found[f"{name}, its first solve"] = setup.median, first.median
    checked, _ = repeat(repeats, verify, case.problem, spline, result, TOLERANCE)
    found["verification"] = checked.median
    solution = solve(case.scenario)
    with tempfile.TemporaryDirectory() as folder:
        written, _ = repeat(repeats, result_writer.save, solution, Path(folder) / "result")
    found["files written"] = written.median
    return {name: 1e3 * seconds for name, seconds in found.items()}


def _functions(case: Case, repeats: int) -> dict[str, float]:
    """Return the time of each function of the problem as IPOPT calls it."""
    nlp, p = case.problem.nlp, case.problem.parameters
    multipliers = np.ones(case.problem.constraints.linear.shape[0])
    values = {"f": ca.Function("f", [nlp.x, nlp.p], [nlp.f]), "g": ca.Function("g", [nlp.x, nlp.p], [nlp.g])}
    calls = {
        **{name: (function, (case.start, p)) for name, function in values.items()},
        "f and gradient": (nlp.grad_f, (case.start, p)),
        "g and Jacobian": (nlp.jac_g, (case.start, p)),
        "Hessian": (nlp.hess_lag, (case.start, p, 1.0, multipliers)),
    }
    return {name: 1e3 * repeat(10 * repeats, f, *a)[0].median for name, (f, a) in calls.items()}


def _solve(result: SolverResult, wall: float, solver: Any) -> dict[str, float]:
    """Return where one solve's time went: what the solver says, and the rest."""
    details = getattr(solver, "details", {})
    found = {"evaluation": 1e3 * result.evaluation_seconds}
    for name in ("assembly", "factorisation"):
        if f"{name}_seconds" in details:
            found[name] = 1e3 * details[f"{name}_seconds"]
    rest = "the rest of the solver" if "factorisation" in found else "linear algebra and the rest of the solver"
    found[rest] = 1e3 * result.seconds - sum(found.values())
    found["interface"] = wall - 1e3 * result.seconds
    found["in all"] = wall
    found["an iteration"] = 1e3 * result.seconds / max(1, result.iterations)
    return found


def _imports() -> dict[str, float]:
    """Return how long a fresh process takes to start and to import each module after those before it."""
    code = "import importlib, time\n"
    code += f"for name in {MODULES!r}:\n began = time.perf_counter(); importlib.import_module(name)\n"
    code += " print(name, 1e3 * (time.perf_counter() - began))\n"
    runs = []
    for _ in range(SLOW):
        began = time.perf_counter()
        out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ)
        whole = 1e3 * (time.perf_counter() - began)
        took = {name: float(ms) for name, ms in (line.split() for line in out.stdout.splitlines())}
        runs.append(took | {"Python itself": whole - sum(took.values())})
    return {name: float(np.median([run[name] for run in runs])) for name in runs[0]}
