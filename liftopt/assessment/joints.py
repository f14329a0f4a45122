"""Torque, speed and angle of an agent's joints against their limits, between the knots too."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from liftopt.assessment.who import Who
from liftopt.multibody.joint_units import JointUnits
from liftopt.multibody.trajectory import AgentTrajectory, limit_share
from liftopt.solution.finding import CAUTION, INFO, WARNING, Finding, percent
from liftopt.solution.solution import Solution

Directions = Mapping[tuple[str, int], str]

NEAR_LIMIT = 0.8  # share of a torque limit from which it is a caution
AT_LIMIT = 1e-3  # share of a limit, or of a range; closer than that is "at" it, farther beyond is exceeded
ALL_ALONG = 0.9  # share of the lift from which a limit is active "all along"


@dataclass(frozen=True)
class Words:
    """The words in which findings tell of an agent's joints.

    Attributes:
        who: whose they are.
        torque: the last part of the code for a torque.
        limit: whose limit on torque it is, ``"strength"`` or ``"torque limit"``.
        source: of the limits on speed, and of those that have none of their own.
        motions: what a joint does in its negative (-1) and positive (+1) direction, by name without the agent's.
        meanings: of joints whose motions have no names, likewise.
        torque_sources, range_sources: of the limits on torque and angle in these directions.
    """

    who: Who
    torque: str
    limit: str
    source: str
    motions: Directions = field(default_factory=dict)
    meanings: Mapping[str, str] = field(default_factory=dict)
    torque_sources: Directions = field(default_factory=dict)
    range_sources: Directions = field(default_factory=dict)


def joint_findings(fine: Solution, agent: AgentTrajectory, words: Words) -> Iterator[Finding]:
    """Give what is to be said of an agent's joints.

    Args:
        fine: the solution between its knots too.
        agent: one of its agents.
        words: for them.
    """
    yield from _torques(fine, agent, words)
    yield from _speeds(fine, agent, words)
    yield from _angles(fine, agent, words)


def _torques(fine: Solution, agent: AgentTrajectory, words: Words) -> Iterator[Finding]:
    share, tau, units = limit_share(agent), agent.tau[:, agent.moving], agent.units
    names, peaks = agent.moving_joints, share.max(axis=0)
    for row in map(int, np.argsort(-peaks)):
        k, name = int(np.argmax(share[:, row])), names[row]
        peak = float(share[k, row])
        if peak < NEAR_LIMIT and peak < peaks.max():
            continue
        sign = 1 if tau[k, row] >= 0 else -1
        joint = _joint(agent, name, sign, words)
        severity = WARNING if peak >= 1 - AT_LIMIT else CAUTION if peak >= NEAR_LIMIT else INFO
        near = 100 * float((share[:, row] >= NEAR_LIMIT).mean())
        beyond = "" if peak <= 1 + AT_LIMIT else ", more than there is: limits hold at the knots only"
        limit = agent.limits.tau_upper[row] if sign > 0 else -agent.limits.tau_lower[row]
        long = f"; above {100 * NEAR_LIMIT:.0f} % for {near:.0f} % of the lift" if near else ""
        yield Finding(
            f"{words.who.subject}.{words.torque}",
            severity,
            f"{joint} at {percent(peak)} % of its {_limit(words, units[row])}",
            f"{_first(joint, words)} takes {abs(tau[k, row]):.3g} {units[row].tau} at {fine.time[k]:.2f} s, "
            f"{percent(peak)} % of its {_limit(words, units[row])} of {limit:.3g} {units[row].tau}{beyond}{long}.",
            agent.name, name, float(fine.time[k]), abs(float(tau[k, row])), float(limit), units[row].tau,
            words.torque_sources.get((_short(agent, name), sign), words.source),
        )  # fmt: skip


def _speeds(fine: Solution, agent: AgentTrajectory, words: Words) -> Iterator[Finding]:
    share = np.abs(agent.v[:, agent.moving]) / agent.limits.velocity
    largest = int(np.argmax(share.max(axis=0)))
    for row, name in enumerate(agent.moving_joints):
        k, unit = int(np.argmax(share[:, row])), agent.units[row]
        peak, limit = float(share[k, row]), float(agent.limits.velocity[row] * unit.factor)
        if peak < 1 - AT_LIMIT and row != largest:
            continue
        joint = _joint(agent, name, 0, words)
        part = float((share[:, row] >= 1 - AT_LIMIT).mean())
        severity = WARNING if peak > 1 + AT_LIMIT else CAUTION if peak >= 1 - AT_LIMIT else INFO
        yield Finding(
            f"{words.who.subject}.speed",
            severity,
            f"{joint} at {percent(peak)} % of its speed limit",
            f"{_first(joint, words)} {unit.move} at up to {peak * limit:.0f} {unit.shown}/s at {fine.time[k]:.2f} s, "
            f"{percent(peak)} % of its speed limit{_along(part)}.",
            agent.name, name, float(fine.time[k]), peak * float(agent.limits.velocity[row]),
            float(agent.limits.velocity[row]), unit.v, words.source,
        )  # fmt: skip


def _angles(fine: Solution, agent: AgentTrajectory, words: Words) -> Iterator[Finding]:
    factor, limits = np.array([unit.factor for unit in agent.units]), agent.limits
    q, low, high = (values * factor for values in (agent.q[:, agent.moving], limits.q_lower, limits.q_upper))
    for row, (name, unit) in enumerate(zip(agent.moving_joints, agent.units, strict=True)):
        margin = AT_LIMIT * (high[row] - low[row])
        ends = (limits.q_lower[row], low[row] - q[:, row]), (limits.q_upper[row], q[:, row] - high[row])
        for sign, (limit, beyond) in zip((-1, 1), ends, strict=True):
            k, at = int(np.argmax(beyond)), beyond >= -margin
            if not at.any():
                continue
            joint, exceeded = _joint(agent, name, sign, words), bool(beyond[k] > margin)
            part = float(at.mean())
            severity = WARNING if exceeded else CAUTION if part >= ALL_ALONG else INFO
            where = f"{beyond[k]:.2g} {unit.shown} beyond" if exceeded else "at"
            yield Finding(
                f"{words.who.subject}.range",
                severity,
                f"{joint} {where} the end of its range",
                f"{_first(joint, words)} comes to {round(q[k, row], 1) + 0.0:.1f} {unit.shown}, {where} the end of its "
                f"range{_along(part)}.",
                agent.name, name, float(fine.time[k]), float(agent.q[k, agent.moving][row]), float(limit), unit.q,
                words.range_sources.get((_short(agent, name), sign), words.source),
            )  # fmt: skip


def _limit(words: Words, units: JointUnits) -> str:
    """Return whose limit on effort it is; a joint that slides has one on force."""
    return words.limit.replace("torque", units.effort)


def _along(part: float) -> str:
    if part >= ALL_ALONG:
        return ", there all along: it shapes the whole prediction"
    return f", there for {100 * part:.0f} % of the lift" if part else ""


def _joint(agent: AgentTrajectory, name: str, sign: int, words: Words) -> str:
    """Return a joint in its user's words: the motion in a direction (0: none), and its name in the paper's tables."""
    short = _short(agent, name)
    motion = words.motions.get((short, sign)) or words.meanings.get(short, "")
    return f"{motion.removesuffix(' (-)').lstrip('-')} ({short})" if motion else short


def _first(joint: str, words: Words) -> str:
    """Return a joint as the first words of a sentence, and whose it is; a robot's names are written as they are."""
    return (joint[0].upper() + joint[1:] if words.motions else joint) + words.who.of


def _short(agent: AgentTrajectory, name: str) -> str:
    return name.removeprefix(f"{agent.name}_")
