"""The solved torques in MuJoCo's forward dynamics: they must make the solved motion. Oracle: MuJoCo's simulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.crosscheck.motion_report import FEEDBACK
from liftopt.crosscheck.mujoco_forward import Simulation, Windows
from liftopt.multibody.mujoco_model import import_mujoco

CHEAP = ("solver.intervals=10", "solver.starts=1")


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Any:
    pytest.importorskip("mujoco", minversion="3.7", reason="mujoco is in the extra 'crosscheck'")
    return solved("table5_paper", *CHEAP).solution


@pytest.fixture(scope="module")
def simulation(solution: Any) -> Simulation:
    return Simulation(solution)


@pytest.fixture(scope="module")
def windows(simulation: Simulation) -> Windows:
    return simulation.windows()


def test_open_loop_follows_the_motion_for_50_ms_from_everywhere(windows):
    assert windows.count == 40
    assert windows.deviation.joint < 5e-3
    assert windows.deviation.position < 3e-4
    assert windows.deviation.turn < 2e-3
    assert windows.force < 0.04


def test_the_moment_that_nobody_serves_turns_the_object_when_it_is_left_out(simulation, windows, solution):
    # Oracle: that moment at its largest for 50 ms on the table's inertia about the line of its grasps.
    turned = simulation.windows(serve=False).deviation.turn
    moment = np.abs(solution.object.wrench[:, 3]).max()
    table = solution.scenario.object
    inertia = table.mass * ((table.width**2 + table.height**2) / 12 + (table.height / 2) ** 2)
    assert windows.deviation.turn < turned < 1.5 * moment / inertia * 0.05**2 / 2


def test_the_whole_lift_is_followed_with_little_feedback(simulation):
    whole = simulation.follow()
    assert whole.deviation.joint < 4e-3
    assert whole.deviation.position < 5e-4
    assert whole.share.max() < FEEDBACK
    assert whole.moment < 0.01
    assert len(whole.joints) == len(whole.torque) == 17


def test_it_starts_where_the_grasps_are_together_and_near_the_solution(simulation, solution):
    # Oracle: MuJoCo's own kinematics of the sites; between the knots the solution's are apart.
    mujoco, model = import_mujoco(), simulation._model
    grasps = [(f"{name}_grasp_site", f"grasp_{name}_site") for name in ("human", "robot")]
    data, apart, parting = mujoco.MjData(model), [], []
    for k in range(0, len(simulation._states.qpos), 77):
        for position, rate in ((simulation._states.qpos[k], simulation._states.qvel[k]), simulation._closed(k)):
            data.qpos[:], data.qvel[:] = position, rate
            mujoco.mj_forward(model, data)
            apart.append(max(np.linalg.norm(data.site(one).xpos - data.site(two).xpos) for one, two in grasps))
            parting.append(np.abs(data.efc_vel).max())
    open_ones, closed = np.reshape(apart, (-1, 2)).max(axis=0)
    assert open_ones > 1e-5
    assert closed < 1e-9
    assert np.reshape(parting, (-1, 2)).max(axis=0)[1] < 1e-9
    moved = [np.abs(simulation._closed(k)[0] - simulation._states.qpos[k]).max() for k in range(0, 4001, 77)]
    assert 0.0 < max(moved) < 0.02


def test_torques_for_another_grasp_force_do_not_make_the_motion(solution, windows):
    human, robot = solution.agents
    wrong = replace(solution, agents=(human, replace(robot, grasp_force=1.1 * robot.grasp_force)))
    found = Simulation(wrong).windows()
    assert found.force > 2 * windows.force
    assert found.deviation.position > 2 * windows.deviation.position


def test_moments_of_hands_that_turn_on_the_object_belong_to_the_motion(solved: Callable[..., Any]) -> None:
    natural = solved("table5_paper", *CHEAP, "objective.preset=natural").solution
    found = Simulation(natural).windows().deviation
    # Measured: 1.5e-4 rad, 6.4e-6 m and 3.3e-5 rad; without the moments 143, 86 and 270 times as much.
    assert found.joint < 1e-3
    assert found.position < 5e-5
    assert found.turn < 3e-4
    bare = tuple(replace(agent, grasp_moment=np.zeros_like(agent.grasp_moment)) for agent in natural.agents)
    without = Simulation(replace(natural, agents=bare)).windows().deviation
    assert without.joint > 20 * found.joint
    assert without.turn > 20 * found.turn


def test_a_box_that_one_person_holds_with_both_hands_stays_there(alone: Any) -> None:
    """Forces at two points along Y leave the box free to pitch: the hands' moments hold it."""
    simulation = Simulation(alone.solution)
    open_loop, whole = simulation.windows().deviation, simulation.follow()
    assert simulation.about == "about its y axis"
    # Measured: 1.9e-4 rad and 9.4e-7 m on 20 intervals; with feedback 3.3e-5 rad.
    assert open_loop.joint < 5e-3 and open_loop.position < 1e-4
    assert whole.deviation.joint < 1e-3 and whole.share.max() < FEEDBACK
