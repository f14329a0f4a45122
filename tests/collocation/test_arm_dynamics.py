"""Serial arms whose kernels are shared. Oracles: Pinocchio in double precision, and the kernels of one model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.arm_dynamics import ArmTopology, arm_functions
from liftopt.collocation.arm_frames import ArmFrames
from liftopt.collocation.dynamics import KnotFunctions
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.collocation.wrench_dynamics import WrenchTopology, wrench_agent_functions
from liftopt.errors import ModelError
from liftopt.multibody.agent import Agent, Grasp, LiftedObject

Built = tuple[pin.Model, ArmTopology, KnotFunctions]
PERIOD = 1.3
GRIP = pin.exp3(np.array([0.4, -1.1, 0.7]))
WALL = pin.SE3(pin.rpy.rpyToMatrix(0.4, 1.9, -0.7), np.array([1.8, -0.3, 1.1]))
RIGHT = np.pi / 2
# Of each joint: kind, then roll, pitch and yaw of its placement, then where it is.
UR = (
    ("R", 0.0, 0.0, 0.0, 0.0, 0.0, 0.128), ("R", RIGHT, RIGHT, 0.0, 0.0, 0.176, 0.0),
    ("R", 0.0, 0.0, 0.0, 0.612, 0.0, -0.128), ("R", 0.0, 0.0, RIGHT, 0.572, 0.0, 0.0),
    ("R", -RIGHT, 0.0, 0.0, 0.0, 0.0, 0.116), ("R", RIGHT, 0.0, 0.0, 0.0, -0.116, 0.0),
)  # fmt: skip
PANDA = (
    ("R", 0.0, 0.0, 0.0, 0.0, 0.0, 0.333), ("R", -RIGHT, 0.0, 0.0, 0.0, 0.0, 0.0),
    ("R", RIGHT, 0.0, 0.0, 0.0, -0.316, 0.0), ("R", RIGHT, 0.0, 0.0, 0.083, 0.0, 0.0),
    ("R", -RIGHT, 0.0, 0.0, -0.083, 0.384, 0.0), ("R", RIGHT, 0.0, 0.0, 0.0, 0.0, 0.0),
    ("R", RIGHT, 0.0, 0.0, 0.088, 0.0, 0.0),
)  # fmt: skip
COLUMN = (("P", 0.0, 0.0, 0.0, 0.1, 0.0, 0.8), ("R", 0.0, 0.0, 0.0, 0.2, 0.1, 0.0), *PANDA[1:5])
# Parallel but for the digits of a URDF, and for rounding; one that meets the axis before; the others anyhow.
ODD = (
    ("R", 0.3, 0.2, 0.1, 0.1, -0.2, 0.3), ("R", 3.7e-6, 0.0, 0.5, 0.2, 0.3, 0.1), ("P", 0.7, -0.3, 1.0, 0.1, 0.2, 0.0),
    ("R", 1e-9, -1e-9, 0.2, 0.2, -0.1, 0.3), ("R", 0.8, 0.6, -0.4, 0.0, 0.0, 0.2),
    ("P", -0.5, 1.1, 0.4, 0.1, 0.1, 0.1), ("R", np.pi, 0.0, 0.0, 0.3, 0.0, 0.1),
)  # fmt: skip
ARMS = {"ur": UR, "panda": PANDA, "column": COLUMN, "gantry": (*COLUMN[:1], *ODD[2:6]), "odd": ODD, "slide": COLUMN[:1]}


def arm(rows: tuple[tuple[object, ...], ...], seed: int = 0, place: pin.SE3 = WALL) -> pin.Model:
    """Return an arm on a base, with random bodies and a random frame ``hand``."""
    rng, model, joint = np.random.default_rng(seed), pin.Model(), 0
    for number, (kind, *numbers) in enumerate(rows):
        at = pin.SE3(pin.rpy.rpyToMatrix(*numbers[:3]), np.array(numbers[3:], dtype=float))
        moving = pin.JointModelRZ() if kind == "R" else pin.JointModelPZ()
        joint = model.addJoint(joint, moving, at if joint else place * at, f"joint{number}")
        half = rng.normal(size=(3, 3))
        body = pin.Inertia(rng.uniform(0.5, 8.0), 0.2 * rng.normal(size=3), 0.02 * half @ half.T + 0.01 * np.eye(3))
        model.appendBodyToJoint(joint, body, pin.SE3.Identity())
    hand = pin.SE3(pin.exp3(rng.normal(size=3)), 0.2 * rng.normal(size=3))
    model.addFrame(pin.Frame("hand", joint, 0, hand, pin.FrameType.OP_FRAME))
    return model


def topology_of(model: pin.Model) -> ArmTopology:
    return ArmTopology.holding(model, "hand", GRIP)


@pytest.fixture(scope="module", params=ARMS)
def built(request: pytest.FixtureRequest) -> Built:
    topology = topology_of(model := arm(ARMS[request.param]))
    return model, topology, arm_functions(topology)


def expected(model: pin.Model, y: np.ndarray) -> np.ndarray:
    """Return the outputs by Pinocchio's RNEA and frame Jacobian, the angle by the rotation vector."""
    n, data, frame = model.nv, model.createData(), model.getFrameId("hand")
    q, v, a, f, m, angles = np.split(y, [n, 2 * n, 3 * n, 3 * n + 3, 3 * n + 6])
    slope = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
    tau = pin.rnea(model, data, q, v / PERIOD, a / PERIOD**2) + slope.T @ np.r_[f, m]
    pin.framesForwardKinematics(model, data, q)
    hand = data.oMf[frame]
    attitude = np.linalg.multi_dot([pin.utils.rotate(axis, angle) for axis, angle in zip("xyz", angles, strict=True)])
    tilt = np.linalg.norm(pin.log3(attitude.T @ hand.rotation @ GRIP))
    return np.r_[tau, hand.translation, f @ f, m @ m, np.cos(tilt), attitude.T @ f, attitude.T @ m]


def test_values_are_pinocchios(built: Built, rng: np.random.Generator) -> None:
    model, topology, functions = built
    for _ in range(5):
        y = 2.0 * rng.normal(size=functions.value.size1_in(0))
        c = functions.value(y, np.r_[PERIOD, topology.parameters]).full().ravel()
        whole = expected(model, y)
        np.testing.assert_allclose(c, whole, rtol=0, atol=1e-13 * np.abs(whole).max())


def test_derivatives_are_those_of_the_kernels_of_one_model(built: Built, rng: np.random.Generator) -> None:
    """CasADi's derivatives of Pinocchio's recursion: slopes, their weighted sum, its slopes, squares."""
    model, topology, functions = built
    own = WrenchTopology.holding(model, ("hand",), GRIP)
    others = wrench_agent_functions(own)
    y, m = rng.normal(size=functions.value.size1_in(0)), rng.normal(size=functions.value.size1_out(0))
    p, q, d = np.r_[PERIOD, topology.parameters], np.r_[PERIOD, own.parameters], rng.uniform(0.5, 2.0, model.nv)
    slopes = others.jacobian(y, q).full()
    leading = slopes[: model.nv]
    for ours, theirs in (
        (functions.gradient(y, p, m), others.gradient(y, q, m).full()),
        (functions.jacobian(y, p), slopes),
        (functions.curvature(y, p, m), others.curvature(y, q, m).full()),
        (functions.squares(functions.jacobian(y, p), d), np.triu(leading.T * d @ leading)),
    ):
        np.testing.assert_allclose(ours.full(), theirs, rtol=0, atol=1e-12 * np.abs(theirs).max())


def test_one_kernel_serves_all_arms_with_the_same_joints() -> None:
    """Lengths, angles, bodies, base, tool and grip are parameters; the kinds of joints are not."""
    bent = tuple((kind, roll + 0.1, pitch, yaw, 2.0 * x, y, z) for kind, roll, pitch, yaw, x, y, z in UR)
    floor, ceiling = pin.SE3.Identity(), pin.SE3(pin.utils.rotate("x", np.pi), np.array([0.0, 0.0, 3.0]))
    models = [arm(rows, seed, place) for seed, (rows, place) in enumerate([(UR, WALL), (UR, floor), (bent, ceiling)])]
    same = [*map(topology_of, models), ArmTopology.holding(models[0], "hand", np.eye(3))]
    assert len({topology.signature() for topology in same}) == 1
    assert len({len(topology.parameters) for topology in same}) == 1
    assert len({topology.parameters.tobytes() for topology in same}) == len(same)
    assert len({topology_of(arm(rows)).signature() for rows in (UR, PANDA, COLUMN, COLUMN[:5])}) == 4


def test_another_arm_is_served_by_the_functions_of_the_first(rng: np.random.Generator) -> None:
    functions, model = arm_functions(topology_of(arm(UR[:3]))), arm(PANDA[:3], 5, pin.SE3.Identity())
    y = rng.normal(size=functions.value.size1_in(0))
    c = functions.value(y, np.r_[PERIOD, topology_of(model).parameters]).full().ravel()
    whole = expected(model, y)
    np.testing.assert_allclose(c, whole, rtol=0, atol=1e-13 * np.abs(whole).max())


def test_a_hold_at_a_point_is_the_same_hold_without_its_moment(
    make_arm: Callable[..., Agent], make_box: Callable[..., LiftedObject], make_task: Callable[..., LiftTask],
    monkeypatch: pytest.MonkeyPatch, rng: np.random.Generator,
) -> None:  # fmt: skip
    """Outputs and rows of a team, and their slopes by all unknowns, are those by the kernels for points."""
    monkeypatch.setenv("CC", "")
    points = np.array([[-0.3, 0.0, 0.0], [0.2, 0.0, 0.0]])
    one = replace(make_arm(1), model=arm(COLUMN[:4]), hands=("hand",), grasps=(Grasp("arm", "hand"),))
    found, unknowns = [], rng.normal(size=1000)
    for shares in (False, True):
        team = Team.of((replace(one, shares_kernels=shares), make_arm(2, "other")), make_box(points))
        problem = Problem(team, make_task(), RestToRestSpline(6).mesh())
        x, p = unknowns[: problem.layout.n_x], problem.parameters
        found.append([np.asarray(result.full()) for result in (*problem.nlp.grad_f(x, p), *problem.nlp.jac_g(x, p))])
    for theirs, ours in zip(*found, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-12 * np.abs(theirs).max())


def test_frames_stay_near_their_links_where_axes_are_almost_parallel() -> None:
    """The feet of the common normals of these axes are up to 10^8 m away."""
    frames = ArmFrames.of(arm(ODD, place=pin.SE3.Identity()))
    assert all(np.linalg.norm(step.placement.translation) < 0.6 for step in frames.steps)
    assert all(np.linalg.norm(own.translation) < 1.5 for own in frames.own)


def _tree() -> pin.Model:
    model = arm(UR[:2])
    model.addJoint(1, pin.JointModelRZ(), pin.SE3.Identity(), "beside")
    return model


def _about_x() -> pin.Model:
    model = pin.Model()
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "joint")
    return model


def _geared() -> pin.Model:
    model = arm(UR[:2])
    model.armature = np.array([0.0, 0.1])
    return model


@pytest.mark.parametrize("make", [_tree, _about_x, _geared, pin.Model])
def test_other_models_are_refused(make: Callable[[], pin.Model]) -> None:
    with pytest.raises(ModelError, match="must be a serial arm"):
        ArmFrames.of(make())
