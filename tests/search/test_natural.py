"""A natural lift, searched and verified; oracles: Pinocchio in the verification, and IPOPT for the objective."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr

from liftopt.scenario.build import agents_of
from liftopt.solution.solution import Solution
from liftopt.solution.summary import summary_dict
from liftopt.storage.reader import load_result

NATURAL = ("table5", "solver.intervals=12")


@pytest.fixture(scope="module")
def natural(solved: Callable[..., Any]) -> Solution:
    """Return the default lift, which is natural, on a coarse mesh."""
    solution: Solution = solved(*NATURAL).solution
    return solution


def test_it_is_solved_and_verified(natural: Solution) -> None:
    assert natural.solved, natural.status
    assert natural.verification.kkt_error <= 1e-6
    assert set(natural.objective_terms) == {"human", "robot", "acceleration", "force", "range", "tilt"}
    weighted = {name: natural.objective_weights[name] * value for name, value in natural.objective_terms.items()}
    assert natural.objective == pytest.approx(sum(weighted.values()), rel=1e-12)


def test_it_is_read_back_with_its_terms(natural: Solution, solved: Callable[..., Any]) -> None:
    """The attributes of solution.nc by xarray, and the result as it was."""
    folder = solved(*NATURAL).folder
    with xr.open_dataset(folder / "solution.nc") as data:
        assert data.attrs["preset"] == "natural"
        for name, value in natural.objective_terms.items():
            assert data.attrs[f"objective_{name}"] == value
    again = load_result(folder)
    assert again.objective_terms == natural.objective_terms
    assert again.objective_weights == natural.objective_weights
    terms = summary_dict(again)["objective"]["terms"]
    assert [terms[name]["unit"] for name in ("human", "robot", "range", "tilt")] == ["s"] * 4


def test_the_scenarios_own_weights_make_up_the_objective_at_any_pace(solved: Callable[..., Any]) -> None:
    """Terms in solution.nc times the weights in the scenario; the accelerations by hand, (1.5 s / 2 s)^4 of them."""
    folder = solved(*NATURAL, "duration=1.5", "solver.starts=1", "solver.tries=8").folder
    with xr.open_dataset(folder / "solution.nc") as data:
        terms = {name.removeprefix("objective_"): v for name, v in data.attrs.items() if name.startswith("objective_")}
        scenario = load_result(folder).scenario
        weights = {name: agent.weight for name, agent in scenario.agents.items()}
        weights |= {n: scenario.value(f"objective.{n}_weight") for n in ("acceleration", "force", "range", "tilt")}
        assert data.attrs["objective"] == pytest.approx(sum(w * terms[n] for n, w in weights.items()), rel=1e-12)
        squares = sum((data[name].values[:, -n:] ** 2).sum(axis=1) for name, n in (("human_a", 10), ("robot_a", 7)))
        squares = squares + (data["table_pose_acceleration"].values ** 2).sum(axis=1)
        expected = 0.75**4 * np.trapezoid(squares, data["time"].values)
    assert terms["acceleration"] == pytest.approx(expected, rel=1e-9)


def test_ipopt_finds_no_better_one(natural: Solution, solved: Callable[..., Any]) -> None:
    """And none worse by more than 2 %: both search from several starts."""
    other = solved(*NATURAL, "solver.name=ipopt", "solver.starts=2", "solver.tries=0").solution
    assert other.solved, other.status
    assert other.objective == pytest.approx(natural.objective, rel=0.02)


def test_torques_of_both_directions_count(natural: Solution) -> None:
    """Strength differs by direction where the torque of some joint changes its sign."""
    human = natural["human"]
    tau, limits = human.tau[:, human.moving], human.limits
    assert ((tau > 0.0).any(axis=0) & (tau < 0.0).any(axis=0)).any()
    assert (np.abs(limits.tau_upper + limits.tau_lower) > 1.0).any()


def test_the_person_holds_more_naturally_than_with_the_papers_weights(
    natural: Solution, solved: Callable[..., Any]
) -> None:
    """The cost of joint angles, in the mean over time."""
    paper = solved("table5_paper", "solver.intervals=12").solution
    comfort = agents_of(natural.scenario)[0].comfort
    assert comfort is not None
    costs = [comfort.cost(one["human"].q[:, one["human"].moving]).mean() for one in (natural, paper)]
    assert costs[0] < 0.5 * costs[1]
