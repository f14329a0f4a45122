"""What passes through the grasps: forces at their cap, hands that work against each other, and the object's tilt."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from liftopt.assessment.joints import ALL_ALONG, AT_LIMIT
from liftopt.assessment.who import Who, hand_of, listed, who_is
from liftopt.multibody.trajectory import GRAVITY, AgentTrajectory
from liftopt.solution.finding import CAUTION, INFO, PERSON, WARNING, Finding
from liftopt.solution.grasp_loads import shares, squeeze
from liftopt.solution.solution import Solution


def cap_findings(fine: Solution, agent: AgentTrajectory, who: Who) -> Iterator[Finding]:
    """Give the largest force of each of an agent's grasps, and its largest moment if it has any, beside their caps."""
    caps = []
    for own, grasp in enumerate(agent.grasps):
        hand, cap = hand_of(grasp.name, who), fine.scenario.limits.max_grasp_force
        caps.append((hand, "force", agent.grasp_force[:, own], cap, "N", "limits.max_grasp_force"))
        if grasp.moments:
            key = f"{agent.name}.max_grasp_moment"
            caps.append((hand, "moment", agent.grasp_moment[:, own], grasp.max_moment, "Nm", key))
    for hand, what, vectors, cap, unit, key in caps:
        size = np.linalg.norm(vectors, axis=1)
        k, at = int(np.argmax(size)), size >= (1 - AT_LIMIT) * cap
        whose = f"The {hand}'s {what}" if who.is_alone else f"The {what} of {who.name}'s {hand}"
        title = f"grasp {what}" if len(agent.grasps) == 1 else f"{what} of the {hand}"
        text = f"{whose} is {size[k]:.3g} {unit} at most, at {fine.time[k]:.2f} s"
        if at.any():
            text += (
                f", its cap, for {100 * at.mean():.0f} % of the lift: only {key} = {cap:g} {unit} holds it back, and "
                "the motion rests on that choice"
            )
        yield Finding(
            f"{who.subject}.grasp_{what}",
            WARNING if size[k] > (1 + AT_LIMIT) * cap else CAUTION if at.any() else INFO,
            f"{title} at its cap" if at.any() else f"{title} up to {size[k]:.3g} {unit}",
            f"{text}.",
            agent.name, None, float(fine.time[k]), float(size[k]), float(cap), unit, f"{key} of the scenario",
        )  # fmt: skip


def squeeze_finding(fine: Solution, person: AgentTrajectory) -> Finding:
    """Return how hard a person's hands and all others work against each other.

    More than the object weighs is a warning.
    """
    squeezed = squeeze(fine.agents, person.name)
    k, weight = int(np.argmax(np.abs(squeezed))), fine.scenario.object.mass * GRAVITY
    peak, name = abs(float(squeezed[k])), fine.object.name
    verb = f"press the {name} together" if squeezed[k] > 0 else f"pull the {name} apart"
    than = f"{'' if peak > weight else 'not '}more than its weight of {weight:.0f} N"
    text = f"{_pair(fine, person)} {verb} with {peak:.0f} N at {fine.time[k]:.2f} s, {than}."
    if peak > weight:
        text += " That lifts nothing, and few would do it unasked; a higher objective.force_weight lowers it."
    return Finding(
        f"{PERSON}.squeeze",
        WARNING if peak > weight else INFO,
        f"hands against each other with {peak:.0f} N",
        text,
        person.name, None, float(fine.time[k]), peak, float(weight), "N", f"weight of the {name}",
    )  # fmt: skip


def _pair(fine: Solution, person: AgentTrajectory) -> str:
    """Return a person's hands and those that they work against, as the first words of a sentence."""
    hands = "hands" if len(person.grasps) > 1 else "hand"
    if len(fine.persons) == len(fine.robots) == 1:
        return f"{hands.capitalize()} and gripper"
    called = {agent.name: who_is(agent, fine.agents).called for agent in fine.agents}
    own = called.pop(person.name)
    if not called:
        return f"The hands of {own}"
    return f"The {hands} of {own} and {'that' if len(called) == 1 else 'those'} of {listed(called.values())}"


def share_finding(fine: Solution, person: AgentTrajectory, who: Who) -> Finding:
    """Return which part of the load a person carries; that one presses down what others lift is a caution.

    From the object's weight on it is a warning, as a squeeze is.
    """
    share = shares(fine.agents)[[agent.name for agent in fine.agents].index(person.name)]
    source = f"vertical grasp force over that of {'both' if len(fine.agents) == 2 else 'all'}"
    if not np.isfinite(share).any():
        text = "There is no load to share."
        return Finding(f"{PERSON}.load_share", INFO, "no load to share", text, person.name, source=source)
    if len(fine.agents) == 1:
        title = "carries the load alone"
        text = f"The {who.told} {title}."
        return Finding(
            f"{PERSON}.load_share", INFO, title, text, person.name, value=1.0, unit="share of the vertical force",
            source="nobody else holds it",
        )  # fmt: skip
    k, low = int(np.nanargmax(share)), 100 * float(np.nanmin(share))
    up = np.stack([agent.load[:, 2] for agent in fine.agents])
    down, weight = -float(np.where(up.sum(axis=0) > 0.0, up, 0.0).min()), fine.scenario.object.mass * GRAVITY
    name, against = fine.object.name, down > AT_LIMIT * weight
    lift = "the other lifts" if len(fine.agents) == 2 else "others lift"
    pressed = f"; one of them presses the {name} down with up to {down:.0f} N while {lift}" if against else ""
    title = f"carries {low:.0f} to {100 * share[k]:.0f} % of the load, {100 * np.nanmean(share):.0f} % on average"
    return Finding(
        f"{PERSON}.load_share",
        WARNING if down > weight else CAUTION if against else INFO,
        title,
        f"The {who.told} {title}; most at {fine.time[k]:.2f} s{pressed}.",
        person.name,
        value=float(share[k]),
        unit="share of the vertical force",
        source=source,
    )


def tilt_findings(fine: Solution) -> Iterator[Finding]:
    """Give where the object's tilt is at its limit."""
    limits, pose, name = fine.scenario.limits, np.degrees(fine.object.pose), fine.object.name
    for column, way, limit in ((4, "pitch", limits.table_pitch_deg), (5, "yaw", limits.table_yaw_deg)):
        tilt = np.abs(pose[:, column])
        k, part = int(np.argmax(tilt)), float((tilt >= (1 - AT_LIMIT) * limit).mean())
        if not part or limit <= 0:
            continue
        along = part >= ALL_ALONG
        yield Finding(
            "object.tilt",
            CAUTION if along else INFO,
            f"{name}'s {way} at its limit",
            f"The {name}'s {way} is at its limit of {limit:g} deg for {100 * part:.0f} % of the lift"
            + (", all along: it shapes the whole prediction." if along else "."),
            time=float(fine.time[k]),
            value=float(np.radians(tilt[k])),
            limit=float(np.radians(limit)),
            unit="rad",
            source=f"limits.table_{way}_deg of the scenario",
        )
