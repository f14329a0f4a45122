"""First-order optimality of a point, recomputed with Pinocchio in double precision instead of the solver's kernels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin
import scipy.sparse as sp

from liftopt.collocation.layout import FORCE_SIZE, OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Multipliers
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.trajectory import object_trajectory

Array = npt.NDArray[np.float64]
# The scale from which on large multipliers relax the test, s_max of Waechter and Biegler (2006), eq. 6.
MULTIPLIER_SCALE = 100.0
STEP = 1e-3


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


def kkt_error(problem: Problem, x: Array, multipliers: Multipliers) -> KktError:
    """Return the KKT error of a point of a problem, all functions evaluated by Pinocchio."""
    outputs, slopes = [], []
    gradient, objective = np.zeros(len(x)), 0.0
    weights, period = problem.mesh.weights, problem.task.duration
    for i, part in enumerate(problem.parts):
        y = (part.select @ x).reshape(len(weights), part.kernel.n_y)
        c, jacobians = _evaluate(problem, i, y, period)
        leading, y_weight = problem.weights(i)
        c_weight = np.concatenate([leading, np.zeros(part.kernel.n_c - len(leading))])
        objective += float(weights @ (c**2 @ c_weight + y**2 @ y_weight))
        pull = 2 * weights[:, None] * c * c_weight
        block = sp.block_diag(jacobians, format="csr")
        gradient += part.select.T @ (block.T @ pull.ravel() + (2 * weights[:, None] * y * y_weight).ravel())
        outputs.append(c.ravel())
        slopes.append(block @ part.select)
    constraints = problem.constraints
    g = constraints.combine @ np.concatenate(outputs) + constraints.linear @ x
    jacobian = constraints.combine @ sp.vstack(slopes) + constraints.linear
    gradient += jacobian.T @ multipliers.g + multipliers.x

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
        objective=objective,
    )


def _evaluate(problem: Problem, part: int, y: Array, period: float) -> tuple[Array, list[Array]]:
    """Return outputs (K, n_c) and their Jacobians (n_c, n_y) at every knot."""
    team = problem.team
    if part < len(team.agents):
        model = team.agents[part].reduced()
        pairs = [_agent_knot(team.agents[part], model, model.createData(), row, period) for row in y]
    else:
        pairs = [_object_knot(team.held, team.held.model.createData(), row, period) for row in y]
    return np.array([c for c, _ in pairs]), [jacobian for _, jacobian in pairs]


def _agent_knot(agent: Agent, model: pin.Model, data: pin.Data, y: Array, period: float) -> tuple[Array, Array]:
    n = model.nv
    q, v, a, f = y[:n], y[n : 2 * n] / period, y[2 * n : 3 * n] / period**2, y[3 * n :]
    frame = model.frames[model.getFrameId(agent.grasp_frame)]
    pin.computeJointJacobians(model, data, q)
    slope_joint = pin.getJointJacobian(model, data, frame.parentJoint, pin.LOCAL)
    placement = data.oMi[frame.parentJoint] * frame.placement
    # The reaction -f seen from the joint that carries the grasp; it turns when the joint does.
    linear, lever = -data.oMi[frame.parentJoint].rotation.T @ f, frame.placement.translation
    turn = np.cross(linear, slope_joint[3:].T).T
    reaction_slope = np.vstack([turn, np.cross(lever, turn.T).T])
    loads = pin.StdVec_Force()
    loads.extend([pin.Force.Zero() for _ in range(model.njoints)])
    loads[frame.parentJoint] = pin.Force(linear, np.cross(lever, linear))

    dtau_dq, dtau_dv, mass_matrix = (np.array(m) for m in pin.computeRNEADerivatives(model, data, q, v, a, loads))
    mass_matrix = np.triu(mass_matrix) + np.triu(mass_matrix, 1).T
    tau = pin.rnea(model, data, q, v, a, loads)
    slope = pin.computeFrameJacobian(model, data, q, model.getFrameId(agent.grasp_frame), pin.LOCAL_WORLD_ALIGNED)[:3]
    c = np.concatenate([tau, placement.translation, [f @ f]])
    jacobian = np.zeros((n + FORCE_SIZE + 1, len(y)))
    jacobian[:n, :n] = dtau_dq - slope_joint.T @ reaction_slope
    jacobian[:n, n : 2 * n], jacobian[:n, 2 * n : 3 * n] = dtau_dv / period, mass_matrix / period**2
    jacobian[:n, 3 * n :] = slope.T
    jacobian[n : n + FORCE_SIZE, :n] = slope
    jacobian[n + FORCE_SIZE, 3 * n :] = 2 * f
    return c, jacobian


def _object_knot(held: LiftedObject, data: pin.Data, y: Array, period: float) -> tuple[Array, Array]:
    c = _object_outputs(held, data, y, period)
    jacobian = np.zeros((len(c), len(y)))
    mass, grasps = held.model.inertias[1].mass, len(held.grasp_frames)
    jacobian[:3, 12:15] = mass / period**2 * np.eye(3)
    jacobian[OBJECT_SIZE:, :3] = np.tile(np.eye(3), (grasps, 1))
    rotation = data.oMi[1].rotation
    for i, name in enumerate(held.grasp_frames):
        column = slice(18 + 3 * i, 21 + 3 * i)
        lever = held.model.frames[held.model.getFrameId(name)].placement.translation
        jacobian[:3, column], jacobian[3:OBJECT_SIZE, column] = -np.eye(3), -pin.skew(lever) @ rotation.T
    # By the angles and their rates: central differences of fourth order, exact to rounding at this step. The balance
    # is linear in the second derivatives, for which any step is exact.
    for j in (3, 4, 5, 9, 10, 11, 15, 16, 17):
        stencil = ((1, 2 / 3), (2, -1 / 12)) if j < 15 else ((1, 1 / 2),)
        for k, weight in stencil:
            ahead, behind = y.copy(), y.copy()
            ahead[j] += k * STEP
            behind[j] -= k * STEP
            difference = _object_outputs(held, data, ahead, period) - _object_outputs(held, data, behind, period)
            jacobian[:, j] += weight * difference / STEP
    return c, jacobian


def _object_outputs(held: LiftedObject, data: pin.Data, y: Array, period: float) -> Array:
    moved = object_trajectory(
        held, y[None, :6], y[None, 6:12] / period, y[None, 12:18] / period**2, y[None, 18:], data
    )  # fmt: skip
    return np.concatenate([moved.wrench[0], moved.grasp_position[0].ravel()])
