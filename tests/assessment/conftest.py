"""A lift to judge."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from liftopt.solution.solution import Solution


@pytest.fixture(scope="session")
def light(solved: Callable[..., Any]) -> Solution:
    """Table 5 by the paper's objective on a coarse mesh, which is refined once."""
    solution: Solution = solved("table5", "objective.preset=paper", "solver.intervals=10", "solver.starts=1").solution
    return solution


@pytest.fixture(scope="session")
def heavy(solved: Callable[..., Any]) -> Any:
    """A table of 14 kg on a coarse mesh, and the folder of its result."""
    return solved("table5", "object.mass=14", "solver.intervals=20", "solver.starts=2")
