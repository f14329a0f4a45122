"""How the person's posture scores by RULA and REBA, and how the person with legs stands at the ends of the lift."""

from __future__ import annotations

from collections.abc import Iterator

from liftopt.assessment.who import Who
from liftopt.ergonomics.lifting_style import SOURCE as STYLE_SOURCE
from liftopt.ergonomics.lifting_style import LiftingStyle
from liftopt.ergonomics.measure import Measure
from liftopt.ergonomics.measures import Ergonomics
from liftopt.ergonomics.reba import reba_action
from liftopt.ergonomics.recorded_lifts import off_recorded_squat
from liftopt.ergonomics.rula import ACTION
from liftopt.ergonomics.scores import PostureScores
from liftopt.solution.finding import CAUTION, INFO, PERSON, WARNING, Finding

CHANGE, INVESTIGATE = 5, 3  # grand scores from which RULA asks for a change, and for a closer look
REBA_CHANGE, REBA_INVESTIGATE = 8, 4  # from which REBA calls the risk high, and medium
UPPER, ENTIRE = "posture", "whole_posture"  # codes of the two measures
FROM_FLOOR = 0.4  # [m] up to which hands lift from the floor
PARTS = {UPPER: ("upper_arm", "lower_arm", "wrist", "trunk"), ENTIRE: ("trunk", "legs", "upper_arm", "wrist")}


def posture_finding(who: Who, ergonomics: Ergonomics, measure: Measure) -> Finding:
    """Return what RULA or REBA says of a person's posture."""
    if measure.code == ENTIRE:
        assert ergonomics.reba is not None
        action, levels = reba_action(int(ergonomics.reba.grand.max())), (REBA_CHANGE, REBA_INVESTIGATE)
        return _scored(who, ergonomics.reba, measure, action, levels, 2)
    scores = ergonomics.rula
    return _scored(
        who, scores, measure, ACTION[int(scores.grand.max())], (CHANGE, INVESTIGATE), len(ergonomics.posture.arms)
    )


def _scored(
    who: Who, scores: PostureScores, measure: Measure, action: str, levels: tuple[int, int], arms: int
) -> Finding:
    """Return the finding on scores; ``levels`` are those from which they are a warning and a caution."""
    change, investigate = levels
    worst, parts, name = int(scores.grand.max()), scores.at(scores.worst), f"{measure.name} {measure.value:.0f}"
    side = f"{scores.side} " if arms > 1 else ""
    words = ", ".join(
        f"{side if 'arm' in part or part == 'wrist' else ''}{part.replace('_', ' ')} {parts[part]}"
        for part in PARTS[measure.code]
    )
    text = f"The posture{who.of} scores {name} {measure.unit} at {measure.time:.2f} s ({words}): {action}"
    if worst >= change:
        text += f"; {change} or more for {100 * float((scores.grand >= change).mean()):.0f} % of the lift"
    return Finding(
        f"{PERSON}.{measure.code}",
        WARNING if worst >= change else CAUTION if worst >= investigate else INFO,
        f"posture {name} {measure.unit}, {action}",
        f"{text}.",
        who.name, None, measure.time, measure.value, None, measure.unit, measure.source.told,
    )  # fmt: skip


def style_findings(who: Who, ergonomics: Ergonomics, height: float) -> Iterator[Finding]:
    """Give how a person with legs stands at the start and at the end of the lift.

    Args:
        who: how texts call them.
        ergonomics: theirs.
        height: of the middle between the hands at the start [m].
    """
    if ergonomics.styles is None:
        return
    start, end = ergonomics.styles
    told = "; ".join(f"at the {when} {_stance(style)}" for when, style in (("start", start), ("end", end)))
    ends = f"ends in {end.style}" if end.style != "upright" else "ends upright"
    begins = f"starts in {start.style}" if start.style != "upright" else "starts upright"
    title = f"{begins}, {ends}"
    yield Finding(
        f"{PERSON}.lifting_style",
        INFO,
        title,
        f"{who.called[0].upper()}{who.called[1:]} {title}: {told}.{_recorded(ergonomics, start, height)}",
        who.name,
        value=start.index,
        unit="postural index at the start",
        source=STYLE_SOURCE.told,
    )


def _recorded(ergonomics: Ergonomics, start: LiftingStyle, height: float) -> str:
    """Return how far a squat lift from the floor is off recorded ones; nothing of other lifts."""
    if start.style not in ("a squat", "a semi-squat") or height > FROM_FLOOR:
        return ""
    off = ", ".join(f"{name} {angle:+.0f}" for name, angle in off_recorded_squat(ergonomics.posture).items())
    return f" Off the means of seven men who squatted to lift from the floor, more bent positive [deg]: {off}."


def _stance(style: LiftingStyle) -> str:
    angles = f"knees {style.knee:.0f}, hips {style.hip:.0f}, trunk {style.inclination:.0f} deg from the vertical"
    return angles if style.style == "upright" else f"{angles} (postural index {style.index:.2f})"
