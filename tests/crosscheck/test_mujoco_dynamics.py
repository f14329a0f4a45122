"""The exported models and the solved motion in MuJoCo: its inverse dynamics is the oracle."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from liftopt.crosscheck.mujoco_dynamics import inverse_dynamics
from liftopt.errors import InputError
from liftopt.multibody.mujoco_model import merged_urdf, spec_of, states_of
from liftopt.solution.interpolation import resample

CHEAP = ("solver.intervals=10", "solver.starts=1")


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Any:
    pytest.importorskip("mujoco", minversion="3.7", reason="mujoco is in the extra 'crosscheck'")
    return solved("table5", *CHEAP).solution


@pytest.mark.parametrize("factor", [1, 7], ids=["knots", "between knots"])
def test_torques_and_balance_are_those_that_mujoco_finds(solution, factor):
    for found in inverse_dynamics(resample(solution, factor) if factor > 1 else solution):
        assert found.relative < 1e-8, (found.name, found.worst)
        assert found.gap < 1e-12


def test_torques_off_by_a_millionth_part_are_noticed(solution):
    human, robot = solution.agents
    tau = robot.tau.copy()
    tau[:, 4] *= 1 + 2e-6
    found = {each.name: each for each in inverse_dynamics(replace(solution, agents=(human, replace(robot, tau=tau))))}
    assert found["robot"].relative > 1e-6
    assert found["robot"].worst == robot.joint_names[4]
    assert found["human"].relative < 1e-8


def test_a_grasp_force_that_is_not_the_solutions_is_noticed_by_its_agent_and_by_the_object(solution):
    human, robot = solution.agents
    wrong = replace(solution, agents=(replace(human, grasp_force=human.grasp_force * 1.001), robot))
    found = {each.name: each.relative for each in inverse_dynamics(wrong)}
    assert found["human"] > 1e-4
    assert found["table"] > 1e-4
    assert found["robot"] < 1e-8


def test_models_keep_their_mass_and_get_no_more_than_a_negligible_one(solution):
    masses = [
        float(mass.get("value"))
        for text in solution.urdfs.values()
        for mass in ElementTree.fromstring(text.encode()).iter("mass")
    ]
    model = spec_of(solution.urdfs.values()).compile()
    assert model.body_mass.sum() == pytest.approx(sum(masses), rel=1e-12)
    assert model.nv == sum(len(agent.joint_names) for agent in solution.agents) + 6
    assert model.body_mass[1:].min() > 0.0


def test_what_is_left_out_of_the_copy_is_limits_and_shapes_alone(solution):
    links = {
        link.get("name")
        for text in solution.urdfs.values()
        for link in ElementTree.fromstring(text.encode()).iter("link")
    }
    copy = ElementTree.fromstring(merged_urdf(solution.urdfs.values(), ["human_GT1"]))
    assert {link.get("name") for link in copy.iter("link")} == links
    assert {part.tag for link in copy.iter("link") for part in link} == {"inertial"}
    kinds = {joint.get("name"): joint.get("type") for joint in copy.iter("joint")}
    assert (kinds["human_GT1"], kinds["human_GT2"], kinds["table_free"]) == ("fixed", "prismatic", "floating")


def test_velocities_are_the_rates_of_the_positions_in_mujocos_conventions(solution):
    # Oracle: MuJoCo's own difference of two positions, by central differences on a fine grid.
    mujoco, model, dense = (
        pytest.importorskip("mujoco"),
        spec_of(solution.urdfs.values()).compile(),
        resample(solution, 200),
    )
    states, step = states_of(model, dense.agents, dense.object), dense.time[1]
    rate = np.zeros(model.nv)
    for k in range(100, len(dense.time) - 1, 331):
        mujoco.mj_differentiatePos(model, rate, 2 * step, states.qpos[k - 1], states.qpos[k + 1])
        np.testing.assert_allclose(rate, states.qvel[k], atol=2e-5)
        slope = (states.qvel[k + 1] - states.qvel[k - 1]) / (2 * step)
        np.testing.assert_allclose(slope, states.qacc[k], atol=2e-3)


def test_without_mujoco_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(InputError, match=r'pip install "liftopt\[crosscheck\]"'):
        inverse_dynamics(None)


def test_a_mujoco_whose_constraints_forget_the_velocity_is_refused(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", SimpleNamespace(__version__="3.6.0"))
    with pytest.raises(InputError, match=r"3\.6\.0.*3\.7 or later"):
        inverse_dynamics(None)
