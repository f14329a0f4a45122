"""The URScript program. Oracles: Python's parser, the maker's signatures, an arm that does what it is told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from liftopt.errors import InputError
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.joint_trajectory import JointTrajectory
from liftopt.lab.robot.urscript import JOINTS, MOST, PERIODS, is_universal, servo_times, urscript


def joints(*names: str) -> JointMap:
    n = len(names)
    none = np.zeros(n)
    return JointMap("made up", names, none + 1.0, none > 0.0, np.stack([none - 6.0, none + 6.0]), none + 3.0,
                    np.stack([none - 50.0, none + 50.0]), ())  # fmt: skip


def motion(period: float, duration: float = 1.001) -> JointTrajectory:
    time = servo_times(duration, period)
    s = (time / duration)[:, None]
    start, way = np.array([-0.5, -1.2, 1.7, -2.0, -1.5, 3.0]), np.array([0.4, -0.3, 0.5, 0.2, -0.1, 0.05])
    return JointTrajectory(joints(*JOINTS), time, start + way * (3 * s**2 - 2 * s**3), 0 * s * way, 0 * s * way)


@pytest.mark.parametrize("rate", ["125", "500"])
def test_the_arm_goes_to_the_start_slowly_follows_every_target_and_stops(ur_controller: Any, rate: str) -> None:
    period = PERIODS[rate]
    trajectory = motion(period)
    arm = ur_controller.Controller(trajectory.position[0] + 0.3)
    arm.run(urscript(trajectory, period, 'a "lift"\nhalt'))
    assert [name for name, _ in arm.told][:4] == ["popup", "movej", "popup", "servoj"]
    assert all(asked["blocking"] and "\n" not in asked["title"] for asked in arm.of("popup"))
    (way,) = arm.of("movej")
    np.testing.assert_allclose(way["q"], trajectory.position[0], rtol=0, atol=1e-9)
    assert way["v"] < 0.2 and way["a"] < 0.5
    targets = arm.of("servoj")
    count = len(trajectory.time) - 1
    np.testing.assert_allclose([one["q"] for one in targets[:count]], trajectory.position[1:], rtol=0, atol=1e-9)
    assert count * period == pytest.approx(1.001, abs=period)
    for one in targets:
        assert one["t"] == period and 0.03 <= one["lookahead_time"] <= 0.2 and 100 <= one["gain"] <= 2000
    held = targets[count:]
    assert len(held) * period == pytest.approx(0.5, abs=2 * period)  # so that an arm that is late arrives
    assert all(one["q"] == targets[count - 1]["q"] for one in held)
    assert [name for name, _ in arm.told][-1] == "stopj" and len(arm.of("stopj")) == 1


@pytest.mark.parametrize("joint", range(6))
def test_an_arm_far_from_the_start_is_not_moved(ur_controller: Any, joint: int) -> None:
    trajectory = motion(0.008)
    arm = ur_controller.Controller(trajectory.position[0] - 0.6 * np.eye(6)[joint])
    with pytest.raises(ur_controller.Halted):
        arm.run(urscript(trajectory, 0.008, "lift"))
    assert [name for name, _ in arm.told] == ["popup"] and arm.told[0][1]["error"]


def test_a_program_that_is_none_is_noticed(ur_controller: Any) -> None:
    """The check must be able to fail: a block without end, an unknown function, an argument that is none."""
    program = urscript(motion(0.008), 0.008, "lift")
    for sound, faulty in (
        ("    end\n", ""),
        ("movej(start, a", "movex(start, a"),
        ("gain=gain", "gains=gain"),
        ("start = [", "start = ("),
    ):
        assert sound in program
        with pytest.raises((AssertionError, NameError, TypeError, SyntaxError)):
            ur_controller.Controller(motion(0.008).position[0]).run(program.replace(sound, faulty, 1))


def test_length_and_reach_are_bounded() -> None:
    with pytest.raises(InputError, match=rf"--servo-rate = '500': makes 25000 targets in 50 s; .* have {MOST}"):
        servo_times(50.0, 0.002)
    assert len(servo_times(2.0, 0.008)) == 251 and servo_times(2.0, 0.008)[-1] == 2.0
    with pytest.raises(InputError, match=r"elbow_joint goes to 7\.000 rad"):
        trajectory = motion(0.008)
        trajectory.position[3, 2] = 7.0
        urscript(trajectory, 0.008, "lift")


def test_whose_joints_are_universal_robots() -> None:
    assert is_universal(joints(*JOINTS))
    assert is_universal(joints(*(f"left_{name}" for name in JOINTS)))
    assert not is_universal(joints(*JOINTS[::-1]))
    assert not is_universal(joints(*JOINTS[:5]))
    assert not is_universal(joints(*JOINTS, "rail"))
    assert not is_universal(joints(*(f"joint_{i}" for i in range(6))))
