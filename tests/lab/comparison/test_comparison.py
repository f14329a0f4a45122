"""Predicted and recorded lifts side by side: a prediction made into a record with known differences gives them back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.errors import InputError
from liftopt.lab.comparison.comparison import PERCENT, SHARE, Comparison, measures
from liftopt.lab.comparison.experiment import experiment
from liftopt.lab.forces.force_record import ForceRecord
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.lab.mocap.recorded_scenario import recorded_scenario
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.trajectory import GRAVITY
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.types import Array

CHEAP = ("solver.intervals=10", "solver.starts=1")
Made = Callable[..., RecordedLift]


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Solution:
    return solved("table5_paper", *CHEAP).solution


def one(found: Any, group: str, name: str) -> Comparison:
    (wanted,) = [item for item in found.group(group) if item.name == name]
    assert isinstance(wanted, Comparison)
    return wanted


def test_measures_of_a_bump_in_closed_form() -> None:
    """sin^2 of the lift, scaled by 1.25 and 10 % late: peaks 1 and 1.25 m, r = 1 where the curves are put together."""
    bump = np.sin(np.pi * np.clip((SHARE - 0.2) / 0.4, 0.0, 1.0)) ** 2
    recorded = 1.25 * np.interp(SHARE - 0.1, SHARE, bump)
    found = measures(bump, recorded)
    assert found.peak_recorded == pytest.approx(1.25)
    assert found.peak_predicted == pytest.approx(1.0)
    assert found.peak_difference == pytest.approx(-20.0)
    assert found.phase == pytest.approx(10.0)
    assert measures(recorded, bump).phase == pytest.approx(-10.0)
    assert measures(recorded, bump).peak_difference == pytest.approx(25.0)


def test_an_offset_is_all_rmse_and_no_phase() -> None:
    wave = np.sin(2.0 * np.pi * SHARE)
    found = measures(wave, wave - 3.0)
    assert found.rmse == pytest.approx(3.0)
    assert found.correlation == pytest.approx(1.0)
    assert found.phase == 0.0
    # The recorded peak is its lowest value, -4, and the prediction's on that side is -1.
    assert (found.peak_recorded, found.peak_predicted) == (pytest.approx(-4.0), pytest.approx(-1.0))
    assert found.peak_difference == pytest.approx(-75.0)


def test_what_says_nothing_is_nan() -> None:
    flat, wave = np.full_like(SHARE, 2.0), np.sin(2.0 * np.pi * SHARE)
    assert np.isnan([measures(flat, wave).correlation, measures(flat, wave).phase]).all()
    assert np.isnan(measures(wave, 0.0 * wave).peak_difference)
    # Half a period up against half a period down: the best shift lies beyond the range.
    assert np.isnan(measures(np.sin(np.pi * SHARE), -np.sin(np.pi * SHARE)).phase)
    # One period against five: wherever they are put, their product integrates to little.
    assert np.isnan(measures(wave, np.sin(10.0 * np.pi * SHARE)).phase)


def test_mean_and_spread_of_trials() -> None:
    """Trials at -d, 0 and +d have the standard deviation d."""
    wave = np.sin(2.0 * np.pi * SHARE)
    trials = Comparison("human_angle", "Q7", "", "deg", wave, wave + np.array([[-0.3], [0.0], [0.3]]))
    np.testing.assert_allclose(trials.mean, wave, atol=1e-15)
    np.testing.assert_allclose(trials.spread, 0.3)
    assert trials.measures.rmse < 1e-12
    assert not Comparison("human_angle", "Q7", "", "deg", wave, wave[None]).spread.any()


def test_a_prediction_recorded_as_it_is_does_not_differ(as_recorded: Made, solution: Solution) -> None:
    found = experiment(solution, mocap=[as_recorded(solution)])
    for item in found.comparisons:
        assert item.measures.rmse < 2e-3 * max(1.0, np.abs(item.predicted).max()), item.label
    assert {item.group for item in found.comparisons} == {"human_angle", "human_torque", "hand_path", "hand_force"}


@pytest.mark.parametrize(
    ("group", "name"),
    [("human_angle", "Q5"), ("human_angle", "Q7"), ("human_torque", "Q7"), ("hand_force", "mocap")],
)
def test_scale_and_lag_come_back(as_recorded: Made, solution: Solution, group: str, name: str) -> None:
    """A record 1.25 times as large is exceeded by -20 %; one that is 5 % late is so."""
    larger = one(experiment(solution, mocap=[as_recorded(solution, scale=1.25)]), group, name)
    assert larger.measures.peak_difference == pytest.approx(-20.0, abs=0.2)
    assert larger.measures.phase == 0.0
    late = one(experiment(solution, mocap=[as_recorded(solution, late=0.05)]), group, name)
    assert late.measures.phase == pytest.approx(5.0, abs=0.5)


def test_three_trials(as_recorded: Made, solution: Solution) -> None:
    trials = [as_recorded(solution, raised=angle) for angle in np.radians([-2.0, 0.0, 2.0])]
    elbow = one(experiment(solution, mocap=trials), "human_angle", "Q7")
    assert elbow.trials.shape == (3, len(PERCENT))
    np.testing.assert_allclose(elbow.spread, 2.0, rtol=1e-9)
    assert elbow.measures.rmse < 0.01


def test_anatomical_signs(as_recorded: Made, solution: Solution) -> None:
    """A bent elbow is positive as in Fig. 13, though Q7 of Table 2 is negative."""
    elbow = one(experiment(solution, mocap=[as_recorded(solution)]), "human_angle", "Q7")
    assert elbow.label.startswith("Elbow flexion")
    assert elbow.trials.min() > 0.0


def test_force_sensors(solution: Solution) -> None:
    """Sensors that show 0.8 of the predicted force: the prediction is 25 % higher; irregular samples at about 0.1 s."""
    dense = resample(solution, 10)
    time = np.sort(np.append(np.random.default_rng(1).uniform(0.0, 2.0, 30), [0.0, 2.0]))
    force = 0.8 * np.interp(time, dense.time, dense.agents[0].load[:, 2])
    flags = np.zeros((len(time), 2), np.uint8)
    flags[3, 0] = 1
    record = ForceRecord(
        "f.csv", 1, ("index", "thumb"), 7.0 + time, np.stack([force + 1.0, np.ones_like(force)], axis=1), flags,
        np.zeros(2), (),
    )  # fmt: skip
    for span in (None, (0.0, 2.0)):
        found = experiment(solution, forces=[record], forces_lift=span)
        vertical = one(found, "hand_force", "sensors")
        assert vertical.measures.peak_difference == pytest.approx(25.0, abs=1.5)
        assert any("1 of 32 samples are flagged" in note for note in found.notes)
        assert any("first and last sample" in note for note in found.notes) == (span is None)
    with pytest.raises(InputError, match="trial 1 = '8 to 10 s': holds 7 to 9 s"):
        experiment(solution, forces=[record], forces_lift=(1.0, 3.0))


def test_another_person_is_said(as_recorded: Made, solution: Solution) -> None:
    record = as_recorded(solution)
    other = replace(record, subject=Subject(1.6, 55.0, "female"))
    assert not any("predicted is one of" in note for note in experiment(solution, mocap=[record]).notes)
    assert any("1.600 m, 55 kg, female; predicted" in note for note in experiment(solution, mocap=[other]).notes)


def test_what_cannot_be_compared(as_recorded: Made, solution: Solution) -> None:
    with pytest.raises(InputError, match="needs recordings"):
        experiment(solution)
    with pytest.raises(InputError, match="must be a solved"):
        experiment(replace(solution, outcome="stopped"), mocap=[as_recorded(solution)])


def test_the_scenario_of_a_recorded_prediction_is_its_own(as_recorded: Made, solution: Solution) -> None:
    """The person's and the robot's grasp are mirror images in a table: its depth is what lies between the carriers."""
    made, given = recorded_scenario(as_recorded(solution), 2.0), solution.scenario
    assert (made.duration, made.first("person"), made.object.mass) == (given.duration, given.first("person"), 2.0)
    assert made.object.depth == pytest.approx(given.object.depth, abs=2e-3)
    for end in ("start", "end"):
        ours, theirs = getattr(made.task, end), getattr(given.task, end)
        assert ours.height == pytest.approx(theirs.height, abs=1e-3)
        assert ours.human_distance == pytest.approx(theirs.human_distance, abs=1e-3)
    assert (made.agents["robot"].weight, made.limits.table_pitch_deg) == (0.0, 1.0)


def test_the_moved_feet_are_taken_off(as_recorded: Made, solution: Solution) -> None:
    """A person who stands 0.1 m ahead and 0.05 m lower, hand and all, is given the same lift."""
    record = as_recorded(solution)
    q = record.q.copy()
    for joint, shift in zip(("GT1", "GT2", "GT3"), _along(record, [0.1, 0.0, -0.05]), strict=True):
        q[:, record.joint_names.index(f"human_{joint}")] += shift
    moved = replace(record, q=q, hand_position=record.hand_position + np.array([0.1, 0.0, -0.05]))
    made, before = recorded_scenario(moved, 2.0), recorded_scenario(record, 2.0)
    assert made.task.start == before.task.start
    assert made.task.end == before.task.end


def _along(record: RecordedLift, shift: list[float]) -> Array:
    """Return the values of GT1 to GT3 that move the base by ``shift``, by finite differences of its place."""
    import pinocchio as pin

    from liftopt.multibody.urdf import load_model

    model = load_model(record.urdf)
    data, joint = model.createData(), model.getJointId("human_GT3")
    columns = []
    for q in (np.zeros(model.nq), *np.eye(model.nq)[:3]):
        pin.forwardKinematics(model, data, q)
        columns.append(data.oMi[joint].translation.copy())
    return np.asarray(np.linalg.solve((np.array(columns[1:]) - columns[0]).T, shift), float)


def test_half_the_weight_is_on_either_carrier(
    as_recorded: Made, solved: Callable[..., Any], solution: Solution
) -> None:
    """At rest at both ends, a level object hangs half on each: statics."""
    made = recorded_scenario(as_recorded(solution), 2.0)
    overrides = [
        "robot.weight=0.0",
        "objective.force_weight=1.0",
        "limits.table_pitch_deg=1.0",
    ]
    lift = solved("table5_paper", *CHEAP, "task.rest=acceleration", *overrides).solution
    assert made.limits.table_pitch_deg == lift.scenario.limits.table_pitch_deg
    assert lift.solved
    vertical = np.stack([agent.load[[0, -1], 2] for agent in lift.agents])
    np.testing.assert_allclose(vertical, GRAVITY, rtol=1e-6)


def test_no_object_no_scenario(as_recorded: Made, solution: Solution) -> None:
    with pytest.raises(InputError, match="shows no object that is carried"):
        recorded_scenario(replace(as_recorded(solution), carried=None), 2.0)
    with pytest.raises(InputError, match="--object-mass"):
        recorded_scenario(as_recorded(solution), -1.0)
