"""The tables of ``solve --details`` and the JSON of lifts by other teams; the oracle is each one's own trajectory."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.commands.solved_text import solved_text
from liftopt.solution.interpolation import between_knots


@pytest.mark.parametrize("name", ["two_people", "two_robots"])
def test_json_holds_everybody_by_name(team_solution: Callable[[str], Any], name: str) -> None:
    lift = team_solution(name).solution
    found = json.loads(solved_text(lift, Path("out"), as_json=True, details=False))
    names = [agent.name for agent in lift.agents]
    for part in (found["joints"], found["load_share"]["agents"], found["grasp_force"]["agents"]):
        assert list(part) == names
    judged = {one["agent"] for one in found["assessment"] if one["code"].startswith("verdict.") and one["agent"]}
    assert judged == set(names)
    if name == "two_robots":
        assert [key for key in found if key.endswith("ground_reaction")] == ["ground_reaction"]
        return
    fine = between_knots(lift)
    for name, key in (("anna", "ground_reaction"), ("ben", "ben_ground_reaction")):
        peak = found[key]["vertical"]["peak_N"]
        assert peak == pytest.approx(np.abs(fine[name].ground_force[:, 2]).max(), rel=1e-12)


@pytest.mark.parametrize("name", ["two_people", "two_robots"])
def test_details_tell_everybody_by_name(team_solution: Callable[[str], Any], name: str) -> None:
    lift = team_solution(name).solution
    text = solved_text(lift, Path("out"), as_json=False, details=True)
    for agent in lift.agents:
        assert f"{agent.name.capitalize()} joint torques" in text
        assert f"grasp force, {agent.name}" in text
    several = len(lift.persons) > 1
    for person in lift.persons:
        assert (f"{person.name}: ground, vertical" in text) == several
    assert ("ground reaction, vertical" in text) != several
    squared = sum(line.split()[2:5] == ["N^2", "m^2", "s"] for line in text.splitlines())
    assert squared == len(lift.agents)
    assert max(map(len, text.splitlines())) <= 80
