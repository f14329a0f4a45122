"""Verification: each way a result can be wrong is put in on purpose; the oracle is what was put in, and where."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.scenario.model import load_scenario
from liftopt.search.initial_guess import posture_starts
from liftopt.solution.checks import Check, Verification
from liftopt.solution.verify import verify

N, KNOT = 20, 7  # the knot that is tampered with, at 0.70 s
TOLERANCE = 1e-6


@dataclass(frozen=True)
class Solve:
    """A converged lift and ways to spoil it."""

    problem: Problem
    spline: RestToRestSpline
    result: SolverResult

    def verify(self, result: SolverResult) -> Verification:
        """Verify a result of this problem."""
        return verify(self.problem, self.spline, result, TOLERANCE)

    def with_control(self, column: int, change: float, row: int = KNOT) -> SolverResult:
        """Return the result with a control point of one coordinate moved."""
        x = self.result.x.copy()
        x[self.problem.layout.control[row, column]] += change
        return replace(self.result, x=x)

    def with_force(self, change: np.ndarray) -> SolverResult:
        """Return the result with the grasp forces (6,) at the knot changed."""
        x = self.result.x.copy()
        x[self.problem.layout.force[KNOT]] += change
        return replace(self.result, x=x)


@pytest.fixture(scope="module")
def solve() -> Solve:
    scenario, spline = load_scenario("table5_paper"), RestToRestSpline(N)
    team = Team.of(agents_of(scenario), object_of(scenario))
    problem = Problem(team, task_of(scenario), spline.mesh())
    deadline = NEVER
    start = posture_starts(problem, 1, 0, deadline)[0]
    result = Ipopt(problem).solve(start.x, deadline=deadline)
    assert result.converged
    return Solve(problem, spline, result)


def _failed(verification: Verification) -> set[str]:
    return {check.name for check in verification.checks if not check.passed}


def test_an_untouched_result_passes(solve: Solve) -> None:
    verification = solve.verify(solve.result)
    assert verification.passed, verification.describe_failure()
    assert verification.max_violation <= 1e-6


@pytest.mark.parametrize(("column", "who"), [(3, "human"), (12, "robot")])
def test_a_moved_joint_opens_the_loop_of_its_own_agent(solve: Solve, column: int, who: str) -> None:
    verification = solve.verify(solve.with_control(column, 1e-4))
    check = verification.check("grasp closure at the knots")
    assert not check.passed
    # The control point's basis function peaks at the knot of its index, two thirds of its height.
    assert 1e-6 < check.value < 1e-4
    assert check.where == f"{who} at 0.70 s"
    assert "objective by Pinocchio" in _failed(verification)


@pytest.mark.parametrize(("axis", "row"), [(0, "force x"), (1, "force y"), (2, "force z")])
def test_a_changed_force_tips_the_balance(solve: Solve, axis: int, row: str) -> None:
    verification = solve.verify(solve.with_force(2e-3 * np.eye(6)[axis]))
    check = verification.check("balance at the knots")
    assert not check.passed
    assert check.value == pytest.approx(2e-3, rel=0.1)
    assert check.where == f"table {row} at 0.70 s"
    assert "grasp closure at the knots" not in _failed(verification)


def test_a_squeeze_beyond_the_cap_is_seen_though_the_object_stays_in_balance(solve: Solve) -> None:
    control, _ = solve.problem.unpack(solve.result.x)
    pose = solve.problem.mesh.basis[0][KNOT] @ control[:, -6:]
    along = np.array(
        [
            np.cos(pose[4]) * np.cos(pose[5]),
            np.sin(pose[5]) * np.cos(pose[3]) + np.cos(pose[5]) * np.sin(pose[3]) * np.sin(pose[4]),
            np.sin(pose[3]) * np.sin(pose[5]) - np.cos(pose[3]) * np.sin(pose[4]) * np.cos(pose[5]),
        ]
    )  # the body's x axis, Rx Ry Rz e_x
    verification = solve.verify(solve.with_force(300.0 * np.concatenate([along, -along])))
    check = verification.check("grasp force cap")
    assert not check.passed
    assert 50.0 < check.value < 150.0
    assert check.where in ("human at 0.70 s", "robot at 0.70 s")
    assert verification.check("balance at the knots").passed
    torque = verification.check("torque limits")
    assert not torque.passed
    assert torque.where.endswith("at 0.70 s")


def test_a_joint_beyond_its_range_is_named_with_its_time(solve: Solve) -> None:
    """A control point 2 rad above the limit puts the knot below it two thirds of its weight outside."""
    elbow, limits = 6, solve.problem.team.agents[0].limits
    here = solve.result.x[solve.problem.layout.control[KNOT, elbow]]
    verification = solve.verify(solve.with_control(elbow, limits.q_upper[elbow] - here + 2.0))
    check = verification.check("position limits")
    assert not check.passed
    assert check.where == "human_Q7 at 0.70 s"
    speed = verification.check("speed limits")
    assert not speed.passed
    assert speed.where.startswith("human_Q7 at ")


def test_the_objects_tilt_is_limited_too(solve: Solve) -> None:
    verification = solve.verify(solve.with_control(-2, 0.5))
    check = verification.check("position limits")
    assert not check.passed
    assert check.where == "table pitch at 0.70 s"


def test_a_wrong_end_is_named(solve: Solve) -> None:
    verification = solve.verify(solve.with_control(-4, 1e-3, row=-1))
    check = verification.check("pose at the ends")
    assert check.value == pytest.approx(1e-3, rel=1e-6)
    assert check.where == "table z at 2.00 s"
    assert not check.passed


def test_a_motion_that_does_not_rest_at_its_ends_is_seen(solve: Solve) -> None:
    class Cut(RestToRestSpline):
        """The middle of the motion: it starts and ends at speed."""

        def basis(self, phase: np.ndarray, derivative: int = 0) -> np.ndarray:
            return super().basis(0.2 + 0.6 * phase, derivative)

    verification = verify(solve.problem, Cut(N), solve.result, TOLERANCE)
    assert "speed at the ends" in _failed(verification)
    assert "acceleration at the ends" not in _failed(verification)


def test_an_acceleration_at_the_ends_is_refused_where_none_is_asked_for(solve: Solve) -> None:
    class Stiller(RestToRestSpline):
        """The motion as it was solved, where zero acceleration was asked for."""

        def basis(self, phase: np.ndarray, derivative: int = 0) -> np.ndarray:
            return solve.spline.basis(phase, derivative)

    verification = verify(solve.problem, Stiller(N, "acceleration"), solve.result, TOLERANCE)
    assert _failed(verification) == {"acceleration at the ends"}
    joint = verification.check("acceleration at the ends")
    control, _ = solve.problem.unpack(solve.result.x)
    # Closed form: of a clamped spline whose first two control points are one, q''(0) = 3 (c_1 - c_0) N**2 / T**2.
    steps = np.stack([control[1] - control[0], control[-2] - control[-1]])
    assert joint.value == pytest.approx(3 * np.abs(steps).max() * (N / solve.problem.task.duration) ** 2)


def test_lost_multipliers_fail_by_the_kkt_error_alone(solve: Solve) -> None:
    lost = Multipliers(np.zeros_like(solve.result.multipliers.x), np.zeros_like(solve.result.multipliers.g))
    verification = solve.verify(replace(solve.result, multipliers=lost))
    assert _failed(verification) == set()
    assert not verification.passed
    assert verification.describe_failure().startswith("KKT error ")


def test_a_feasible_start_is_not_taken_for_an_optimum(solve: Solve) -> None:
    """Multipliers of the wrong sign: every bound would push outward."""
    multipliers = solve.result.multipliers
    verification = solve.verify(replace(solve.result, multipliers=Multipliers(-multipliers.x, -multipliers.g)))
    assert verification.kkt_error > TOLERANCE
    assert not verification.passed


@pytest.mark.parametrize("factor", [1.0 + 1e-6, 0.5, 0.0, -1.0, np.nan])
def test_an_objective_that_pinocchio_does_not_find_is_seen(solve: Solve, factor: float) -> None:
    verification = solve.verify(replace(solve.result, objective=factor * solve.result.objective))
    assert _failed(verification) == {"objective by Pinocchio"}
    assert "objective by Pinocchio" in verification.describe_failure()


def test_a_solver_that_was_fed_a_wrong_robot_is_found_out(solve: Solve) -> None:
    """Oracle: the exported models. The kernels' parameters are not theirs: the solver converges to another lift."""
    team = solve.problem.team
    human, robot, table = team.topologies
    wrong = replace(robot, entries=robot.entries * 1.01)
    fooled = replace(solve.problem, team=replace(team, topologies=(human, wrong, table)))
    result = Ipopt(fooled).solve(solve.result.x, deadline=NEVER)
    verification = solve.verify(result)
    assert not verification.passed
    assert {"grasp closure at the knots", "objective by Pinocchio"} <= _failed(verification)


@pytest.mark.parametrize(
    ("part", "names"),
    [
        ("joint", {"grasp closure at the knots", "position limits", "speed limits", "torque limits"}),
        ("force", {"balance at the knots", "torque limits", "grasp force cap"}),
        ("end", {"pose at the ends", "speed at the ends", "grasp closure at the knots", "position limits"}),
    ],
)
def test_nan_passes_nothing_that_it_touches(solve: Solve, part: str, names: set[str]) -> None:
    spoilt = {
        "joint": solve.with_control(3, np.nan),
        "force": solve.with_force(np.nan * np.eye(6)[0]),
        "end": solve.with_control(-6, np.nan, row=0),
    }[part]
    verification = solve.verify(spoilt)
    assert names <= _failed(verification)
    assert not verification.kkt_error <= TOLERANCE
    assert not verification.passed
    assert not verification.max_violation <= 1e-6


def test_worst_is_the_largest_share_of_its_limit() -> None:
    checks = (Check("a", 1e-7, 1e-6, "m", ""), Check("b", 5e-4, 1e-3, "m", ""), Check("c", 70.0, np.inf, "Nm", ""))
    assert Verification(checks, 0.0, 1e-6).worst.name == "b"
    assert Verification((*checks, Check("d", np.nan, np.inf, "Nm", "")), 0.0, 1e-6).worst.name == "d"
    assert not Verification(checks, float("nan"), 1e-6).passed
    with pytest.raises(KeyError):
        Verification(checks, 0.0, 1e-6).check("e")
