"""First-order optimality of a point, recomputed with Pinocchio in double precision instead of the solver's kernels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.collocation.kkt_agent import STEP
from liftopt.collocation.kkt_disc import disc_agent_knots
from liftopt.collocation.kkt_object import object_knots
from liftopt.collocation.kkt_poses import link_poses, object_pose
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Multipliers
from liftopt.multibody.trajectory import turned
from liftopt.types import Array

# The scale from which on large multipliers relax the test, s_max of Waechter and Biegler (2006), eq. 6.
MULTIPLIER_SCALE = 100.0


@dataclass(frozen=True)
class KktError:
    """Errors of the first-order conditions in the problem's own units.

    Attributes:
        stationarity: largest entry of the Lagrangian's gradient over s_d.
        violation: largest violation of a constraint or bound.
        complementarity: largest product of a multiplier and its distance to the bound over s_c.
        objective: value of the objective by Pinocchio.
    """

    stationarity: float
    violation: float
    complementarity: float
    objective: float

    @property
    def error(self) -> float:
        """The largest of the three: E_0 of Waechter and Biegler (2006), eq. 5."""
        return max(self.stationarity, self.violation, self.complementarity)


@dataclass(frozen=True)
class FirstOrder:
    """What the first-order conditions are made of, at a point.

    Attributes:
        gradient: (n_x,) of the Lagrangian.
        g: (n_g,) values of the constraint rows.
        objective: value of the objective.
    """

    gradient: Array
    g: Array
    objective: float


def first_order(problem: Problem, x: Array, multipliers: Multipliers) -> FirstOrder:
    """Return gradient of the Lagrangian, rows and objective at a point of a problem, all evaluated by Pinocchio."""
    constraints, weights, period = problem.constraints, problem.mesh.weights, problem.task.duration
    gradient, objective = multipliers.x + constraints.linear.T @ multipliers.g, 0.0
    pulls, outputs = constraints.combine.T @ multipliers.g, []
    for i, part in enumerate(problem.parts):
        y = (part.select @ x).reshape(len(weights), part.kernel.n_y)
        c, jacobian = _evaluate(problem, i, y, period)
        own = problem.weights(i)
        c_weight = np.zeros_like(c)
        c_weight[:, : len(own.above)] = own.of_outputs(c[:, : len(own.above)])
        squares = (c**2 * c_weight).sum(axis=1) + y**2 @ own.variable + own.range_cost(y).sum(axis=1)
        objective += float(weights @ squares)
        pull, pulls = pulls[: c.size].reshape(c.shape), pulls[c.size :]
        by_c = pull + 2 * weights[:, None] * c * c_weight
        by_y = turned(jacobian.swapaxes(1, 2), by_c) + 2 * weights[:, None] * y * own.variable
        n_range = own.range.shape[1]
        by_y[:, :n_range] += weights[:, None] * own.range_cost(y + 1j * STEP).imag / STEP
        gradient += part.select.T @ by_y.ravel()
        outputs.append(c.ravel())
    return FirstOrder(gradient, constraints.combine @ np.concatenate(outputs) + constraints.linear @ x, objective)


def kkt_error(problem: Problem, x: Array, multipliers: Multipliers) -> KktError:
    """Return the KKT error of a point of a problem, all functions evaluated by Pinocchio."""
    constraints, at = problem.constraints, first_order(problem, x, multipliers)
    gradient, g = at.gradient, at.g
    lower, upper = problem.bounds()
    free = upper > lower
    outside = np.abs(x - np.clip(x, lower, upper))
    all_lower = np.concatenate([lower[free], constraints.lower])
    all_upper = np.concatenate([upper[free], constraints.upper])
    values, lam = np.concatenate([x[free], g]), np.concatenate([multipliers.x[free], multipliers.g])
    bounded = all_upper > all_lower
    products = [
        np.abs(np.minimum(lam, 0.0) * np.where(np.isfinite(all_lower), values - all_lower, 1.0))[bounded],
        np.abs(np.maximum(lam, 0.0) * np.where(np.isfinite(all_upper), all_upper - values, 1.0))[bounded],
    ]
    s_d = max(MULTIPLIER_SCALE, float(np.abs(lam).mean())) / MULTIPLIER_SCALE
    s_c = max(MULTIPLIER_SCALE, float(np.abs(lam[bounded]).mean())) / MULTIPLIER_SCALE
    return KktError(
        stationarity=float(np.abs(gradient[free]).max()) / s_d,
        # np.max, unlike max, keeps a NaN.
        violation=float(np.max(np.concatenate([[0.0], all_lower - values, values - all_upper, outside]))),
        complementarity=float(max(p.max(initial=0.0) for p in products)) / s_c,
        objective=at.objective,
    )


def _evaluate(problem: Problem, part: int, y: Array, period: float) -> tuple[Array, Array]:
    """Return outputs (K, n_c) and their Jacobians (K, n_c, n_y) at every knot."""
    team = problem.team
    if part > len(team.agents):
        pose = problem.poses[part - len(team.agents) - 1]
        moves = pose.part < len(team.agents)
        return link_poses(team.agents[pose.part], pose.joints, y) if moves else object_pose(y)
    if part < len(team.agents):
        return disc_agent_knots(team.agents[part], y, period)
    return object_knots(team.object, y, period, bare=all(grasp.is_point_contact for grasp in team.grasps))
