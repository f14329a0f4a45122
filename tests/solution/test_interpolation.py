"""Between knots: the oracles are a closed form and the verification, which samples the solver's own spline."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from liftopt.solution.interpolation import motion_between, resample

CHEAP = ("solver.intervals=10", "solver.starts=1")


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Any:
    return solved("table5", *CHEAP).solution


def test_a_cubic_comes_back_exactly() -> None:
    # q = 1 + 2 t - t^2 + 3 t^3 has a linear acceleration, on uneven knots too.
    knots, time = np.array([0.0, 0.3, 1.0, 1.1, 2.0]), np.linspace(0.0, 2.0, 37)

    def cubic(t: np.ndarray) -> tuple[np.ndarray, ...]:
        return (1 + 2 * t - t**2 + 3 * t**3)[:, None], (2 - 2 * t + 9 * t**2)[:, None], (-2 + 18 * t)[:, None]

    for found, wanted in zip(motion_between(knots, *cubic(knots), time), cubic(time), strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-12)


def test_finer_grid_shows_the_closure_that_the_verification_found_on_the_solvers_spline(solution: Any) -> None:
    dense = resample(solution, 10)
    gaps = [
        np.linalg.norm(agent.p_world_hold - dense.object.grasp_position[:, i], axis=1).max()
        for i, agent in enumerate(dense.agents)
    ]
    found = solution.verification.check("grasp closure between knots").value
    assert max(gaps) == pytest.approx(found, rel=1e-6)


def test_knots_stay_what_they_were(solution: Any) -> None:
    dense = resample(solution, 4)
    np.testing.assert_allclose(dense.time[::4], solution.time, atol=1e-15)
    for fine, coarse in zip(dense.agents, solution.agents, strict=True):
        for name in ("q", "v", "a", "tau", "grasp_force"):
            np.testing.assert_allclose(getattr(fine, name)[::4], getattr(coarse, name), atol=1e-9)
    np.testing.assert_allclose(dense.object.pose[::4], solution.object.pose, atol=1e-12)
