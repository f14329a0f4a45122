"""A solved lift of a whole person, recorded by markers, followed and compared with itself: no difference is left."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from whole_markers import MAPPING, RATE, recorded_truth

from liftopt.lab.comparison.experiment import Experiment, experiment
from liftopt.lab.mocap.from_markers import recorded_lift
from liftopt.lab.mocap.hand_force import HandForce
from liftopt.lab.mocap.loads import Load
from liftopt.lab.mocap.whole_map import WholeMap
from liftopt.multibody.person.whole_body import WholeLengths
from liftopt.multibody.trajectory import attitude
from liftopt.scenario.build import subject_of
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.types import Array

STANDS, BENDS = 0.5, 1.5  # s before the lift: upright, and on the way to its start


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Solution:
    found: Solution = solved("table5", "solver.intervals=10", "solver.starts=1", "human.body=whole").solution
    return found


@pytest.fixture(scope="module")
def found(solution: Solution) -> Experiment:
    dense, person = resample(solution, 10), solution.scenario.first("person")
    human, lifted = dense["human"], dense.object
    before = STANDS + BENDS
    time = np.arange(round((before + float(dense.time[-1]) + 0.3) * RATE)) / RATE

    def over(values: Array) -> Array:
        flat = values.reshape(len(dense.time), -1)
        rows = np.stack([np.interp(time - before, dense.time, column) for column in flat.T], axis=1)
        return rows.reshape(len(time), *values.shape[1:])

    share = np.clip((time - STANDS) / BENDS, 0.0, 1.0)
    bent = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    q = bent[:, None] * over(human.q)
    pose = over(lifted.pose)
    lengths = WholeLengths.of(subject_of(person))
    truth = recorded_truth(lengths, solution.urdfs["human"], q, pose[:, :3], attitude(pose[:, 3:])[0])
    carried = (time >= before) & (time <= before + float(dense.time[-1]))
    forces = np.where(carried[:, None, None], over(human.grasp_force), 0.0) @ truth.turn.T
    hands = [HandForce(side, time, forces[:, i]) for i, side in enumerate(("right", "left"))]
    mapping = WholeMap.checked(
        MAPPING | {"subject": {"sex": person.sex, "mass": person.mass, "stature": person.stature}}
    )
    lift = recorded_lift(truth.recording, mapping, Load(measured=hands[0], left_measured=hands[1]), 12.0)
    return experiment(solution, mocap=[lift])


def test_angles_paths_and_forces_are_those_predicted(found: Experiment) -> None:
    # What the record takes for the lift begins and ends where the object is 5 mm away from its place.
    for one in found.group("human_angle"):
        assert one.measures.rmse < 2.0, one.name
    for one in found.group("hand_path"):
        assert one.measures.rmse < 0.02, one.name
    for one in found.group("hand_force"):
        assert one.measures.rmse < 0.05 * np.abs(one.predicted).max(), one.name


def test_torques_and_the_ground_are_those_predicted(found: Experiment) -> None:
    """By inverse dynamics of the followed motion; wrench grasps' moments are not measured, so wrists are left out."""
    torques = {one.name: one for one in found.group("human_torque")}
    for name in ("ankle", "knee", "hip", "Q2", "right_Q5", "left_Q5"):
        one = torques[name]
        assert one.measures.rmse < 0.1 * np.abs(one.predicted).max() + 2.0, name
    (vertical, pressure) = found.group("ground")
    assert vertical.measures.rmse < 0.03 * vertical.predicted.max()
    assert pressure.measures.rmse < 0.01
