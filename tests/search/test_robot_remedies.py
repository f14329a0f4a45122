"""What is said of a robot that cannot reach or turn, and what is proposed. Oracle: distances and numbers put in."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.spline import RestToRestSpline
from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.search.adjustables import adjustables
from liftopt.search.reach_words import how_far_it_reaches
from liftopt.solution.infeasibility_report import InfeasibilityReason

TWISTED = InfeasibilityReason("grasp_turn", "robot", 34.2, "deg", "", 0.0, static=True)


def test_a_robot_that_cannot_reach_is_told_how_far_it_does(ur10: Any) -> None:
    solution = ur10.solution
    agents, lifted = agents_of(solution.scenario, solution.urdfs), object_of(solution.scenario, solution.urdfs)
    problem = Problem(Team.of(agents, lifted), task_of(solution.scenario), RestToRestSpline(6).mesh())
    robot, box = solution["robot"], solution.object
    joints = [agent.q[0, agent.moving] for agent in solution.agents]
    origin = agents[1].model.jointPlacements[1].translation
    reached = np.linalg.norm(robot.grasp_position[0, 0] - origin)
    for shift in (-0.3, 0.1):  # away from the robot, and towards it
        pose = box.pose[0] + np.array([shift, 0.0, 0.0, 0.0, 0.0, 0.0])
        away = np.linalg.norm(box.grasp_position[0, 1] + (shift, 0.0, 0.0) - origin)
        told = how_far_it_reaches(problem, np.concatenate([*joints, pose]), 1)
        wanted = f" ({away:.2f} m from its first joint, where it reaches {reached:.2f} m)"
        assert told == (wanted if shift < 0.0 else "")
        assert how_far_it_reaches(problem, np.concatenate([*joints, pose]), 0) == ""  # a person leans


@pytest.mark.parametrize("grasp", ["wrench", "point"])
def test_a_hand_that_has_to_turn_farther_may_be_allowed_to(ur10: Any, grasp: str) -> None:
    scenario = ur10.solution.scenario.replace({"robot.grasp": grasp, "human.grasp": "point"})
    found = {adjustable.keys: adjustable for adjustable in adjustables(scenario)}
    assert (("robot.grasp_turn_deg",) in found) is (grasp == "wrench")
    assert ("human.grasp_turn_deg",) not in found
    if grasp == "wrench":
        turn = found["robot.grasp_turn_deg",]
        steps = turn.hint(scenario, [TWISTED])
        assert steps == 35
        assert turn.hint(scenario, [replace(TWISTED, constraint="torque")]) == 0
        changed = turn.changed(scenario, steps)
        assert changed is not None
        assert changed.agents["robot"].grasp_turn_deg == scenario.agents["robot"].grasp_turn_deg + 35.0
    lengths = [each for keys, each in found.items() if keys != ("robot.grasp_turn_deg",)]
    assert not any(each.hint(scenario, [TWISTED]) for each in lengths)
