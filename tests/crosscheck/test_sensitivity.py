"""Eqs. 7-9. Oracles: Pinocchio's Jacobians of points on any link; central differences with a rounding bound."""

import numpy as np
import pytest

from liftopt.crosscheck import oracle
from liftopt.crosscheck.finite_difference import load_differences
from liftopt.crosscheck.kinematics import chain_motion
from liftopt.crosscheck.sensitivity import force_sensitivity, moment_sensitivity
from liftopt.crosscheck.systems import CheckedSystem, random_load, random_states


@pytest.mark.parametrize("link", [0, 3, 6, 9])
def test_sensitivities_on_any_link_are_minus_the_transposed_jacobian(arm: CheckedSystem, link: int) -> None:
    rng = np.random.default_rng(link)
    q, v, a = random_states(arm, 50, rng)
    load = random_load(link, rng.uniform(-0.3, 0.3, 3), 50, rng)
    motion = chain_motion(arm.chain, q, v, a)
    body = arm.body_load(load)
    _, jacobians = oracle.point_jacobians(arm.model, q, body.joint, body.point)
    by_force = -jacobians[:, :3].swapaxes(1, 2) @ arm.rotation
    by_moment = -jacobians[:, 3:].swapaxes(1, 2) @ arm.rotation
    np.testing.assert_allclose(force_sensitivity(motion, link, load.point), by_force, rtol=0, atol=1e-9)
    np.testing.assert_allclose(moment_sensitivity(arm.chain, motion, link), by_moment, rtol=0, atol=1e-9)


def test_finite_differences_agree_within_their_own_rounding(arm: CheckedSystem) -> None:
    """Central differences of eq. 1; the bound is below 1e-12, so agreement within it says much."""
    rng = np.random.default_rng(7)
    state = random_states(arm, 100, rng)
    load = random_load(8, rng.uniform(-0.3, 0.3, 3), 100, rng)
    motion = chain_motion(arm.chain, *state)
    exact = {
        "force": force_sensitivity(motion, 8, load.point),
        "moment": moment_sensitivity(arm.chain, motion, 8),
    }
    for by in ("force", "moment"):
        differences, bound = load_differences(arm.chain, motion, arm.gravity, load, by)
        assert bound.max() < 1e-12
        assert np.all(np.abs(differences - exact[by]) <= bound)


def test_sensitivities_are_those_of_the_torque(arm: CheckedSystem) -> None:
    """Pinocchio's RNEA: the torque with a load is the torque without it plus sensitivity times load."""
    rng = np.random.default_rng(8)
    state = random_states(arm, 20, rng)
    load = random_load(6, rng.uniform(-0.3, 0.3, 3), 20, rng)
    motion = chain_motion(arm.chain, *state)
    change = np.einsum("snj,sj->sn", force_sensitivity(motion, 6, load.point), load.force)
    change += np.einsum("snj,sj->sn", moment_sensitivity(arm.chain, motion, 6), load.moment)
    expected = oracle.torques(arm.model, *state, [arm.body_load(load)])
    np.testing.assert_allclose(oracle.torques(arm.model, *state) + change, expected, rtol=0, atol=1e-9)
