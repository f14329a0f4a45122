"""What makes a lift impossible before any solve: out of reach, too weak, or too fast, by name and amount."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liftopt.assessment.who import whose_hold
from liftopt.collocation.layout import FORCE_SIZE, OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.task import OBJECT_COORDINATES
from liftopt.ergonomics.spine import load_through
from liftopt.multibody.trajectory import agent_trajectory
from liftopt.search.inverse_kinematics import InverseKinematics
from liftopt.search.postures import Posture, PostureSolver, distinct, seed_coordinates
from liftopt.search.reach_words import how_far_it_reaches
from liftopt.solution.infeasibility_report import InfeasibilityReason
from liftopt.types import Array

REACHED = 1e-4  # [m]
SEEDS, ITERATIONS = 24, 25
# Iterations from the nearest postures of all: stretched arms converge slowly.
MORE_ITERATIONS = 400
STRONGEST = 64.0
# A motion may begin or end falling, so that it takes somewhat less strength than holding still there.
RELIEF = 1.1
# Postures that differ by less in every joint [rad] are one; so many of them are tried further.
DIFFERENT, NEAREST = 0.1, 6
# At most so many exceeded limits are named.
NAMED = 3
# Ratio of the strengths at which the bisection ends.
PRECISION = 1.01
# A joint beyond its range by less than this is not named [rad, m].
NOTICEABLE = 0.01


def too_fast(problem: Problem) -> InfeasibilityReason | None:
    """Return how much longer the lift must last for the object's speed limit, or None if it lasts long enough."""
    task = problem.task
    # The speed limit bounds the step from each control point to the next; all steps together cover a share of the
    # distance at full speed.
    share = (1.0 / problem.mesh.slope[:, 1:].diagonal()).sum()
    needed = np.abs(task.end - task.start) / task.pose_velocity / share
    shortest = float(np.nanmax(needed))
    if shortest <= task.duration:
        return None
    which, lifted = OBJECT_COORDINATES[int(np.nanargmax(needed))], problem.team.object.name
    text = (
        f"too fast: the {lifted} would exceed its speed limit along {which}; "
        f"the lift must last at least {shortest:.2f} s, not {task.duration:g} s"
    )
    beyond = shortest / task.duration - 1.0
    return InfeasibilityReason("velocity", lifted, shortest - task.duration, "s", text, share=beyond)


def screen_ends(
    problem: Problem, seed: int, deadline: Deadline, solver: PostureSolver | None = None
) -> tuple[list[InfeasibilityReason], list[Posture]]:
    """Return what is in the way of holding the object still at each end, and the nearest posture of each.

    Args:
        problem: the lift.
        seed: of the random seeds.
        deadline: past which the search stops.
        solver: of static postures of the problem's team, to be used again; None: one is made.
    """
    solver = solver or PostureSolver(problem.team, problem.task)
    reasons: list[InfeasibilityReason] = []
    postures: list[Posture] = []
    for name, pose in (("start", problem.task.start), ("end", problem.task.end)):
        reason, posture = _screen_end(problem, solver, name, pose, np.random.default_rng(seed), deadline)
        postures.append(posture)
        if reason is not None:
            when = 0.0 if name == "start" else problem.task.duration
            reasons.append(replace(reason, time=when, static=True))
    return reasons, postures


def _screen_end(
    problem: Problem, postures: PostureSolver, name: str, pose: Array, rng: np.random.Generator, deadline: Deadline
) -> tuple[InfeasibilityReason | None, Posture]:
    kinematics = postures.kinematics
    seeds = np.array([seed_coordinates(problem, pose, rng if i else None) for i in range(SEEDS)])
    reach = kinematics.reach(pose, seeds, deadline, most=ITERATIONS)
    if reach.shortfall.min() >= REACHED:
        promising = reach.coordinates[np.argsort(reach.shortfall)[:NEAREST]]
        reach = kinematics.reach(pose, promising, deadline, most=MORE_ITERATIONS)
    nearest = int(np.argmin(reach.shortfall))
    near = Posture(reach.coordinates[nearest], np.zeros(problem.layout.force.shape[1]), np.inf)
    if reach.shortfall.min() < REACHED:
        reached = list(reach.coordinates[reach.shortfall < REACHED])
        return _strength(problem, postures, name, pose, reached, deadline) or (None, near)
    if deadline.passed:
        return None, near
    again = np.vstack([reach.coordinates, seeds])
    beyond = kinematics.reach(pose, again, deadline, most=ITERATIONS, anywhere=True)
    closed = np.flatnonzero(beyond.gaps.max(axis=1) < REACHED)
    if len(closed):
        best = closed[np.argmin(np.maximum(beyond.outside, beyond.twisted)[closed].max(axis=1))]
        return _outside(problem, name, beyond.outside[best], beyond.twisted[best]), near
    gaps = reach.gaps[nearest]
    who = problem.team.grasps[int(np.argmax(gaps))].name
    whose = whose_hold(who, problem.team.agents)
    text = f"out of reach at the {name} of the lift: {whose} grasp stays {gaps.max():.3f} m short"
    text += how_far_it_reaches(problem, near.coordinates, int(np.argmax(gaps)))
    text += _range_of_motion(problem, kinematics, pose, again, deadline)
    return InfeasibilityReason("grasp_closure", who, float(gaps.max()), "m", text), near


def _outside(problem: Problem, name: str, outside: Array, twisted: Array) -> InfeasibilityReason:
    if twisted.max() > outside.max():
        grasp = problem.team.grasps[int(np.argmax(twisted))]
        limit, amount = grasp.max_turn, float(np.degrees(grasp.turn_beyond(twisted.max())))
        whose = whose_hold(grasp.name, problem.team.agents)
        text = f"held back at the {name} of the lift: {whose} hand would have to turn "
        text += f"{amount:.0f} deg farther on the object than the {np.degrees(limit):.0f} deg allowed"
        return InfeasibilityReason("grasp_turn", grasp.name, amount, "deg", text)
    who, amount = problem.team.grasps[int(np.argmax(outside))].name, float(outside.max())
    whose = whose_hold(who, problem.team.agents)
    text = f"held back at the {name} of the lift: {whose} grasp would lie {amount:.3f} m outside its half-space"
    return InfeasibilityReason("workspace", who, amount, "m", text)


def _range_of_motion(
    problem: Problem, kinematics: InverseKinematics, pose: Array, seeds: Array, deadline: Deadline
) -> str:
    """Return which joints would reach if they moved farther than they can, and how much; nothing if none would."""
    reach = kinematics.reach(pose, seeds, deadline, most=ITERATIONS, any_angle=True)
    closed = reach.shortfall < REACHED
    if not closed.any():
        return ""
    limits = [agent.limits for agent in problem.team.agents]
    lower, upper = (np.concatenate([getattr(limit, side) for limit in limits]) for side in ("q_lower", "q_upper"))
    q = reach.coordinates[closed, :-OBJECT_SIZE]
    beyond = np.maximum(0.0, np.maximum(lower - q, q - upper))
    least = beyond[np.argmin(beyond.sum(axis=1))]
    joints = [joint for agent in problem.team.agents for joint in agent.units.items()]
    told = [(*joints[j], least[j]) for j in np.argsort(-least) if least[j] > NOTICEABLE]
    parts = [f"{name} {units.factor * much:.0f} {units.shown}" for name, units, much in told]
    return f" (with {', '.join(parts)} beyond the range of motion it would reach)" if parts else ""


def _strength(
    problem: Problem, postures: PostureSolver, name: str, pose: Array, seeds: list[Array], deadline: Deadline
) -> tuple[InfeasibilityReason | None, Posture] | None:
    """Find by bisection how many times stronger agents and grasps must be to hold still there.

    Returns the posture that holds, with the reason why it is not allowed if it exceeds limits; None if nothing helps.
    """
    if posture := _hold(postures, pose, seeds[:NEAREST], deadline):
        return None, posture
    # Postures of little torque are near those that the limits allow, and found from nearly every seed without them.
    found = distinct(stronger(problem, STRONGEST).search(pose, seeds, deadline), DIFFERENT)
    if not found:
        return None
    found.sort(key=lambda posture: _tightest(problem, posture)[0])
    held, near = found[0], [posture.coordinates for posture in found[:NEAREST]]
    weak, strong = 1.0, _tightest(problem, held)[0]
    if strong > weak:
        if posture := _hold(postures, pose, near, deadline):
            return None, posture
        while strong / weak > PRECISION and not deadline.passed:
            middle = (weak * strong) ** 0.5
            # What holds with more strength is the best seed for less.
            posture = _hold(stronger(problem, middle), pose, [held.coordinates, *near], deadline)
            weak, strong, held = (weak, middle, posture) if posture else (middle, strong, held)
        if posture := _hold(postures, pose, [held.coordinates], deadline):
            return None, posture
    if strong <= 1.0 or deadline.passed:
        return None, held
    # A squeeze relieves some joints: the limits that are exceeded belong together.
    exceeded = sorted((use for use in _uses(problem, held) if use[0] > 1.0), reverse=True)
    if not exceeded:
        return None, held
    _, constraint, who = exceeded[0]
    words = {
        "torque": "the torque limit of",
        "grasp_force": "the grasp force cap of",
        "grasp_moment": "the grasp moment cap of",
        "compression": "the limit on the compression of the lumbar spine of",
    }
    shares = [strong, *(share for share, _, _ in exceeded[1:NAMED])]
    pairs = zip(shares, exceeded[:NAMED], strict=True)
    what = [f"{share:.2f} times {words[kind]} {whose}" for share, (_, kind, whose) in pairs]
    text = f"too weak at the {name} of the lift: holding still needs about {' and '.join(what)}"
    return InfeasibilityReason(constraint, who, strong, "times the limit", text, share=strong - 1.0), held


def _hold(postures: PostureSolver, pose: Array, seeds: list[Array], deadline: Deadline) -> Posture | None:
    """Return the first posture found that holds the object, or None if no seed leads to one."""
    return next(filter(None, postures.search(pose, seeds, deadline)), None)


def stronger(problem: Problem, factor: float) -> PostureSolver:
    """Return the search for postures with ``factor`` times the strength."""
    agents = []
    for agent in problem.team.agents:
        limits = agent.limits
        stronger = replace(limits, tau_lower=factor * limits.tau_lower, tau_upper=factor * limits.tau_upper)
        grasps = tuple(replace(grasp, max_moment=factor * grasp.max_moment) for grasp in agent.grasps)
        disc = agent.disc and replace(agent.disc, most=factor * agent.disc.most)
        agents.append(replace(agent, limits=stronger, grasps=grasps, disc=disc))
    task = replace(problem.task, max_grasp_force=factor * problem.task.max_grasp_force)
    return PostureSolver(replace(problem.team, agents=tuple(agents)), task)


def _tightest(problem: Problem, posture: Posture) -> tuple[float, str, str]:
    """Return how many times its limit is used by what leaves the least room in a posture, the constraint, and whose."""
    return max(_uses(problem, posture))


def _uses(problem: Problem, posture: Posture) -> list[tuple[float, str, str]]:
    """Return how many times each limit is used in a posture, the constraint, and whose."""
    candidates = []
    for i, agent in enumerate(problem.team.agents):
        q = posture.coordinates[None, problem.layout.columns(i)]
        wrench = problem.layout.wrenches(posture.force[None])[:, list(problem.layout.grasps_of(i))]
        force, moment = wrench[..., :FORCE_SIZE], wrench[..., FORCE_SIZE:]
        still = agent_trajectory(agent, q, 0 * q, 0 * q, force, moment)
        tau = still.tau[0, still.moving]
        share = np.where(tau > 0, tau / agent.limits.tau_upper, tau / agent.limits.tau_lower)
        candidates += [(float(s), "torque", joint) for s, joint in zip(share, agent.moving_joints, strict=True)]
        if agent.disc is not None:
            load = load_through(agent, still, agent.disc.upright, agent.disc.place)
            candidates.append((float(load.compression[0]) / agent.disc.most, "compression", agent.name))
        for f, m, grasp in zip(force[0], moment[0], agent.grasps, strict=True):
            candidates.append((float(np.linalg.norm(f)) / problem.task.max_grasp_force, "grasp_force", grasp.name))
            if grasp.moments:
                candidates.append((float(np.linalg.norm(m)) / grasp.max_moment, "grasp_moment", grasp.name))
    return candidates
