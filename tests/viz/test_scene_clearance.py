"""The line between the nearest two bodies: against the solution's clearance, which coal measured."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from liftopt.viz.playback import playback_of
from liftopt.viz.scene_clearance import END, line_values, nearest_at
from liftopt.viz.viewer_page import playback_page

CHEAP = ("solver.intervals=10", "solver.starts=1")


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Any:
    return solved("table5", *CHEAP).solution


def _data(page: str) -> Any:
    (text,) = re.findall(r'type="application/json">(.*?)</script>', page, re.DOTALL)
    return json.loads(text)


def test_the_nearest_pair_is_that_of_the_sample_nearest_in_time(solution: Any) -> None:
    clearance = solution.clearance
    found = nearest_at(clearance, clearance.time)
    assert found is not None
    among = [kind for kind in clearance.kinds if "-" in kind.kind]
    np.testing.assert_array_equal(found["distance"], np.min([kind.distance for kind in among], axis=0))
    apart = np.linalg.norm(found["points"][:, 1] - found["points"][:, 0], axis=1)
    np.testing.assert_allclose(apart, np.abs(found["distance"]), atol=1e-6)
    step = float(clearance.time[1])
    for shift in (-0.4, 0.4):
        moved = nearest_at(clearance, np.clip(clearance.time + shift * step, 0.0, clearance.time[-1]))
        assert moved is not None
        np.testing.assert_array_equal(moved["distance"], found["distance"])
        assert moved["pairs"] == found["pairs"]


def test_the_line_ends_at_the_two_points(solution: Any) -> None:
    found = nearest_at(solution.clearance, playback_of(solution).time)
    assert found is not None
    values = line_values("/n", found["points"])
    turn = Rotation.from_quat(values["/n"]["quaternion"])
    np.testing.assert_allclose(values["/n"]["position"], found["points"][:, 0], atol=1e-12)
    end = values["/n"]["position"] + turn.apply(values["/n/end"]["position"])
    np.testing.assert_allclose(end, found["points"][:, 1], atol=2e-4)
    assert values["/n/shaft"]["scale"][:, 2].min() > 0.0
    assert END < 0.05


def test_the_page_tells_the_distance_and_whose_it_is(solution: Any) -> None:
    data = _data(playback_page(solution))
    (lift,) = data["lifts"]
    found = nearest_at(solution.clearance, np.array(lift["time"]))
    assert found is not None
    np.testing.assert_allclose(lift["nearest"]["distance"], found["distance"], atol=1e-4)
    assert [lift["nearest"]["pairs"][i] for i in lift["nearest"]["pair"]] == found["pairs"]
    drawn = {command["path"] for command in data["commands"] if command["type"] == "set_object"}
    assert {f"/lift/nearest/{part}/mesh" for part in ("shaft", "start", "end")} <= drawn


def test_of_what_has_no_clearance_nothing_is_told(solution: Any) -> None:
    data = _data(playback_page(replace(solution, clearance=None)))
    assert data["lifts"][0]["nearest"] is None
    assert not any("/nearest" in command.get("path", "") for command in data["commands"])
