"""Eqs. 1-5. Oracles: Pinocchio's RNEA on random chains and on Tables 2 and 3; closed forms for signs and inertia."""

from collections.abc import Callable
from math import pi

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from liftopt.crosscheck import oracle
from liftopt.crosscheck.kinematics import chain_motion
from liftopt.crosscheck.lagrangian import ExternalLoad, inverse_dynamics, pseudo_inertia, torque_terms
from liftopt.crosscheck.systems import CheckedSystem, random_load, random_states
from liftopt.multibody.dh import BodyInertia, DHChain, DHRow

DOWN = np.array([0.0, -9.81, 0.0])
LENGTH = st.floats(-0.6, 0.6)
ANGLE = st.one_of(st.sampled_from([0.0, pi / 2, -pi / 2, pi]), st.floats(-3.0, 3.0))
ROW = st.builds(DHRow, st.just("j"), st.sampled_from(["revolute", "prismatic"]), ANGLE, LENGTH, LENGTH, ANGLE)


@settings(max_examples=60, deadline=None)
@given(rows=st.lists(ROW, min_size=1, max_size=9), seed=st.integers(0, 2**32 - 1))
def test_any_chain_with_loads_on_every_link_matches_rnea(
    random_arm: Callable[[tuple[DHRow, ...], int], CheckedSystem], rows: list[DHRow], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    named = tuple(DHRow(f"j{i}", r.kind, r.theta, r.d, r.a, r.alpha) for i, r in enumerate(rows))
    system = random_arm(named, seed)
    state = random_states(system, 3, rng)
    loads = [random_load(link, rng.uniform(-0.3, 0.3, (3, 3)), 3, rng) for link in range(len(rows))]
    tau = inverse_dynamics(system.chain, *state, system.gravity, loads)
    expected = oracle.torques(system.model, *state, [system.body_load(load) for load in loads])
    np.testing.assert_allclose(tau, expected, rtol=0, atol=1e-9)


def test_terms_match_pinocchio_one_by_one(arm: CheckedSystem) -> None:
    """Each term of eq. 1 by switching the others off in RNEA: gravity, motion, force, moment."""
    rng = np.random.default_rng(0)
    q, v, a = random_states(arm, 50, rng)
    load = random_load(5, rng.uniform(-0.3, 0.3, 3), 50, rng)
    terms = torque_terms(arm.chain, chain_motion(arm.chain, q, v, a), arm.gravity, [load])
    still, body = np.zeros_like(q), arm.body_load(load)
    weight = oracle.torques(arm.model, q, still, still)
    force = oracle.BodyLoad(body.joint, body.point, body.force, np.zeros_like(body.moment))
    moment = oracle.BodyLoad(body.joint, body.point, np.zeros_like(body.force), body.moment)
    for ours, theirs in (
        (terms.gravity, weight),
        (terms.inertia, oracle.torques(arm.model, q, v, a) - weight),
        (terms.force, oracle.torques(arm.model, q, still, still, [force]) - weight),
        (terms.moment, oracle.torques(arm.model, q, still, still, [moment]) - weight),
    ):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-9)


def test_many_states_at_once_are_what_each_alone_is(arm: CheckedSystem) -> None:
    """Self-consistency: batching does not mix states."""
    state = random_states(arm, 4, np.random.default_rng(5))
    together = inverse_dynamics(arm.chain, *state, arm.gravity)
    for s in range(4):
        alone = inverse_dynamics(arm.chain, *(x[s : s + 1] for x in state), arm.gravity)
        np.testing.assert_allclose(alone[0], together[s], rtol=0, atol=1e-12)


def test_signs_on_a_horizontal_pendulum() -> None:
    """Closed form: a link of length L along x holds m g L; a force up or a moment about +z at its tip relieves it."""
    mass, length, lift, couple = 2.0, 0.5, 3.0, 0.7
    chain = DHChain(
        "rod", (DHRow("Q1", "revolute", 0.0, 0.0, length, 0.0),), (BodyInertia(mass, np.zeros(3), np.zeros((3, 3))),)
    )
    rest = np.zeros((1, 1))
    load = ExternalLoad(0, np.zeros(3), np.array([[0.0, lift, 0.0]]), np.array([[0.0, 0.0, couple]]))
    tau = inverse_dynamics(chain, rest, rest, rest, DOWN, [load])
    np.testing.assert_allclose(tau, [[mass * 9.81 * length - lift * length - couple]], rtol=1e-14)


def test_prismatic_joint_ignores_moments() -> None:
    """Closed form: z_0 = 0 in eq. 1; a slide along vertical holds the weight whatever the moment."""
    chain = DHChain(
        "slide", (DHRow("GT1", "prismatic", 0.0, 0.0, 0.0, 0.0),), (BodyInertia(2.0, np.ones(3), np.eye(3)),)
    )
    rest = np.zeros((1, 1))
    load = ExternalLoad(0, np.ones(3), np.zeros((1, 3)), np.ones((1, 3)))
    tau = inverse_dynamics(chain, rest, rest, rest, np.array([0.0, 0.0, -9.81]), [load])
    np.testing.assert_allclose(tau, [[2.0 * 9.81]], rtol=1e-14)


def test_pseudo_inertia_is_the_sum_over_point_masses() -> None:
    """Closed form: for point masses the integral of r r^T dm is a sum."""
    rng = np.random.default_rng(0)
    masses, points = rng.uniform(0.1, 1.0, 8), rng.normal(size=(8, 3))
    mass, com = masses.sum(), masses @ points / masses.sum()
    arms = points - com
    inertia = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, arms, strict=True))
    homogeneous = np.column_stack([points, np.ones(8)])
    expected = np.einsum("p,pi,pj->ij", masses, homogeneous, homogeneous)
    np.testing.assert_allclose(pseudo_inertia(BodyInertia(mass, com, inertia)), expected, rtol=0, atol=1e-13)
