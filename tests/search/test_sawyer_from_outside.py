"""Sawyer read from the URDF that liftopt exports lifts as liftopt's own Sawyer. Oracle: that one's lift."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("yourdfpy")

import liftopt as lo
from liftopt.multibody.robots.sawyer import MOVING, POSTURE, VIRTUAL
from liftopt.scenario.model import scenario_from_dict

FILE = Path(__file__).parents[2] / "models/sawyer.urdf"
CHEAP = {"solver.intervals": 10, "solver.starts": 1, "solver.tries": 4}


def test_the_same_optimum_to_1e_9_and_the_same_verdicts():
    own = lo.load_scenario("table5_paper", CHEAP)
    tables = own.to_dict()
    tables["agents"]["robot"] = {
        "kind": "robot",
        "model": str(FILE),
        "grasp_frame": "robot_grasp",
        "base_link": "world",  # where it stands is in the file
        "base": {"x": 0.0, "z": 0.0, "yaw_deg": 0.0},
        "locked": {f"robot_{row}": 0.0 for row in VIRTUAL},
        "posture": {f"robot_{row}": angle for row, angle in zip(MOVING, POSTURE, strict=True)},
        "tool": {"length": 0.0, "mass": 0.0, "direction": "z"},
    }
    lifts = [lo.solve(scenario) for scenario in (own, scenario_from_dict(tables))]
    assert [lift.status for lift in lifts] == ["solved", "solved"]
    assert lifts[1].objective == pytest.approx(lifts[0].objective, rel=1e-9)
    verdicts = [
        [(verdict.subject, verdict.severity) for verdict in lift.assessment.verdicts if verdict.subject != "robot"]
        for lift in lifts
    ]
    assert verdicts[0] == verdicts[1]
    torque = [
        max(one.value / one.limit for one in lift.assessment.findings if one.code == "robot.torque") for lift in lifts
    ]
    assert torque[1] == pytest.approx(torque[0], rel=1e-6)
