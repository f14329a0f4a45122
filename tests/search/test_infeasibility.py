"""What is in the way and what would help: oracles are SciPy on Pinocchio, half the weight in each hand, speed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import minimize

from liftopt.collocation.solvers.banded import Banded
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.scenario.build import agent_of
from liftopt.scenario.model import load_scenario
from liftopt.search import suggested_changes
from liftopt.search.adjustables import adjustables
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.coarse_search import coarse_search
from liftopt.search.found import Found
from liftopt.search.infeasibility import infeasible_candidate
from liftopt.search.initial_guess import InitialGuess, InitialGuessSet, naive_guess
from liftopt.search.session import Session
from liftopt.search.solve import WIDER, solve
from liftopt.search.suggested_changes import suggest_changes
from liftopt.solution.solution import Solution
from liftopt.solution.summary import summary_dict

pytestmark = pytest.mark.long
FAR = ("task.standing_distance=2.3",)
MUCH_TOO_FAR = ("task.standing_distance=3",)
HEAVY = ("object.mass=40",)
WEAK = ("limits.max_grasp_force=8", "duration=8")
FAST = ("duration=0.27", "object.mass=6", "solver.starts=3")
BANDED = ("solver.name=banded", "solver.starts=2", "solver.intervals=10", "solver.time_limit=3600")


@cache
def _cache() -> SolverCache:
    return SolverCache()


@cache
def _solution(*overrides: str) -> Solution:
    return solve(load_scenario("table5_paper", [*BANDED, *overrides]), cache=_cache())


def _infeasible(session: Session, start: InitialGuess | None = None) -> Found:
    """Return what a search hands on that found nothing, and for what reasons."""
    problem, reasons = session.problem(session.spline), _solution(*FAR).reasons
    start = start or naive_guess(problem)
    best = infeasible_candidate(session.scenario, problem, session.spline, start, reasons)
    return Found(best, reasons=reasons)


def _value(solution: Solution, *keys: str) -> float:
    return next(change.values[0] for change in solution.suggested_changes if change.keys == keys)


def _farthest(height: float) -> float:
    """Return the largest distance of feet and base at which the robot's hand gets to 0.85 m ahead of the feet."""
    robot = agent_of(load_scenario("table5_paper", FAR), "robot")
    model, limits = robot.reduced(), robot.limits
    data, frame = model.createData(), model.getFrameId(robot.hands[0])

    def hand(q: np.ndarray) -> np.ndarray:
        pin.framesForwardKinematics(model, data, q)
        return np.array(data.oMf[frame].translation)

    def slope(q: np.ndarray) -> np.ndarray:
        return np.asarray(pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)[:3])

    found = []
    for seed in range(12):
        q = np.random.default_rng(seed).uniform(limits.q_lower, limits.q_upper)
        level = {"type": "eq", "fun": lambda q: hand(q)[2:] - height, "jac": lambda q: slope(q)[2:]}
        result = minimize(
            lambda q: hand(q)[0], q, jac=lambda q: slope(q)[0], constraints=[level], method="SLSQP",
            bounds=list(zip(limits.q_lower, limits.q_upper, strict=True)),
        )  # fmt: skip
        found += [float(result.fun)] if result.success else []
    return 2.3 - (min(found) - 0.85)


def test_a_robot_too_far_away_is_to_come_as_near_as_it_must_reach() -> None:
    """The base moves in steps of 1 cm; one more is granted to torques and to the motion between the ends."""
    solution, farthest = _solution(*FAR), min(_farthest(0.9), _farthest(1.4))
    assert not solution.solved
    assert [(r.constraint, r.who, r.time) for r in solution.reasons] == [
        ("grasp_closure", "robot", 0.0), ("grasp_closure", "robot", 2.0)
    ]  # fmt: skip
    nearer = _value(solution, "task.standing_distance")
    assert farthest - 0.02 <= nearer <= farthest
    message = next(r.message for r in solution.suggested_changes if r.keys == ("task.standing_distance",))
    assert message == f"robot base {2.3 - nearer:.2f} m nearer"


def test_a_robot_much_too_far_away_is_to_come_as_near_as_one_somewhat_too_far_away() -> None:
    """What it must reach does not depend on where it stood."""
    values = [_value(_solution(*far), "task.standing_distance") for far in (FAR, MUCH_TOO_FAR)]
    assert values[0] == pytest.approx(values[1], abs=0.015)


def test_an_object_too_heavy_for_two_grasps_is_to_weigh_what_they_hold() -> None:
    """Two hands of 8 N hold 16 N, and 9.81 N hold 2 kg; steps of 0.1 kg and 1 N, and hardly any acceleration in 8 s."""
    solution = _solution(*WEAK)
    assert {(r.constraint, r.unit) for r in solution.reasons} == {("grasp_force", "times the limit")}
    assert _value(solution, "object.mass") == pytest.approx(np.floor(10 * 16 / 9.81) / 10)
    assert _value(solution, "limits.max_grasp_force") == np.ceil(2 * 9.81 / 2)


def test_a_lift_too_short_names_joints_limits_and_times_and_is_to_last_longer(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 2 m/s, 0.5 m take 0.26 s with 20 intervals; 0.27 s leave that speed, and torques and times are named."""
    longer = adjustables(load_scenario("table5_paper"))[0]
    monkeypatch.setattr(suggested_changes, "adjustables", lambda scenario: [longer])
    solution = _solution(*FAST)
    assert solution.status.startswith("infeasible: ")
    assert "\n" not in solution.status
    assert solution.reasons
    for reason in solution.reasons:
        assert reason.message in solution.status
        assert reason.time is not None and 0.0 <= reason.time <= 0.27
        assert f"at {reason.time:.2f} s" in reason.message
        assert reason.share > 0.0 and f"({100 * reason.share:.0f} %)" in reason.message
    assert {"velocity", "torque"} & {reason.constraint for reason in solution.reasons}
    assert 0.27 < _value(solution, "duration") < 0.5


@pytest.mark.parametrize("overrides", [FAR, WEAK, HEAVY])
def test_each_suggested_change_leads_to_a_verified_lift_and_is_told(overrides: tuple[str, ...]) -> None:
    """Solved from the beginning, not from the motion that led to it; a heavy object could be let fall at first."""
    solution = _solution(*overrides)
    assert solution.suggested_changes == tuple(sorted(solution.suggested_changes, key=lambda change: change.size))
    summary = summary_dict(solution)
    assert [entry["message"] for entry in summary["suggested_changes"]] == [
        change.message for change in solution.suggested_changes
    ]
    assert solution.suggested_changes
    for change in solution.suggested_changes:
        changes = dict(zip(change.keys, change.values, strict=True))
        assert solve(solution.scenario.replace(changes), cache=_cache()).solved


def test_no_work_or_no_time_no_suggested_change_and_the_scenario_stays_as_it_is() -> None:
    scenario = load_scenario("table5_paper", [*BANDED, *FAR])
    before = scenario.to_dict()
    session = Session(scenario, _cache())
    found = _infeasible(session)
    assert suggest_changes(session, found, work=0.0) == ()
    session.limit = Deadline.after(0.0)
    assert suggest_changes(session, found) == ()
    assert scenario.to_dict() == before


def test_a_change_that_leaves_what_a_model_can_be_is_not_suggested() -> None:
    """A scenario takes a base height of 0.01 m, Sawyer's model none below 0.1 m."""
    scenario = load_scenario("table5_paper", [*BANDED, "robot.base_height=0.3"])
    session = Session(scenario, _cache())
    (height,) = [found for found in adjustables(scenario) if found.keys == ("robot.base_height",)]
    trials = suggested_changes._Trials(session, _infeasible(session), suggested_changes.WORK)
    assert trials.solve(height, -29) is None


def test_a_lift_that_no_start_led_to_is_found_from_the_motion_that_breaks_least(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The solver gives up at every start but the last, which it is brought by the elastic problem.

    To which of several optima that leads, and whether that one takes a finer mesh, is for rounding to decide.
    """
    own_solve = Banded.solve
    failed: list[SolverResult] = []

    def fails_first(self: Banded, x0: np.ndarray, **given: Any) -> SolverResult:
        result = own_solve(self, x0, **given)
        if len(self.problem.mesh.phase) == 1 or len(failed) == 2:  # a posture, or the last start
            return result
        failed.append(result)
        return replace(result, converged=False, status="Line_Search_Failed", x=x0)

    monkeypatch.setattr(Banded, "solve", fails_first)
    solution = solve(load_scenario("table5_paper", [*BANDED, "solver.tries=0"]))
    assert solution.solved and solution.kept_start.startswith("elastic")
    first, others = solution.starts[:3], solution.starts[3:]
    assert [start.status for start in first] == ["Line_Search_Failed"] * 2 + ["converged"]
    assert first[-1].name == "elastic" and all(start.name.startswith("elastic, ") for start in others)
    assert solution.reasons == () == solution.suggested_changes


def test_a_lift_counts_as_impossible_only_after_many_more_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first coarse search finds nothing and the starts on the full mesh fail; those after them find the lift."""
    asked: list[int] = []

    def blind(
        session: Session, spline: RestToRestSpline, guesses: InitialGuessSet, tries: int, *most: int
    ) -> list[Candidate]:
        asked.append(tries)
        return coarse_search(session, spline, guesses, tries, *most) if len(asked) > 1 else []

    def fails(session: Session, spline: RestToRestSpline, starts: list[InitialGuess]) -> Found:
        return _infeasible(session, starts[0])

    monkeypatch.setattr("liftopt.search.solve.coarse_search", blind)
    monkeypatch.setattr("liftopt.search.solve.solve_starts", fails)
    finer = "solver.intervals=20"  # than the coarse search's, so that there are two meshes
    solution = solve(load_scenario("table5_paper", [*BANDED, finer, "solver.tries=2"]), cache=_cache())
    assert asked == [2, 2 * WIDER]
    assert solution.solved and solution.reasons == () == solution.suggested_changes
