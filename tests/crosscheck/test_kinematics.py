"""Oracles: ``dh.row_transform`` (built from elementary transforms), closed forms, Pinocchio's frame kinematics."""

import numpy as np
import pinocchio as pin
import pytest

from liftopt.crosscheck.kinematics import at_rest, chain_motion, row_transforms
from liftopt.crosscheck.systems import CheckedSystem, random_states
from liftopt.multibody.dh import DHRow, frame_transforms, row_transform

ROWS = [
    DHRow("x", kind, 0.3, -0.2, 0.7, alpha) for kind in ("revolute", "prismatic") for alpha in (0.0, 0.4, np.pi / 2)
]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.kind}-{row.alpha:.2f}")
def test_row_matches_the_product_of_elementary_transforms(row: DHRow) -> None:
    q = np.linspace(-3.0, 3.0, 13)
    expected = np.array([row_transform(row, value) for value in q])
    np.testing.assert_allclose(row_transforms(row, q)[0], expected, rtol=0, atol=1e-15)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.kind}-{row.alpha:.2f}")
def test_row_derivatives_are_products_with_the_generator(row: DHRow) -> None:
    """Closed form: dT/dq = Q T and d2T/dq2 = Q Q T with Q the joint's unit twist about or along z."""
    generator = np.zeros((4, 4))
    if row.kind == "revolute":
        generator[0, 1], generator[1, 0] = -1.0, 1.0
    else:
        generator[2, 3] = 1.0
    step, first, second = row_transforms(row, np.linspace(-3.0, 3.0, 13))
    np.testing.assert_allclose(first, generator @ step, rtol=0, atol=1e-15)
    np.testing.assert_allclose(second, generator @ generator @ step, rtol=0, atol=1e-15)


def test_placements_match_the_dh_module(arm: CheckedSystem) -> None:
    q, _, _ = random_states(arm, 5, np.random.default_rng(0))
    motion = at_rest(arm.chain, q)
    for s in range(5):
        np.testing.assert_allclose(motion.placement[1:, s], frame_transforms(arm.chain, q[s]), rtol=0, atol=1e-14)


def test_tip_velocity_and_acceleration_match_pinocchio(arm: CheckedSystem) -> None:
    q, v, a = random_states(arm, 20, np.random.default_rng(1))
    motion = chain_motion(arm.chain, q, v, a)
    data, frame = arm.model.createData(), arm.model.getFrameId("tip")
    for s in range(20):
        pin.forwardKinematics(arm.model, data, q[s], v[s], a[s])
        reference = pin.LOCAL_WORLD_ALIGNED
        velocity = pin.getFrameVelocity(arm.model, data, frame, reference).linear
        acceleration = pin.getFrameClassicalAcceleration(arm.model, data, frame, reference).linear
        np.testing.assert_allclose(arm.to_world(motion.velocity[-1, s, :3, 3]), velocity, rtol=0, atol=1e-12)
        np.testing.assert_allclose(arm.to_world(motion.acceleration[-1, s, :3, 3]), acceleration, rtol=0, atol=1e-11)


def test_wrong_shape_is_refused_by_name(arm: CheckedSystem) -> None:
    q = np.zeros((4, len(arm.chain.rows)))
    with pytest.raises(ValueError, match="v has shape"):
        chain_motion(arm.chain, q, q[:, :-1], q)
