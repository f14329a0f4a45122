"""Serial arms whose kernels are shared. Oracles: Pinocchio in double precision, and the kernels of one model."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.arm_dynamics import ArmTopology, arm_functions
from liftopt.collocation.arm_frames import ArmFrames
from liftopt.collocation.dynamics import KnotFunctions, Topology, agent_functions
from liftopt.collocation.wrench_dynamics import WrenchTopology, wrench_agent_functions
from liftopt.errors import ModelError

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


def topology_of(model: pin.Model, moments: bool) -> ArmTopology:
    return ArmTopology.holding(model, "hand", GRIP if moments else None)


@pytest.fixture(scope="module", params=[*((name, True) for name in ARMS), ("ur", False), ("gantry", False)], ids=str)
def built(request: pytest.FixtureRequest) -> tuple[pin.Model, ArmTopology, KnotFunctions]:
    name, moments = request.param
    topology = topology_of(model := arm(ARMS[name]), moments)
    return model, topology, arm_functions(topology)


def expected(model: pin.Model, moments: bool, y: np.ndarray) -> np.ndarray:
    """Return the outputs by Pinocchio's RNEA and frame Jacobian, the angle by the rotation vector."""
    n, data, frame = model.nv, model.createData(), model.getFrameId("hand")
    q, v, a, f = y[:n], y[n : 2 * n] / PERIOD, y[2 * n : 3 * n] / PERIOD**2, y[3 * n : 3 * n + 3]
    m = y[3 * n + 3 : 3 * n + 6] if moments else np.zeros(3)
    slope = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
    tau = pin.rnea(model, data, q, v, a) + slope.T @ np.r_[f, m]
    pin.framesForwardKinematics(model, data, q)
    hand = data.oMf[frame]
    if not moments:
        return np.r_[tau, hand.translation, f @ f]
    attitude = np.linalg.multi_dot([pin.utils.rotate(axis, a) for axis, a in zip("xyz", y[-3:], strict=True)])
    tilt = np.linalg.norm(pin.log3(attitude.T @ hand.rotation @ GRIP))
    return np.r_[tau, hand.translation, f @ f, m @ m, np.cos(tilt), attitude.T @ f, attitude.T @ m]


def test_values_are_pinocchios(built: tuple[pin.Model, ArmTopology, KnotFunctions], rng: np.random.Generator) -> None:
    model, topology, functions = built
    for _ in range(5):
        y = 2.0 * rng.normal(size=functions.value.size1_in(0))
        c = functions.value(y, np.r_[PERIOD, topology.parameters]).full().ravel()
        whole = expected(model, topology.moments, y)
        np.testing.assert_allclose(c, whole, rtol=0, atol=1e-13 * np.abs(whole).max())


def test_derivatives_are_those_of_the_kernels_of_one_model(
    built: tuple[pin.Model, ArmTopology, KnotFunctions], rng: np.random.Generator
) -> None:
    """CasADi's derivatives of Pinocchio's recursion: slopes, their weighted sum, its slopes, squares."""
    model, topology, functions = built
    if topology.moments:
        own: Topology = WrenchTopology.holding(model, ("hand",), GRIP)
        others = wrench_agent_functions(own)  # type: ignore[arg-type]
    else:
        others = agent_functions(own := Topology.of(model, ("hand",)))
    y, m = rng.normal(size=functions.value.size1_in(0)), rng.normal(size=functions.value.size1_out(0))
    p, q = np.r_[PERIOD, topology.parameters], np.r_[PERIOD, own.parameters]
    pairs = [
        (functions.gradient(y, p, m), others.gradient(y, q, m)),
        (functions.jacobian(y, p), others.jacobian(y, q)),
        (functions.curvature(y, p, m), others.curvature(y, q, m)),
    ]
    d = rng.uniform(0.5, 2.0, model.nv)
    leading = pairs[1][1].full()[: model.nv]
    pairs.append((functions.squares(pairs[1][0], d), np.triu(leading.T * d @ leading)))
    for ours, theirs in pairs:
        full = np.asarray(theirs if isinstance(theirs, np.ndarray) else theirs.full())
        np.testing.assert_allclose(ours.full(), full, rtol=0, atol=1e-12 * np.abs(full).max())


@pytest.mark.parametrize("moments", [False, True])
def test_one_kernel_serves_all_arms_with_the_same_joints(moments: bool) -> None:
    """Lengths, angles, bodies, base, tool and grip are parameters; kinds of joints and moments are not."""
    bent = tuple((kind, roll + 0.1, pitch, yaw, 2.0 * x, y, z) for kind, roll, pitch, yaw, x, y, z in UR)
    floor, ceiling = pin.SE3.Identity(), pin.SE3(pin.utils.rotate("x", np.pi), np.array([0.0, 0.0, 3.0]))
    models = [arm(rows, seed, place) for seed, (rows, place) in enumerate([(UR, WALL), (UR, floor), (bent, ceiling)])]
    same = [topology_of(model, moments) for model in models]
    assert len({topology.signature() for topology in same}) == 1
    assert len({len(topology.parameters) for topology in same}) == 1
    assert len({topology.parameters.tobytes() for topology in same}) == len(same)
    others = [topology_of(arm(rows), moments) for rows in (PANDA, COLUMN)] + [topology_of(models[0], not moments)]
    assert len({topology.signature() for topology in (same[0], *others)}) == 4


def test_another_arm_is_served_by_the_functions_of_the_first(rng: np.random.Generator) -> None:
    functions, model = arm_functions(topology_of(arm(UR), True)), arm(ARMS["panda"][:6], 5, pin.SE3.Identity())
    y = rng.normal(size=functions.value.size1_in(0))
    c = functions.value(y, np.r_[PERIOD, topology_of(model, True).parameters]).full().ravel()
    whole = expected(model, True, y)
    np.testing.assert_allclose(c, whole, rtol=0, atol=1e-13 * np.abs(whole).max())


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
