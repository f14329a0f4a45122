"""A search keeps bodies apart: coal on a ten times finer grid, the KKT error and the free optimum are the oracles."""

from __future__ import annotations

import numpy as np
import pytest

from liftopt.control.replanning import Replanner
from liftopt.scenario.build import obstacles_of
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.make_clear import pairs_in
from liftopt.search.session import Session
from liftopt.search.solid_distances import solid_distances
from liftopt.search.solve import find_lift, solve
from liftopt.search.team_solids import TeamSolids

BOX = {"object.depth": 0.3, "object.width": 0.3, "object.height": 0.3, "solver.tries": 16}
QUICK = {"solver.tries": 12, "solver.time_limit": 300.0}


def box(clearance: float | str) -> Scenario:
    return load_scenario("table5_paper").replace({**BOX, **QUICK, "limits.clearance": clearance})


def depth(candidate: Candidate, clearance: float = 0.0) -> tuple[float, str]:
    """Return the least distance of all pairs, beyond what they are asked to keep [m], and of which."""
    problem, spline = candidate.problem, candidate.spline
    solids = TeamSolids.of(problem.team, obstacles_of(candidate.scenario))
    phase = np.linspace(0.0, 1.0, 10 * spline.intervals + 1)
    coordinates = spline.basis(phase) @ problem.unpack(candidate.result.x)[0]
    least = solid_distances(solids, problem, coordinates, 0.05).distance.min(axis=0)
    least = least - np.array([pair.asked(clearance) for pair in solids.pairs])
    return float(least.min()), solids.pairs[int(least.argmin())].told


@pytest.fixture(scope="module")
def free() -> Candidate:
    return find_lift(Session(box("off"), SolverCache())).best


@pytest.fixture(scope="module")
def cache() -> SolverCache:
    return SolverCache()


@pytest.fixture(scope="module")
def clear(cache: SolverCache) -> Candidate:
    return find_lift(Session(box(0.0), cache)).best


def test_a_box_that_was_deep_in_the_arm_is_clear(free: Candidate, clear: Candidate) -> None:
    deep, told = depth(free)
    assert free.solved and deep < -0.03 and told.endswith("and table")
    assert clear.solved and depth(clear)[0] >= -0.001
    assert clear.verification.check("clearance").passed and clear.verification.kkt_error <= 1e-6
    assert free.result.objective < clear.result.objective < 1.1 * free.result.objective


def test_planes_that_bind_have_multipliers(clear: Candidate) -> None:
    """And only they: what is idle has none to speak of."""
    problem, lam = clear.problem, clear.result.multipliers.g
    assert problem.planes is not None
    rows = np.concatenate(
        [np.arange(b.rows.start, b.rows.stop) for b in problem.constraints.blocks if b.name == "clearance"]
    )
    active = np.concatenate([separation.active.ravel() for separation in problem.planes.separations])
    assert np.abs(lam[rows][~active]).max(initial=0.0) < 1e-4 < 0.1 < np.abs(lam[rows][active]).max()


def test_a_wider_clearance_is_kept_too() -> None:
    found = find_lift(Session(box(0.03), SolverCache())).best
    assert found.solved and depth(found, 0.03)[0] >= -0.001


def test_where_nothing_is_near_the_answer_is_the_same() -> None:
    """Bit by bit, and without planes."""
    scenario = load_scenario("table5_paper").replace({**QUICK, "object.depth": 0.6, "object.mass": 1.0})
    changes = {"task.start.human_distance": 0.45, "task.end.human_distance": 0.45, "task.standing_distance": 2.1}
    first, second = (
        find_lift(Session(scenario.replace({**changes, "limits.clearance": limit}), SolverCache())).best
        for limit in ("off", 0.0)
    )
    if depth(first)[0] < 0.0:
        pytest.skip("this lift is not clear by itself")
    np.testing.assert_array_equal(first.result.x, second.result.x)
    assert second.problem.planes is None


def test_replans_keep_clear(clear: Candidate, cache: SolverCache) -> None:
    """Other masses, heights and statures, from the latest plan: few iterations, verified clear."""
    replanner = Replanner(cache=cache)
    replanner.latest = clear
    for change in ({"object.mass": 2.1}, {"task.end.height": 1.38}, {"human.stature": 1.76}):
        plan = replanner.replan(clear.scenario.replace(change))
        assert plan is not None and plan.result.iterations < 40
        solids = TeamSolids.of(plan.problem.team, ())
        assert len(pairs_in(solids, plan.problem.planes))
        solution, latest = replanner.solve(plan.scenario), replanner.latest
        assert solution.solved and latest is not None and depth(latest)[0] >= -0.001


def test_a_lift_that_bodies_block_says_which() -> None:
    """A wall between the two, through which the object would have to reach: elastic mode names it and the object."""
    wall = {"name": "wall", "box": [0.05, 3.0, 2.5], "position": [0.6, 0.0, 0.0]}
    found = find_lift(Session(box(0.0).replace({"obstacles": [wall]}), SolverCache()))
    assert not found.best.solved
    named = [reason for reason in found.reasons if reason.constraint == "clearance"]
    assert any("wall" in reason.who and reason.amount > 0.05 for reason in named)
    assert "wall" in found.best.outcome


def test_an_object_that_starts_within_something_is_to_start_above_it() -> None:
    """A pallet that is 5 cm higher than where the object starts: the reason tells so, the change was solved."""
    pallet = {"name": "pallet", "box": [0.3, 3.0, 0.95], "position": [0.6, 0.0, 0.475]}
    scenario = load_scenario("table5_paper").replace({**QUICK, "solver.tries": 4, "limits.clearance": 0.0})
    solution = solve(scenario.replace({"obstacles": [pallet]}))
    (reason,) = [reason for reason in solution.reasons if reason.who == "table and pallet"]
    assert not solution.solved and reason.time == 0.0 and reason.amount == pytest.approx(0.05, abs=2e-3)
    higher = [change for change in solution.suggested_changes if change.keys == ("task.start.height",)]
    assert higher and higher[0].values[0] >= 0.949
