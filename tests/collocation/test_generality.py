"""Other teams need models and no change of the core: derivatives by finite differences, solutions by Pinocchio."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.kkt import kkt_error
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.errors import ModelError
from liftopt.multibody.agent import Agent, Grasp, LiftedObject
from liftopt.multibody.person.human import Subject, human_agent
from liftopt.multibody.placement import facing
from liftopt.multibody.robots.sawyer import sawyer_agent
from liftopt.search.initial_guess import posture_starts

EDGES = np.array([[-0.225, 0.0, -0.01], [0.225, 0.0, -0.01]])


@pytest.fixture(autouse=True)
def _virtual_machine(team: Team, monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep what the default team compiled, and compile nothing more."""
    monkeypatch.setenv("CC", "")


def grasp_map(points: np.ndarray) -> np.ndarray:
    """Return the map (6, 3n) from forces at points (n, 3) to force and moment about the centre of mass."""
    return np.vstack([np.hstack([np.eye(3)] * len(points)), np.hstack([pin.skew(point) for point in points])])


def solve(problem: Problem) -> None:
    """Solve from a posture pair and check the point by Pinocchio in double precision."""
    starts = posture_starts(problem, 1, 0, NEVER)
    assert starts
    result = Ipopt(problem).solve(starts[0].x, deadline=NEVER)
    assert result.converged, result.status
    assert kkt_error(problem, result.x, result.multipliers).error <= 1e-6


def test_two_robots(
    sawyer: Agent,
    make_box: Callable[..., LiftedObject],
    make_turned: Callable[..., Agent],
    make_task: Callable[..., LiftTask],
    check_derivatives: Callable[[Problem], None],
) -> None:
    """Two Sawyers face each other over a box, one turned about the vertical."""
    near = sawyer_agent(place=facing(1.275), base_height=0.8, tool_length=0.15, tool_mass=0.4)
    agents = (make_turned(near, np.pi, 0.65), sawyer)
    team = Team.of(agents, make_box(EDGES))
    problem = Problem(team, make_task(), RestToRestSpline(8).mesh())
    check_derivatives(problem)
    solve(problem)


def test_two_humans(
    human: Agent,
    table: LiftedObject,
    make_turned: Callable[..., Agent],
    make_task: Callable[..., LiftTask],
    check_derivatives: Callable[[Problem], None],
) -> None:
    """A man and a woman opposite each other; her half-space is turned with her."""
    other = make_turned(human_agent(Subject(1.65, 62.0, "female")), np.pi, 1.25)
    assert other.workspace is not None and other.workspace.normal[0] == pytest.approx(-1.0)
    team = Team.of((human, other), table)
    problem = Problem(team, make_task(), RestToRestSpline(8).mesh())
    check_derivatives(problem)
    solve(problem)


def test_three_agents_on_one_object(
    human: Agent,
    sawyer: Agent,
    make_arm: Callable[..., Agent],
    make_box: Callable[..., LiftedObject],
    make_task: Callable[..., LiftTask],
    check_derivatives: Callable[[Problem], None],
) -> None:
    """A third grasp on the object, held by a random arm: sizes and derivatives."""
    lifted = make_box(np.vstack([EDGES, [[0.0, 0.15, -0.01]]]))
    team = Team.of((human, sawyer, make_arm(4)), lifted)
    problem = Problem(team, make_task(3), RestToRestSpline(6).mesh())
    assert problem.layout.n_x == 7 * (10 + 7 + 4 + 6) + 7 * 9
    assert sum(block.name == "grasp_closure" for block in problem.constraints.blocks) == 3
    check_derivatives(problem)


def test_three_grasps_off_one_line_balance_about_every_axis(
    make_arm: Callable[..., Agent], make_box: Callable[..., LiftedObject], make_task: Callable[..., LiftTask]
) -> None:
    """Statics: three point grasps that are not on a line can serve all six rows, so equality must ask for all six."""
    grasps = np.vstack([EDGES, [[0.0, 0.15, -0.01]]])
    assert np.linalg.matrix_rank(grasp_map(grasps)) == 6
    team = Team.of(tuple(make_arm(i, f"arm{i}") for i in range(3)), make_box(grasps))
    problem = Problem(team, make_task(3), RestToRestSpline(6).mesh())
    (block,) = (block for block in problem.constraints.blocks if block.name == "balance")
    assert len(block.labels) == 6


def test_grasps_along_another_axis_leave_out_its_moment(
    make_arm: Callable[..., Agent], make_box: Callable[..., LiftedObject], make_task: Callable[..., LiftTask]
) -> None:
    """Statics: two point grasps cannot turn the object about the line through them, here the body's y axis."""
    team = Team.of((make_arm(1), make_arm(2, "other")), make_box(EDGES[:, [1, 0, 2]]))
    problem = Problem(team, make_task(), RestToRestSpline(6).mesh())
    (block,) = (block for block in problem.constraints.blocks if block.name == "balance")
    assert "moment y" not in block.labels and "moment x" in block.labels


def test_grasps_on_a_skew_line_are_refused(make_box: Callable[..., LiftedObject]) -> None:
    """Statics: the moment about that line cannot be served, and no single row of the balance stands for it."""
    lifted = make_box(np.array([[-0.3, 0.1, 0.0], [0.3, -0.1, 0.0]]))
    with pytest.raises(ModelError, match="axes"):
        lifted.unserved_row()


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("beside", [0.0, 1e-9], ids=["exact", "rounded"])
def test_grasps_at_one_point_are_refused(
    make_arm: Callable[..., Agent],
    make_box: Callable[..., LiftedObject],
    count: int,
    beside: float,
) -> None:
    """Statics: of such forces NumPy finds a grasp map of rank 3, so three moments stay unserved."""
    grasps = EDGES[0] + beside * np.arange(3 * count).reshape(count, 3)
    assert np.linalg.matrix_rank(grasp_map(grasps), tol=1e-6) == 3
    agents = tuple(make_arm(i, f"arm{i}") for i in range(count))
    held = "held at one point only" if count == 1 else f"held by {count} grasps at one point"
    with pytest.raises(ModelError, match=f"{held}, where forces cannot turn it"):
        Team.of(agents, make_box(grasps))


def test_a_single_grasp_that_transmits_moments_holds(
    make_arm: Callable[..., Agent], make_box: Callable[..., LiftedObject], make_task: Callable[..., LiftTask]
) -> None:
    """Statics: a force and a moment at one point are a grasp map of rank 6."""
    agent = replace(make_arm(1), grasps=(Grasp("arm", "tip", moments=True, max_moment=10.0),))
    assert np.linalg.matrix_rank(np.hstack([grasp_map(EDGES[:1]), np.eye(6)[:, 3:]])) == 6
    problem = Problem(Team.of((agent,), make_box(EDGES[:1])), make_task(1), RestToRestSpline(6).mesh())
    (block,) = (block for block in problem.constraints.blocks if block.name == "balance")
    assert len(block.labels) == 6


@pytest.mark.parametrize("seed", range(8))
def test_rows_served_are_the_rank_of_the_grasp_map(make_box: Callable[..., LiftedObject], seed: int) -> None:
    """NumPy's rank of the map from point forces to force and moment, for points on an axis and anywhere."""
    rng = np.random.default_rng(seed)
    count, axis = int(rng.integers(2, 6)), int(rng.integers(3))
    anywhere = rng.uniform(-0.3, 0.3, (count, 3))
    in_line = anywhere[0] + rng.uniform(-0.3, 0.3, (count, 1)) * np.eye(3)[axis]
    assert np.linalg.matrix_rank(grasp_map(in_line), tol=1e-6) == 5
    assert make_box(in_line).unserved_row() == 3 + axis
    if count > 2:
        assert np.linalg.matrix_rank(grasp_map(anywhere), tol=1e-6) == 6
        assert make_box(anywhere).unserved_row() is None


def test_grasps_that_do_not_match_the_agents_are_refused(
    make_arm: Callable[..., Agent], make_box: Callable[..., LiftedObject]
) -> None:
    with pytest.raises(ModelError, match="2 grasp frames for 1 grasps"):
        Team.of((make_arm(1),), make_box(EDGES))


@pytest.mark.parametrize("frames", [(), ("porter_nose",), ("porter_left_grasp", "porter_left_grasp")])
def test_grasps_without_hands_of_their_own_are_refused(
    make_two_handed: Callable[..., Agent], make_box: Callable[..., LiftedObject], frames: tuple[str, ...]
) -> None:
    agent = make_two_handed(moments=True)
    holds = tuple(replace(agent.grasps[0], frame=frame) for frame in frames)
    with pytest.raises(ModelError, match="each grasp takes one of its hands, porter_right_grasp, porter_left_grasp"):
        Team.of(
            (make_two_handed("other", moments=True), replace(agent, grasps=holds)),
            make_box(np.eye(4)[: 2 + len(frames), :3]),
        )
