"""The assembled NLP: finite differences, CasADi's own derivatives and plain NumPy with Pinocchio are the oracles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest
from scipy.interpolate import BSpline

from liftopt.collocation.constraints import Block
from liftopt.collocation.dynamics import Topology
from liftopt.collocation.kkt import kkt_error
from liftopt.collocation.layout import Layout
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.result import Multipliers
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.multibody.agent import Agent, LiftedObject

Unknowns = Callable[[Problem, np.random.Generator], np.ndarray]
Outputs = Callable[[pin.Model, tuple[str, ...], np.ndarray, float], np.ndarray]


def test_derivatives_by_finite_differences(problem: Problem, check_derivatives: Callable[[Problem], None]) -> None:
    check_derivatives(problem)


def test_derivatives_are_casadis_own(
    arm_team: Team, random_unknowns: Unknowns, make_task: Callable[..., LiftTask]
) -> None:
    """CasADi's automatic differentiation of f and g as one expression, on the virtual machine."""
    rng = np.random.default_rng(3)
    problem = Problem(arm_team, make_task(), RestToRestSpline(6).mesh(), posture_weight=0.3)
    nlp, sigma, lam = problem.nlp, ca.MX.sym("s"), ca.MX.sym("l", problem.nlp.g.shape[0])
    hessian, _ = ca.hessian(sigma * nlp.f + ca.dot(lam, nlp.g), nlp.x)
    reference = ca.Function(
        "reference",
        [nlp.x, nlp.p, sigma, lam],
        [ca.gradient(nlp.f, nlp.x), ca.jacobian(nlp.g, nlp.x), ca.triu(hessian)],
    )
    x, p = random_unknowns(problem, rng), problem.parameters
    multipliers = rng.normal(size=lam.shape[0])
    gradient, jacobian, curvature = (ca.DM(part).full() for part in reference(x, p, 0.7, multipliers))
    pairs = (
        (nlp.grad_f(x, p)[1], gradient),
        (nlp.jac_g(x, p)[1], jacobian),
        (nlp.hess_lag(x, p, 0.7, multipliers), curvature),
    )
    for actual, expected in pairs:
        np.testing.assert_allclose(ca.DM(actual).full(), expected, rtol=0, atol=1e-11 * np.abs(expected).max())


class Plain:
    """The lift evaluated without the code under test: SciPy's splines, Pinocchio's RNEA, NumPy."""

    def __init__(self, problem: Problem, x: np.ndarray, intervals: int) -> None:
        self.problem, self.task = problem, problem.task
        control, force = problem.unpack(x)
        knots = np.concatenate([np.zeros(3), np.arange(intervals + 1) / intervals, np.ones(3)])
        self.spline = BSpline(knots, np.vstack([control[:1], control, control[-1:]]), 3)
        self.phase, period = np.arange(intervals + 1) / intervals, problem.task.duration
        self.q = self.spline(self.phase)
        self.v = self.spline.derivative()(self.phase) / period
        self.a = self.spline.derivative(2)(self.phase) / period**2
        self.force = force.reshape(len(self.phase), -1, 3)
        self.agents = [self._agent(i) for i in range(len(problem.team.agents))]

    def _agent(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        agent = self.problem.team.agents[i]
        model, columns = agent.reduced(), self.problem.layout.columns(i)
        data, frame = model.createData(), model.getFrameId(agent.hands[0])
        tau, point = [], []
        for k in range(len(self.phase)):
            q = self.q[k, columns]
            free = pin.rnea(model, data, q, self.v[k, columns], self.a[k, columns])
            jacobian = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)[:3]
            tau.append(free + jacobian.T @ self.force[k, i])
            pin.framesForwardKinematics(model, data, q)
            point.append(data.oMf[frame].translation.copy())
        return np.array(tau), np.array(point)

    def objective(self) -> float:
        """Return J of the contract, by NumPy's trapezoid rule over time."""
        task, time = self.task, self.phase * self.task.duration
        terms = task.acceleration_weight * (self.a**2).sum(axis=1)
        terms = terms + task.force_weight * (self.force**2).sum(axis=(1, 2))
        for weight, (tau, _) in zip(task.agent_weights, self.agents, strict=True):
            terms = terms + weight * (tau**2).sum(axis=1)
        return float(np.trapezoid(terms, time))

    def attitude(self, k: int) -> np.ndarray:
        """Return R = Rx Ry Rz (3, 3) at a knot."""
        roll, pitch, yaw = self.q[k, -3:]
        return np.asarray(pin.exp3(roll * np.eye(3)[0]) @ pin.exp3(pitch * np.eye(3)[1]) @ pin.exp3(yaw * np.eye(3)[2]))

    def grasp(self, i: int) -> np.ndarray:
        """Return the object's grasp point (K, 3) of an agent."""
        lifted = self.problem.team.object
        lever = lifted.model.frames[lifted.model.getFrameId(lifted.grasp_frames[i])].placement.translation
        return np.array([self.q[k, -6:-3] + self.attitude(k) @ lever for k in range(len(self.phase))])

    def balance(self, newton_euler: Outputs) -> np.ndarray:
        """Return force and moment (K, 6) of Newton and Euler less the grasps'."""
        lifted = self.problem.team.object
        y = np.hstack([*(part[:, -6:] for part in (self.q, self.v, self.a)), self.force.reshape(len(self.q), -1)])
        return np.array([newton_euler(lifted.model, lifted.grasp_frames, row, 1.0)[:6] for row in y])


@pytest.fixture
def plain(
    problem: Problem, random_unknowns: Unknowns, rng: np.random.Generator
) -> tuple[Plain, np.ndarray, np.ndarray]:
    """Return the plain evaluation, the unknowns and the rows of the NLP at a random point."""
    x = random_unknowns(problem, rng)
    return Plain(problem, x, 8), x, ca.DM(problem.nlp.jac_g(x, problem.parameters)[0]).full().ravel()


def test_objective_is_the_contracts(plain: tuple[Plain, np.ndarray, np.ndarray]) -> None:
    """NumPy and Pinocchio: weighted integrals of squared torques, accelerations and forces, by the trapezoid rule."""
    reference, x, _ = plain
    problem, expected = reference.problem, reference.objective()
    np.testing.assert_allclose(float(problem.nlp.grad_f(x, problem.parameters)[0]), expected, rtol=1e-12)
    none = Multipliers(np.zeros(len(x)), np.zeros(problem.constraints.linear.shape[0]))
    np.testing.assert_allclose(kkt_error(problem, x, none).objective, expected, rtol=1e-12)


def rows_of(problem: Problem, g: np.ndarray, name: str, who: str) -> tuple[Block, np.ndarray]:
    (block,) = (block for block in problem.constraints.blocks if (block.name, block.who) == (name, who))
    return block, g[block.rows].reshape(-1, len(block.labels))


def test_rows_by_name(plain: tuple[Plain, np.ndarray, np.ndarray], newton_euler: Outputs) -> None:
    """Every block recomputed with NumPy and Pinocchio from the motion alone."""
    reference, _, g = plain
    problem, task = reference.problem, reference.task
    for i, agent in enumerate(problem.team.agents):
        tau, point = reference.agents[i]
        columns = problem.layout.columns(i)
        _, closure = rows_of(problem, g, "grasp_closure", agent.name)
        np.testing.assert_allclose(closure, point - reference.grasp(i), atol=1e-12)
        block, torque = rows_of(problem, g, "torque", agent.name)
        scale = np.maximum(-agent.limits.tau_lower, agent.limits.tau_upper)
        np.testing.assert_allclose(torque, tau / scale, atol=1e-12)
        assert block.labels == agent.moving_joints
        np.testing.assert_allclose(block.lower.reshape(torque.shape)[3] * scale, agent.limits.tau_lower)
        np.testing.assert_allclose(block.upper.reshape(torque.shape)[3] * scale, agent.limits.tau_upper)
        block, norm = rows_of(problem, g, "grasp_force", agent.name)
        squared = (reference.force[:, i] ** 2).sum(axis=1)
        np.testing.assert_allclose(norm.ravel(), squared / task.max_grasp_force**2, atol=1e-14)
        assert (block.upper == 1.0).all() and (block.lower == -np.inf).all()
        block, speed = rows_of(problem, g, "velocity", agent.name)
        hull = reference.spline.derivative().c[1:9, columns]
        np.testing.assert_allclose(speed, hull, atol=1e-11)
        np.testing.assert_allclose(block.upper.reshape(speed.shape)[0] / task.duration, agent.limits.velocity)
        np.testing.assert_array_equal(block.lower, -block.upper)
        if agent.workspace is not None:
            block, distance = rows_of(problem, g, "workspace", agent.name)
            np.testing.assert_allclose(distance.ravel(), point @ agent.workspace.normal, atol=1e-12)
            assert (block.lower == agent.workspace.offset).all() and (block.upper == np.inf).all()
    block, balance = rows_of(problem, g, "balance", problem.team.object.name)
    served = [0, 1, 2, 4, 5]
    assert block.labels == ("force x", "force y", "force z", "moment y", "moment z")
    np.testing.assert_allclose(balance, reference.balance(newton_euler)[:, served], atol=1e-10)
    assert not block.lower.any() and not block.upper.any()
    block, speed = rows_of(problem, g, "velocity", problem.team.object.name)
    np.testing.assert_allclose(speed, reference.spline.derivative().c[1:9, -6:], atol=1e-11)
    np.testing.assert_allclose(block.upper, task.duration * np.tile(task.pose_velocity, len(speed)))


def test_blocks_cover_all_rows_in_order(problem: Problem) -> None:
    blocks = problem.constraints.blocks
    ends = [0, *(block.rows.stop for block in blocks)]
    assert [block.rows.start for block in blocks] == ends[:-1]
    assert ends[-1] == problem.constraints.linear.shape[0] == problem.nlp.g.shape[0]
    assert all(len(block.lower) == block.rows.stop - block.rows.start for block in blocks)
    assert {(b.name, b.who) for b in blocks} == {
        *((name, who) for name in ("grasp_closure", "torque", "grasp_force", "velocity") for who in ("human", "robot")),
        ("workspace", "human"),
        ("balance", "table"),
        ("velocity", "table"),
    }


def test_oblique_half_space_and_tolerance(
    arm_team: Team, random_unknowns: Unknowns, make_task: Callable[..., LiftTask], newton_euler: Outputs
) -> None:
    """NumPy: a half-space along no axis, six balance rows with a tolerance, other caps and periods."""
    rng = np.random.default_rng(5)
    task = make_task(balance_tolerance=1.0, max_grasp_force=50.0, duration=1.1)
    problem = Problem(arm_team, task, RestToRestSpline(6).mesh())
    x = random_unknowns(problem, rng)
    reference = Plain(problem, x, 6)
    g = ca.DM(problem.nlp.jac_g(x, problem.parameters)[0]).full().ravel()
    block, distance = rows_of(problem, g, "workspace", "arm")
    np.testing.assert_allclose(distance.ravel(), reference.agents[0][1] @ [0.6, 0.0, 0.8], atol=1e-12)
    block, balance = rows_of(problem, g, "balance", "box")
    np.testing.assert_allclose(balance, reference.balance(newton_euler), atol=1e-10)
    assert (block.lower == -1.0).all() and (block.upper == 1.0).all() and len(block.labels) == 6
    np.testing.assert_allclose(float(problem.nlp.grad_f(x, problem.parameters)[0]), reference.objective(), rtol=1e-12)


def test_layout_places_every_unknown_once(problem: Problem) -> None:
    layout = problem.layout
    both = np.concatenate([layout.control.ravel(), layout.force.ravel()])
    assert sorted(both) == list(range(layout.n_x))
    assert (np.diff(layout.control[:, 0]) > 0).all() and (np.diff(layout.force[:, 0]) > 0).all()


def test_layout_selects_knot_variables(make_arm: Callable[..., Agent], rng: np.random.Generator) -> None:
    """NumPy: basis times control points, and the forces as they are."""
    mesh = RestToRestSpline(7).mesh()
    layout = Layout.on(mesh, (make_arm(1), make_arm(2, "other")))
    x = rng.normal(size=layout.n_x)
    for part, (columns, forces) in enumerate(
        ((slice(0, 4), slice(0, 3)), (slice(4, 8), slice(3, 6)), (slice(8, 14), slice(0, 6)))
    ):
        control = x[layout.control][:, columns]
        expected = np.hstack([*(basis @ control for basis in mesh.basis), x[layout.force][:, forces]])
        actual = (layout.select(part) @ x).reshape(len(mesh.phase), -1)
        np.testing.assert_allclose(actual, expected, atol=1e-11)


def test_parameters_alone_change_subject_weights_and_period(
    arm_team: Team,
    random_unknowns: Unknowns,
    make_task: Callable[..., LiftTask],
    make_box: Callable[..., LiftedObject],
    newton_euler: Outputs,
    rng: np.random.Generator,
) -> None:
    """The functions of one problem at another's parameters give the other's plain objective."""
    one = Problem(arm_team, make_task(), RestToRestSpline(6).mesh())
    heavy = make_box(np.array([[-0.35, 0.01, -0.06], [0.3, 0.01, -0.06]]), 8.0)
    topology = Topology.of(heavy.model, heavy.grasp_frames)
    team = replace(arm_team, object=heavy, topologies=(*arm_team.topologies[:-1], topology))
    other = Problem(team, make_task(duration=3.1, acceleration_weight=2.0, force_weight=0.3, agent_weights=(0.2, 4.0)),
                    RestToRestSpline(6).mesh())  # fmt: skip
    x = random_unknowns(one, rng)
    reference = Plain(other, x, 6)
    np.testing.assert_allclose(float(one.nlp.grad_f(x, other.parameters)[0]), reference.objective(), rtol=1e-12)
    g = ca.DM(one.nlp.jac_g(x, other.parameters)[0]).full().ravel()
    _, balance = rows_of(other, g, "balance", "box")
    np.testing.assert_allclose(balance, reference.balance(newton_euler)[:, [0, 1, 2, 4, 5]], atol=1e-10)
