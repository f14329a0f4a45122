"""Fig. 2. Oracles: closed form at rest; the whole-body Newton-Euler balance is in test_report and in the arm checks."""

from dataclasses import replace

import numpy as np
import pytest

from liftopt.crosscheck.arm_checks import arm_checks
from liftopt.crosscheck.ground_reaction import ground_reaction, with_root_rotations
from liftopt.crosscheck.kinematics import at_rest
from liftopt.crosscheck.lagrangian import ExternalLoad
from liftopt.crosscheck.systems import CheckedSystem
from liftopt.multibody.dh import DHChain


def test_arm_agrees_with_pinocchio_in_every_quantity(arm: CheckedSystem) -> None:
    """Pinocchio's RNEA, Jacobians and centroidal momentum; finite differences within their own bound."""
    rows = arm_checks(arm, 200, np.random.default_rng(0))
    assert [row for row in rows if not row.passed] == []


def test_standing_still_the_ground_gives_the_weight_and_takes_the_load(arm: CheckedSystem) -> None:
    """Closed form: force = -m g - f; moment about the foot = -sum of the arms times what acts there."""
    rest = np.zeros((1, len(arm.chain.rows)))
    force, moment = np.array([[10.0, -20.0, 5.0]]), np.array([[1.0, 2.0, 3.0]])
    last = len(arm.chain.rows) - 1
    load = ExternalLoad(last, np.zeros(3), force, moment)
    ground = ground_reaction(arm.chain, rest, rest, rest, arm.gravity, [load])
    placements = at_rest(arm.chain, rest).placement[1:, 0]
    expected_force, expected_moment = -force[0], -moment[0] - np.cross(placements[last][:3, 3], force[0])
    for body, placement in zip(arm.chain.inertias, placements, strict=True):
        weight = body.mass * arm.gravity
        expected_force = expected_force - weight
        expected_moment = expected_moment - np.cross(placement[:3, :3] @ body.com + placement[:3, 3], weight)
    np.testing.assert_allclose(ground.foot, 0.0, atol=1e-15)
    np.testing.assert_allclose(ground.force[0], expected_force, rtol=0, atol=1e-11)
    np.testing.assert_allclose(ground.moment[0], expected_moment, rtol=0, atol=1e-11)


def test_root_rotations_leave_the_frames_where_they_are(arm: CheckedSystem) -> None:
    """Closed form: three cyclic permutations of the axes are the identity."""
    rooted = with_root_rotations(arm.chain)
    n = len(arm.chain.rows)
    np.testing.assert_allclose(
        at_rest(rooted, np.zeros((1, n + 3))).placement[3:], at_rest(arm.chain, np.zeros((1, n))).placement, atol=1e-15
    )


def test_chain_without_global_translations_is_refused(arm: CheckedSystem) -> None:
    chain = DHChain("arm", arm.chain.rows[3:], arm.chain.inertias[3:])
    rest = np.zeros((1, len(chain.rows)))
    with pytest.raises(ValueError, match="prismatic global translations"):
        ground_reaction(chain, rest, rest, rest, arm.gravity)


def test_mass_that_the_last_global_joint_would_not_carry_is_refused(arm: CheckedSystem) -> None:
    chain = replace(arm.chain, inertias=(arm.chain.inertias[-1], *arm.chain.inertias[1:]))
    rest = np.zeros((1, len(chain.rows)))
    with pytest.raises(ValueError, match="massless"):
        ground_reaction(chain, rest, rest, rest, arm.gravity)
