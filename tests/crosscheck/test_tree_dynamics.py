"""The recursion over a tree. Oracles: closed forms of a pendulum, Pinocchio; and that a spoilt model is found."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from liftopt.crosscheck.default_systems import default_whole_person
from liftopt.crosscheck.tree_checks import tree_checks
from liftopt.crosscheck.tree_dynamics import read_tree, tree_forces

PENDULUM = """<robot name="pendulum"><link name="world"/>
<link name="rod"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
<inertia ixx="0.1" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tip"><inertial><mass value="1"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="swing" type="revolute"><parent link="world"/><child link="rod"/><origin xyz="0 0 3"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="end" type="fixed"><parent link="rod"/><child link="tip"/><origin xyz="0 0 -1" rpy="0.3 0.2 0.1"/></joint>
</robot>"""


def test_a_pendulum_is_the_closed_form() -> None:
    """Inertia about the pivot times acceleration, and gravity; the centripetal force at the pivot."""
    tree = read_tree(PENDULUM, ["swing"])
    q, v, a = (np.array([[value]]) for value in (0.4, 1.5, -2.0))
    found = tree_forces(tree, q, v, a, {})
    inertia, first = 0.2 + 2.0 * 0.25 + 1.0, 2.0 * 0.5 + 1.0
    assert found.tau[0, 0] == pytest.approx(inertia * a[0, 0] + first * 9.81 * np.sin(0.4), abs=1e-12)
    # Hanging at q, the rod points to (-sin q, -cos q): its acceleration is along it and across it.
    along, across = np.array([-np.sin(0.4), 0.0, -np.cos(0.4)]), np.array([-np.cos(0.4), 0.0, np.sin(0.4)])
    expected = first * (a[0, 0] * across - v[0, 0] ** 2 * along) + 3.0 * 9.81 * np.array([0.0, 0.0, 1.0])
    np.testing.assert_allclose(found.force[0], expected, atol=1e-12)


def test_a_load_at_a_fixed_link_counts_where_it_acts() -> None:
    tree = read_tree(PENDULUM, ["swing"])
    still = np.zeros((1, 1))
    found = tree_forces(tree, still, still, still, {"tip": (np.array([[10.0, 0.0, 0.0]]), np.array([[0.0, 3.0, 0.0]]))})
    np.testing.assert_allclose(found.positions["tip"], [[0.0, 0.0, 2.0]], atol=1e-12)
    assert found.tau[0, 0] == pytest.approx(10.0 - 3.0, abs=1e-12)  # 1 m below the pivot, +X is about -Y


def test_joints_that_are_not_asked_for_are_refused() -> None:
    with pytest.raises(ValueError, match="swing"):
        read_tree(PENDULUM, ["other"])


def test_the_whole_person_agrees_and_a_wrong_mass_is_found() -> None:
    person, rng = default_whole_person(), np.random.default_rng(1)
    assert [row for row in tree_checks(person, 50, rng) if not row.passed] == []
    forearm = r'(<link name="human_left_Q8_link">\s*<inertial>.*?<mass value=")([0-9.]+)'
    heavier = re.sub(forearm, _more, person.urdf, flags=re.DOTALL)
    assert heavier != person.urdf
    failed = {row.quantity for row in tree_checks(replace(person, urdf=heavier), 50, rng) if not row.passed}
    assert {"torque, no load", "ground force, feet included", "work of the torques in 1 s"} <= failed
    assert "grasp positions" not in failed


def _more(found: re.Match[str]) -> str:
    return f"{found[1]}{float(found[2]) + 1e-6}"
