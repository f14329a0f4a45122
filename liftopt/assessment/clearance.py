"""Whether bodies keep apart: the smallest distances by kind of pair, and room for the fingers under the object."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from liftopt.assessment.who import HANDS, whose
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.build import obstacles_of
from liftopt.scenario.grasps import grasp_points
from liftopt.scenario.task import GraspPlace
from liftopt.solution.checks import TOUCH
from liftopt.solution.clearance import WITHIN_BODIES, Clearance, PairClearance
from liftopt.solution.finding import CLEARANCE, INFO, PERSON, VERDICT, WARNING, Finding
from liftopt.solution.solution import Solution
from liftopt.types import Array

MOST_OF_KIND = 3  # pairs of a kind that are told one by one
NO_GAP = 5e-5  # [m]: would be told as 0.0 mm
FINGERS = 0.025  # [m] below an edge, for the fingers that hold it there; chosen for this model
SOURCE = "distances by coal between the collision shapes of the exported models, ten times a mesh interval"
NO_SAFETY = (
    "This is the distance of a predicted motion. ISO/TS 15066 is about how hard a robot may press or hit a person, and "
    "how far it must keep when it cannot stop in time; neither is assessed here"
)


def clearance_findings(fine: Solution, clearance: Clearance) -> Iterator[Finding]:
    """Give the smallest distance of each kind of pair, what overlaps, and where fingers have no room."""
    limit = fine.scenario.limits.clearance
    if limit is None:
        yield _off(clearance)
    for kind in clearance.kinds:
        near = [item for item in clearance.closest if item.pair.kind == kind.kind]
        wrong = [item for item in near if item.distance < item.pair.asked(limit or 0.0) - TOUCH]
        for item in wrong[:MOST_OF_KIND] or near[:1]:
            yield _distance(clearance, item, limit, bool(wrong), len(wrong) - MOST_OF_KIND)
    yield from _fingers(fine)


def clearance_verdict(findings: Sequence[Finding]) -> Finding:
    """Return the verdict on clearance: as grave as the gravest finding, and what that is."""
    wrong = [finding.title for finding in findings if finding.severity == WARNING]
    if wrong:
        return Finding(f"{VERDICT}.{CLEARANCE}", WARNING, "warning", f"Warning for clearance: {'; '.join(wrong)}.")
    between = [item for item in findings if item.value is not None and item.code not in map(_code, WITHIN_BODIES)]
    told = min(between, key=lambda item: item.value or 0.0).title if between else "none comes near another"
    return Finding(f"{VERDICT}.{CLEARANCE}", INFO, "bodies keep apart", f"Bodies keep apart; the nearest: {told}.")


def _code(kind: str) -> str:
    return f"{CLEARANCE}.{kind.replace('-', '_')}"


def _off(clearance: Clearance) -> Finding:
    nearest = clearance.smallest
    deep = nearest is not None and nearest.distance < -TOUCH
    text = "Clearance is off: nothing keeps bodies apart, and a predicted motion may pass through something"
    text += f"; here {_near(nearest)}" if nearest is not None and deep else "; here none does"
    source = "limits.clearance of the scenario"
    return Finding(f"{CLEARANCE}.off", WARNING, "clearance is off", f"{text}.", source=source)


def _distance(clearance: Clearance, item: PairClearance, limit: float | None, wrong: bool, more: int) -> Finding:
    kind = item.pair.kind
    near = _near(item)
    text = f"{near[0].upper()}{near[1:]} at {item.time:.2f} s"
    if wrong and limit and item.distance >= -TOUCH:
        text += f", less than limits.clearance of {_mm(limit)}"
    if wrong and more > 0:
        text += f"; {more} more pair{'s' if more > 1 else ''} of this kind with it"
    if kind == "person-robot":
        text += f". {_approach(clearance, kind)}. {NO_SAFETY}"
    return Finding(
        _code(kind),
        WARNING if wrong else INFO,
        near if wrong else f"{item.pair.told} {_apart(item)}",
        f"{text}.",
        time=item.time,
        value=item.distance,
        limit=None if limit is None else item.pair.asked(limit),
        unit="m",
        source=SOURCE,
    )


def _approach(clearance: Clearance, kind: str) -> str:
    """Return how fast what is nearest of a kind moves against each other."""
    found = clearance.of_kind(kind)
    assert found is not None
    closing = -np.gradient(found.distance, clearance.time)
    fast, near = int(np.argmax(found.speed)), int(np.argmax(closing))
    return (
        f"Their nearest points move against each other with {found.speed[fast]:.2f} m/s at most, at "
        f"{clearance.time[fast]:.2f} s, and come nearer with {max(closing[near], 0.0):.2f} m/s at most"
    )


def _near(item: PairClearance) -> str:
    """Return how near a pair comes, ``"table and shelf overlap by 12 mm"``."""
    if _touches(item):
        return f"{item.pair.told} touch"
    if item.distance < 0.0:
        return f"{item.pair.told} overlap by {_mm(-item.distance)}"
    return f"{item.pair.told} come as near as {_mm(item.distance)}"


def _apart(item: PairClearance) -> str:
    return "touching" if _touches(item) else f"{_mm(item.distance)} apart"


def _touches(item: PairClearance) -> bool:
    return abs(item.distance) < NO_GAP


def _mm(length: float) -> str:
    """Return a length in millimetres, with a digit more where it is small."""
    return f"{1e3 * length:.1f} mm" if length < 0.01 else f"{1e3 * length:.0f} mm"


def _fingers(fine: Solution) -> Iterator[Finding]:
    """Give where the fingers of a hand that holds the object from below have no room at one end of the lift."""
    under, points = -fine.scenario.object.height / 2.0, grasp_points(fine.scenario)
    for person in fine.persons:
        below_it = [i for i, grasp in enumerate(person.grasps) if abs(points[grasp.name][2] - under) <= TOUCH]
        if not below_it:
            continue
        for k, end in ((0, "start"), (-1, "end")):
            room, below = min(_room(fine, person, i, k) for i in below_it)
            if room >= FINGERS:
                continue
            hand, name = f"{whose(person.name)} {HANDS[PERSON]}", fine.object.name
            text = f"At the {end} {hand} holds the {name} from below, {_mm(max(room, 0.0))} above the {below}"
            height = "height" if isinstance(getattr(fine.scenario.task, end), GraspPlace) else "z"
            yield Finding(
                f"{CLEARANCE}.fingers",
                WARNING,
                f"no room for fingers above the {below} at the {end}",
                f"{text}; fingers take some {_mm(FINGERS)}. Raise task.{end}.{height}, or hold it elsewhere with "
                "object.grasps.",
                person.name,
                time=float(fine.time[k]),
                value=room,
                limit=FINGERS,
                unit="m",
                source="room below a bottom edge, chosen for this model",
            )


def _room(fine: Solution, person: AgentTrajectory, which: int, k: int) -> tuple[float, str]:
    """Return the room below a grasp point [m] at a time, above the floor or an obstacle, and which."""
    point, breadth = person.grasp_position[k, which], person.grasps[which].breadth
    room, below = float(point[2]), "floor"
    for obstacle in obstacles_of(fine.scenario):
        T_world_box, half = obstacle.T_joint_solid, np.array(obstacle.size) / 2.0
        own: Array = T_world_box[:3, :3].T @ (point - T_world_box[:3, 3])
        over = bool((np.abs(own[:2]) <= half[:2] + breadth / 2.0).all())
        if over and -half[2] < own[2] and own[2] - half[2] < room:
            room, below = float(own[2] - half[2]), obstacle.told
    return room, below
