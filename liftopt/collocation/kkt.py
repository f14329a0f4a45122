"""First-order optimality of a point, recomputed with Pinocchio in double precision instead of the solver's kernels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.collocation.kkt_poses import link_poses, object_pose
from liftopt.collocation.kkt_wrench import add_agent_wrench, object_wrench_slopes
from liftopt.collocation.layout import FORCE_SIZE, OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Multipliers
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.trajectory import attitude, bearing, cross, free_flyer_state, object_trajectory, turned
from liftopt.types import Array

# The scale from which on large multipliers relax the test, s_max of Waechter and Biegler (2006), eq. 6.
MULTIPLIER_SCALE = 100.0
# A step along the imaginary axis gives a derivative without a difference, so it can be as small as this.
STEP = 1e-30


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
        agent = team.agents[part]
        found = _agent_knots(agent, y, period)
        return found if agent.pushes_at_a_point else add_agent_wrench(agent, y, *found)
    if all(grasp.is_point_contact for grasp in team.grasps):
        return _object_outputs(team.object, y, period), _object_slopes(team.object, y, period)
    # Forces and moments take turns in y.
    wrenches = y[:, 18:].reshape(len(y), -1, 2, 3)
    forces, moments = (wrenches[:, :, i].reshape(len(y), -1) for i in (0, 1))
    without_moments = np.hstack([y[:, :18], forces])
    slopes = object_wrench_slopes(team.object, y, _object_slopes(team.object, without_moments, period))
    return _object_outputs(team.object, without_moments, period, moments), slopes


def _agent_knots(agent: Agent, y: Array, period: float) -> tuple[Array, Array]:
    model = agent.reduced()
    n, data, frame = model.nv, model.createData(), model.frames[model.getFrameId(agent.hands[0])]
    q, v, a, f = y[:, :n], y[:, n : 2 * n] / period, y[:, 2 * n : 3 * n] / period**2, y[:, 3 * n : 3 * n + FORCE_SIZE]
    tau, point, slopes = np.zeros((len(y), n)), np.zeros((len(y), 3)), np.zeros((len(y), 6, n))
    jacobian, mass_matrix = np.zeros((len(y), n + FORCE_SIZE + 1, y.shape[1])), np.zeros((len(y), n, n))
    for k in range(len(y)):
        tau[k] = pin.rnea(model, data, q[k], v[k], a[k])
        slopes[k] = pin.computeJointJacobians(model, data, q[k])
        point[k] = data.oMi[frame.parentJoint].act(frame.placement.translation)
        by_state = pin.computeRNEADerivatives(model, data, q[k], v[k], a[k])
        jacobian[k, :n, :n], jacobian[k, :n, n : 2 * n], mass_matrix[k] = by_state
    jacobian[:, :n, n : 2 * n] /= period
    jacobian[:, :n, 2 * n : 3 * n] = _mirrored(mass_matrix) / period**2
    slopes *= bearing(model, frame.parentJoint)
    turning = slopes[:, 3:].swapaxes(1, 2)
    slope = slopes[:, :3].swapaxes(1, 2) + cross(turning, point[:, None])
    # A joint turns the grasp's Jacobian columns of the joints after it: d2p / dq_i dq_j = w_i x dp/dq_j for i <= j,
    # and the order of differentiation does not matter.
    jacobian[:, :n, :n] += _mirrored(turned(cross(turning[:, :, None], slope[:, None, :]), f[:, None]))
    jacobian[:, :n, 3 * n : 3 * n + FORCE_SIZE] = slope
    jacobian[:, n : n + FORCE_SIZE, :n] = slope.swapaxes(1, 2)
    jacobian[:, n + FORCE_SIZE, 3 * n : 3 * n + FORCE_SIZE] = 2 * f
    return np.hstack([tau + turned(slope, f), point, (f**2).sum(axis=1)[:, None]]), jacobian


def _object_outputs(lifted: LiftedObject, y: Array, period: float, moments: Array | None = None) -> Array:
    moved = object_trajectory(lifted, y[:, :6], y[:, 6:12] / period, y[:, 12:18] / period**2, y[:, 18:], moments)
    return np.hstack([moved.wrench, moved.grasp_position.reshape(len(y), -1)])


def _object_slopes(lifted: LiftedObject, y: Array, period: float) -> Array:
    """Return the Jacobians (K, n_c, n_y): Pinocchio's by the free-flyer's motion, times that motion's by y."""
    model, data = lifted.model, lifted.model.createData()
    rotation, spin = attitude(y[:, 3:6])
    back = rotation.swapaxes(1, 2)
    # The motion (q in its tangent space, v, a) by x, x', x''.
    motion = np.zeros((len(y), 18, 18))
    motion[:, 0:3, 0:3], motion[:, 3:6, 3:6] = back, spin
    nudged = y[:, None, :18] + 1j * STEP * np.eye(18)
    _, v, a = free_flyer_state(nudged[..., :6], nudged[..., 6:12] / period, nudged[..., 12:] / period**2)
    motion[:, 6:12], motion[:, 12:] = v.imag.swapaxes(1, 2) / STEP, a.imag.swapaxes(1, 2) / STEP
    turning = attitude(nudged[:, 3:6, 3:6])[0].imag / STEP  # dR by roll, pitch, yaw

    q, v, a = free_flyer_state(y[:, :6], y[:, 6:12] / period, y[:, 12:18] / period**2)
    generalized, by_motion = np.zeros((len(y), OBJECT_SIZE)), np.zeros((len(y), OBJECT_SIZE, 18))
    for k in range(len(y)):
        generalized[k] = pin.rnea(model, data, q[k], v[k], a[k])
        by_motion[k] = np.hstack(pin.computeRNEADerivatives(model, data, q[k], v[k], a[k]))
    by_motion[:, :, 12:] = _mirrored(by_motion[:, :, 12:])
    levers = [model.frames[model.getFrameId(name)].placement.translation for name in lifted.grasp_frames]
    jacobian = np.zeros((len(y), OBJECT_SIZE + 3 * len(levers), y.shape[1]))
    jacobian[:, :OBJECT_SIZE, :18] = by_motion @ motion
    jacobian[:, :3] = rotation @ jacobian[:, :3]
    jacobian[:, :3, 3:6] += np.einsum("kaij,kj->kia", turning, generalized[:, :3])
    for i, lever in enumerate(levers):
        rows, columns = slice(OBJECT_SIZE + 3 * i, OBJECT_SIZE + 3 * i + 3), slice(18 + 3 * i, 21 + 3 * i)
        jacobian[:, :3, columns] = -np.eye(3)
        jacobian[:, 3:OBJECT_SIZE, columns] = -pin.skew(lever) @ back
        jacobian[:, 3:OBJECT_SIZE, 3:6] -= pin.skew(lever) @ np.einsum("kaji,kj->kia", turning, y[:, columns])
        jacobian[:, rows, :3], jacobian[:, rows, 3:6] = np.eye(3), np.einsum("kaij,j->kia", turning, lever)
    return jacobian


def _mirrored(matrices: Array) -> Array:
    """Return symmetric matrices (K, n, n) from their upper triangles, all that Pinocchio fills of a mass matrix."""
    return np.triu(matrices) + np.triu(matrices, 1).swapaxes(1, 2)
