"""What is named as being in the way: oracles are the weight shared by two hands, straight lines, and speed limits."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.batch import Batch
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER, Deadline
from liftopt.multibody.agent import HalfSpace
from liftopt.scenario.build import agents_of, motions_of, object_of, task_of
from liftopt.scenario.model import load_scenario
from liftopt.search.feasibility_screen import screen_ends, too_fast
from liftopt.solution.infeasibility_report import InfeasibilityReason

N = 20


def _problem(*overrides: str) -> Problem:
    scenario = load_scenario("table5_paper", overrides)
    return Problem(Team.of(agents_of(scenario), object_of(scenario)), task_of(scenario), motions_of(scenario, N).mesh())


def _reasons(*overrides: str) -> list[InfeasibilityReason]:
    return screen_ends(_problem(*overrides), 0, NEVER)[0]


def test_nothing_is_in_the_way_of_the_default_lift_and_the_postures_hold_it() -> None:
    problem = _problem()
    reasons, postures = screen_ends(problem, 0, NEVER)
    assert reasons == []
    for posture, pose in zip(postures, (problem.task.start, problem.task.end), strict=True):
        z = posture.coordinates[-6:]
        np.testing.assert_allclose(z[[0, 2, 4, 5]], pose[[0, 2, 4, 5]], atol=1e-12)
        at = 0
        for agent, ahead in zip(problem.team.agents, (-0.225, 0.225), strict=True):
            model = agent.reduced()
            data, q = model.createData(), posture.coordinates[at : at + model.nq]
            at += model.nq
            pin.framesForwardKinematics(model, data, q)
            hand = data.oMf[model.getFrameId(agent.hands[0])].translation
            assert np.linalg.norm(hand - (z[:3] + np.array([ahead, 0.0, -0.01]))) < 1e-4
            assert (q >= agent.limits.q_lower - 1e-12).all()
            assert (q <= agent.limits.q_upper + 1e-12).all()


def test_shortfall_grows_as_the_robot_is_moved_away() -> None:
    """Out of reach the arm is stretched: half a metre farther along it is half a metre more."""
    near, far = _reasons("task.standing_distance=3.0"), _reasons("task.standing_distance=3.5")
    for one, other, end in zip(near, far, ("start", "end"), strict=True):
        assert (one.constraint, one.who, one.unit) == ("grasp_closure", "robot", "m")
        assert 0.49 < other.amount - one.amount <= 0.5 + 1e-6
        assert f"out of reach at the {end} of the lift: the robot's grasp stays {one.amount:.3f} m short" in one.message


def test_a_person_who_cannot_reach_is_named() -> None:
    """1.1 m ahead of the feet is beyond a person of 1.2 m; the robot stands as far from the object as by default."""
    ahead = ["task.start.human_distance=1.1", "task.end.human_distance=1.1", "task.standing_distance=2.6"]
    reasons = _reasons("human.stature=1.2", *ahead)
    assert [(o.constraint, o.who) for o in reasons] == [("grasp_closure", "human")] * 2
    assert "at the start of the lift: the human's grasp stays" in reasons[0].message


@pytest.mark.parametrize(("cap", "mass"), [(5.0, 2.0), (8.0, 4.0)])
def test_a_grasp_too_weak_lacks_what_half_the_weight_asks(cap: float, mass: float) -> None:
    """Two hands at the edges of a level body carry half its weight each."""
    reasons = _reasons(f"limits.max_grasp_force={cap}", f"object.mass={mass}")
    assert [(o.constraint, o.unit) for o in reasons] == [("grasp_force", "times the limit")] * 2
    for reason in reasons:
        # The bisection ends within 1 %, on the side that holds.
        assert 0.999 <= reason.amount / (mass * 9.81 / 2 / cap) <= 1.011
        assert f"{reason.amount:.2f} times the grasp force cap of" in reason.message


def test_a_weak_joint_is_named() -> None:
    reasons = _reasons("object.mass=40", "limits.max_grasp_force=2000")
    assert reasons
    for reason in reasons:
        assert (reason.constraint, reason.unit) == ("torque", "times the limit")
        assert "_Q" in reason.who
        assert f"holding still needs about {reason.amount:.2f} times the torque limit of {reason.who}" in reason.message
        assert reason.amount > 1.0


def test_a_joint_that_cannot_bend_enough_is_named() -> None:
    """A trunk and an elbow that cannot bend keep the hand from 0.4 m ahead of the feet; bending, it gets there."""
    problem = _problem()
    human, robot = problem.team.agents
    q_lower, q_upper = human.limits.q_lower.copy(), human.limits.q_upper.copy()
    q_lower[:3], q_upper[:3], q_lower[6], q_upper[6] = -0.01, 0.01, -0.01, 0.0
    stiff = replace(human, limits=replace(human.limits, q_lower=q_lower, q_upper=q_upper))
    reasons, _ = screen_ends(replace(problem, team=replace(problem.team, agents=(stiff, robot))), 0, NEVER)
    assert reasons
    for reason in reasons:
        assert reason.constraint == "grasp_closure" and reason.amount > 1e-3
        named = re.search(r"\(with (.*) beyond the range of motion it would reach\)", reason.message)
        assert named and re.search(r"human_Q\d+ \d+ deg", named.group(1))


def test_a_half_space_that_keeps_the_hand_away_is_named() -> None:
    """The hand must be 0.40 m ahead of the feet; a wall at 0.55 m leaves it 0.15 m outside."""
    problem = _problem()
    human, robot = problem.team.agents
    walled = replace(human, workspace=HalfSpace(np.array([1.0, 0.0, 0.0]), 0.55))
    reasons, _ = screen_ends(replace(problem, team=replace(problem.team, agents=(walled, robot))), 0, NEVER)
    assert [(o.constraint, o.who, o.unit) for o in reasons] == [("workspace", "human", "m")] * 2
    for reason in reasons:
        assert reason.amount == pytest.approx(0.15, abs=1e-4)
        assert "the human's grasp would lie 0.150 m outside its half-space" in reason.message


def test_a_load_that_some_posture_holds_is_not_called_too_heavy() -> None:
    """20 kg: the search fails from most seeds, but not from all; a posture that holds it is the proof."""
    assert _reasons("object.mass=20", "limits.max_grasp_force=2000") == []


@pytest.mark.parametrize(("rest", "ramps"), [("velocity", 2 / 3), ("acceleration", 2.0)])
def test_a_lift_too_short_for_the_speed_limit_is_told_the_shortest(rest: str, ramps: float) -> None:
    """0.5 m at 2 m/s, and at both ends in all so many intervals at rest: 0.25 s * 20 / (20 - ramps).

    The quadratic from rest to full speed covers two thirds of its interval; with zero acceleration it takes two
    intervals, of which it covers one.
    """
    still, shortest = f"task.rest={rest}", 0.25 * N / (N - ramps)
    reason = too_fast(_problem("duration=0.25", still))
    assert reason is not None
    assert (reason.constraint, reason.who, reason.unit) == ("velocity", "table", "s")
    assert reason.amount == pytest.approx(shortest - 0.25)
    assert f"the lift must last at least {shortest:.2f} s, not 0.25 s" in reason.message
    assert too_fast(_problem(f"duration={shortest + 1e-4:.6f}", still)) is None
    assert too_fast(_problem(f"duration={shortest - 1e-4:.6f}", still)) is not None


def test_a_passed_deadline_ends_the_search_at_once_and_makes_nothing_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Slopes are what each iteration of inverse kinematics takes; none is begun."""

    def asked(*_: object) -> None:
        raise AssertionError("an iteration after the deadline")

    monkeypatch.setattr(Batch, "slopes", asked)
    reasons, postures = screen_ends(_problem(), 0, Deadline.after(0.0))
    assert reasons == []
    assert len(postures) == 2
