"""Weights of a robot's joints are in the solve. Oracle: no other motion that is known costs less with them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from liftopt.control.replanning import Replanner
from liftopt.multibody.trajectory import limit_share

WEIGHTS = {"shoulder_lift_joint": 40.0, "elbow_joint": 5.0, "wrist_2_joint": 0.0}


def test_a_replanner_moves_as_the_weights_ask(ur10: Any) -> None:
    """From the lift without weights, which the new objective finds dearer than its own optimum."""
    replanner = Replanner()
    before = replanner.solve(ur10.solution.scenario)
    plan = replanner.solve(before.scenario.replace({"robot.joint_weights": WEIGHTS}))
    assert plan.solved and plan.kept_start == "last optimum"
    terms, weights = plan.objective_terms, plan.objective_weights
    found = sum(weights[name] * value for name, value in terms.items())
    names = [name.removeprefix("robot_") for name in before["robot"].moving_joints]
    factors = np.array([WEIGHTS.get(name, 1.0) for name in names])

    def effort(solution: Any) -> float:
        return float(np.trapezoid((factors * limit_share(solution["robot"]) ** 2).sum(axis=1), solution.time))

    assert terms["robot"] == pytest.approx(effort(plan), rel=1e-9)
    assert plan.objective == pytest.approx(found, rel=1e-9)
    old = before.objective + weights["robot"] * (effort(before) - before.objective_terms["robot"])
    assert found < 0.999 * old
