"""Eq. 6 and the map to a free body. Oracles: Pinocchio's free-flyer, the chain's own rates, closed form at rest."""

import numpy as np
import pinocchio as pin

from liftopt.crosscheck.floating_base import body_motion, body_wrench, joint_forces
from liftopt.crosscheck.kinematics import at_rest, chain_motion
from liftopt.crosscheck.lagrangian import ExternalLoad, torque_terms
from liftopt.crosscheck.systems import CheckedSystem, random_states
from liftopt.crosscheck.table_checks import body_in_last_link, free_flyer_positions, table_checks


def test_table_agrees_with_the_free_flyer(table: CheckedSystem) -> None:
    """Pinocchio: joint forces by the map between coordinates, the wrench itself, eq. 6 in balance, sensitivities."""
    rows = table_checks(table, 200, np.random.default_rng(0))
    assert [row for row in rows if not row.passed] == []


def test_twist_is_the_jacobian_times_the_rates(table: CheckedSystem) -> None:
    """Self-consistency of A, B and S, which come from different recursions."""
    q, v, a = random_states(table, 50, np.random.default_rng(1))
    body = body_motion(chain_motion(table.chain, q, v, a), table.t_world_root, body_in_last_link(table))
    np.testing.assert_allclose(np.einsum("sij,sj->si", body.jacobian, v), body.twist, rtol=0, atol=1e-13)


def test_twist_and_its_rate_carry_the_free_flyer_along(table: CheckedSystem) -> None:
    """Pinocchio's integration on SE(3) to second order meets the chain's next placement up to O(h^3)."""
    q, v, a = random_states(table, 20, np.random.default_rng(2))
    turned, errors = body_in_last_link(table), []
    for h in (1e-2, 5e-3):
        here = body_motion(chain_motion(table.chain, q, v, a), table.t_world_root, turned)
        there = body_motion(at_rest(table.chain, q + h * v + 0.5 * h**2 * a), table.t_world_root, turned)
        start, end = free_flyer_positions(here), free_flyer_positions(there)
        step = h * here.twist + 0.5 * h**2 * here.twist_rate
        errors.append(
            max(
                np.linalg.norm(pin.difference(table.model, pin.integrate(table.model, start[s], step[s]), end[s]))
                for s in range(20)
            )
        )
    assert errors[1] < errors[0] / 6.0  # a wrong rate would make it O(h^2), a ratio of 4


def test_wrench_and_joint_forces_are_inverse_maps(table: CheckedSystem) -> None:
    q, _, _ = random_states(table, 20, np.random.default_rng(3))
    body = body_motion(at_rest(table.chain, q), table.t_world_root, body_in_last_link(table))
    wrench = np.random.default_rng(4).normal(size=(20, 6))
    np.testing.assert_allclose(body_wrench(body, joint_forces(body, wrench)), wrench, rtol=0, atol=1e-13)


def test_half_the_weight_at_each_end_balances_a_level_table(table: CheckedSystem) -> None:
    """Closed form: two equal upward forces symmetric about the centre of mass make eq. 6 hold at rest."""
    q = np.zeros((1, 6))
    body, last = table.chain.inertias[-1], 5
    half = -0.5 * body.mass * table.gravity[None]
    arm = np.array([0.2, 0.1, 0.0])
    loads = [ExternalLoad(last, body.com + sign * arm, half, np.zeros((1, 3))) for sign in (1.0, -1.0)]
    tau = torque_terms(table.chain, at_rest(table.chain, q), table.gravity, loads).tau
    np.testing.assert_allclose(tau, 0.0, atol=1e-13)
