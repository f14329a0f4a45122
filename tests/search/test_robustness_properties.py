"""What holds for every scenario and every agent, tried on random ones.

Oracles: Newton's and Euler's laws on the momentum that Pinocchio gives for random chains; the written values themselves
for what is read back.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from liftopt.errors import InputError
from liftopt.multibody.agent import Agent, Grasp, JointLimits
from liftopt.multibody.dh import BodyInertia, DHChain, DHRow
from liftopt.multibody.trajectory import agent_trajectory, object_trajectory
from liftopt.multibody.urdf import FixedLink, JointBounds, chain_robot, load_model, urdf_text
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import Scenario, scenario_from_dict
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.storage.reader import load_result
from liftopt.storage.urdf_check import check_urdf
from liftopt.storage.writer import save

HAND = "random_grasp"
SLOW = settings(
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


def _accepted(data: dict[str, Any]) -> Scenario | None:
    try:
        return scenario_from_dict(data)
    except InputError as error:
        assert "\n" not in str(error)
        return None


@pytest.fixture(scope="module")
def pattern(solved: Callable[..., Any]) -> Solution:
    """Return a solution whose figures the random ones borrow."""
    solution: Solution = solved("table5", "solver.intervals=10", "solver.starts=1").solution
    return solution


def _moved(pattern: Solution, scenario: Scenario, seed: int) -> Solution:
    """Return a motion of a scenario that is random and solves nothing."""
    rng, knots = np.random.default_rng(seed), len(pattern.time)
    agents, lifted = agents_of(scenario), object_of(scenario)
    forces = rng.normal(size=(knots, len(lifted.grasp_frames), 3)) * 50.0
    own = np.split(forces, np.cumsum([len(agent.grasps) for agent in agents])[:-1], axis=1)
    moves = [rng.normal(size=(3, knots, len(agent.moving_joints))) for agent in agents]
    texts = {agent.name: agent.urdf for agent in agents} | {lifted.name: lifted.urdf}
    return dataclasses.replace(
        pattern,
        scenario=scenario,
        time=np.linspace(0.0, scenario.duration, knots),
        agents=tuple(agent_trajectory(a, *m, f) for a, m, f in zip(agents, moves, own, strict=True)),
        object=object_trajectory(lifted, *rng.normal(size=(3, knots, 6)), forces.reshape(knots, -1)),
        urdfs=texts,
    )


@settings(SLOW, max_examples=8)
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_any_motion_of_any_scenario_is_read_back_as_it_was_written(
    data: st.DataObject, seed: int, scenario_tables: st.SearchStrategy[Any], pattern: Solution, tmp_path: Path
) -> None:
    scenario = data.draw(scenario_tables.map(_accepted).filter(lambda found: found is not None))
    try:
        written = _moved(pattern, scenario, seed)
    except InputError as error:  # a robot or an object that cannot be built
        assert error.key.split(".")[0] in ("robot", "object", "task", "human")
        return
    save(written, tmp_path / "result")
    read = load_result(tmp_path / "result")
    assert read.scenario == scenario
    assert read.urdfs == written.urdfs
    for one, other in ((read.object, written.object), *zip(read.agents, written.agents, strict=True)):
        for field in dataclasses.fields(one):
            if isinstance(value := getattr(other, field.name), np.ndarray):
                np.testing.assert_array_equal(getattr(one, field.name), value, err_msg=field.name)


def test_the_knots_of_a_finer_grid_are_the_knots(pattern: Solution) -> None:
    fine = resample(pattern, 4)
    np.testing.assert_array_equal(fine.time[::4], pattern.time)
    for agent, was in zip(fine.agents, pattern.agents, strict=True):
        np.testing.assert_allclose(agent.q[::4], was.q, atol=1e-12)
        np.testing.assert_allclose(agent.tau[::4], was.tau, atol=1e-7)


LENGTH, ANGLE = st.floats(-0.5, 0.5), st.floats(-np.pi, np.pi)


@st.composite
def chains(draw: st.DrawFn) -> Agent:
    """Return an agent of one to seven joints, each of either kind, with a body each, on a base anywhere."""
    kinds = draw(st.lists(st.sampled_from(("revolute", "prismatic")), min_size=1, max_size=7))
    rows, bodies = [], []
    for i, kind in enumerate(kinds):
        rows.append(DHRow(f"Q{i + 1}", kind, draw(ANGLE), draw(LENGTH), draw(LENGTH), draw(ANGLE)))
        com, sides = (
            np.array([draw(LENGTH) for _ in range(3)]),
            np.array([draw(st.floats(0.01, 0.3)) for _ in range(3)]),
        )
        mass = draw(st.floats(0.01, 30.0))
        bodies.append(BodyInertia(mass, com, mass / 12.0 * np.diag(np.sum(sides**2) - sides**2)))
    base = np.eye(4)
    base[:3, :3] = pin.rpy.rpyToMatrix(draw(ANGLE), draw(ANGLE), draw(ANGLE))
    base[:3, 3] = [draw(LENGTH) for _ in range(3)]
    bounds = {row.name: JointBounds(-3.0, 3.0, 100.0, 10.0) for row in rows}
    root = FixedLink("base", "world", base)
    chain = DHChain("random", tuple(rows), tuple(bodies))
    text = urdf_text(chain_robot(chain, root=root, bounds=bounds, shapes={}, grasp=HAND))
    ones = np.ones(len(rows))
    limits = JointLimits(-3.0 * ones, 3.0 * ones, 10.0 * ones, -100.0 * ones, 100.0 * ones)
    return Agent("random", "robot", text, load_model(text), (), (Grasp("random", HAND),), (HAND,), limits, 0.0 * ones)


@settings(SLOW, max_examples=60)
@given(agent=chains(), seed=st.integers(0, 2**32 - 1))
def test_the_ground_bears_any_agent_by_newtons_and_eulers_laws(agent: Agent, seed: int) -> None:
    """What the ground and the object do to it, and gravity, is the rate of its momentum about its centre of mass."""
    rng, model = np.random.default_rng(seed), agent.model
    q, v, a, force = (rng.normal(size=(1, n)) for n in (model.nv, model.nv, model.nv, 3))
    found = agent_trajectory(agent, q, v, a, 40.0 * force)
    data = model.createData()
    pin.computeCentroidalMomentumTimeVariation(model, data, q[0], v[0], a[0])
    weight = sum(body.mass for body in list(model.inertias)[1:]) * np.array([0.0, 0.0, -9.81])
    com, base = data.com[0], model.jointPlacements[1].translation
    by_ground, by_object = found.ground_force[0], -found.load[0]
    scale = 1.0 + np.abs(np.concatenate([data.dhg.vector, found.ground_moment[0], by_ground])).max()
    np.testing.assert_allclose((by_ground + by_object + weight) / scale, data.dhg.linear / scale, atol=1e-12)
    moment = found.ground_moment[0] + np.cross(base - com, by_ground)
    moment += np.cross(found.p_world_hold[0] - com, by_object)
    np.testing.assert_allclose(moment / scale, data.dhg.angular / scale, atol=1e-12)
    check_urdf(agent.urdf)  # raises where it is none of liftopt's


@settings(SLOW, max_examples=60)
@given(agent=chains(), seed=st.integers(0, 2**32 - 1))
def test_torques_of_any_agent_do_the_work_that_changes_its_energy(agent: Agent, seed: int) -> None:
    """Power of the torques is that of the grasp force plus the rate of kinetic and potential energy."""
    rng, model = np.random.default_rng(seed), agent.model
    q, v, a, force = (rng.normal(size=(1, n)) for n in (model.nv, model.nv, model.nv, 3))
    found, data = agent_trajectory(agent, q, v, a, force), model.createData()
    grasp = model.getFrameId(agent.hands[0])
    pin.forwardKinematics(model, data, q[0], v[0])
    velocity = pin.getFrameVelocity(model, data, grasp, pin.LOCAL_WORLD_ALIGNED).linear
    # The rate of kinetic energy is v . (M a + C v), that of the potential energy v . g.
    rate = v[0] @ pin.rnea(model, data, q[0], v[0], a[0])
    step = 1e-6
    energy = [
        pin.computeMechanicalEnergy(model, model.createData(), q[0] + h * v[0] + h * h / 2 * a[0], v[0] + h * a[0])
        for h in (-step, step)
    ]
    scale = 1.0 + abs(rate) + abs(max(energy, key=abs))
    assert found.tau[0] @ v[0] == pytest.approx(rate + force[0] @ velocity, abs=1e-9 * scale)
    assert rate == pytest.approx((energy[1] - energy[0]) / (2 * step), abs=1e-6 * scale)
