"""Is it a solution? Every requirement measured on the exported models by Pinocchio, not by the solver's functions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from liftopt.collocation.constraints import BALANCE_ROWS, served_rows
from liftopt.collocation.flat_hand import flat_hand_rows
from liftopt.collocation.kkt import kkt_error
from liftopt.collocation.motion import Motion, motion_at, objective_terms, objective_weights
from liftopt.collocation.problem import Problem
from liftopt.collocation.soles import sole_rows
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import OBJECT_COORDINATES
from liftopt.ergonomics.spine import load_through
from liftopt.multibody.agent import Agent
from liftopt.multibody.leaning import trunk_tilt
from liftopt.multibody.solid_pairs import solid_pairs
from liftopt.multibody.solids import Solid
from liftopt.multibody.standing import ground_in_base
from liftopt.multibody.trajectory import AgentTrajectory, attitude, grasps_of, hand_turn, turned
from liftopt.solution.checks import AT_KNOTS, BETWEEN_KNOTS, COMPRESSION, FINER, TOUCH, Check, Verification
from liftopt.solution.clearance_measure import pairs_nearby
from liftopt.types import Array

CLOSURE_BETWEEN_KNOTS = 1e-3  # [m]
AT_ENDS = 1e-9
OBJECTIVE = 1e-8  # relative, between the solver's functions and Pinocchio


def verify(
    problem: Problem,
    spline: RestToRestSpline,
    result: SolverResult,
    tolerance: float,
    obstacles: Sequence[Solid] = (),
    clearance: float | None = None,
) -> Verification:
    """Measure every requirement on a solver's result.

    Args:
        problem: what was solved.
        spline: its space of motions.
        result: where the solver stopped.
        tolerance: largest KKT error.
        obstacles: solids that stand in the way.
        clearance: how far bodies must keep apart [m]; None: they may overlap.
    """
    fine = motion_at(problem, spline, result.x, np.linspace(0.0, 1.0, FINER * spline.intervals + 1))
    knots = fine.every(FINER)
    optimality = kkt_error(problem, result.x, result.multipliers)
    checks = [
        _closure("grasp closure at the knots", knots, AT_KNOTS, problem.mesh.closure_knots),
        _closure("grasp closure between knots", fine, CLOSURE_BETWEEN_KNOTS, np.arange(len(fine.time))),
        *_balance(problem, knots, fine),
        *_limits(problem, knots, AT_KNOTS, ""),
        *_limits(problem, fine, np.inf, BETWEEN_KNOTS),
        *_ends(problem, spline, knots),
        _objective(problem, knots, result),
    ]
    if clearance is not None:
        checks.append(_clearance(problem, fine, obstacles, clearance))
    return Verification(tuple(checks), optimality.error, tolerance)


def _closure(name: str, motion: Motion, limit: float, at: npt.NDArray[np.int64]) -> Check:
    """Eq. 16: distance of each grasp point from the object's."""
    gaps, names = [], []
    for g, agent, own, grasp in grasps_of(motion.agents):
        apart = agent.grasp_position[:, own] - motion.object.grasp_position[:, g]
        gaps.append(np.linalg.norm(apart, axis=1)[at])
        names.append(grasp.name)
    return _worst(name, np.stack(gaps, axis=1), limit, "m", names, motion.time[at])


def _balance(problem: Problem, knots: Motion, fine: Motion) -> list[Check]:
    """Eq. 17 on the rows that the grasps serve; the other row, and all rows between knots, are only reported."""
    tolerance, team = problem.task.balance_tolerance, problem.team
    served = served_rows(team.agents, team.object, tolerance)
    moments = any(grasp.moments for grasp in team.grasps)
    other = None if moments else team.object.unserved_row()
    labels = [f"{knots.object.name} {row}" for row in BALANCE_ROWS]
    pick = [labels[r] for r in served]
    excess = np.maximum(np.abs(knots.object.wrench[:, served]) - tolerance, 0.0)
    between = np.abs(fine.object.wrench[:, served])
    checks = [
        _worst("balance at the knots", excess, AT_KNOTS, "SI", pick, knots.time),
        _worst("balance between knots", between, np.inf, "SI", pick, fine.time),
    ]
    if other is not None:
        unserved = np.abs(fine.object.wrench[:, [other]])
        checks.append(_worst("unserved moment", unserved, np.inf, "Nm", [labels[other]], fine.time))
    return checks


def _limits(problem: Problem, motion: Motion, limit: float, suffix: str) -> list[Check]:
    """Eqs. 11, 12, 14, 15 and the limits on speed and grasp force: how far each is exceeded."""
    task, lifted, names = problem.task, motion.object, [f"{motion.object.name} {c}" for c in OBJECT_COORDINATES]
    position, speed, torque, force = [], [], [], []
    for agent in motion.agents:
        q, v, tau = (values[:, agent.moving] for values in (agent.q, agent.v, agent.tau))
        bounds = agent.limits
        position.append(np.maximum(bounds.q_lower - q, q - bounds.q_upper))
        speed.append(np.abs(v) - bounds.velocity)
        torque.append(np.maximum(bounds.tau_lower - tau, tau - bounds.tau_upper))
        force.append(np.linalg.norm(agent.grasp_force, axis=2) - task.max_grasp_force)
    joints = [name for agent in motion.agents for name in agent.moving_joints]
    position.append(np.maximum(task.pose_lower - lifted.pose, lifted.pose - task.pose_upper))
    speed.append(np.abs(lifted.pose_velocity) - task.pose_velocity)
    grasps = [grasp.name for _, _, _, grasp in grasps_of(motion.agents)]
    unit = "SI" if any(agent.sliding[agent.moving].any() for agent in motion.agents) else "Nm"
    checks = [
        _worst("position limits", np.hstack(position), limit, "SI", joints + names, motion.time),
        _worst("speed limits", np.hstack(speed), limit, "SI", joints + names, motion.time),
        _worst("torque limits", np.hstack(torque), limit, unit, joints, motion.time),
        _worst("grasp force cap", np.hstack(force), limit, "N", grasps, motion.time),
    ]
    for model, trajectory in zip(problem.team.agents, motion.agents, strict=True):
        if model.workspace is not None:
            short = model.workspace.offset - trajectory.grasp_position @ model.workspace.normal
            names = [grasp.name for grasp in model.grasps]
            checks.append(_worst("grasp in front", short, limit, "m", names, motion.time))
    checks += _holds(motion, limit)
    for model, trajectory in zip(problem.team.agents, motion.agents, strict=True):
        checks += _soles(model, trajectory, limit, motion.time)
        if model.lean is not None:
            beyond = np.cos(model.lean.most) - 1.0 + trunk_tilt(model, trajectory.q)
            checks.append(_worst("lean of the trunk", beyond[:, None], limit, "1 - cos", [model.name], motion.time))
        if model.disc is not None:
            load = load_through(model, trajectory, model.disc.upright, model.disc.place)
            excess = load.compression[:, None] - model.disc.most
            checks.append(_worst(COMPRESSION, excess, limit, "N", [model.name], motion.time))
    # np.maximum lets a NaN through where max would hide it.
    return [Check(c.name + suffix, float(np.maximum(0.0, c.value)), c.limit, c.unit, c.where) for c in checks]


def _holds(motion: Motion, limit: float) -> list[Check]:
    """Limits of grasps that transmit more than a force at a point: moment, angle on the object, friction."""
    checks, rotation = [], attitude(motion.object.pose[:, 3:])[0]
    for _, agent, own, grasp in grasps_of(motion.agents):
        force, moment = agent.grasp_force[:, own], agent.grasp_moment[:, own]
        if grasp.moments:
            excess = np.linalg.norm(moment, axis=1) - grasp.max_moment
            checks.append(_worst("grasp moment cap", excess[:, None], limit, "Nm", [grasp.name], motion.time))
            angle = hand_turn(grasp, rotation, agent.grip_rotation[:, own]) - grasp.max_turn
            checks.append(_worst("hand on the object", angle[:, None], limit, "rad", [grasp.name], motion.time))
        back = rotation.swapaxes(1, 2)
        local = np.hstack([turned(back, force), turned(back, moment)])
        for rows in flat_hand_rows(grasp):
            worst, unit = -rows.room(local), "N" if rows.name == "friction" else "Nm"
            ways = [f"{grasp.name} {label}" for label in rows.labels]
            checks.append(_worst(f"{rows.name} of the hand", worst, limit, unit, ways, motion.time))
    return checks


def _soles(model: Agent, trajectory: AgentTrajectory, limit: float, time: Array) -> list[Check]:
    """Both feet of one who stands stay on the floor: friction, and the centre of pressure within the soles."""
    if model.stance is None:
        return []
    ground, (friction, pressure) = ground_in_base(model, trajectory), sole_rows(model.stance)
    bears = np.maximum(ground[:, [2]], 1.0)  # [N]: one who is in the air has no centre of pressure, and slips anyhow
    names = ([f"{model.name} {label}" for label in rows.labels] for rows in (friction, pressure))
    return [
        _worst("friction of the soles", -friction.room(ground), limit, "N", next(names), time),
        _worst("pressure under the soles", -pressure.room(ground) / bears, limit, "m", next(names), time),
    ]


def _clearance(problem: Problem, motion: Motion, obstacles: Sequence[Solid], clearance: float) -> Check:
    """How much nearer than asked two solids come, by coal."""
    team = problem.team
    agents, lifted = list(zip(team.agents, motion.agents, strict=True)), (team.object, motion.object)
    pairs = solid_pairs(team.agents, team.object, obstacles)
    near = pairs_nearby(motion.time, agents, lifted, pairs, clearance)
    short = [item.pair.asked(clearance) - item.distance for item in near]
    if max(short, default=0.0) <= 0.0:
        return Check("clearance", 0.0, TOUCH, "m", "")
    worst = near[int(np.argmax(short))]
    return Check("clearance", max(short), TOUCH, "m", f"{worst.pair.told} at {worst.time:.2f} s")


def _ends(problem: Problem, spline: RestToRestSpline, motion: Motion) -> list[Check]:
    """Eqs. 18 and 19: rest at both ends as asked, the object's pose where the task fixes it."""
    ends, task, lifted = [0, -1], problem.task, motion.object
    labels = [name for agent in motion.agents for name in agent.joint_names]
    labels += [f"{lifted.name} {c}" for c in OBJECT_COORDINATES]
    speed = np.hstack([*(agent.v[ends] for agent in motion.agents), lifted.pose_velocity[ends]])
    acceleration = np.hstack([*(agent.a[ends] for agent in motion.agents), lifted.pose_acceleration[ends]])
    still = AT_ENDS if spline.rest == "acceleration" else np.inf
    wanted = np.stack([task.start, task.end])
    off = np.where(np.isnan(wanted), 0.0, np.abs(lifted.pose[ends] - wanted))
    time = motion.time[ends]
    return [
        _worst("speed at the ends", np.abs(speed), AT_ENDS, "SI", labels, time),
        _worst("acceleration at the ends", np.abs(acceleration), still, "SI", labels, time),
        _worst("pose at the ends", off, AT_KNOTS, "SI", labels[-len(OBJECT_COORDINATES) :], time),
    ]


def _objective(problem: Problem, motion: Motion, result: SolverResult) -> Check:
    """The solver's objective against Pinocchio's torques: a wrong kernel would show here."""
    terms, weights = objective_terms(problem, motion), objective_weights(problem)
    ours = sum(weights[name] * value for name, value in terms.items())
    error = abs(ours - result.objective) / max(1.0, abs(ours))
    return Check("objective by Pinocchio", error, OBJECTIVE, "relative", "")


def _worst(name: str, values: Array, limit: float, unit: str, labels: list[str], time: Array) -> Check:
    """Return the check of the largest entry of ``values`` (times, labels); a NaN is the largest."""
    flat = np.where(np.isnan(values), np.inf, values)
    k, j = np.unravel_index(int(np.argmax(flat)), flat.shape)
    return Check(name, float(values[k, j]), limit, unit, f"{labels[j]} at {time[k]:.2f} s")
