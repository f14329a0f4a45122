"""A lift by one agent with two hands, from its first postures to its verified optimum, on CasADi's virtual machine.

Oracles: Pinocchio, IPOPT against the banded solver on the same problem, finite differences of whole optima, and NumPy's
rank of the grasp map.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.elastic_mode import solve_elastic
from liftopt.collocation.kkt import kkt_error
from liftopt.collocation.parametric import Optimum
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.banded import Banded, BandedOptions
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt, IpoptOptions
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import Mesh, RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.collocation.transfer import transfer, transfer_multipliers
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.table import lifted_table
from liftopt.search.feasibility_screen import screen_ends
from liftopt.search.initial_guess import InitialGuess, posture_starts
from liftopt.search.inverse_kinematics import InverseKinematics
from liftopt.search.mirrored_joints import mirrored_joints, neighbours
from liftopt.search.postures import seed_coordinates
from liftopt.solution.verify import verify

TOLERANCE = 1e-8
SPLINE = RestToRestSpline(8)
SIDE = {"right": -0.2, "left": 0.2}


def held_box(hands: tuple[str, ...], mass: float = 4.0) -> LiftedObject:
    """Return a box that the porter holds at the bottom edge."""
    points = {f"porter_{hand}": (-0.15, SIDE[hand], -0.1) for hand in hands}
    return lifted_table(mass=mass, depth=0.3, width=0.4, height=0.2, name="box", grasps=points)


def lift_task(pitch: float) -> LiftTask:
    """Return a lift by 0.35 m; the box may pitch by so much."""
    pose, free = np.array([0.55, 0.0, 0.9, 0.0, 0.0, 0.0]), np.array([3.0, 3.0, 3.0, 0.3, pitch, 0.3])
    end = pose + 0.35 * np.eye(6)[2]
    return LiftTask(2.0, pose, end, -free, free, np.full(6, 2.0), (1.0,), 0.5, 0.01, 200.0)


@dataclass(frozen=True)
class Lift:
    """A problem, where to start, and its optimum from there."""

    problem: Problem
    start: InitialGuess
    optimum: SolverResult


def make_lift(agent: Agent, mass: float = 4.0, like: Team | None = None) -> Problem:
    hands = tuple(grasp.name.removeprefix("porter_") for grasp in agent.grasps)
    turns = any(grasp.moments for grasp in agent.grasps)
    team = Team.of((agent,), held_box(hands, mass), like=like)
    return Problem(team, lift_task(0.3 if turns else 0.0), SPLINE.mesh())


@pytest.fixture(scope="module")
def machine() -> Iterator[None]:
    """Kernels run on CasADi's virtual machine."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", "")
        patch.setenv("LIFTOPT_CACHE", "/dev/null/none")
        yield


@pytest.fixture(scope="module", params=["points", "moments", "moment and flat point", "left hand"])
def lift(request: pytest.FixtureRequest, machine: None, make_two_handed: Callable[..., Agent]) -> Lift:
    """A lift by two points, by two grasps that transmit moments, by one of these and a flat hand, by one hand."""
    hands = ("left",) if request.param == "left hand" else ("right", "left")
    agent = make_two_handed(hands=hands, moments=request.param != "points")
    if request.param == "moment and flat point":
        right, left = make_two_handed(moments=True).grasps
        agent = replace(agent, grasps=(right, replace(left, moments=False, friction=0.6)))
    problem = make_lift(agent)
    solver = Banded(problem, BandedOptions(TOLERANCE, 300))
    for start in posture_starts(problem, 3, 0, NEVER):
        optimum = solver.solve(start.x, deadline=NEVER)
        if optimum.converged:
            return Lift(problem, start, optimum)
    raise AssertionError("no start leads to an optimum")


def test_balance_is_asked_for_by_the_rank_of_the_grasp_map(lift: Lift) -> None:
    """NumPy: two points serve five rows; a grasp that transmits moments serves all six."""
    team = lift.problem.team
    columns = []
    for grasp, name in zip(team.grasps, team.object.grasp_frames, strict=True):
        lever = team.object.model.frames[team.object.model.getFrameId(name)].placement.translation
        columns.append(np.vstack([np.eye(3), pin.skew(lever)]))
        if grasp.moments:
            columns.append(np.eye(6)[:, 3:])
    (block,) = (block for block in lift.problem.constraints.blocks if block.name == "balance")
    assert len(block.labels) == np.linalg.matrix_rank(np.hstack(columns))


def test_optimum_is_verified_by_pinocchio(lift: Lift) -> None:
    """Closure, balance, limits and the KKT error, all on the model; the mesh is too coarse between its knots."""
    found = verify(lift.problem, SPLINE, lift.optimum, 1e-6)
    assert found.kkt_error < 1e-6
    assert [check.name for check in found.checks if not check.passed] in ([], ["grasp closure between knots"])


def test_ipopt_finds_it_too(lift: Lift) -> None:
    again = Ipopt(lift.problem, IpoptOptions(TOLERANCE, 300)).solve(
        lift.optimum.x, warm=lift.optimum.multipliers, deadline=NEVER
    )
    assert again.converged
    assert again.objective == pytest.approx(lift.optimum.objective, rel=1e-6)


def test_a_multiplier_that_is_wrong_is_noticed(lift: Lift) -> None:
    for block in lift.problem.constraints.blocks:
        if block.name in ("grasp_closure", "torque", "balance"):
            wrong = lift.optimum.multipliers.g.copy()
            wrong[block.rows.start] += 1.0
            multipliers = replace(lift.optimum.multipliers, g=wrong)
            assert kkt_error(lift.problem, lift.optimum.x, multipliers).error > 1e-3


def test_an_optimum_is_taken_to_another_mesh(lift: Lift) -> None:
    onto = RestToRestSpline(12)
    finer = Problem(lift.problem.team, lift.problem.task, onto.mesh())
    x = transfer(lift.problem, SPLINE, lift.optimum.x, finer, onto)
    transfer_multipliers(lift.problem, lift.optimum.multipliers, finer)
    found = Banded(finer, BandedOptions(TOLERANCE, 300)).solve(x, deadline=NEVER)
    assert found.converged and found.objective == pytest.approx(lift.optimum.objective, rel=0.1)


def test_its_slope_by_the_mass_is_that_of_optima(lift: Lift) -> None:
    """Finite difference of two optima."""
    agent, team = lift.problem.team.agents[0], lift.problem.team
    below, above = (make_lift(agent, 4.0 + change, team) for change in (-1e-3, 1e-3))
    tangent = Optimum(lift.problem, lift.optimum.x, lift.optimum.multipliers).tangent(below, above, 1e-3)
    at = {"warm": lift.optimum.multipliers, "deadline": NEVER}
    ends = [Banded(p, BandedOptions(TOLERANCE, 300)).solve(lift.optimum.x, **at) for p in (below, above)]
    assert all(end.converged for end in ends)
    slope = (ends[1].objective - ends[0].objective) / 2e-3
    assert tangent.objective == pytest.approx(slope, rel=1e-3)


def test_inverse_kinematics_brings_all_hands_to_the_box_at_once(lift: Lift) -> None:
    """Pinocchio: both grasp points are the box's, from a third of the seeds and more."""
    still = Problem(lift.problem.team, lift.problem.task, Mesh.at_rest())
    rng, pose, (agent,) = np.random.default_rng(1), lift.problem.task.start, lift.problem.team.agents
    seeds = np.array([seed_coordinates(still, pose, rng) for _ in range(16)])
    reach = InverseKinematics(still).reach(pose, seeds, NEVER, most=40)
    closed = reach.shortfall < 1e-6
    assert closed.mean() > 0.3 and reach.gaps.shape == (16, len(agent.grasps))
    data, lifted = agent.model.createData(), lift.problem.team.object
    for q in reach.coordinates[closed, :12]:
        pin.framesForwardKinematics(agent.model, data, q)
        for grasp, name in zip(agent.grasps, lifted.grasp_frames, strict=True):
            hand = data.oMf[agent.model.getFrameId(grasp.frame)].translation
            lever = lifted.model.frames[lifted.model.getFrameId(name)].placement.translation
            np.testing.assert_allclose(hand, pose[:3] + lever, atol=2e-6)


def test_joints_of_both_arms_are_mirrored_and_none_across_the_trunk(lift: Lift) -> None:
    (agent,) = lift.problem.team.agents
    names = agent.moving_joints
    for joint, (before, after) in neighbours(agent).items():
        sides = {name.split("_")[1] for name in (names[joint], names[after])}
        assert len(sides & {"left", "right"}) <= 1 and names[before] != names[after]
    assert {guess.name for guess in mirrored_joints(lift.problem, lift.optimum.x)} <= {
        f"porter mirrored at joint {j + 1}" for j in neighbours(agent)
    }


def test_what_is_in_the_way_names_the_hand(machine: None, make_two_handed: Callable[..., Agent]) -> None:
    """By hand: the two points are farther apart than the arms are long."""
    agent, far = make_two_handed(moments=True), {"porter_right": (-0.15, -0.2, -0.1), "porter_left": (0.9, 0.9, -0.1)}
    lifted = lifted_table(mass=4.0, depth=2.0, width=2.0, height=0.2, name="box", grasps=far)
    problem = Problem(Team.of((agent,), lifted), lift_task(0.3), SPLINE.mesh())
    reasons, _ = screen_ends(problem, 0, NEVER)
    assert len(reasons) == 2
    for reason in reasons:
        assert reason.constraint == "grasp_closure" and reason.who in ("porter_left", "porter_right")
        assert f"porter's {reason.who.removeprefix('porter_')} grasp stays" in reason.message


def test_a_low_cap_is_told_of_both_hands(lift: Lift) -> None:
    """Statics: the box of 39 N cannot be held with 10 N a hand; the elastic mode says of which hand what is missing."""
    capped = replace(lift.problem, task=replace(lift.problem.task, max_grasp_force=10.0))
    broken = solve_elastic(capped, lift.optimum.x, NEVER).violations
    assert {v.who for v in broken if v.constraint == "grasp_force"} == {g.name for g in lift.problem.team.grasps}
