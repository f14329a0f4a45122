"""Findings on everybody who lifts, told by name; oracles: each one's own trajectory, and who is in the scenario."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from liftopt.assessment.assess import assess
from liftopt.assessment.text import details_text, verdict_text
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution

GRAVITY = 9.81


def _verdicts(solution: Solution) -> dict[str | None, str]:
    return {verdict.agent: verdict.code for verdict in solution.assessment.verdicts}


def test_everybody_has_a_verdict_and_nobody_else(people: Solution, robots: Solution) -> None:
    assert _verdicts(people) == {"anna": "verdict.person", "ben": "verdict.person", None: "verdict.mathematics"}
    assert _verdicts(robots) == {
        "human": "verdict.person", "near": "verdict.robot", "far": "verdict.robot", None: "verdict.mathematics",
    }  # fmt: skip
    with pytest.raises(KeyError):
        people.assessment.verdict("robot")
    assert robots.assessment.verdict("robot", "far").agent == "far"


def test_what_is_found_is_everybodys_own(people: Solution, robots: Solution) -> None:
    """Peak of the grasp force, share of the load and load of the lifting guide, from their own trajectories."""
    for solution in (people, robots):
        fine = between_knots(solution)
        total = sum(agent.load[:, 2] for agent in fine.agents)
        for agent in fine.agents:
            found = {finding.code: finding for finding in solution.assessment.about(agent.kind, agent.name)}
            peak = np.linalg.norm(agent.load, axis=1).max()
            assert found[f"{agent.kind}.grasp_force"].value == pytest.approx(peak, rel=1e-12)
            if agent.kind == "robot":
                carried = 0.4 + (agent.load[:, 2] / GRAVITY).max()
                assert found["robot.payload"].value == pytest.approx(carried, rel=1e-12)
                continue
            assert found["person.acgih"].value == pytest.approx((agent.load[:, 2] / GRAVITY).max(), rel=1e-12)
            assert found["person.load_share"].value == pytest.approx((agent.load[:, 2] / total).max(), rel=1e-12)


def test_messages_name_whose_they_are_where_there_are_several(people: Solution, robots: Solution) -> None:
    for solution in (people, robots):
        for agent in solution.agents:
            several = sum(other.kind == agent.kind for other in solution.agents) > 1
            told = [
                *solution.assessment.about(agent.kind, agent.name),
                solution.assessment.verdict(agent.kind, agent.name),
            ]
            assert len(told) > 4
            for finding in told:
                if finding.code != "person.squeeze":  # it names all hands
                    assert (agent.name in finding.message) == several, finding


def test_the_terminal_tells_everybody_under_their_name(people: Solution, robots: Solution) -> None:
    lines = verdict_text(people, None).splitlines()
    told = "two_people: WARNING for clearance, WARNING for the person anna, WARNING for the person ben"
    assert " ".join(lines).startswith(told)
    assert "anna (female 1.62 m, 58 kg) and ben (male 1.82 m, 84 kg) lift 8 kg" in " ".join(lines)
    assert {line for line in lines if line.startswith("Person")} == {"Person anna: WARNING", "Person ben: WARNING"}
    assert "robot" not in " ".join(lines).lower()
    text = verdict_text(robots, None)
    for words in ("Person: WARNING", "Robot near: ", "Robot far: ", "human and near"):
        assert words in text
    assert max(map(len, text.splitlines())) <= 80


def test_the_distance_told_is_that_of_the_two_who_face_each_other(robots: Solution) -> None:
    """The human at the origin, the robot near where the scenario puts it: 1.75 m ahead and 0.55 m to the side."""
    apart = np.hypot(1.75, 0.55)
    assert f"human and near standing {apart:.3f} m apart" in " ".join(verdict_text(robots, None).split())
    moved = replace(robots, scenario=robots.scenario.replace({"near.base.y": 0.0, "near.base.x": 1.5}))
    assert "human and near standing 1.5 m apart" in " ".join(verdict_text(moved, None).split())


def test_hands_of_three_work_against_each_other(robots: Solution) -> None:
    """A push of two against the third, put on top, is in the finding by as much."""
    push = np.zeros((3, 3))
    human, *others = robots.agents
    along = [agent.p_world_hold[0] - human.p_world_hold[0] for agent in others]
    for i, line in enumerate(along, start=1):  # along two sides of the triangle: it moves nothing
        push[0] += 100.0 * line / np.linalg.norm(line)
        push[i] -= 100.0 * line / np.linalg.norm(line)
    pushed = tuple(
        replace(agent, grasp_force=agent.grasp_force + one) for agent, one in zip(robots.agents, push, strict=True)
    )
    before = next(one for one in robots.assessment if one.code == "person.squeeze")
    after = next(one for one in assess(replace(robots, agents=pushed)) if one.code == "person.squeeze")
    assert before.value is not None
    assert after.value == pytest.approx(before.value + np.linalg.norm(push[0]), rel=0.02)
    assert after.severity == "warning"
    assert after.message.startswith("The hand of the person and those of near and far press the plank together")


def test_clearance_speaks_of_those_who_are_there(people: Solution, robots: Solution) -> None:
    """By the kinds of pairs that each team has; both persons' hands are told with their names."""
    codes = [{finding.code for finding in team.assessment.about("clearance")} for team in (people, robots)]
    assert {"clearance.person_person", "clearance.person_object"} <= codes[0]
    assert {"clearance.person_robot", "clearance.robot_robot", "clearance.robot_object"} <= codes[1]
    assert not {code for code in codes[0] if "robot" in code}
    (between,) = [finding for finding in people.assessment if finding.code == "clearance.person_person"]
    assert "of anna and" in between.message and "of ben" in between.message
    assert "ISO/TS 15066" not in between.message


def test_of_what_is_no_solution_nobody_is_assessed(people: Solution) -> None:
    assessment = assess(replace(people, outcome="time limit reached"))
    assert {(one.agent, one.message) for one in assessment.verdicts if one.agent} == {
        (name, f"The person {name} is not assessed: there is no lift.") for name in ("anna", "ben")
    }
    assert "The person ben is not assessed" in details_text(assessment)
