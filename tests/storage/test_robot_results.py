"""Results of lifts with robots from outside: they open anywhere, and hold the robot that they say."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr

from liftopt.errors import InputError
from liftopt.multibody.robots.known_robot import KnownRobot
from liftopt.storage.reader import load_result
from liftopt.storage.writer import save


def test_a_result_opens_where_the_robots_own_file_is_not(ur10: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """No reader of URDFs, no xacro, and example-robot-data is not there."""
    for module in ("yourdfpy", "xacro"):
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setattr(KnownRobot, "path", None)
    again = load_result(ur10.folder)
    assert again.solved and again.scenario == ur10.solution.scenario
    assert again.urdfs == ur10.solution.urdfs
    for one, other in zip(again.agents, ur10.solution.agents, strict=True):
        for kind in ("q", "v", "a", "tau", "grasp_force", "grasp_moment"):
            np.testing.assert_allclose(getattr(one, kind), getattr(other, kind), rtol=1e-12, atol=1e-9)
    assert list(again.assessment) == list(ur10.solution.assessment)


def test_a_file_of_a_robot_may_be_gone(on_a_column: Any) -> None:
    path = on_a_column.solution.scenario.agents["robot"].model
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("liftopt.multibody.robots.chosen_robot.read_robot", lambda *_, **__: pytest.fail("it was read"))
        again = load_result(on_a_column.folder)
    assert again.scenario.agents["robot"].model == path
    assert again["robot"].sliding.tolist() == [True] + [False] * 6


def test_xarray_reads_it_and_tells_units_of_joints_that_slide(on_a_column: Any) -> None:
    with xr.open_dataset(on_a_column.folder / "solution.nc", engine="h5netcdf") as data:
        assert data["robot_joint_kind"].values.tolist() == ["prismatic"] + ["revolute"] * 6
        for kind, units in (("q", "m"), ("v", "m/s"), ("a", "m/s^2"), ("tau", "N")):
            assert data[f"robot_{kind}"].attrs["units_prismatic"] == units
        assert data["robot_tau"].sel(robot_joint="robot_column").max() > 100.0


def test_a_model_that_is_not_the_scenarios_is_refused_in_one_line(ur10: Any, on_a_column: Any, tmp_path: Any) -> None:
    """The scenario says more than its model has, and a model of another robot stands there."""
    asked, other = ur10.solution.scenario, on_a_column.solution
    shorter = ur10.solution.urdfs["robot"].replace("-0.5723", "-0.3922")  # its forearm: at the same base, another hand
    cases = {
        "its base is 0.100 m": {"scenario": asked.replace({"robot.base.x": 1.7})},
        "its base is 0.000 m and 90 deg": {"scenario": asked.replace({"robot.base.roll_deg": 90.0})},
        "its joint elbow_joint has effort 150, not 100": {
            "scenario": asked.replace({"robot.limits": {"elbow_joint": {"effort": 100.0}}})
        },
        "its joint wrist_3_joint moves, and the scenario holds it": {
            "scenario": asked.replace({"robot.locked": {"wrist_3_joint": 0.0}})
        },
        r"its hand is 0\.\d+ m from where it holds the object": {"urdfs": ur10.solution.urdfs | {"robot": shorter}},
        "its base is 0.800 m": {"urdfs": ur10.solution.urdfs | {"robot": other.urdfs["robot"]}},
    }
    for k, (why, changed) in enumerate(cases.items()):
        save(replace(ur10.solution, **changed), tmp_path / str(k))
        with pytest.raises(
            InputError, match=f"the model of robot is not that of the result's scenario: {why}"
        ) as error:
            load_result(tmp_path / str(k))
        assert "\n" not in str(error.value)
