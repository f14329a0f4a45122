"""A scenario to start from for a robot. Oracle: Pinocchio's kinematics, and the search for postures that hold."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("yourdfpy")

from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.scenario.build import agent_of
from liftopt.scenario.model import scenario_from_dict
from liftopt.search.first_scenario import AHEAD, DEPTH, first_scenario


@pytest.mark.parametrize("name", ["sawyer", "icub_left"])
def test_its_tool_is_where_the_robot_is_to_hold(name: str) -> None:
    """ICub's front is behind the x axis of its base; a Sawyer stands on a pedestal."""
    if name != "sawyer" and share_folder() is None:
        pytest.skip("example-robot-data is not installed (it is in 'test')")
    scenario = scenario_from_dict(first_scenario({"model": name}, "first"))
    robot = agent_of(scenario, "robot")
    model = robot.reduced()
    data = model.createData()
    pin.framesForwardKinematics(model, data, robot.posture)
    tip = data.oMf[model.getFrameId("robot_grasp")].translation
    middle = (scenario.task.start.height + scenario.task.end.height) / 2.0
    # A Sawyer's own posture is known; the base is rounded to centimetres.
    np.testing.assert_allclose(tip, [AHEAD + DEPTH, 0.0, middle], rtol=0.0, atol=0.02)
    assert scenario.task.end.height > scenario.task.start.height + 0.05  # the least share of what a child reaches
