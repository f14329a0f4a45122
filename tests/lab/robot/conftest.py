"""Lifts with robots of example-robot-data, made without a solver."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest

from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.solution.solution import Solution
from liftopt.storage.writer import save


@pytest.fixture(scope="session")
def arm_lift(team_solution: Callable[[str], Any]) -> Callable[[str], Solution]:
    """Return a function that gives the lift of a person and the robot ``arm`` of that name, as ``team_solution``."""
    pytest.importorskip("yourdfpy", reason="yourdfpy is in the extra 'robots'")
    if share_folder() is None:
        pytest.skip("example-robot-data is in the extra 'robots'")
    return lambda name: team_solution(name).solution


@pytest.fixture(scope="session")
def ur_controller() -> Any:
    """Return the module that runs URScript."""
    spec = spec_from_file_location("ur_controller", Path(__file__).with_name("ur_controller.py"))
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def arm_folder(arm_lift: Callable[[str], Solution], tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return a function that gives the folder of such a lift."""

    @cache
    def saved(name: str) -> Path:
        folder = tmp_path_factory.mktemp(name)
        save(arm_lift(name), folder)
        return folder

    return saved
