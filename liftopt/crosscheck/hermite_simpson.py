"""A second transcription of the same lift: Hermite-Simpson on the states, as a check on the spline collocation.

Nothing of ``liftopt.collocation``'s spline, kernels, constraints or assembly is used; only the task (limits, weights).
Unknowns are, at the nodes and at the middles of N intervals, the states (q, v), the controls (a, the grasp forces f,
the moments m of grasps that transmit them, and the joint torques tau). In the separated form of Betts (2010, Practical
Methods for Optimal Control and Estimation Using Nonlinear Programming, section 4.6), for x = (q, v) with rate
F = (v, a), a middle m between nodes k and k + 1:

    x_m = (x_k + x_k+1) / 2 + h / 8 (F_k - F_k+1),        x_k+1 - x_k = h / 6 (F_k + 4 F_m + F_k+1).

Dynamics are implicit: ``tau = RNEA(q, v, a, f, m)`` and the object's balance are equations at every node and middle,
so no mass matrix is inverted. What the grasps allow holds there too. The objective is integrated by Simpson's rule, the
same weights as the defects.

Loop closure makes the states dependent: a differential-algebraic system of index 3. Closing the loop at position,
velocity and acceleration level everywhere would give dependent rows, closing it at no level would let it drift. Here
positions are closed at the nodes only. In each closed direction there are N + 1 such rows; the accelerations at nodes
and middles and the initial state are 2 N + 3 unknowns, rest at both ends takes 4, so 2 N - 1 remain and the rows are
independent for every N >= 2, with none left out. The freedom that remains, the bend of the motion within an interval
with fixed ends, moves the grasp points apart in between. Its cost is quadratic in the acceleration it takes and what
it gains linear in the gap, so the gap shrinks with h**4 and needs no row of its own; it is reported.

Rest at both ends, joint limits, speed limits, range of motion and poses are bounds on unknowns at nodes and middles;
torque limits likewise. Coordinates that the task locks (the object's roll) are constants.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from liftopt.collocation.task import LiftTask
from liftopt.crosscheck.holds import FORCE_UNIT, MOMENT_UNIT
from liftopt.crosscheck.instant import FORCE_SIZE, OBJECT_SIZE, Coordinates, Instant, instant
from liftopt.crosscheck.integrand import integrand
from liftopt.errors import SolverError
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.types import Array

FEWEST = 2
TORQUE_UNIT = 10.0  # what the solver sees as one, near the size of what is found [Nm]
TOLERANCE = 1e-7


@dataclass(frozen=True)
class Points:
    """A motion at the 2 N + 1 nodes and middles: what the transcription starts from and what it gives.

    Attributes:
        q, v, a: (2 N + 1, n_q) of ``Coordinates`` [rad, m and per s, per s^2].
        force: (2 N + 1, 3 grasps) on the object, world axes [N].
        moment: (2 N + 1, 3 grasps that transmit moments) on the object about the grasp points, world axes [Nm].
        tau: (2 N + 1, n_joints) [Nm].
    """

    q: Array
    v: Array
    a: Array
    force: Array
    moment: Array
    tau: Array

    @staticmethod
    def of(y: Array, at: Coordinates) -> Points:
        """Read points off their rows (2 N + 1, n_y)."""
        return Points(*np.split(y, np.cumsum(at.sizes[:-1]), axis=1))

    @property
    def y(self) -> Array:
        """(2 N + 1, n_y) everything, one row a point."""
        return np.hstack([getattr(self, field.name) for field in fields(self)])

    def every(self, step: int) -> Points:
        """Return the points of a mesh that is ``step`` times as coarse."""
        return Points(*(getattr(self, field.name)[::step] for field in fields(self)))


@dataclass(frozen=True)
class Optimum:
    """What the transcription found.

    Attributes:
        intervals: N.
        objective: J by Simpson's rule.
        points: the motion.
        middle_gap: largest distance of a grasp point from the object's at the middles [m].
        violation: largest violation of a constraint or bound, as scaled for the solver.
        converged: IPOPT's word.
        seconds: wall time in IPOPT [s].
    """

    intervals: int
    objective: float
    points: Points
    middle_gap: float
    violation: float
    converged: bool
    seconds: float


@dataclass(frozen=True, eq=False)
class HermiteSimpson:
    """A lift on N intervals by Hermite-Simpson.

    Attributes:
        agents, object, task: the same as the solve's.
        intervals: N, at least 2.
        still: whether accelerations are zero at both ends (eq. 19). In continuous time that asks nothing: an
            acceleration may jump. On a mesh it costs a ramp over the first and the last interval, first order in h.
    """

    agents: tuple[Agent, ...]
    object: LiftedObject
    task: LiftTask
    intervals: int
    still: bool = True

    def __post_init__(self) -> None:
        if self.intervals < FEWEST:
            raise ValueError(f"rest at both ends and closed loops need at least {FEWEST} intervals")

    @cached_property
    def instant(self) -> Instant:
        """The equations at one instant."""
        return instant(self.agents, self.object, self.task)

    @property
    def at(self) -> Coordinates:
        """What moves."""
        return self.instant.coordinates

    @property
    def n_points(self) -> int:
        """Number of nodes and middles."""
        return 2 * self.intervals + 1

    @property
    def units(self) -> Array:
        """(n_y,) what one of each unknown of a point stands for."""
        return np.repeat([1.0, 1.0, 1.0, FORCE_UNIT, MOMENT_UNIT, TORQUE_UNIT], self.at.sizes)

    def solve(self, start: Points, *, max_iterations: int = 300, seconds: float = 600.0) -> Optimum:
        """Find the optimum nearest to ``start`` with IPOPT.

        Raises:
            SolverError: IPOPT cannot run.
        """
        solver, lower_g, upper_g, constraints = self._solver(max_iterations, seconds)
        lower, upper = self._bounds()
        x0 = np.clip((start.y / self.units).ravel(), lower, upper)
        began = time.perf_counter()
        try:
            found = solver(x0=x0, lbx=lower, ubx=upper, lbg=lower_g, ubg=upper_g)
        except RuntimeError as error:
            raise SolverError(f"IPOPT could not run: {error}") from error
        took = time.perf_counter() - began
        x = np.asarray(found["x"]).ravel()
        g = np.asarray(constraints(x)).ravel()
        excess = np.concatenate([lower_g - g, g - upper_g, lower - x, x - upper])
        points = Points.of(x.reshape(self.n_points, -1) * self.units, self.at)
        gaps = np.asarray(self.instant.closure(points.q[1::2].T)).reshape(-1, FORCE_SIZE, self.intervals)
        return Optimum(
            self.intervals,
            float(found["f"]),
            points,
            float(np.linalg.norm(gaps, axis=1).max()),
            float(excess.max()),
            bool(solver.stats()["success"]),
            took,
        )

    def defects(self, q: Any, v: Any, a: Any) -> list[Any]:
        """Return the defects of the module's docstring, first of q, then of v: at the middles, over the intervals.

        Arguments are arrays or expressions of one column a point, results of one column an interval.
        """
        h, defects = self._step, []
        for state, rate in ((q, v), (v, a)):
            left, middle, right = state[:, :-1:2], state[:, 1::2], state[:, 2::2]
            rate_left, rate_middle, rate_right = rate[:, :-1:2], rate[:, 1::2], rate[:, 2::2]
            defects.append(middle - (left + right) / 2 - h / 8 * (rate_left - rate_right))
            defects.append(right - left - h / 6 * (rate_left + 4 * rate_middle + rate_right))
        return defects

    def _solver(self, max_iterations: int, seconds: float) -> tuple[Any, Array, Array, Any]:
        n, n_y, points = self.at.n_q, len(self.units), self.n_points
        x = ca.MX.sym("x", n_y * points)
        y = ca.reshape(x, n_y, points)
        physical = ca.mtimes(ca.diag(ca.DM(self.units)), y)
        q, v, a = (y[i * n : (i + 1) * n, :] for i in range(3))
        rows = self._rows(q, v, a, physical)
        g = ca.vertcat(*(ca.vec(row) for row, _, _ in rows))
        lower, upper = (np.concatenate([np.full(row[0].numel(), row[side]) for row in rows]) for side in (1, 2))
        tilts = self.instant.tilt.map(points)(q)
        f = ca.mtimes(integrand(self.agents, self.task, self.at, physical, tilts), ca.DM(self._simpson))
        ipopt = dict(
            print_level=0, sb="yes", tol=TOLERANCE, constr_viol_tol=TOLERANCE, max_iter=max_iterations,
            max_wall_time=seconds, mu_init=1e-3, bound_push=1e-6, bound_frac=1e-6, bound_relax_factor=1e-10,
            obj_scaling_factor=0.1, nlp_scaling_method="none",
        )  # fmt: skip
        nlp: dict[str, Any] = {"x": x, "f": f, "g": g}
        options: dict[str, Any] = dict(print_time=False, calc_lam_p=False, ipopt=ipopt)
        solver = ca.nlpsol("hermite_simpson", "ipopt", nlp, options)
        return solver, lower, upper, ca.Function("g", [x], [g])

    @property
    def _step(self) -> float:
        return self.task.duration / self.intervals

    @property
    def _simpson(self) -> Array:
        """Simpson's weights (2 N + 1,) [s]; they sum to the duration."""
        weights = np.zeros(self.n_points)
        for k in range(self.intervals):
            weights[2 * k : 2 * k + 3] += self._step / 6 * np.array([1.0, 4.0, 1.0])
        return weights

    def _rows(self, q: Any, v: Any, a: Any, y: Any) -> list[tuple[Any, float, float]]:
        """Return the constraints, one column a point or an interval, each with its lower and upper bound."""
        task, everywhere = self.task, self.n_points
        tolerance, unserved = task.balance_tolerance, None if self.at.turning else self.object.unserved_row()
        served = [r for r in range(OBJECT_SIZE) if tolerance > 0 or r != unserved]
        tilts, leans = self.instant.tilt.map(everywhere)(q), [agent.lean for agent in self.agents if agent.lean]
        return [
            *((defect, 0.0, 0.0) for defect in self.defects(q, v, a)),
            (self.instant.dynamics.map(everywhere)(y) / TORQUE_UNIT, 0.0, 0.0),
            (self.instant.balance.map(everywhere)(y)[served, :], -tolerance, tolerance),
            (self.instant.closure.map(self.intervals + 1)(q[:, ::2]), 0.0, 0.0),
            (self.instant.grasp.map(everywhere)(y) / task.max_grasp_force**2, -np.inf, 1.0),
            (self.instant.hold.map(everywhere)(y), 0.0, np.inf),
            (self.instant.workspace.map(everywhere)(q), 0.0, np.inf),
            *((tilts[row, :], -np.inf, 1.0 - np.cos(lean.most)) for row, lean in enumerate(leans)),
        ]

    def _bounds(self) -> tuple[Array, Array]:
        """Return bounds (n_x,) of the unknowns: limits everywhere, rest at both ends (eq. 19) and poses there."""
        task, at = self.task, self.at
        lower = np.tile(self._limits("lower", -1.0, task.pose_lower), (self.n_points, 1))
        upper = np.tile(self._limits("upper", 1.0, task.pose_upper), (self.n_points, 1))
        resting = slice(at.n_q, (3 if self.still else 2) * at.n_q)
        for end, pose in ((0, task.start[at.unlocked]), (-1, task.end[at.unlocked])):
            given = np.flatnonzero(~np.isnan(pose))
            for bound in (lower, upper):
                bound[end, resting] = 0.0
                bound[end, at.n_joints + given] = pose[given]
        return lower.ravel(), upper.ravel()

    def _limits(self, side: str, sign: float, pose: Array) -> Array:
        """Return the lower or upper limits (n_y,) of the unknowns of one point, in their units."""
        task, at, limits = self.task, self.at, [agent.limits for agent in self.agents]
        q = [*(getattr(limit, f"q_{side}") for limit in limits), pose[at.unlocked]]
        v = [*(sign * limit.velocity for limit in limits), sign * task.pose_velocity[at.unlocked]]
        a, force = np.full(at.n_q, sign * np.inf), np.full(at.n_force, sign * task.max_grasp_force)
        turning = [grasp for agent in self.agents for grasp in agent.grasps if grasp.moments]
        moment = np.repeat([sign * grasp.max_moment for grasp in turning], FORCE_SIZE)
        tau = [getattr(limit, f"tau_{side}") for limit in limits]
        return np.asarray(np.concatenate([*q, *v, a, force, moment, *tau]) / self.units, dtype=np.float64)
