"""What the lift asks of the person: strength, posture, the lifting guides, and how far the limits can be trusted."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from liftopt.assessment.grasp import cap_findings, share_finding, squeeze_finding
from liftopt.assessment.joints import AT_LIMIT, NEAR_LIMIT, Words, joint_findings
from liftopt.assessment.posture import PARTS, posture_finding, style_findings
from liftopt.assessment.standing import standing_findings
from liftopt.assessment.who import Who
from liftopt.ergonomics.lift import subject_in
from liftopt.ergonomics.measure import Measure
from liftopt.ergonomics.measures import ergonomics_of
from liftopt.ergonomics.spine import SpineLoad
from liftopt.multibody.joint_meanings import joint_meanings
from liftopt.multibody.person.provenance import subject_quantities, whole_quantities
from liftopt.multibody.person.range_of_motion import RANGES, VELOCITY_SOURCE
from liftopt.multibody.person.strength import STRENGTHS
from liftopt.multibody.person.whole_joints import WHOLE_RANGES, WHOLE_STRENGTHS
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.solution.finding import CAUTION, INFO, PERSON, WARNING, Finding, percent
from liftopt.solution.solution import Solution

UNSURE = ("unverified", "estimate")


def person_findings(fine: Solution, person: AgentTrajectory, who: Who) -> Iterator[Finding]:
    """Give what is to be said of a person in a solution between its knots too; ``who`` is how texts call them."""
    ergonomics = ergonomics_of(fine, person)
    yield from joint_findings(fine, person, _words(who))
    for measure in ergonomics.measures:
        yield posture_finding(who, ergonomics, measure) if measure.code in PARTS else _guide(who, measure)
    yield from _spine_limit(fine, who, ergonomics.spine)
    yield from standing_findings(fine, person, who)
    yield from style_findings(who, ergonomics, float(person.p_world_hold[0, 2]))
    if fine.object.grasp_position.shape[1] > 1:
        yield squeeze_finding(fine, person)
    yield share_finding(fine, person, who)
    yield from cap_findings(fine, person, who)
    yield _data(fine, who)


def _words(who: Who) -> Words:
    strengths, every_range = (*STRENGTHS, *WHOLE_STRENGTHS), (*RANGES, *WHOLE_RANGES)
    motions = {(item.joint, item.sign): f"{_side(item.joint)}{item.motion}" for item in strengths}
    strength = {(item.joint, item.sign): item.source.told for item in strengths}
    ranges = {(item.joint, -1): item.lower_source.told for item in every_range}
    ranges |= {(item.joint, 1): item.upper_source.told for item in every_range}
    meanings = joint_meanings("person")
    return Words(who, "strength", "strength", VELOCITY_SOURCE.told, motions, meanings, strength, ranges)


def _side(joint: str) -> str:
    """Return ``"left "`` of ``"left_Q4"``, nothing of a joint that has no side."""
    side, separator, _ = joint.partition("_")
    return f"{side} " if separator else ""


def _guide(who: Who, measure: Measure) -> Finding:
    """Return what a lifting guide says; beyond its limit, or where it knows none, is a warning."""
    name, severity, title = measure.name, INFO, f"{measure.name} not evaluated"
    if measure.value is not None and measure.limit is None:
        severity, title = WARNING, f"{name}: no limit known to be safe for where the hand is"
    elif measure.value is not None and measure.limit is not None:
        used = max(0.0, measure.value / measure.limit)  # a hand that only pulls down lifts nothing
        severity = WARNING if used > 1.0 else CAUTION if used >= NEAR_LIMIT else INFO
        digits = 1 if measure.unit == "kg" else 0
        numbers = f"{measure.value:.{digits}f} of {measure.limit:.{digits}f} {measure.unit}"
        title = f"{percent(used)} % of the {name} ({numbers})"
    return Finding(
        f"{PERSON}.{measure.code}",
        severity,
        title,
        f"{name}{_for(who)} ({measure.scope}): {measure.result}. {measure.reading}",
        who.name, None, measure.time, measure.value, measure.limit, measure.unit, measure.source.told,
    )  # fmt: skip


def _spine_limit(fine: Solution, who: Who, load: SpineLoad) -> Iterator[Finding]:
    """Give how near the spine comes to the limit that the scenario sets, if it does."""
    most = fine.scenario.limits.spine_compression
    if most is None:
        return
    k = int(np.argmax(load.compression))
    peak, shapes = float(load.compression[k]), float(load.compression[k]) >= (1.0 - AT_LIMIT) * most
    how = "shapes the lift: without it the spine would be pressed more" if shapes else "does not shape the lift"
    yield Finding(
        f"{PERSON}.spine_limit",
        CAUTION if shapes else INFO,
        f"compression of the lumbar spine {'at' if shapes else 'below'} its limit ({peak:.0f} of {most:g} N)",
        f"The lumbar spine{who.of} is pressed with {peak:.0f} N at most, by the estimate with one muscle, and "
        f"limits.spine_compression allows {most:g} N. The limit {how}.",
        who.name, None, float(fine.time[k]), peak, most, "N", "limits.spine_compression of the scenario",
    )  # fmt: skip


def _for(who: Who) -> str:
    return "" if who.is_alone else f" for {who.name}"


def _data(fine: Solution, who: Who) -> Finding:
    stated = subject_quantities if fine[who.name].stance is None else whole_quantities
    strengths = [item for item in stated(subject_in(fine, who.name)) if item.group == "strength"]
    weak = [item for item in strengths if item.source.confidence in UNSURE]
    part = f"{len(weak)} of {len(strengths)} strength limits"
    return Finding(
        f"{PERSON}.strength_data",
        INFO,
        f"{part} not checked at their source",
        f"{part}{who.of} could not be checked at their source. They are typical values of the 50th percentile, not of "
        "one person; every share of strength inherits that.",
        who.name,
        value=float(len(weak)),
        source="; ".join(dict.fromkeys(item.source.told for item in weak)),
    )
