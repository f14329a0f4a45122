"""The assessment: oracle is arithmetic on the trajectories between the knots, and cases put into a solved lift."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.assessment.assess import assess
from liftopt.ergonomics.measures import ergonomics_of
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.solution.finding import Assessment, Finding
from liftopt.solution.infeasibility_report import InfeasibilityReason, SuggestedChange
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution

GRAVITY = 9.81


def _of(assessment: Assessment, code: str) -> list[Finding]:
    return [finding for finding in assessment if finding.code == code]


def _with_limits(solution: Solution, index: int, **limits: Any) -> Solution:
    """Return the solution with other limits of one agent, which the models it came from do not have."""
    agents = list(solution.agents)
    agents[index] = replace(agents[index], limits=replace(agents[index].limits, **limits))
    return replace(solution, agents=tuple(agents))


@pytest.fixture
def as_given(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take a solution for one between its knots already, with limits and forces that were put into it."""
    monkeypatch.setattr("liftopt.assessment.assess.between_knots", lambda solution: solution)


def test_four_verdicts_are_always_there_and_lead(light: Solution, heavy: Any) -> None:
    for solution in (light, heavy.solution, replace(light, outcome="time limit reached")):
        codes = [finding.code for finding in assess(solution)]
        assert sorted(codes[:4]) == ["verdict.clearance", "verdict.mathematics", "verdict.person", "verdict.robot"]
        assert not [code for code in codes[4:] if code.startswith("verdict")]


def test_the_gravest_comes_first(heavy: Any) -> None:
    assessment = heavy.solution.assessment
    ranks = [finding.rank for finding in assessment[4:]]
    assert ranks == sorted(ranks)
    assert assessment[0].severity == "warning"
    assert assessment.verdict("mathematics").severity == "info"


def test_a_lift_beyond_the_acgih_value_is_a_warning_for_the_person(heavy: Any) -> None:
    fine = between_knots(heavy.solution)
    load = (fine.agents[0].load[:, 2] / GRAVITY).max()
    (finding,) = _of(heavy.solution.assessment, "person.acgih")
    assert (finding.value, finding.limit) == (pytest.approx(load, rel=1e-12), 7.0)  # above the shoulder, 40 cm ahead
    assert finding.severity == "warning"
    assert f"{100 * load / 7.0:.0f} %" in finding.title
    assert "ACGIH" in heavy.solution.assessment.verdict("person").message


def test_payload_is_gripper_and_share_of_the_load(heavy: Any) -> None:
    fine = between_knots(heavy.solution)
    carried = 0.4 + (fine.agents[1].load[:, 2] / GRAVITY).max()
    (finding,) = _of(heavy.solution.assessment, "robot.payload")
    assert (finding.value, finding.limit) == (pytest.approx(carried, rel=1e-12), 4.0)
    assert finding.severity == "warning"


def _share(agent: AgentTrajectory) -> np.ndarray:
    tau = agent.tau[:, agent.moving]
    return np.maximum(tau / agent.limits.tau_upper, tau / agent.limits.tau_lower)


def test_peaks_are_those_between_the_knots(light: Solution) -> None:
    """Of a coarse mesh, some joint's torque is larger between its knots than at any of them."""
    fine = between_knots(light)
    share = _share(fine.agents[1])
    row = int(np.argmax(share.max(axis=0) / _share(light.agents[1]).max(axis=0)))
    assert share[:, row].max() > 1.001 * _share(light.agents[1])[:, row].max()
    (finding,) = [f for f in assess(light) if f.code == "robot.torque" and f.severity == "info"]
    worst = int(np.argmax(share.max(axis=0)))
    assert finding.value is not None and finding.limit is not None
    assert finding.value / finding.limit == pytest.approx(share[:, worst].max(), rel=1e-12)
    assert finding.time == pytest.approx(fine.time[np.argmax(share[:, worst])])
    assert finding.joint == np.array(fine.agents[1].joint_names)[fine.agents[1].moving][worst]


@pytest.mark.usefixtures("as_given")
@pytest.mark.parametrize(("share", "severity"), [(1.02, "warning"), (1.0, "warning"), (0.9, "caution")])
@pytest.mark.parametrize(("index", "code"), [(0, "person.strength"), (1, "robot.torque")])
def test_a_torque_at_its_limit_is_a_warning_and_near_it_a_caution(
    light: Solution, index: int, code: str, share: float, severity: str
) -> None:
    fine = between_knots(light)
    agent = fine.agents[index]
    row = int(np.argmax(_share(agent).max(axis=0)))
    scale = np.ones(_share(agent).shape[1])
    scale[row] = _share(agent)[:, row].max() / share
    limits = {name: getattr(agent.limits, name) * scale for name in ("tau_lower", "tau_upper")}
    assessment = assess(_with_limits(fine, index, **limits))
    finding = _of(assessment, code)[0]
    assert finding.severity == severity
    assert f"at {100 * share:.0f} % of its" in finding.title
    assert finding.joint == np.array(agent.joint_names)[agent.moving][row]
    assert assessment.verdict(code.partition(".")[0]).severity in ("warning", severity)


@pytest.mark.usefixtures("as_given")
@pytest.mark.parametrize(("share", "severity"), [(1.02, "warning"), (1.0, "caution")])
def test_speed_beyond_its_limit_is_a_warning(light: Solution, share: float, severity: str) -> None:
    fine = between_knots(light)
    robot = fine.agents[1]
    speed = np.abs(robot.v[:, robot.moving]).max(axis=0)
    limits = np.full(7, 100.0)
    limits[2] = speed[2] / share
    (finding,) = [
        f for f in assess(_with_limits(fine, 1, velocity=limits)) if f.code == "robot.speed" and f.severity != "info"
    ]
    assert (finding.joint, finding.severity) == ("robot_Q3", severity)
    assert finding.value == pytest.approx(speed[2], rel=1e-12)


@pytest.mark.usefixtures("as_given")
def test_an_angle_beyond_its_range_is_a_warning(light: Solution) -> None:
    fine = between_knots(light)
    upper = np.full(10, 10.0)
    upper[4] = fine.agents[0].q[:, 7].max() - 0.05
    (finding,) = [
        f for f in assess(_with_limits(fine, 0, q_upper=upper)) if f.code == "person.range" and f.severity == "warning"
    ]
    assert finding.joint == "human_Q5"
    assert finding.value is not None and finding.limit is not None
    assert finding.value - finding.limit == pytest.approx(0.05, abs=1e-9)


@pytest.mark.usefixtures("as_given")
def test_hands_against_each_other_are_a_warning_from_the_objects_weight_on(light: Solution) -> None:
    weight = 2.0 * GRAVITY
    for push, severity in ((1.05 * weight, "warning"), (0.95 * weight, "info"), (-1.05 * weight, "warning")):
        solution = _pressed(light, push)
        (finding,) = _of(assess(solution), "person.squeeze")
        assert (finding.severity, finding.limit) == (severity, pytest.approx(weight))
        assert finding.value == pytest.approx(abs(push), rel=1e-12)
        assert ("press the table together" if push > 0 else "pull the table apart") in finding.message


def _pressed(light: Solution, push: float) -> Solution:
    """Return the lift with forces of 10 N up from both and ``push`` along the line between the grasps."""
    line = light.agents[1].p_world_hold - light.agents[0].p_world_hold
    line = line / np.linalg.norm(line, axis=1, keepdims=True)
    agents = []
    for agent, sign in zip(light.agents, (1.0, -1.0), strict=True):
        along = sign * push * line
        up = np.cross(np.cross(line, [0.0, 0.0, 10.0]), line)
        agents.append(replace(agent, grasp_force=(along + up)[:, None]))
    return replace(light, agents=tuple(agents))


@pytest.mark.usefixtures("as_given")
@pytest.mark.parametrize(("down", "severity"), [(-5.0, "info"), (5.0, "caution"), (21.0, "warning")])
def test_one_who_presses_down_what_the_other_lifts_is_told(light: Solution, down: float, severity: str) -> None:
    """Of a table of 19.62 N one carries all and ``down`` on top, which the other presses down."""
    upward = np.array([0.0, 0.0, 1.0])
    agents = tuple(
        replace(agent, grasp_force=np.tile(force * upward, (len(light.time), 1, 1)))
        for agent, force in zip(light.agents, (2.0 * GRAVITY + down, -down), strict=True)
    )
    (finding,) = _of(assess(replace(light, agents=agents)), "person.load_share")
    assert finding.severity == severity
    assert finding.value == pytest.approx(1.0 + down / (2.0 * GRAVITY), rel=1e-12)
    assert (f"with up to {down:.0f} N" in finding.message) == (severity != "info")


@pytest.mark.usefixtures("as_given")
def test_grasp_force_at_its_cap_is_a_caution_and_beyond_it_a_warning(light: Solution) -> None:
    for agent, code in zip(light.agents, ("person.grasp_force", "robot.grasp_force"), strict=True):
        largest = float(np.linalg.norm(agent.load, axis=1).max())
        for cap, severity in ((largest, "caution"), (0.98 * largest, "warning"), (2.0 * largest, "info")):
            capped = replace(light, scenario=light.scenario.replace({"limits.max_grasp_force": cap}))
            (finding,) = _of(assess(capped), code)
            assert (finding.severity, finding.value) == (severity, pytest.approx(largest, rel=1e-12))


@pytest.mark.usefixtures("as_given")
def test_a_tilt_that_is_at_its_limit_all_along_is_told_from_one_that_is_touched(light: Solution) -> None:
    limit = np.radians(light.scenario.limits.table_pitch_deg)
    pose = light.object.pose.copy()
    pose[:, 4] = limit
    (always,) = _of(assess(replace(light, object=replace(light.object, pose=pose))), "object.tilt")
    touched = pose.copy()
    touched[2:, 4:] = 0.0
    touched[:2, 5] = 0.0
    (sometimes,) = _of(assess(replace(light, object=replace(light.object, pose=touched))), "object.tilt")
    assert (always.severity, sometimes.severity) == ("caution", "info")
    assert "all along" in always.message


def test_posture_is_as_grave_as_rula_says(light: Solution) -> None:
    fine = between_knots(light)
    worst = int(ergonomics_of(fine, fine["human"]).rula.grand.max())
    (finding,) = _of(light.assessment, "person.posture")
    assert finding.value == worst
    assert finding.severity == ("warning" if worst >= 5 else "caution" if worst >= 3 else "info")


def test_what_is_weak_is_said(light: Solution) -> None:
    (data,) = _of(light.assessment, "person.strength_data")
    assert "20 of 20" in data.title
    assert all(finding.source for finding in light.assessment if finding.limit is not None)


def test_an_iterate_is_not_judged_and_its_suggested_changes_name_keys(light: Solution) -> None:
    failed = replace(
        light,
        outcome="infeasible: too far",
        reasons=(
            InfeasibilityReason("grasp_closure", "robot", 0.2, "m", "the robot's grasp stays 0.200 m short", 0.0),
        ),
        suggested_changes=(SuggestedChange(("task.standing_distance",), (1.8,), "robot base 0.10 m nearer", 1.0),),
    )
    assessment = assess(failed)
    assert [finding.severity for finding in assessment.verdicts] == ["error"] * 4
    assert assessment[0].code == "verdict.mathematics"
    assert "infeasible: too far" in assessment[0].message
    assert not assessment.about("person") and not assessment.about("robot")
    (change,) = _of(assessment, "mathematics.suggested_change")
    assert "task.standing_distance = 1.80" in change.message


def test_a_mesh_that_was_refined_is_said(light: Solution) -> None:
    coarse = replace(light, scenario=light.scenario.replace({"solver.intervals": light.intervals // 2}))
    (finding,) = _of(assess(coarse), "mathematics.mesh")
    assert finding.title == f"mesh refined from N = {coarse.scenario.solver.intervals} to {light.intervals}"


def test_a_finding_holds_known_severities_and_finite_numbers() -> None:
    with pytest.raises(ValueError, match="severity"):
        Finding("a.b", "fatal", "", "")
    with pytest.raises(ValueError, match=r"value of 'a\.b' is nan"):
        Finding("a.b", "info", "", "", value=float("nan"))
