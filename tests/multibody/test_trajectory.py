"""Trajectories: Pinocchio with external forces, whole-body Newton-Euler and finite differences are the oracles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest

from liftopt.crosscheck.tree_dynamics import read_tree, tree_forces
from liftopt.multibody.agent import Agent, Grasp, JointLimits, LiftedObject
from liftopt.multibody.person.human import Subject, human_agent
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.placement import Placement, facing
from liftopt.multibody.robots.sawyer import sawyer_agent
from liftopt.multibody.table import lifted_table
from liftopt.multibody.trajectory import agent_trajectory, free_flyer_state, object_trajectory

Motion = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]


def smooth(size: int, seed: int, amplitude: float = 0.4) -> Motion:
    """Return a motion of ``size`` coordinates with its exact first and second derivatives by time."""
    rng = np.random.default_rng(seed)
    mean, rate, shift = rng.normal(size=size) * amplitude, rng.uniform(0.5, 2.0, size), rng.uniform(0.0, 6.0, size)

    def motion(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        at = np.multiply.outer(t, rate) + shift
        return mean + amplitude * np.sin(at), amplitude * rate * np.cos(at), -amplitude * rate**2 * np.sin(at)

    return motion


def swinging_arm() -> Agent:
    """Return an agent none of whose joints is pinned, on a turned and moved base."""
    model = pin.Model()
    base = pin.SE3(pin.exp3(np.array([0.3, -0.8, 0.5])), np.array([0.7, -0.2, 0.4]))
    parent = 0
    for i, joint in enumerate((pin.JointModelRX(), pin.JointModelRY(), pin.JointModelRZ())):
        placement = base if i == 0 else pin.SE3(pin.exp3(np.array([0.1, 0.4, -0.3]) * i), np.array([0.1, 0.0, 0.3]))
        parent = model.addJoint(parent, joint, placement, f"joint{i}")
        body = pin.Inertia(2.0, np.array([0.05, 0.1, 0.1]), np.diag([0.03, 0.04, 0.02]))
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    model.addFrame(pin.Frame("tip", parent, 0, pin.SE3(np.eye(3), np.array([0.0, 0.1, 0.3])), pin.FrameType.OP_FRAME))
    ones = np.ones(3)
    limits = JointLimits(-ones, ones, ones, -ones, ones)
    return Agent("swing", "robot", "", model, (), (Grasp("swing", "tip"),), ("tip",), limits, np.zeros(3))


AGENTS = {
    "human": lambda: human_agent(Subject(1.75, 75.0, "male")),
    "robot": lambda: sawyer_agent(place=facing(1.9), base_height=0.915, tool_length=0.15, tool_mass=0.4),
    "swing": swinging_arm,
}


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(11)


@pytest.fixture(scope="module", params=list(AGENTS))
def agent(request: pytest.FixtureRequest) -> Agent:
    return AGENTS[request.param]()


def full(agent: Agent, moving: np.ndarray) -> np.ndarray:
    """Return the coordinates of all joints, the pinned ones at zero."""
    values = np.zeros((len(moving), agent.model.nv))
    names = list(agent.model.names)[1:]
    values[:, [names.index(name) for name in agent.moving_joints]] = moving
    return values


def test_torques_are_rneas_with_the_reaction_as_external_force(agent: Agent, rng: np.random.Generator) -> None:
    """Pinocchio's RNEA with an external force on the joint that carries the grasp, in double precision."""
    n, model, data = len(agent.moving_joints), agent.model, agent.model.createData()
    moving, force = smooth(n, 1)(np.linspace(0.0, 2.0, 5)), 20.0 * rng.normal(size=(5, 3))
    found = agent_trajectory(agent, *moving, force)
    q, v, a = (full(agent, part) for part in moving)
    frame = model.frames[model.getFrameId(agent.hands[0])]
    for k in range(5):
        pin.forwardKinematics(model, data, q[k])
        placement = data.oMi[frame.parentJoint] * frame.placement
        loads = pin.StdVec_Force()
        loads.extend([pin.Force.Zero() for _ in range(model.njoints)])
        aligned = pin.SE3(np.eye(3), placement.translation)
        reaction = aligned.act(pin.Force(-force[k], np.zeros(3)))
        loads[frame.parentJoint] = data.oMi[frame.parentJoint].actInv(reaction)
        expected = pin.rnea(model, data, q[k], v[k], a[k], loads)
        np.testing.assert_allclose(found.tau[k], expected, rtol=0, atol=1e-12 * max(1.0, np.abs(expected).max()))
        np.testing.assert_allclose(found.p_world_hold[k], placement.translation, atol=1e-14)
    assert found.joint_names == tuple(list(model.names)[1:])
    np.testing.assert_array_equal(found.moving, [name not in agent.locked_joints for name in found.joint_names])
    for actual, expected in zip((found.q, found.v, found.a), (q, v, a), strict=True):
        np.testing.assert_array_equal(actual, expected)


def test_ground_reaction_is_whole_body_newton_euler(agent: Agent, rng: np.random.Generator) -> None:
    """Momentum of all bodies, its rate by finite differences, and the reaction of the grasp, about the base point."""
    n, model, data = len(agent.moving_joints), agent.model, agent.model.createData()
    times, motion, force, h = np.linspace(0.0, 2.0, 4), smooth(n, 2), 20.0 * rng.normal(size=(4, 3)), 1e-4
    found = agent_trajectory(agent, *motion(times), force)
    base = model.jointPlacements[1].translation

    def momentum(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return linear and angular momentum about the base, and the weight's moment about it."""
        q, v, _ = (full(agent, part[None])[0] for part in motion(np.array(t)))
        pin.forwardKinematics(model, data, q, v)
        linear, angular, moment = np.zeros((3, 3))
        for j in range(1, model.njoints):
            body = data.oMi[j].act(model.inertias[j] * data.v[j])
            linear, angular = linear + body.linear, angular + body.angular - np.cross(base, body.linear)
            weight = model.inertias[j].mass * np.array([0.0, 0.0, -9.81])
            moment = moment + np.cross(data.oMi[j].act(model.inertias[j].lever) - base, weight)
        return linear, angular, moment

    mass = sum(model.inertias[j].mass for j in range(1, model.njoints))
    for k, t in enumerate(times):
        ahead, behind, (_, _, gravity) = momentum(t + h), momentum(t - h), momentum(t)
        expected = (ahead[0] - behind[0]) / (2 * h) + [0.0, 0.0, 9.81 * mass] + force[k]
        np.testing.assert_allclose(found.ground_force[k], expected, atol=1e-5)
        moment = (ahead[1] - behind[1]) / (2 * h) - gravity + np.cross(found.p_world_hold[k] - base, force[k])
        np.testing.assert_allclose(found.ground_moment[k], moment, atol=1e-5)


def test_ground_carries_the_weight_of_a_person_who_stands() -> None:
    """Closed form: at rest the ground bears body weight less what the grasp carries."""
    agent = AGENTS["human"]()
    q, zero = np.tile(agent.posture, (2, 1)), np.zeros((2, 10))
    found = agent_trajectory(agent, q, zero, zero, np.array([[0.0, 0.0, 0.0], [3.0, -2.0, 10.0]]))
    np.testing.assert_allclose(found.ground_force, [[0.0, 0.0, 735.75], [3.0, -2.0, 745.75]], atol=1e-9)


@pytest.fixture(scope="module")
def lifted() -> LiftedObject:
    return lifted_table(mass=2.0, depth=0.45, width=0.31, height=0.02)


def test_object_rates_are_those_of_its_pose(lifted: LiftedObject) -> None:
    """Finite differences of position and of the quaternion, world axes."""
    motion, times, h = smooth(6, 3), np.linspace(0.0, 2.0, 7), 1e-5
    forces = np.zeros((7, 6))
    found, ahead, behind = (object_trajectory(lifted, *motion(times + step), forces) for step in (0.0, h, -h))

    def attitude(quaternion: np.ndarray) -> np.ndarray:
        return np.asarray(pin.Quaternion(quaternion).toRotationMatrix())

    for k in range(7):
        turn = pin.log3(attitude(ahead.quaternion[k]) @ attitude(behind.quaternion[k]).T) / (2 * h)
        np.testing.assert_allclose(found.velocity[k, 3:], turn, atol=1e-8)
        np.testing.assert_allclose(found.velocity[k, :3], (ahead.pose[k, :3] - behind.pose[k, :3]) / (2 * h), atol=1e-8)
    numeric = (ahead.velocity - behind.velocity) / (2 * h)
    np.testing.assert_allclose(found.acceleration, numeric, atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(found.quaternion, axis=1), 1.0, atol=1e-14)


def test_object_attitude_is_rx_ry_rz(lifted: LiftedObject, rng: np.random.Generator) -> None:
    """Closed form: Table 4's order, and grasp points that turn with it."""
    x = rng.normal(size=(3, 6))
    found = object_trajectory(lifted, x, np.zeros((3, 6)), np.zeros((3, 6)), np.zeros((3, 6)))
    for k in range(3):
        turn = [pin.exp3(axis * angle) for axis, angle in zip(np.eye(3), x[k, 3:], strict=True)]
        rotation = turn[0] @ turn[1] @ turn[2]
        np.testing.assert_allclose(pin.Quaternion(found.quaternion[k]).toRotationMatrix(), rotation, atol=1e-14)
        for i, lever in enumerate(([-0.225, 0.0, -0.01], [0.225, 0.0, -0.01])):
            np.testing.assert_allclose(found.grasp_position[k, i], x[k, :3] + rotation @ lever, atol=1e-14)


def test_wrench_is_newton_euler_less_the_grasps(lifted: LiftedObject, rng: np.random.Generator) -> None:
    """Closed form: m (a - g) - sum f along world axes, I alpha + w x I w - sum r x f about body axes."""
    motion, times, forces = smooth(6, 4), np.linspace(0.0, 2.0, 5), 10.0 * rng.normal(size=(5, 6))
    found, body = object_trajectory(lifted, *motion(times), forces), lifted.model.inertias[1]
    for k in range(5):
        rotation = pin.Quaternion(found.quaternion[k]).toRotationMatrix()
        omega, alpha = rotation.T @ found.velocity[k, 3:], rotation.T @ found.acceleration[k, 3:]
        force = body.mass * (found.acceleration[k, :3] + [0.0, 0.0, 9.81]) - forces[k, :3] - forces[k, 3:]
        moment = body.inertia @ alpha + np.cross(omega, body.inertia @ omega)
        for i in range(2):
            lever = found.grasp_position[k, i] - found.pose[k, :3]
            moment -= rotation.T @ np.cross(lever, forces[k, 3 * i : 3 * i + 3])
        np.testing.assert_allclose(found.wrench[k], np.concatenate([force, moment]), atol=1e-11)


def test_free_flyer_state_is_the_derivative_on_pinocchios_manifold(lifted: LiftedObject) -> None:
    """Pinocchio's difference of two configurations over the time between them, and of two velocities."""
    motion, h, model = smooth(6, 5), 1e-5, lifted.model
    for t in (0.0, 0.7, 1.9):
        (q, v, a), (ahead, fast, _), (behind, slow, _) = (
            free_flyer_state(*motion(np.array(at))) for at in (t, t + h, t - h)
        )
        np.testing.assert_allclose(
            v, (pin.difference(model, q, ahead) - pin.difference(model, q, behind)) / (2 * h), atol=1e-8
        )
        np.testing.assert_allclose(a, (fast - slow) / (2 * h), atol=1e-8)
        np.testing.assert_allclose(np.linalg.norm(q[3:]), 1.0, atol=1e-14)


@pytest.mark.parametrize("hands", [("right", "left"), ("left",)])
def test_who_stands_has_feet_in_the_ground_reaction_and_a_centre_of_pressure(hands, rng):
    """Oracle: the recursion over the tree, on numbers read out of the URDF without Pinocchio."""
    person = whole_human_agent(Subject(1.6, 58.0, "female"), place=Placement(0.7, -0.3, 2.5), hands=hands)
    q, v, a = (factor * rng.uniform(-0.5, 0.5, (30, 20)) for factor in (1.0, 2.0, 5.0))
    force, moment = rng.uniform(-40.0, 40.0, (2, 30, len(hands), 3))
    found = agent_trajectory(person, q, v, a, force, moment)
    loads = {grasp.frame: (-force[:, g], -moment[:, g]) for g, grasp in enumerate(person.grasps)}
    expected = tree_forces(read_tree(person.urdf, found.joint_names), q, v, a, loads)
    base = np.array([0.7, -0.3, 0.0])
    np.testing.assert_allclose(found.tau, expected.tau, rtol=1e-10, atol=1e-9)
    np.testing.assert_allclose(found.ground_force, expected.force, rtol=1e-10, atol=1e-9)
    about_base = expected.moment - np.cross(base, expected.force)
    np.testing.assert_allclose(found.ground_moment, about_base, rtol=1e-10, atol=1e-9)
    pressure = found.centre_of_pressure
    assert pressure is not None
    bears = found.ground_force[:, 2] > 0.0
    assert bears.any() and np.isnan(pressure[~bears]).all()
    there = expected.moment - np.cross(pressure, expected.force)
    np.testing.assert_allclose(there[bears, :2], 0.0, atol=1e-9)
    np.testing.assert_array_equal(pressure[bears, 2], 0.0)


def test_who_stands_still_presses_below_the_centre_of_mass():
    """Closed form: without loads and motion, the centre of mass of the whole body, feet included."""
    person = whole_human_agent(Subject(1.75, 75.0, "male"))
    still = agent_trajectory(person, person.posture[None], *np.zeros((2, 1, 20)), np.zeros((1, 2, 3)))
    np.testing.assert_allclose(still.ground_force, [[0.0, 0.0, 75.0 * 9.81]], atol=1e-9)
    moving = pin.centerOfMass(person.model, person.model.createData(), person.posture)
    resting = person.model.inertias[0]
    whole = ((75.0 - resting.mass) * moving + resting.mass * resting.lever) / 75.0
    assert still.centre_of_pressure is not None
    np.testing.assert_allclose(still.centre_of_pressure[0, :2], whole[:2], atol=1e-12)
    arm = human_agent(Subject(1.75, 75.0, "male"))
    assert agent_trajectory(arm, arm.posture[None], *np.zeros((2, 1, 10)), np.zeros((1, 3))).centre_of_pressure is None
