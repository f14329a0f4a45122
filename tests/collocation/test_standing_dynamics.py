"""Trees with several hands on a base: Pinocchio in double precision and finite differences are the oracles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.dynamics import KnotFunctions
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.standing_dynamics import StandingTopology, standing_agent_functions
from liftopt.collocation.task import LiftTask
from liftopt.multibody.agent import Agent, Grasp, JointLimits, LiftedObject
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.placement import Placement

PERIOD = 1.3
PLACE = Placement(0.4, -0.3, 0.8)
GRIPS = tuple(pin.exp3(np.array(turn)) for turn in ([0.4, -1.1, 0.7], [-0.2, 0.5, 1.9]))
KINDS = ("person", "tree", "two roots", "chain")
TRUNKS = {"person": "human_Q3", "tree": "joint4"}
Built = tuple[pin.Model, StandingTopology, KnotFunctions]


def random_tree(seed: int, joints: list[tuple[int, pin.JointModel]], hands: tuple[int, ...]) -> pin.Model:
    """Return a tree of joints that stand on the joints named, with random placements and bodies, on ``PLACE``."""
    rng = np.random.default_rng(seed)
    model = pin.Model()
    for i, (parent, joint) in enumerate(joints):
        placement = pin.SE3(pin.exp3(rng.normal(size=3)), 0.3 * rng.normal(size=3))
        if i in (2, 3):  # one centre with the joint before
            placement.translation = np.zeros(3)
        if parent == 0:
            placement = pin.SE3(PLACE.T_world_base) * placement
        j = model.addJoint(parent, joint, placement, f"joint{i}")
        half = rng.normal(size=(3, 3))
        body = pin.Inertia(rng.uniform(0.5, 2.0), 0.1 * rng.normal(size=3), 0.02 * half @ half.T + 0.01 * np.eye(3))
        if i != 3:
            model.appendBodyToJoint(j, body, pin.SE3.Identity())
    for i, joint_id in enumerate(hands):
        tip = pin.SE3(pin.exp3(rng.normal(size=3)), 0.2 * rng.normal(size=3))
        model.addFrame(pin.Frame(f"hand{i}", joint_id, 0, tip, pin.FrameType.OP_FRAME))
    return model


def model_of(kind: str) -> pin.Model:
    x, y, z, slide = pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ, pin.JointModelPY
    skew = np.array([0.6, 0.0, 0.8])
    if kind == "tree":
        legs_and_trunk = [(0, y()), (1, z()), (2, x()), (3, pin.JointModelRevoluteUnaligned(skew))]
        return random_tree(1, [*legs_and_trunk, (4, x()), (5, slide()), (6, y()), (4, z()), (8, y())], (7, 9))
    if kind == "two roots":
        return random_tree(2, [(0, y()), (1, z()), (0, x()), (3, slide())], (2, 4))
    if kind == "chain":
        return random_tree(3, [(0, y()), (1, z()), (2, x())], (3,))
    return whole_human_agent(Subject(1.7, 68.0, "female"), place=PLACE).reduced()


@pytest.fixture(scope="module", params=KINDS)
def built(request: pytest.FixtureRequest) -> Built:
    model = model_of(request.param)
    hands = tuple(frame.name for frame in model.frames if frame.name.startswith("hand") or "grasp" in frame.name)
    hands = tuple(dict.fromkeys(name.removesuffix("_fixed") for name in hands))
    trunk = TRUNKS.get(request.param, "")
    topology = StandingTopology.standing(model, hands, PLACE.T_world_base, *GRIPS[: len(hands)], trunk=trunk)
    return model, topology, standing_agent_functions(topology)


def expected(model: pin.Model, topology: StandingTopology, y: np.ndarray) -> np.ndarray:
    """Return the outputs by Pinocchio's RNEA, the force of its first joints, and whole frame Jacobians."""
    n, data = model.nv, model.createData()
    q, v, a, angles = y[:n], y[n : 2 * n] / PERIOD, y[2 * n : 3 * n] / PERIOD**2, y[-3:]
    pin.forwardKinematics(model, data, q)
    tau = pin.rnea(model, data, q, v, a).copy()
    roots = [j for j in range(1, model.njoints) if model.parents[j] == 0]
    ground = sum((data.oMi[j].act(data.f[j]) for j in roots), pin.Force.Zero())
    attitude = np.linalg.multi_dot([pin.utils.rotate(axis, angle) for axis, angle in zip("xyz", angles, strict=True)])
    outputs = []
    for name, grip, wrench in zip(topology.frames, GRIPS, y[3 * n : -3].reshape(-1, 6), strict=False):
        frame, (f, m) = model.getFrameId(name), np.split(wrench, 2)
        tau += pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED).T @ wrench
        pin.framesForwardKinematics(model, data, q)
        hand = data.oMf[frame]
        tilt = np.linalg.norm(pin.log3(attitude.T @ hand.rotation @ grip))
        ground += pin.SE3(np.eye(3), hand.translation).act(pin.Force(wrench))
        outputs.append([*hand.translation, f @ f, m @ m, np.cos(tilt), *attitude.T @ f, *attitude.T @ m])
    lean = []
    if topology.trunk:
        there, upright = data.oMi[topology.trunk].rotation.copy(), model.createData()
        pin.forwardKinematics(model, upright, pin.neutral(model))
        lean = [1.0 - float(there[2] @ upright.oMi[topology.trunk].rotation[2])]
    return np.concatenate([tau, lean, *outputs, pin.SE3(PLACE.T_world_base).actInv(ground).vector])


def sample(functions: KnotFunctions, rng: np.random.Generator) -> np.ndarray:
    return rng.normal(size=functions.value.size1_in(0))


def test_values_are_pinocchios(built: Built, rng: np.random.Generator) -> None:
    model, topology, functions = built
    for _ in range(5):
        y = sample(functions, rng)
        c = functions.value(y, np.r_[PERIOD, topology.parameters]).full().ravel()
        whole = expected(model, topology, y)
        np.testing.assert_allclose(c, whole, rtol=0, atol=1e-12 * np.abs(whole).max())


def test_jacobian_by_finite_differences_of_pinocchio(
    built: Built, rng: np.random.Generator, differences: Callable[..., np.ndarray]
) -> None:
    model, topology, functions = built
    y = sample(functions, rng)
    numeric = differences(lambda at: expected(model, topology, at), y)
    actual = functions.jacobian(y, np.r_[PERIOD, topology.parameters]).full()
    np.testing.assert_allclose(actual, numeric, rtol=0, atol=1e-9 * np.abs(numeric).max())


def test_gradient_and_curvature_are_derivatives_of_the_jacobian(
    built: Built, rng: np.random.Generator, check_knot_derivatives: Callable[..., None]
) -> None:
    _, topology, functions = built
    y, p = sample(functions, rng), np.r_[PERIOD, topology.parameters]
    check_knot_derivatives(functions, y, p, rng.normal(size=functions.value.size1_out(0)))


def test_squares_are_the_gauss_newton_term(built: Built, rng: np.random.Generator) -> None:
    """NumPy: sum_j d_j c_j' c_j'^T over the torques, and the lean of a trunk."""
    model, topology, functions = built
    jacobian = functions.jacobian(sample(functions, rng), np.r_[PERIOD, topology.parameters])
    squared = model.nv + bool(topology.trunk)
    d, leading = rng.normal(size=squared), jacobian.full()[:squared]
    whole = np.triu(leading.T @ (d[:, None] * leading))
    np.testing.assert_allclose(
        ca.DM(functions.squares(jacobian, d)).full(), whole, rtol=0, atol=1e-12 * np.abs(whole).max()
    )


@pytest.mark.parametrize("used", [("hand1",), ("hand1", "hand0")])
def test_derivatives_of_the_programme(
    used: tuple[str, ...],
    make_arm: Callable[..., Agent],
    make_box: Callable[..., LiftedObject],
    make_task: Callable[..., LiftTask],
    check_derivatives: Callable[[Problem], None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Central differences of objective, rows and Lagrangian with one hand or two of a tree, and another arm."""
    monkeypatch.setenv("CC", "")
    monkeypatch.setenv("LIFTOPT_CACHE", "/dev/null/none")
    model = model_of("tree")
    n, arm = model.nv, make_arm(2)
    limits = JointLimits(*(bound * np.ones(n) for bound in (-2.0, 2.5, 3.0, -60.0, 80.0)))
    grasps = tuple(Grasp(name, name, True, 10.0, 0.5, grip) for name, grip in zip(used, GRIPS, strict=False))
    tree = replace(
        arm, name="tree", model=model, grasps=grasps, hands=("hand0", "hand1"), limits=limits, posture=np.zeros(n)
    )
    points = np.array([[-0.3, 0.02, -0.05], [0.25, 0.02, -0.05], [0.0, 0.2, 0.1]])[: len(used) + 1]
    team = Team.of((tree, arm), make_box(points))
    check_derivatives(Problem(team, make_task(), RestToRestSpline(6).mesh()))


def test_one_kernel_serves_everybody_everywhere(rng: np.random.Generator) -> None:
    """Men and women of any stature, at any place and heading, with any grip: equal signatures, other parameters."""
    signatures, parameters = set(), []
    for i, (sex, stature) in enumerate((s, h) for s in ("male", "female") for h in np.linspace(1.5, 2.0, 6)):
        place = Placement(*rng.uniform(-2.0, 2.0, 2), (0.0, np.pi / 2, rng.uniform(-3.0, 3.0))[i % 3])
        agent = whole_human_agent(Subject(stature, rng.uniform(45.0, 120.0), sex), place=place)
        grips = [np.eye(3) if i % 2 else pin.exp3(rng.normal(size=3)) for _ in agent.hands]
        topology = StandingTopology.standing(agent.reduced(), agent.hands, place.T_world_base, *grips)
        signatures.add(topology.signature())
        parameters.append(topology.parameters)
    assert len(signatures) == 1
    assert len({len(p) for p in parameters}) == 1
    assert not np.array_equal(parameters[0], parameters[-1])
