"""A lift by both hands of one person comes back from its file as it was."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from liftopt.solution.summary import summary_dict
from liftopt.storage.reader import load_result

HANDS = ["human_right", "human_left"]


def test_file_names_both_hands_and_keeps_their_forces(alone: Any) -> None:
    """The file is read by xarray, apart from our reader."""
    assert alone.solution.solved, alone.solution.status
    (person,), (again,) = alone.solution.agents, load_result(alone.folder).agents
    with xr.open_dataset(alone.folder / "solution.nc") as file:
        assert file["grasp"].values.tolist() == HANDS
        for own, hand in enumerate(HANDS):
            for kind in ("grasp_force", "grasp_moment"):
                np.testing.assert_array_equal(file[kind].sel(grasp=hand), getattr(person, kind)[:, own])
        np.testing.assert_allclose(file["grasp_position"], person.grasp_position, rtol=0, atol=1e-6)
    for kind in ("q", "tau", "grasp_force", "grasp_moment"):
        np.testing.assert_array_equal(getattr(again, kind), getattr(person, kind))
    np.testing.assert_allclose(again.ground_moment, person.ground_moment, rtol=0, atol=1e-9)
    assert [grasp.name for grasp in again.grasps] == HANDS


def test_hands_are_told_apart(alone: Any) -> None:
    """Of a box that is the same on both sides both carry alike."""
    summary = summary_dict(alone.solution)
    peaks = [summary["grasp_force"]["agents"][hand]["peak_N"] for hand in HANDS]
    assert np.isclose(*peaks, rtol=0.05) and list(summary["grasp_moment"]) == HANDS
    titles = [finding.title for finding in alone.solution.assessment if finding.code == "person.grasp_force"]
    assert len(titles) == 2 and "right hand" in titles[0] and "left hand" in titles[1]
