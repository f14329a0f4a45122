"""The functions at one knot: Pinocchio in double precision, Newton-Euler and finite differences are the oracles."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.dynamics import KnotFunctions, Topology, agent_functions, object_functions
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.person.human import Subject, human_agent
from liftopt.multibody.placement import facing
from liftopt.multibody.robots.sawyer import sawyer_agent
from liftopt.multibody.table import lifted_table

PERIOD = 1.7
AGENTS = ("human", "sawyer", "arm")
OBJECTS = ("table", "box")
Built = dict[str, tuple[pin.Model, Topology, KnotFunctions]]
Outputs = Callable[[pin.Model, tuple[str, ...], np.ndarray, float], np.ndarray]


def dense(value: object) -> np.ndarray:
    return np.asarray(ca.DM(value).full())


def agent_outputs(model: pin.Model, frame: str, y: np.ndarray, period: float) -> np.ndarray:
    """Return RNEA plus J^T f, the grasp point and f . f by Pinocchio."""
    n, data = model.nv, model.createData()
    q, v, a, f = y[:n], y[n : 2 * n] / period, y[2 * n : 3 * n] / period**2, y[3 * n :]
    tau = pin.rnea(model, data, q, v, a).copy()
    index = model.getFrameId(frame)
    tau += pin.computeFrameJacobian(model, data, q, index, pin.LOCAL_WORLD_ALIGNED)[:3].T @ f
    pin.framesForwardKinematics(model, data, q)
    return np.concatenate([tau, data.oMf[index].translation, [f @ f]])


def outputs(name: str, built: Built, y: np.ndarray, newton_euler: Outputs) -> np.ndarray:
    model, topology, _ = built[name]
    if name in OBJECTS:
        return newton_euler(model, topology.frames, y, PERIOD)
    return agent_outputs(model, topology.frames[0], y, PERIOD)


def sample(functions: KnotFunctions, rng: np.random.Generator) -> np.ndarray:
    y = rng.normal(size=functions.value.size1_in(0))
    y[-3:] *= 20.0
    return y


@pytest.mark.parametrize("name", AGENTS + OBJECTS)
def test_values_are_those_of_pinocchio_or_newton_euler(
    name: str, knot_functions: Built, newton_euler: Outputs, rng: np.random.Generator
) -> None:
    _, topology, functions = knot_functions[name]
    for _ in range(5):
        y = sample(functions, rng)
        expected = outputs(name, knot_functions, y, newton_euler)
        actual = dense(functions.value(y, np.r_[PERIOD, topology.parameters])).ravel()
        np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * max(1.0, np.abs(expected).max()))


@pytest.mark.parametrize("name", AGENTS + OBJECTS)
def test_jacobian_by_finite_differences_of_pinocchio(
    name: str, knot_functions: Built, newton_euler: Outputs, rng: np.random.Generator
) -> None:
    _, topology, functions = knot_functions[name]
    y, h = sample(functions, rng), 1e-2
    numeric = np.zeros(functions.jacobian.size_out(0))
    for j, e in enumerate(np.eye(len(y))):
        for k, weight in ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60)):
            ahead, behind = (outputs(name, knot_functions, at, newton_euler) for at in (y + k * h * e, y - k * h * e))
            numeric[:, j] += weight * (ahead - behind) / h
    actual = dense(functions.jacobian(y, np.r_[PERIOD, topology.parameters]))
    np.testing.assert_allclose(actual, numeric, rtol=0, atol=1e-9 * np.abs(numeric).max())


@pytest.mark.parametrize("name", AGENTS + OBJECTS)
def test_gradient_and_curvature_are_derivatives_of_the_jacobian(
    name: str, knot_functions: Built, rng: np.random.Generator, check_knot_derivatives: Callable[..., None]
) -> None:
    _, topology, functions = knot_functions[name]
    y, p = sample(functions, rng), np.r_[PERIOD, topology.parameters]
    check_knot_derivatives(functions, y, p, rng.normal(size=functions.value.size1_out(0)))


@pytest.mark.parametrize("name", AGENTS)
def test_squares_are_the_gauss_newton_term(name: str, knot_functions: Built, rng: np.random.Generator) -> None:
    """NumPy: sum_j d_j c_j' c_j'^T over the torques alone."""
    model, topology, functions = knot_functions[name]
    jacobian = functions.jacobian(sample(functions, rng), np.r_[PERIOD, topology.parameters])
    d, leading = rng.normal(size=model.nv), dense(jacobian)[: model.nv]
    expected = np.triu(leading.T @ (d[:, None] * leading))
    actual = dense(functions.squares(jacobian, d))
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_balance_agrees_with_pinocchios_free_flyer_and_external_forces(
    knot_functions: Built, rng: np.random.Generator
) -> None:
    """Pinocchio's RNEA with the grasp forces as external forces at rest, at any attitude."""
    model, topology, functions = knot_functions["box"]
    y = sample(functions, rng)
    y[6:18] = 0.0
    rotation = pin.utils.rotate("x", y[3]) @ pin.utils.rotate("y", y[4]) @ pin.utils.rotate("z", y[5])
    load = pin.Force.Zero()
    for name, force in zip(topology.frames, y[18:].reshape(-1, 3), strict=True):
        lever = model.frames[model.getFrameId(name)].placement.translation
        load += pin.Force(rotation.T @ force, np.cross(lever, rotation.T @ force))
    loads = pin.StdVec_Force()
    loads.extend([pin.Force.Zero(), load])
    q = np.concatenate([y[:3], pin.Quaternion(rotation).coeffs()])
    expected = pin.rnea(model, model.createData(), q, np.zeros(6), np.zeros(6), loads)
    expected[:3] = rotation @ expected[:3]
    actual = dense(functions.value(y, np.r_[PERIOD, topology.parameters])).ravel()[:6]
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-11)


def of(agent: Agent) -> Topology:
    return Topology.of(agent.reduced(), agent.hands)


@pytest.mark.parametrize("subject", [(1.60, 55.0, "female"), (2.0, 120.0, "male")])
def test_one_function_serves_every_subject(
    subject: tuple[float, float, str], knot_functions: Built, rng: np.random.Generator
) -> None:
    """Pinocchio on the other subject's model, with the function built from the default one."""
    _, topology, functions = knot_functions["human"]
    other = of(human_agent(Subject(*subject)))  # type: ignore[arg-type]
    assert other.signature() == topology.signature()
    assert np.abs(other.parameters - topology.parameters).max() > 1.0
    y = sample(functions, rng)
    expected = agent_outputs(other.model, other.frames[0], y, PERIOD)
    actual = dense(functions.value(y, np.r_[PERIOD, other.parameters])).ravel()
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize(("distance", "height", "length", "mass"), [(1.7, 1.0, 0.3, 2.0), (1.4, 0.6, 0.0, 0.0)])
def test_one_function_serves_every_tool_and_stand(
    distance: float, height: float, length: float, mass: float, knot_functions: Built, rng: np.random.Generator
) -> None:
    """Pinocchio on another tool's and base's model, the bare flange included."""
    _, topology, functions = knot_functions["sawyer"]
    other = of(sawyer_agent(place=facing(distance), base_height=height, tool_length=length, tool_mass=mass))
    assert other.signature() == topology.signature()
    y = sample(functions, rng)
    expected = agent_outputs(other.model, other.frames[0], y, PERIOD)
    actual = dense(functions.value(y, np.r_[PERIOD, other.parameters])).ravel()
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_one_function_serves_every_table(
    knot_functions: Built, newton_euler: Outputs, rng: np.random.Generator
) -> None:
    """Newton-Euler of another table, another period too."""
    _, topology, functions = knot_functions["table"]
    lifted = lifted_table(mass=9.0, depth=1.2, width=0.6, height=0.05)
    other = Topology.of(lifted.model, lifted.grasp_frames)
    assert other.signature() == topology.signature()
    y = sample(functions, rng)
    expected = newton_euler(other.model, other.frames, y, 0.9)
    actual = dense(functions.value(y, np.r_[0.9, other.parameters])).ravel()
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def signature(model: pin.Model, frames: tuple[str, ...] = ("tip",)) -> str:
    return Topology.of(model, frames).signature()


def test_signature_tells_apart_what_a_kernel_bakes_in(make_chain: Callable[..., pin.Model]) -> None:
    """Each change alters the generated function by construction: rotation, zero pattern, joints, gravity."""
    base = make_chain(0, ("RX", "RY"))
    assert signature(base) == signature(base.copy())
    rotated = base.copy()
    rotated.jointPlacements[2] = rotated.jointPlacements[2] * pin.SE3(pin.utils.rotate("z", 1e-6), np.zeros(3))
    sparse = base.copy()
    sparse.jointPlacements[2] = pin.SE3(sparse.jointPlacements[2].rotation, np.array([0.0, 0.1, 0.2]))
    falling = base.copy()
    falling.gravity.linear = np.array([0.0, 0.0, -1.62])
    models = [base, rotated, sparse, falling, make_chain(0, ("RX", "RZ")), make_chain(0, ("RX", "RY", "RZ"))]
    assert len({signature(model) for model in models}) == len(models)


def test_signature_leaves_out_what_is_a_parameter(
    make_chain: Callable[..., pin.Model], rng: np.random.Generator
) -> None:
    """Masses, centres of mass and placements are arguments: the signature is that of the structure."""
    base = make_chain(0, ("RX", "RY"))
    other = base.copy()
    for j in (1, 2):
        other.inertias[j] = pin.Inertia(3.0, rng.normal(size=3), pin.Inertia.Random().inertia)
        other.jointPlacements[j] = pin.SE3(base.jointPlacements[j].rotation, rng.normal(size=3))
    assert signature(other) == signature(base)
    y, frame = rng.normal(size=9), Topology.of(other, ("tip",))
    functions = agent_functions(Topology.of(base, ("tip",)))
    expected = agent_outputs(other, "tip", y, PERIOD)
    actual = dense(functions.value(y, np.r_[PERIOD, frame.parameters])).ravel()
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def oblique(axis: tuple[float, float, float], armature: float = 0.0) -> pin.Model:
    model = pin.Model()
    joint = pin.JointModelRevoluteUnaligned(np.array(axis) / np.linalg.norm(axis))
    parent = model.addJoint(0, joint, pin.SE3.Identity(), "oblique")
    model.appendBodyToJoint(parent, pin.Inertia(1.0, np.array([0.1, 0.2, 0.3]), np.eye(3)), pin.SE3.Identity())
    model.addFrame(pin.Frame("tip", parent, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
    model.armature = np.array([armature])
    return model


def test_signature_tells_axes_of_unaligned_joints_apart() -> None:
    """The axis of an unaligned joint is baked into the kernel."""
    assert signature(oblique((1.0, 1.0, 0.0))) != signature(oblique((0.0, 1.0, 1.0)))


def test_signature_or_parameters_carry_the_armature() -> None:
    """Pinocchio's RNEA adds armature times acceleration: two armatures must not share kernel and parameters."""
    one, two = (Topology.of(oblique((1.0, 1.0, 0.0), armature), ("tip",)) for armature in (0.0, 2.0))
    assert one.signature() != two.signature() or not np.array_equal(one.parameters, two.parameters)


def test_unaligned_joint_by_pinocchio(rng: np.random.Generator) -> None:
    model = oblique((1.0, 2.0, -1.0), 0.5)
    topology, y = Topology.of(model, ("tip",)), rng.normal(size=6)
    actual = dense(agent_functions(topology).value(y, np.r_[PERIOD, topology.parameters])).ravel()
    np.testing.assert_allclose(actual, agent_outputs(model, "tip", y, PERIOD), rtol=0, atol=1e-12)


def test_functions_are_finite_at_zero(knot_functions: Built) -> None:
    """No norm, root or arc function at 0: values and derivatives at y = 0 are numbers."""
    for _, topology, functions in knot_functions.values():
        y, p = np.zeros(functions.value.size1_in(0)), np.r_[PERIOD, topology.parameters]
        m = np.ones(functions.value.size1_out(0))
        for result in (functions.value(y, p), functions.jacobian(y, p), functions.curvature(y, p, m)):
            assert np.isfinite(dense(result)).all()


def test_object_functions_take_any_number_of_grasps(
    make_box: Callable[..., LiftedObject], newton_euler: Outputs, rng: np.random.Generator
) -> None:
    """Newton-Euler with one and with four grasps."""
    for grasps in (1, 4):
        lifted = make_box(rng.normal(size=(grasps, 3)))
        topology = Topology.of(lifted.model, lifted.grasp_frames)
        functions = object_functions(topology)
        y = sample(functions, rng)
        assert len(y) == 18 + 3 * grasps
        expected = newton_euler(lifted.model, lifted.grasp_frames, y, PERIOD)
        actual = dense(functions.value(y, np.r_[PERIOD, topology.parameters])).ravel()
        np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
