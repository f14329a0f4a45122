"""What passes a disc, as outputs of a kernel: oracles are the load by a cut through inverse dynamics, differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.codegen.kernels import kernel_key
from liftopt.collocation.disc_dynamics import DiscTopology, disc_agent_functions
from liftopt.collocation.dynamics import KnotFunctions
from liftopt.collocation.kkt_agent import agent_knots
from liftopt.collocation.kkt_disc import disc_agent_knots
from liftopt.collocation.outputs import outputs_of
from liftopt.collocation.problem import kernel_requests
from liftopt.collocation.standing_dynamics import StandingTopology, standing_agent_functions
from liftopt.ergonomics.spine import SpineLoad, load_through
from liftopt.multibody.agent import Agent
from liftopt.multibody.person.lumbosacral import lumbosacral
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.placement import Placement
from liftopt.multibody.trajectory import agent_trajectory
from liftopt.scenario.build import agent_of, object_of
from liftopt.scenario.model import load_scenario

PERIOD = 1.3
PLACE = Placement(0.4, -0.3, 0.8)
WOMAN = Subject(1.63, 62.0, "female")


@pytest.fixture(scope="module")
def person() -> Agent:
    agent = whole_human_agent(WOMAN, place=PLACE, compression=3000.0)
    turns = (pin.exp3(np.array(turn)) for turn in ([0.4, -1.1, 0.7], [-0.2, 0.5, 1.9]))
    held = tuple(replace(g, moments=True, R_hand_object=t) for g, t in zip(agent.grasps, turns, strict=True))
    return replace(agent, grasps=held)


@pytest.fixture(scope="module")
def topology(person: Agent) -> DiscTopology:
    return _topology(person)


@pytest.fixture(scope="module")
def functions(topology: DiscTopology) -> KnotFunctions:
    return disc_agent_functions(topology)


@pytest.fixture
def y(rng: np.random.Generator) -> np.ndarray:
    """Knot variables of any motion, the hands' forces and moments like those of a lift, an object turned anyhow."""
    found = rng.normal(size=3 * 20 + 2 * 6 + 3)
    found[60:72] *= 40.0
    return found


def _topology(agent: Agent) -> DiscTopology:
    assert agent.disc is not None and agent.lean is not None
    grips = [grasp.R_hand_object for grasp in agent.grasps]
    base, trunk = agent.T_world_base, agent.lean.joint
    return DiscTopology.pressed(agent.reduced(), agent.hands, base, *grips, disc=agent.disc, trunk=trunk)


def _load(agent: Agent, y: np.ndarray) -> SpineLoad:
    """Return the load on the disc as the assessment tells it, of the subject herself."""
    q, v, a = (y[None, 20 * i : 20 * (i + 1)] / PERIOD**i for i in range(3))
    wrench = y[60:72].reshape(2, 6)
    force, moment = wrench[None, :, :3], wrench[None, :, 3:]
    motion = agent_trajectory(agent, q, v, a, force, moment)
    return load_through(agent, motion, PLACE.T_world_base[:3, :3], lumbosacral(WOMAN))


def _passed(agent: Agent, y: np.ndarray) -> np.ndarray:
    load = _load(agent, y)
    return np.concatenate([load.axial, load.lateral, load.extension])


def test_values_are_the_load_that_the_assessment_tells(
    person: Agent, topology: DiscTopology, functions: KnotFunctions, y: np.ndarray
) -> None:
    for scale in (1.0, -0.3, 0.01):
        c = functions.value(scale * y, np.r_[PERIOD, topology.parameters]).full().ravel()
        passed, expected = c[outputs_of(person).disc], _passed(person, scale * y)
        np.testing.assert_allclose(passed, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
        assert person.disc is not None
        pressing = (person.disc.factors @ passed).max()
        assert pressing == pytest.approx(_load(person, scale * y).compression[0], rel=1e-9)


def test_slopes_are_differences_of_that_load(
    person: Agent,
    topology: DiscTopology,
    functions: KnotFunctions,
    y: np.ndarray,
    differences: Callable[..., np.ndarray],
) -> None:
    numeric = differences(lambda at: _passed(person, at), y)
    jacobian = functions.jacobian(y, np.r_[PERIOD, topology.parameters]).full()
    actual = jacobian[outputs_of(person).disc]
    np.testing.assert_allclose(actual, numeric, rtol=0, atol=1e-9 * np.abs(numeric).max())


def test_all_else_is_as_without_a_disc(
    person: Agent, topology: DiscTopology, functions: KnotFunctions, y: np.ndarray
) -> None:
    """Pinocchio in double precision on the tree that is not cut."""
    c, jacobian = agent_knots(replace(person, disc=None), y[None], PERIOD)
    p, first = np.r_[PERIOD, topology.parameters], outputs_of(person).disc.start
    np.testing.assert_allclose(functions.value(y, p).full()[:first, 0], c[0], atol=1e-11 * np.abs(c).max())
    actual = functions.jacobian(y, p).full()[:first]
    np.testing.assert_allclose(actual, jacobian[0], rtol=0, atol=1e-11 * np.abs(jacobian).max())


def test_gradient_and_curvature_are_derivatives_of_the_jacobian(
    topology: DiscTopology, functions: KnotFunctions, y: np.ndarray, rng: np.random.Generator,
    check_knot_derivatives: Callable[..., None],
) -> None:  # fmt: skip
    """With weights of every output."""
    m = rng.normal(size=functions.value.size1_out(0))
    check_knot_derivatives(functions, y, np.r_[PERIOD, topology.parameters], m)


def test_optimality_is_judged_by_pinocchio_on_the_tree_that_is_cut(
    person: Agent, topology: DiscTopology, functions: KnotFunctions, y: np.ndarray
) -> None:
    c, jacobian = disc_agent_knots(person, np.stack([y, -0.5 * y]), PERIOD)
    p = np.r_[PERIOD, topology.parameters]
    for k, at in enumerate((y, -0.5 * y)):
        np.testing.assert_allclose(c[k], functions.value(at, p).full().ravel(), atol=1e-11 * np.abs(c).max())
        whole = functions.jacobian(at, p).full()
        np.testing.assert_allclose(jacobian[k], whole, rtol=0, atol=1e-11 * np.abs(whole).max())


def test_one_kernel_serves_everybody_everywhere_and_every_limit(rng: np.random.Generator) -> None:
    signatures = set()
    for sex, stature, yaw in (("male", 1.95, 0.0), ("female", 1.5, np.pi / 2), ("male", 1.6, 2.2)):
        place = Placement(*rng.uniform(-2.0, 2.0, 2), yaw)
        subject = Subject(stature, rng.uniform(45.0, 120.0), sex)
        signatures.add(_topology(whole_human_agent(subject, place=place, compression=yaw + 2500.0)).signature())
    assert len(signatures) == 1


def test_who_has_no_limit_keeps_the_kernel_without() -> None:
    scenario = load_scenario("pallet")
    agent, lifted = agent_of(scenario, "human"), object_of(scenario)
    (builder, own), *_ = kernel_requests((agent,), lifted)
    assert agent.disc is None and agent.lean is not None
    grips = [grasp.R_hand_measured for grasp in agent.grasps]
    plain = StandingTopology.standing(
        agent.reduced(), agent.hands, agent.T_world_base, *grips, trunk=agent.lean.joint
    )  # fmt: skip
    assert kernel_key(builder, own) == kernel_key(standing_agent_functions, plain)
    limited = agent_of(scenario.replace({"limits.spine_compression": 3400.0}), "human")
    assert kernel_key(*kernel_requests((limited,), lifted)[0]) != kernel_key(builder, own)
