"""IPOPT (Waechter and Biegler 2006) with MUMPS, through CasADi's ``nlpsol``, with the problem's own derivatives."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from liftopt.collocation.assembly import Nlp
from liftopt.collocation.codegen.simd_kernels import SimdKernel
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.collocation.solvers.result import STOPPED, Multipliers, SolverResult
from liftopt.collocation.solvers.simd_nlp import simd_nlp
from liftopt.errors import SolverError
from liftopt.types import Array

# IPOPT measures errors of the scaled objective and relaxes them by averages over other multipliers than we do. With
# this factor the KKT error stays below the tolerance; a smaller one costs iterations (docs/tuning.md).
SAFETY = 0.5
# A warm start is near the solution: a larger mu takes more iterations (docs/tuning.md).
WARM_MU, WARM_PUSH = 1e-6, 1e-5
# What converges at all from a warm start takes a third of these iterations; then a cold start is quicker.
WARM_ITERATIONS = 40
EXHAUSTED = "Maximum_Iterations_Exceeded"  # its own word
EVALUATIONS = ("nlp_f", "nlp_g", "nlp_grad_f", "nlp_jac_g", "nlp_hess_l")


@dataclass(frozen=True)
class IpoptOptions:
    """Options of IPOPT that liftopt sets; the others keep IPOPT's defaults.

    Attributes:
        tolerance: KKT error in the problem's own units at which it stops.
        max_iterations: iterations before it gives up.
        objective_scaling: factor on the objective inside IPOPT; torques squared are large beside the constraints.
    """

    tolerance: float = 1e-6
    max_iterations: int = 500
    objective_scaling: float = 0.1


class Ipopt:
    """IPOPT on one problem; ``solve`` may be called from many starts."""

    def __init__(
        self, problem: Problem, options: IpoptOptions | None = None, simd: Sequence[SimdKernel] | None = None
    ) -> None:
        """Build the solver.

        Args:
            problem: what to solve.
            options: see there.
            simd: the parts' kernels for several knots at once, built in half the time and quicker to evaluate; None:
                CasADi maps the one-knot kernels.

        Raises:
            SolverError: CasADi's IPOPT cannot be had.
        """
        self.problem, self.options, self._simd = problem, options or IpoptOptions(), simd
        self._stop = _Stop(len(problem.bounds()[0]), problem.constraints.linear.shape[0], len(problem.parameters))
        self._solvers: dict[bool, Any] = {}

    def takes(self, problem: Problem) -> bool:
        """Whether it may be solved without another solver."""
        return problem.interchangeable(self.problem)

    def solve(
        self,
        x0: Array,
        *,
        deadline: Deadline,
        warm: Multipliers | None = None,
        problem: Problem | None = None,
        incumbent: SolverResult | None = None,
        most: int | None = None,
    ) -> SolverResult:
        """Solve from ``x0``; see ``Solver.solve``. A Ctrl-C acts at the next iteration; an incumbent changes nothing.

        Where a warm start does not converge, a cold one from ``x0`` follows, and the status says so.
        """
        problem = problem or self.problem
        if not problem.constraints.same_rows(self.problem.constraints):
            raise SolverError("the problem has other constraint rows than the one this solver was built for")
        self._stop.most = most
        if warm is None:
            return self._run(x0, deadline, None, problem)
        first = self._run(x0, deadline, warm, problem)
        if first.converged or first.status == STOPPED:
            return first
        second = self._run(x0, deadline, None, problem)
        status = second.status if second.status == STOPPED else f"{second.status} (cold, after warm: {first.status})"
        return replace(
            second,
            status=status,
            iterations=first.iterations + second.iterations,
            seconds=first.seconds + second.seconds,
            evaluation_seconds=first.evaluation_seconds + second.evaluation_seconds,
        )

    def _run(self, x0: Array, deadline: Deadline, warm: Multipliers | None, problem: Problem) -> SolverResult:
        solver, constraints = self._solver(warm is not None), problem.constraints
        lower, upper = problem.bounds()
        arguments = dict(x0=x0, p=problem.parameters, lbx=lower, ubx=upper)
        arguments |= dict(lbg=constraints.lower, ubg=constraints.upper)
        if warm is not None:
            arguments |= dict(lam_x0=warm.x, lam_g0=warm.g)
        self._stop.deadline, self._stop.interrupted, self._stop.iterations = deadline, False, 0
        began = time.perf_counter()
        try:
            with _interruptible(self._stop):
                found = solver(**arguments)
        except RuntimeError as error:
            raise SolverError(f"IPOPT could not run: {error}") from error
        seconds = time.perf_counter() - began
        stats = solver.stats()
        return SolverResult(
            x=np.asarray(found["x"]).ravel(),
            multipliers=Multipliers(np.asarray(found["lam_x"]).ravel(), np.asarray(found["lam_g"]).ravel()),
            objective=float(found["f"]),
            iterations=int(stats["iter_count"]),
            converged=bool(stats["success"]),
            status=EXHAUSTED if self._stop.exhausted else str(stats["return_status"]),
            seconds=seconds,
            evaluation_seconds=sum(float(stats.get(f"t_wall_{name}") or 0.0) for name in EVALUATIONS),
        )

    @cached_property
    def _nlp(self) -> Nlp:
        return self.problem.nlp if self._simd is None else simd_nlp(self.problem, self._simd)

    def _solver(self, warm: bool) -> Any:
        if warm not in self._solvers:
            try:
                self._solvers[warm] = self._build(warm)
            except RuntimeError as error:
                raise SolverError(f"IPOPT could not be set up: {error}") from error
        return self._solvers[warm]

    def _build(self, warm: bool) -> Any:
        nlp, options = self._nlp, self.options
        ipopt: dict[str, Any] = dict(
            print_level=0,
            sb="yes",
            tol=options.tolerance * options.objective_scaling * SAFETY,
            max_iter=options.max_iterations,
            nlp_scaling_method="none",
            obj_scaling_factor=options.objective_scaling,
            # Relaxed bounds leave complementarity errors of the relaxation times the multiplier, which may be large.
            bound_relax_factor=1e-12,
            # MUMPS' own scaling and ordering take longer than none and AMD, and its usual pivoting test delays pivots
            # that do no harm. Where a solution of the linear system turns out bad, IPOPT asks for a stricter test.
            mumps_permuting_scaling=0,
            mumps_scaling=0,
            mumps_pivot_order=0,
            mumps_pivtol=1e-10,
        )
        if warm:
            ipopt |= dict(
                max_iter=min(options.max_iterations, WARM_ITERATIONS),
                warm_start_init_point="yes",
                mu_init=WARM_MU,
                warm_start_bound_push=WARM_PUSH,
                warm_start_bound_frac=WARM_PUSH,
                warm_start_slack_bound_push=WARM_PUSH,
                warm_start_slack_bound_frac=WARM_PUSH,
                warm_start_mult_bound_push=WARM_PUSH,
            )
        return ca.nlpsol(
            "lift",
            "ipopt",
            {"x": nlp.x, "p": nlp.p, "f": nlp.f, "g": nlp.g},
            dict(
                grad_f=nlp.grad_f,
                jac_g=nlp.jac_g,
                hess_lag=nlp.hess_lag,
                iteration_callback=self._stop,
                iteration_callback_ignore_errors=False,
                print_time=False,
                record_time=True,
                calc_lam_p=False,
                no_nlp_grad=True,
                ipopt=ipopt,
            ),
        )


@contextmanager
def _interruptible(stop: _Stop) -> Iterator[None]:
    """Let a Ctrl-C stop the solver and act after it: CasADi would take it for a failed evaluation and go on."""
    handler = signal.getsignal(signal.SIGINT)
    # Only the main thread may set handlers; without one of Python's the signal is ignored or ends the process.
    if not callable(handler) or threading.current_thread() is not threading.main_thread():
        yield
        return
    interrupted = []

    def note(*_: object) -> None:
        interrupted.append(True)
        stop.interrupted = True

    signal.signal(signal.SIGINT, note)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        if interrupted:
            signal.raise_signal(signal.SIGINT)


class _Stop(ca.Callback):
    """Stops IPOPT between iterations, after so many or once the time is over: its own limits stay as they were set."""

    def __init__(self, n_x: int, n_g: int, n_p: int) -> None:
        ca.Callback.__init__(self)
        self.deadline, self.interrupted = NEVER, False
        self.most: int | None = None
        self.iterations = 0
        self._sizes = {"x": n_x, "f": 1, "g": n_g, "lam_x": n_x, "lam_g": n_g, "lam_p": n_p}
        self.construct("stop", {})

    @property
    def exhausted(self) -> bool:
        """Whether all iterations it may take were taken, and one more was asked for."""
        return self.most is not None and self.iterations > self.most

    def get_n_in(self) -> int:
        return int(ca.nlpsol_n_out())

    def get_n_out(self) -> int:
        return 1

    def get_name_in(self, i: int) -> str:
        return str(ca.nlpsol_out(i))

    def get_name_out(self, i: int) -> str:
        return "stop"

    def get_sparsity_in(self, i: int) -> Any:
        return ca.Sparsity.dense(self._sizes.get(ca.nlpsol_out(i), 0), 1)

    def has_eval_buffer(self) -> bool:
        return True

    def eval_buffer(self, _: Any, results: Any) -> int:
        self.iterations += 1  # the first call is at the start
        np.frombuffer(results[0])[0] = self.exhausted or self.interrupted or self.deadline.passed
        return 0
