"""What is said of clearance: oracle is the measured distances, and cases put into a solved lift."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.assessment.assess import assessed
from liftopt.assessment.clearance import FINGERS, clearance_findings
from liftopt.assessment.text import verdict_text
from liftopt.solution.finding import Finding
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution

# Under the middle of the table where the lift begins, 0.4 m wide; the hand is at 0.4 m, the edge at 0.9 m.
SHELF: dict[str, Any] = {"name": "shelf", "box": [0.3, 0.4, 0.02], "position": [0.65, 0.0, 0.87]}
IN_THE_WAY = SHELF | {"name": "beam", "position": [0.65, 0.0, 1.1]}


def _with(solution: Solution, **changes: Any) -> Solution:
    """Return the same motion, judged in another scenario."""
    keys = {key.replace("__", "."): value for key, value in changes.items()}
    return assessed(replace(solution, scenario=solution.scenario.replace(keys)))


def _of(solution: Solution, code: str) -> list[Finding]:
    return [finding for finding in solution.assessment if finding.code == f"clearance.{code}"]


@pytest.fixture(scope="module")
def clear(light: Solution) -> Solution:
    """Return the default lift with nothing in the way, and no forearm that is under the table's edge."""
    object_above = light.object.pose.copy()
    object_above[:, 2] += 0.3
    return assessed(replace(light, object=replace(light.object, pose=object_above)))


def test_every_kind_of_pair_is_told_with_its_smallest_distance(light: Solution) -> None:
    assert light.clearance is not None
    for kind in light.clearance.kinds:
        first = _of(light, kind.kind.replace("-", "_"))[0]
        closest = light.clearance.closest_of(kind.kind)
        assert closest is not None
        assert (first.value, first.time, first.unit) == (closest.distance, closest.time, "m")
        assert closest.pair.told in first.title


def test_what_overlaps_is_the_first_warning(light: Solution) -> None:
    judged = _with(light, obstacles=[IN_THE_WAY])
    first = judged.assessment[0]
    assert (first.code, first.severity) == ("verdict.clearance", "warning")
    assert next(finding for finding in judged.assessment[4:]).subject == "clearance"
    (beam, *_) = [finding for finding in _of(judged, "object_obstacle") if finding.severity == "warning"]
    assert beam.value is not None and beam.value < -0.01
    assert beam.title.startswith("table and beam overlap by ")
    assert beam.title in first.message
    text = verdict_text(judged, None).splitlines()
    assert text[0].startswith("table5: WARNING for clearance")
    assert next(line for line in text if line.startswith(("Person", "Robot", "Solve", "Clear"))) == "Clearance: WARNING"


def test_less_than_asked_is_a_warning_too_and_the_limit_is_told(clear: Solution) -> None:
    assert clear.clearance is not None
    between = clear.clearance.between_bodies
    assert between is not None
    least = float(between.distance.min())
    assert least > 0.0
    (kind,) = {clear.clearance.pairs[between.pair[int(np.argmin(between.distance))]].kind}
    asked = _with(clear, limits__clearance=least + 0.01)
    found = _of(asked, kind.replace("-", "_"))[0]
    assert found.severity == "warning"
    assert f"less than limits.clearance of {1e3 * (least + 0.01):.0f} mm" in found.message
    assert found.limit == least + 0.01


def test_off_is_the_first_warning_of_all(clear: Solution) -> None:
    off = _with(clear, limits__clearance="off")
    assert [finding.code for finding in off.assessment[:5]][::4] == ["verdict.clearance", "clearance.off"]
    assert off.assessment[4].severity == "warning"
    assert "limits.clearance" in off.assessment[4].source


def test_clear_bodies_are_told_in_one_verdict(clear: Solution) -> None:
    verdict = clear.assessment.verdict("clearance")
    assert clear.clearance is not None and clear.clearance.between_bodies is not None
    least = float(clear.clearance.between_bodies.distance.min())
    assert (verdict.severity, verdict.title) == ("info", "bodies keep apart")
    assert f"{1e3 * least:.0f} mm apart" in verdict.message
    assert "Clearance: bodies keep apart" in verdict_text(clear, None).splitlines()


def test_what_touches_is_told_without_a_number(clear: Solution) -> None:
    """An object that rests on an obstacle at the start is nowhere nearer."""
    dense = clear.clearance
    assert dense is not None
    (item, *others) = dense.closest
    for distance in (-1e-5, 1e-5):
        judged = list(clearance_findings(clear, replace(dense, closest=(replace(item, distance=distance), *others))))
        told = next(finding for finding in judged if finding.title.startswith(item.pair.told))
        assert told.title == f"{item.pair.told} touching"
        assert f"{item.pair.told} touch at {item.time:.2f} s".lower() in told.message.lower()


def test_person_and_robot_have_distance_and_speed_and_no_claim_of_safety(light: Solution) -> None:
    assert light.clearance is not None
    found = light.clearance.of_kind("person-robot")
    assert found is not None
    (told,) = _of(light, "person_robot")
    assert f"{found.speed.max():.2f} m/s at most" in told.message
    closing = float((-np.gradient(found.distance, light.clearance.time)).max())
    assert f"come nearer with {closing:.2f} m/s at most" in told.message
    assert "ISO/TS 15066" in told.message and "neither is assessed here" in told.message
    assert "safe" not in told.message


@pytest.mark.parametrize(("top", "room"), [(0.89, 0.01), (0.87, 0.03)])
def test_fingers_under_the_edge_need_room(light: Solution, top: float, room: float) -> None:
    under = {"name": "stand", "box": [0.6, 0.4, 0.1], "position": [0.6, 0.0, top - 0.05]}
    found = _of(_with(light, obstacles=[under]), "fingers")
    fine = between_knots(light)
    assert fine["human"].p_world_hold[0, 2] == pytest.approx(0.9)
    if room >= FINGERS:
        assert not found
        return
    (start,) = found
    assert (start.severity, start.limit, start.time) == ("warning", FINGERS, 0.0)
    assert start.value == pytest.approx(room, abs=1e-6)
    assert "no room for fingers above the stand at the start" in start.title
    assert "task.start.height" in start.message


def test_elsewhere_there_is_no_finger_to_squeeze(light: Solution) -> None:
    beside = {"name": "stand", "box": [0.6, 0.4, 0.1], "position": [0.6, 1.0, 0.84]}
    above = {"name": "roof", "box": [0.6, 0.4, 0.1], "position": [0.6, 0.0, 1.9]}
    assert not _of(_with(light, obstacles=[beside, above]), "fingers")


def test_what_is_no_solution_has_none(light: Solution) -> None:
    failed = assessed(replace(light, outcome="time limit reached"))
    assert failed.assessment.verdict("clearance").severity == "error"
    assert not failed.assessment.about("clearance")
