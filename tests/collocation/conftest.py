"""Teams, problems and small models that the tests of the optimal-control core share.

The human, Sawyer and table come from the user's own kernel cache, so that they are compiled once a machine; everything
else runs on small chains or on CasADi's virtual machine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.dynamics import KnotFunctions, Topology, agent_functions, object_functions
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.multibody.agent import Agent, Grasp, HalfSpace, JointLimits, LiftedObject
from liftopt.search.initial_guess import InitialGuess


def chain(seed: int, joints: tuple[str, ...] = ("RX", "RY", "RZ", "PY")) -> pin.Model:
    """Return a chain with random placements and bodies, and the frame ``tip``."""
    rng = np.random.default_rng(seed)
    kinds = {"RX": pin.JointModelRX, "RY": pin.JointModelRY, "RZ": pin.JointModelRZ, "PY": pin.JointModelPY}
    model, parent = pin.Model(), 0
    for i, kind in enumerate(joints):
        placement = pin.SE3(pin.exp3(rng.normal(size=3)), 0.3 * rng.normal(size=3))
        parent = model.addJoint(parent, kinds[kind](), placement, f"arm_{kind}{i}")
        half = rng.normal(size=(3, 3))
        body = pin.Inertia(rng.uniform(0.5, 2.0), 0.1 * rng.normal(size=3), 0.02 * half @ half.T + 0.01 * np.eye(3))
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    tip = pin.SE3(pin.exp3(rng.normal(size=3)), 0.2 * rng.normal(size=3))
    model.addFrame(pin.Frame("tip", parent, 0, tip, pin.FrameType.OP_FRAME))
    return model


def chain_agent(seed: int, name: str = "arm") -> Agent:
    """Return a four-joint agent on a random chain, with a half-space that is not along an axis."""
    n = 4
    limits = JointLimits(
        -2.0 * np.ones(n), 2.5 * np.ones(n), 3.0 * np.ones(n), -np.arange(60.0, 100.0, 10.0), 80.0 * np.ones(n)
    )
    workspace = HalfSpace(np.array([0.6, 0.0, 0.8]), -5.0)
    holds, posture = (Grasp(name, "tip"),), 0.1 * np.arange(n)
    return Agent(name, "robot", "", chain(seed), (), holds, ("tip",), limits, posture, workspace)


def box(grasps: np.ndarray, mass: float = 3.0) -> LiftedObject:
    """Return a body with a full inertia tensor, its frame at the centre of mass, and grasp frames (m, 3)."""
    model = pin.Model()
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    inertia = np.array([[0.06, 0.004, -0.003], [0.004, 0.05, 0.002], [-0.003, 0.002, 0.08]])
    model.appendBodyToJoint(root, pin.Inertia(mass, np.zeros(3), inertia), pin.SE3.Identity())
    names = tuple(f"grasp_{i}" for i in range(len(grasps)))
    for name, point in zip(names, grasps, strict=True):
        model.addFrame(pin.Frame(name, root, 0, pin.SE3(np.eye(3), point), pin.FrameType.OP_FRAME))
    return LiftedObject("box", "", model, names)


def turned(agent: Agent, angle: float, x: float) -> Agent:
    """Return ``agent`` turned by ``angle`` about the vertical through the origin, then moved by ``x`` ahead."""
    model = agent.model.copy()
    moved = pin.SE3(pin.utils.rotate("z", angle), np.array([x, 0.0, 0.0]))
    model.jointPlacements[1] = moved * model.jointPlacements[1]
    workspace = agent.workspace
    if workspace is not None:
        normal = moved.rotation @ workspace.normal
        workspace = HalfSpace(normal, workspace.offset + float(normal @ moved.translation))
    return replace(agent, model=model, workspace=workspace, name=f"{agent.name}_turned")


def newton_euler(model: pin.Model, frames: tuple[str, ...], y: np.ndarray, period: float) -> np.ndarray:
    """Return the object's outputs by Newton and Euler, its attitude Rx Ry Rz differentiated by the chain rule.

    Args:
        model: free body whose frame is at its centre of mass.
        frames: its grasp frames.
        y: (18 + 3 m,) coordinates, their first and second derivatives by the phase, and the grasp forces.
        period: [s].
    """
    x, rate, second = y[:6], y[6:12] / period, y[12:18] / period**2
    forces = y[18:].reshape(-1, 3)
    turns = []
    for axis, angle, dot, ddot in zip(np.eye(3), x[3:], rate[3:], second[3:], strict=True):
        rotation, generator = pin.exp3(axis * angle), pin.skew(axis)
        twice = rotation @ (generator @ generator * dot**2 + generator * ddot)
        turns.append((rotation, rotation @ generator * dot, twice))
    (a, da, dda), (b, db, ddb), (c, dc, ddc) = turns
    rotation = a @ b @ c
    first = da @ b @ c + a @ db @ c + a @ b @ dc
    twice = dda @ b @ c + a @ ddb @ c + a @ b @ ddc + 2 * (da @ db @ c + da @ b @ dc + a @ db @ dc)
    omega = pin.unSkew(rotation.T @ first)
    alpha = pin.unSkew(rotation.T @ twice + first.T @ first)
    body = model.inertias[1]
    levers = np.array([model.frames[model.getFrameId(name)].placement.translation for name in frames])
    force = body.mass * (second[:3] - np.array([0.0, 0.0, -9.81])) - forces.sum(axis=0)
    moment = body.inertia @ alpha + np.cross(omega, body.inertia @ omega)
    moment -= np.cross(levers, forces @ rotation).sum(axis=0)
    return np.concatenate([force, moment, (x[:3] + levers @ rotation.T).ravel()])


def random_unknowns(problem: Problem, rng: np.random.Generator) -> np.ndarray:
    """Return unknowns near the comfortable postures with forces of some newtons."""
    layout = problem.layout
    postures = np.concatenate([*(agent.posture for agent in problem.team.agents), [0.6, 0.0, 1.1, 0.0, 0.0, 0.0]])
    x = np.empty(layout.n_x)
    x[layout.control] = postures + 0.2 * rng.normal(size=layout.control.shape)
    x[layout.force] = 10.0 * rng.normal(size=layout.force.shape)
    return x


def check_derivatives(problem: Problem) -> None:
    """Central differences of f, g and of the Lagrangian's gradient at a random point with random multipliers."""
    nlp, p, rng = problem.nlp, problem.parameters, np.random.default_rng(7)
    x, sigma, h = random_unknowns(problem, rng), 0.7, 1e-5
    lam = rng.normal(size=problem.constraints.linear.shape[0])
    n_x = len(x)
    columns = ca.DM(np.hstack([x[:, None] + h * np.eye(n_x), x[:, None] - h * np.eye(n_x)]))
    f, gradient = nlp.grad_f.map(2 * n_x)(columns, p)
    g = nlp.jac_g.map(2 * n_x)(columns, p)[0]
    value, at = nlp.grad_f(x, p)
    rows, jacobian = nlp.jac_g(x, p)

    def difference(values: object) -> np.ndarray:
        full = ca.DM(values).full()
        return np.asarray(full[:, :n_x] - full[:, n_x:]) / (2 * h)

    numeric = difference(f).ravel()
    np.testing.assert_allclose(ca.DM(at).full().ravel(), numeric, rtol=0, atol=1e-7 * np.abs(numeric).max())
    numeric = difference(g)
    np.testing.assert_allclose(ca.DM(jacobian).full(), numeric, rtol=0, atol=1e-7 * np.abs(numeric).max())
    symbol = ca.Function("direct", [nlp.x, nlp.p], [nlp.f, nlp.g])(x, p)
    np.testing.assert_allclose(float(symbol[0]), float(value), rtol=1e-14)
    np.testing.assert_allclose(ca.DM(symbol[1]).full(), ca.DM(rows).full(), rtol=0, atol=1e-12)

    slopes = np.empty((n_x, 2 * n_x))
    for i in range(2 * n_x):
        slopes[:, i] = sigma * gradient[:, i].full().ravel()
        slopes[:, i] += ca.mtimes(nlp.jac_g(columns[:, i], p)[1].T, lam).full().ravel()
    numeric = difference(slopes)
    hessian = nlp.hess_lag(x, p, sigma, lam)
    assert hessian.sparsity().is_triu()
    np.testing.assert_allclose(ca.DM(hessian).full(), np.triu(numeric), rtol=0, atol=1e-7 * np.abs(numeric).max())


@pytest.fixture(scope="session", name="random_unknowns")
def _random_unknowns() -> Callable[[Problem, np.random.Generator], np.ndarray]:
    return random_unknowns


@pytest.fixture(scope="session", name="check_derivatives")
def _check_derivatives() -> Callable[[Problem], None]:
    return check_derivatives


@pytest.fixture(scope="session", name="newton_euler")
def _newton_euler() -> Callable[..., np.ndarray]:
    return newton_euler


@pytest.fixture(scope="session")
def make_chain() -> Callable[..., pin.Model]:
    return chain


@pytest.fixture(scope="session")
def make_arm() -> Callable[..., Agent]:
    return chain_agent


def central_differences(function: Callable[[np.ndarray], np.ndarray], y: np.ndarray) -> np.ndarray:
    """Return the Jacobian by central differences of sixth order."""
    h, columns = 1e-2, []
    for e in np.eye(len(y)):
        columns.append(
            sum(
                w * (function(y + k * h * e) - function(y - k * h * e)) / h
                for k, w in ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
            )
        )
    return np.transpose(columns)


@pytest.fixture(scope="session")
def differences() -> Callable[..., np.ndarray]:
    return central_differences


def derive_from_jacobian(functions: KnotFunctions, y: np.ndarray, p: np.ndarray, m: np.ndarray) -> None:
    """Check that gradient and curvature are J^T m, and differences of it; the Jacobian is checked elsewhere."""

    def pull(at: np.ndarray) -> np.ndarray:
        return np.asarray(functions.jacobian(at, p).full().T @ m)

    whole = pull(y)
    actual = functions.gradient(y, p, m).full().ravel()
    np.testing.assert_allclose(actual, whole, rtol=0, atol=1e-12 * np.abs(whole).max())
    numeric = central_differences(pull, y)
    curvature = functions.curvature(y, p, m).full()
    assert not np.tril(curvature, -1).any()
    np.testing.assert_allclose(curvature, np.triu(numeric), rtol=0, atol=1e-9 * np.abs(numeric).max())


@pytest.fixture(scope="session")
def check_knot_derivatives() -> Callable[..., None]:
    return derive_from_jacobian


@pytest.fixture(scope="session")
def make_box() -> Callable[..., LiftedObject]:
    return box


@pytest.fixture(scope="session")
def make_turned() -> Callable[..., Agent]:
    return turned


@pytest.fixture(scope="session")
def problem(team: Team, make_task: Callable[..., LiftTask]) -> Problem:
    """Return the lift of Table 5 on 8 intervals."""
    return Problem(team, make_task(), RestToRestSpline(8).mesh())


@pytest.fixture(scope="session")
def ipopt(small_lift: Problem) -> Ipopt:
    return Ipopt(small_lift)


@pytest.fixture(scope="session")
def solved(ipopt: Ipopt, starts: list[InitialGuess]) -> SolverResult:
    return ipopt.solve(starts[0].x, deadline=NEVER)


@pytest.fixture(scope="session")
def arm_team(make_arm: Callable[..., Agent]) -> Team:
    """Return two random arms that hold a box, on CasADi's virtual machine, which alone can differentiate itself."""
    lifted = box(np.array([[-0.3, 0.02, -0.05], [0.25, 0.02, -0.05]]))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", "")
        patch.setenv("LIFTOPT_CACHE", "/dev/null/none")
        return Team.of((make_arm(1), make_arm(2, "other")), lifted)


@pytest.fixture(scope="session")
def knot_functions(
    human: Agent, sawyer: Agent, table: LiftedObject
) -> dict[str, tuple[pin.Model, Topology, KnotFunctions]]:
    """Return (model, topology, uncompiled functions) of three agents and of an object."""
    arm = chain_agent(3)
    built = {}
    for name, agent in (("human", human), ("sawyer", sawyer), ("arm", arm)):
        topology = Topology.of(agent.reduced(), agent.hands)
        built[name] = (topology.model, topology, agent_functions(topology))
    for name, lifted in (
        ("table", table),
        ("box", box(np.array([[-0.3, 0.1, 0.0], [0.2, 0.1, -0.1], [0, -0.2, 0.1]]))),
    ):
        topology = Topology.of(lifted.model, lifted.grasp_frames)
        built[name] = (topology.model, topology, object_functions(topology))
    return built
