"""The table. Oracles: closed form of a uniform box, textbook DH matrices, Pinocchio."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from liftopt.errors import InputError
from liftopt.multibody.dh import ROTATION_WORLD_PAPER
from liftopt.multibody.table import lifted_table, table_chain

SIZES = {"mass": 2.0, "depth": 0.45, "width": 0.31, "height": 0.02}


def test_one_free_body_whose_frame_is_its_centre_of_mass(assert_bodies_are_physical):
    table = lifted_table(**SIZES)
    assert (table.model.nq, table.model.nv) == (7, 6)
    body = table.model.inertias[1]
    np.testing.assert_array_equal(body.lever, np.zeros(3))
    box = 2.0 / 12.0 * np.array([0.31**2 + 0.02**2, 0.45**2 + 0.02**2, 0.45**2 + 0.31**2])
    np.testing.assert_allclose(body.inertia, np.diag(box), rtol=1e-12)
    assert_bodies_are_physical(table.model)


def test_grasps_are_on_the_bottom_edges_and_massless(frame_pose):
    table = lifted_table(**SIZES)
    at = {name: frame_pose(table.model, name, pin.neutral(table.model))[:3, 3] for name in table.grasp_frames}
    np.testing.assert_allclose(at["grasp_human"], [-0.225, 0.0, -0.01], atol=1e-15)
    np.testing.assert_allclose(at["grasp_robot"], [0.225, 0.0, -0.01], atol=1e-15)
    assert table.model.inertias[1].mass == 2.0


def test_table_4_at_zero_is_turned_as_the_chain_says(textbook_end):
    """Oracle: textbook DH matrices. The bottom is at y = +height/2 of the last frame."""
    chain = table_chain(**SIZES)
    end = textbook_end(chain.rows, np.zeros(6))
    np.testing.assert_allclose(end, np.diag([-1.0, -1.0, 1.0, 1.0]), atol=1e-15)
    bottom = ROTATION_WORLD_PAPER @ end[:3, :3] @ np.array([0.0, 0.01, 0.0])
    np.testing.assert_allclose(bottom, [0.0, 0.0, -0.01], atol=1e-15)


def test_chain_and_urdf_are_the_same_body(textbook_end):
    """Oracle: the inertia tensor of the free body, seen in the world at zero."""
    chain, table = table_chain(**SIZES), lifted_table(**SIZES)
    rotation = ROTATION_WORLD_PAPER @ textbook_end(chain.rows, np.zeros(6))[:3, :3]
    body = chain.inertias[-1]
    np.testing.assert_allclose(
        rotation @ body.inertia @ rotation.T, table.model.inertias[1].inertia, rtol=0.0, atol=1e-15
    )
    assert body.mass == table.model.inertias[1].mass


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf"), True, "2", None, 1e9])
@pytest.mark.parametrize("key", ["mass", "depth", "width", "height"])
def test_refuses_by_name(key, value):
    with pytest.raises(InputError) as error:
        lifted_table(**(SIZES | {key: value}))
    assert error.value.key == f"object.{key}"
    assert error.value.value is value
