"""What the action server makes of an export. Oracles: its sources, its curve by Hermite conditions, differences."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.commands.cli import main
from liftopt.commands.exit_status import BAD_INPUT, DONE
from liftopt.errors import InputError
from liftopt.lab.robot.action_server import server_curve
from liftopt.lab.robot.joint_trajectory import JointTrajectory, joint_trajectory
from liftopt.lab.robot.robot_limits import check_curve
from liftopt.lab.robot.robot_start import check_start
from liftopt.multibody.robots.sawyer import sawyer_limits
from liftopt.solution.solution import Solution
from liftopt.storage.writer import save
from liftopt.types import Array

CHEAP = ("solver.intervals=10", "solver.starts=1")
JOINTS = tuple(f"right_j{i}" for i in range(7))


@pytest.fixture(scope="module")
def result(solved: Callable[..., Any]) -> Any:
    return solved("table5_paper", *CHEAP)


@pytest.fixture(scope="module")
def gentle(solved: Callable[..., Any]) -> Any:
    return solved("table5_paper", *CHEAP, "task.rest=acceleration")


@pytest.fixture(scope="module")
def trajectory(result: Any) -> JointTrajectory:
    return joint_trajectory(result.solution)


def export(result: Any, out: Path, *words: str) -> int:
    return main(["export", str(result.folder), "--out", str(out), "--format", "csv", *words])


def _quintics(time: Array, values: Array) -> list[np.polynomial.Polynomial]:
    """Return the server's curve of one column: at points no acceleration, and the mean of the slopes on both sides."""
    slope = np.diff(values) / np.diff(time)
    inner = np.where(slope[:-1] * slope[1:] >= 1e-10, (slope[:-1] + slope[1:]) / 2.0, 0.0)
    velocity = np.concatenate([[0.0], inner, [0.0]])
    curves = []
    for k, t in enumerate(np.diff(time)):
        conditions = [
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
            [1.0, t, t**2, t**3, t**4, t**5], [0.0, 1.0, 2.0 * t, 3.0 * t**2, 4.0 * t**3, 5.0 * t**4],
            [0.0, 0.0, 2.0, 6.0 * t, 12.0 * t**2, 20.0 * t**3],
        ]  # fmt: skip
        right = [values[k], velocity[k], 0.0, values[k + 1], velocity[k + 1], 0.0]
        curves.append(np.polynomial.Polynomial(np.linalg.solve(conditions, right)))
    return curves


@pytest.mark.parametrize("rate", [10.0, 33.0, 100.0])
def test_the_servers_curve_meets_its_conditions_at_every_point(result: Any, rate: float) -> None:
    trajectory = joint_trajectory(result.solution, rate)
    time, value, slope = server_curve(trajectory).sampled(8)
    assert time[0] == 0.0 and time[-1] == pytest.approx(2.0)
    columns = np.hstack([trajectory.position, trajectory.velocity, trajectory.acceleration])
    columns[-1, 7:] = 0.0  # the server takes the last velocity and acceleration for zero
    for j in (3, 10, 18):
        for k, curve in enumerate(_quintics(trajectory.time, columns[:, j])):
            rows = slice(9 * k, 9 * (k + 1))
            since = time[rows] - trajectory.time[k]
            np.testing.assert_allclose(value[rows, j], curve(since), rtol=0, atol=1e-9)
            np.testing.assert_allclose(slope[rows, j], curve.deriv()(since), rtol=0, atol=1e-7)


@pytest.mark.parametrize("rest", ["velocity", "acceleration"])
def test_a_rate_at_which_the_server_is_too_fast_is_refused(
    result: Any, gentle: Any, rest: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept = result if rest == "velocity" else gentle
    assert export(kept, tmp_path / "coarse", "--rate", "10") == BAD_INPUT
    error = capsys.readouterr().err
    found = re.search(r"--rate = 10\.0: .*(right_j\d) turns at (\S+) rad/s at (\S+) s, .* take --rate (\d+)$", error)
    assert found is not None and error.count("\n") == 1 and not list(tmp_path.iterdir())
    trajectory, j = joint_trajectory(kept.solution, 10.0), JOINTS.index(found[1])
    limit = sawyer_limits().velocity[j]
    curves = _quintics(trajectory.time, trajectory.position[:, j])
    k = min(int(float(found[3]) * 10.0), len(curves) - 1)
    fastest = max(np.abs(curves[i].deriv()(np.linspace(0.0, 0.1, 1001))).max() for i in (k - 1, k))
    assert abs(float(found[2])) == pytest.approx(fastest, abs=1e-3) and fastest > 1.005 * limit
    assert export(kept, tmp_path / "fine", "--rate", found[4]) == DONE


def test_the_default_rate_stays_within_the_limits_and_on_the_plan(result: Any, gentle: Any) -> None:
    for kept in (result, gentle):
        assert check_curve(kept.solution, joint_trajectory(kept.solution), 100.0) < 2e-4


def test_leaving_the_plan_is_said(result: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The same path in one and a half times the time is fast nowhere, but 10 points a second cut its corners."""
    solution = _stretched(result.solution, 1.5)
    coarse, fine = (joint_trajectory(solution, rate) for rate in (10.0, 1000.0))
    off = 0.0
    for j in range(7):
        for k, curve in enumerate(_quintics(coarse.time, coarse.position[:, j])):
            inside = (fine.time >= coarse.time[k]) & (fine.time <= coarse.time[k + 1])
            off = max(off, np.abs(curve(fine.time[inside] - coarse.time[k]) - fine.position[inside, j]).max())
    assert off > 1e-3
    save(solution, tmp_path / "slow")
    words = ["export", str(tmp_path / "slow"), "--format", "csv", "--json", "--out"]
    assert main([*words, str(tmp_path / "coarse"), "--rate", "10"]) == DONE
    told = json.loads(capsys.readouterr().out)
    assert told["off_plan"] == pytest.approx(off, rel=0.02) and told["files"] == ["trajectory.csv"]
    assert f"leaves the plan by {told['off_plan']:.4f} rad" in " ".join(told["notes"])
    assert main([*words, str(tmp_path / "fine")]) == DONE
    assert "leaves the plan" not in capsys.readouterr().out


def _stretched(solution: Solution, factor: float) -> Solution:
    robot = solution.agents[1]
    slow = replace(robot, v=robot.v / factor, a=robot.a / factor**2)
    longer = solution.scenario.replace({"duration": factor * solution.scenario.duration})
    return replace(solution, scenario=longer, time=factor * solution.time, agents=(solution.agents[0], slow))


def test_a_start_too_far_from_the_arm_is_refused(
    result: Any, trajectory: JointTrajectory, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The server's own mode, position_w_id, gives up at 0.2 rad, its velocity mode beyond 1 rad."""
    start = trajectory.position[0]
    for name, off, mode, status in (
        ("a", 0.19, "position_w_id", DONE), ("b", 0.21, "position_w_id", BAD_INPUT),
        ("c", 0.21, "position", BAD_INPUT), ("d", 0.6, "velocity", DONE), ("e", 1.2, "velocity", BAD_INPUT),
    ):  # fmt: skip
        pose = start - off * np.eye(7)[5]
        words = ["--current-pose", str(pose.tolist()), *(() if mode == "position_w_id" else ("--mode", mode))]
        assert export(result, tmp_path / name, *words) == status, (off, mode)
        told = capsys.readouterr()
        if status == DONE:
            assert f"the arm is {off:.3f} rad from the start" in told.out
        else:
            accepted = "1 rad" if mode == "velocity" else "0.2 rad"
            assert f"right_j5 is {off:.3f} rad from the motion's start" in told.err
            assert f"in {mode} mode the action server accepts less than {accepted}" in told.err
            assert not (tmp_path / name).exists()
    with pytest.raises(InputError, match="--current-pose"):
        check_start(trajectory, start + 0.2001, "position")


def test_a_step_of_acceleration_is_said_with_its_size_and_how_to_have_none(
    result: Any, gentle: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """From rest, the acceleration at the start is twice the way over the time squared."""
    assert export(result, tmp_path / "a") == DONE
    said = capsys.readouterr().out
    found = re.search(
        r"starts with a step of acceleration \((\S+) rad/s\^2 in (\S+)\) and ends with a step of acceleration "
        r"\((\S+) rad/s\^2 in (\S+)\): solve with --set task\.rest=acceleration to have none",
        said,
    )
    assert found is not None
    fine = joint_trajectory(result.solution, 1000.0)
    for row, way, size, joint in (
        (0, fine.position[1] - fine.position[0], found[1], found[2]),
        (-1, fine.position[-2] - fine.position[-1], found[3], found[4]),
    ):
        step = 2.0 * way / 1e-3**2
        assert joint == JOINTS[int(np.argmax(np.abs(step)))], row
        assert float(size) == pytest.approx(step[JOINTS.index(joint)], rel=0.02)
    assert export(gentle, tmp_path / "b") == DONE
    assert "step of acceleration" not in capsys.readouterr().out
