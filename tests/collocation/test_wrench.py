"""Holds that transmit moments, on random arms and a box: Pinocchio, Newton and Euler, finite differences as oracles."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation import kkt
from liftopt.collocation.constraints import BALANCE_ROWS
from liftopt.collocation.flat_hand import flat_hand_rows
from liftopt.collocation.kkt import kkt_error
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.result import Multipliers
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.collocation.wrench_dynamics import WrenchTopology, wrench_agent_functions, wrench_object_functions
from liftopt.multibody.agent import Agent, Grasp, LiftedObject

PERIOD = 1.3
POINTS = np.array([[-0.3, 0.02, -0.05], [0.25, 0.02, -0.05]])
Outputs = Callable[..., np.ndarray]


def attitude(angles: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.multi_dot([pin.utils.rotate(axis, a) for axis, a in zip("xyz", angles, strict=True)]))


@pytest.fixture(scope="module")
def grip() -> np.ndarray:
    return np.asarray(pin.exp3(np.array([0.4, -1.1, 0.7])))


@pytest.fixture(scope="module")
def mixed(make_arm: Callable[..., Agent], make_box: Callable[..., LiftedObject], grip: np.ndarray) -> Iterator[Team]:
    """A flat hand that transmits moments and a point grasp of a box, on CasADi's virtual machine."""
    flat = Grasp("arm", "tip", True, 10.0, 0.5, grip, friction=0.4)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", "")
        patch.setenv("LIFTOPT_CACHE", "/dev/null/none")
        yield Team.of((replace(make_arm(1), grasps=(flat,)), make_arm(2, "other")), make_box(POINTS))


def test_agent_outputs_are_pinocchios(
    make_arm: Callable[..., Agent], grip: np.ndarray, rng: np.random.Generator
) -> None:
    """Torques by RNEA and the whole frame Jacobian, the angle by the rotation vector, the wrench by rotation."""
    model = make_arm(3).reduced()
    topology, n = WrenchTopology.holding(model, ("tip",), grip), model.nv
    function, data = wrench_agent_functions(topology).value, model.createData()
    for _ in range(5):
        y = rng.normal(size=3 * n + 9)
        q, v, a = y[:n], y[n : 2 * n] / PERIOD, y[2 * n : 3 * n] / PERIOD**2
        f, m, angles = y[3 * n : 3 * n + 3], y[3 * n + 3 : 3 * n + 6], y[3 * n + 6 :]
        c = function(y, np.r_[PERIOD, topology.parameters]).full().ravel()
        tip, turned = model.getFrameId("tip"), attitude(angles)
        slope = pin.computeFrameJacobian(model, data, q, tip, pin.LOCAL_WORLD_ALIGNED)
        tau = pin.rnea(model, data, q, v, a) + slope.T @ np.r_[f, m]
        pin.framesForwardKinematics(model, data, q)
        tilt = np.linalg.norm(pin.log3(turned.T @ data.oMf[tip].rotation @ grip))
        expected = np.r_[tau, data.oMf[tip].translation, f @ f, m @ m, np.cos(tilt), turned.T @ f, turned.T @ m]
        np.testing.assert_allclose(c, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_object_outputs_are_newton_eulers_less_the_moments(
    make_box: Callable[..., LiftedObject], newton_euler: Outputs, rng: np.random.Generator
) -> None:
    lifted = make_box(POINTS)
    topology = WrenchTopology.holding(lifted.model, lifted.grasp_frames)
    y = rng.normal(size=30)
    c = wrench_object_functions(topology).value(y, np.r_[PERIOD, topology.parameters]).full().ravel()
    expected = newton_euler(lifted.model, lifted.grasp_frames, np.r_[y[:18], y[18:21], y[24:27]], PERIOD)
    expected[3:6] -= attitude(y[3:6]).T @ (y[21:24] + y[27:30])
    np.testing.assert_allclose(c, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_derivatives_of_the_programme(
    mixed: Team, make_task: Callable[..., LiftTask], check_derivatives: Callable[[Problem], None]
) -> None:
    """Central differences of objective, rows and Lagrangian where one hold has moments and the other none."""
    check_derivatives(Problem(mixed, make_task(), RestToRestSpline(6).mesh()))


def test_rows_of_mixed_holds(mixed: Team, make_task: Callable[..., LiftTask]) -> None:
    """One hold that transmits moments is enough for six rows of balance; only that hold has rows of its own."""
    problem = Problem(mixed, make_task(), RestToRestSpline(6).mesh())
    blocks = {(block.name, block.who): block for block in problem.constraints.blocks}
    assert blocks["balance", "box"].labels == BALANCE_ROWS
    own = {"grasp_moment", "grasp_turn", "friction", "pressure"}
    assert {name for name, who in blocks if who == "arm"} - {name for name, who in blocks if who == "other"} == own
    assert problem.layout.force.shape[1] == 6 + 3


def test_slopes_of_the_kkt_check_by_finite_differences(mixed: Team, rng: np.random.Generator) -> None:
    """The check's own outputs, differentiated; and they are the kernels', an independent path of both."""
    problem = Problem(mixed, _task(), RestToRestSpline(6).mesh())
    h = 1e-2
    for part, kernel in enumerate(mixed.kernels):
        y = rng.normal(size=kernel.n_y)
        nudges = h * np.eye(len(y))
        at = np.vstack([y + k * nudges for k in (-3, -2, -1, 1, 2, 3)])
        values = kkt._evaluate(problem, part, at, PERIOD)[0].reshape(6, len(y), -1)
        numeric = np.einsum("k,kjc->cj", [-1 / 60, 3 / 20, -3 / 4, 3 / 4, -3 / 20, 1 / 60], values) / h
        (c,), (slopes,) = kkt._evaluate(problem, part, y[None], PERIOD)
        np.testing.assert_allclose(slopes, numeric, rtol=0, atol=1e-8 * np.abs(numeric).max())
        p = np.r_[PERIOD, mixed.topologies[part].parameters]
        np.testing.assert_allclose(c, kernel.value(y, p).full().ravel(), rtol=0, atol=1e-11 * np.abs(c).max())


def test_kkt_check_is_that_of_the_programme(mixed: Team, random_unknowns: Outputs, rng: np.random.Generator) -> None:
    """The gradient of the Lagrangian by CasADi at a random point with random multipliers."""
    problem = Problem(mixed, _task(), RestToRestSpline(6).mesh())
    x, lam = random_unknowns(problem, rng), rng.normal(size=problem.constraints.linear.shape[0])
    nlp, p = problem.nlp, problem.parameters
    gradient = nlp.grad_f(x, p)[1].full().ravel() + nlp.jac_g(x, p)[1].full().T @ lam
    found = kkt_error(problem, x, Multipliers(np.zeros_like(x), lam))
    lower, upper = problem.bounds()
    np.testing.assert_allclose(found.stationarity, np.abs(gradient[upper > lower]).max(), rtol=1e-9)
    np.testing.assert_allclose(found.objective, float(nlp.grad_f(x, p)[0]), rtol=1e-12)


def test_flat_hand_pushes_within_the_cone(rng: np.random.Generator) -> None:
    """Closed form: the pyramid lies in the cone, touches it at its edges, and the centre of pressure is in the hand."""
    friction, breadth = 0.4, 0.1
    slide, tip = flat_hand_rows(Grasp("hand", "tip", moments=True, friction=friction, breadth=breadth))
    wrench = rng.normal(size=(4000, 6)) * [0.3, 0.3, 1.0, 0.05, 0.05, 0.05]
    inside = (slide.room(wrench) >= 0).all(axis=1)
    assert 100 < inside.sum() < 3000
    assert (np.linalg.norm(wrench[inside, :2], axis=1) <= friction * wrench[inside, 2] + 1e-12).all()
    edge = np.array([[friction / np.sqrt(2), friction / np.sqrt(2), 1.0, 0.0, 0.0, 0.0]])
    np.testing.assert_allclose(slide.room(edge).min(), 0.0, atol=1e-15)
    held = inside & (tip.room(wrench) >= 0).all(axis=1)
    pressure = wrench[held][:, [4, 3]] / wrench[held, 2:3]
    assert held.any() and np.abs(pressure).max() <= breadth / 2 + 1e-12
    assert not flat_hand_rows(Grasp("hand", "tip", moments=True))


def test_inverse_kinematics_turns_the_hand(
    human: Agent, sawyer: Agent, table: LiftedObject, make_task: Callable[..., LiftTask]
) -> None:
    """Pinocchio: every posture that is said to hold has both hands within their angle on the object."""
    from liftopt.collocation.spline import Mesh
    from liftopt.multibody.person.holds import hand_on
    from liftopt.multibody.robots.sawyer import LEVEL_TOOL
    from liftopt.search.inverse_kinematics import InverseKinematics
    from liftopt.search.postures import seed_coordinates

    limit, grips = np.radians(20.0), (hand_on("edge", "right").T, LEVEL_TOOL.T)
    agents = tuple(
        replace(agent, grasps=(Grasp(agent.name, agent.hands[0], True, 5.0, limit, grip),))
        for agent, grip in zip((human, sawyer), grips, strict=True)
    )
    problem = Problem(Team.of(agents, table), make_task(), Mesh.at_rest())
    rng, pose = np.random.default_rng(3), make_task().start
    seeds = np.array([seed_coordinates(problem, pose, rng) for _ in range(16)])
    reach = InverseKinematics(problem).reach(pose, seeds, NEVER, most=40)
    held = reach.coordinates[reach.shortfall < 1e-6]
    assert len(held) >= 4
    for coordinates in held:
        turned = attitude(coordinates[-3:])
        for i, agent in enumerate(agents):
            model = agent.reduced()
            data = model.createData()
            pin.framesForwardKinematics(model, data, coordinates[problem.layout.columns(i)])
            hand = data.oMf[model.getFrameId(agent.hands[0])].rotation
            assert np.linalg.norm(pin.log3(turned.T @ hand @ agent.grasps[0].R_hand_object)) <= limit + 1e-5


def _task() -> LiftTask:
    pose = np.array([0.6, np.nan, 0.9, 0.0, 0.0, 0.0])
    room, fast = np.array([5.0, 5.0, 3.0, 0.2, 0.2, 0.2]), np.full(6, 2.0)
    return LiftTask(PERIOD, pose, pose, -room, room, fast, (1.0, 0.7), 0.5, 0.01, 200.0)
