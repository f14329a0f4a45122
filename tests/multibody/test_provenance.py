"""Every number of the human model is stated with a source. Oracle: the limits and bodies of the loaded URDF."""

from __future__ import annotations

import numpy as np
import pytest

from liftopt.multibody.person.human import Subject, human_agent
from liftopt.multibody.person.provenance import subject_quantities, whole_quantities
from liftopt.multibody.person.whole_body import whole_human_agent

SUBJECT = Subject(1.7, 68.0, "female")


def test_states_the_limits_that_the_agent_has():
    limits, stated = human_agent(SUBJECT).limits, subject_quantities(SUBJECT)
    torques = [item.value for item in stated if item.group == "strength"]
    np.testing.assert_array_equal(np.reshape(torques, (10, 2)), np.c_[limits.tau_lower, limits.tau_upper])
    angles = [item.value for item in stated if item.group == "range of motion"]
    np.testing.assert_allclose(np.radians(angles).reshape(10, 2), np.c_[limits.q_lower, limits.q_upper])
    np.testing.assert_array_equal([item.value for item in stated if item.group == "speed"], limits.velocity)


def test_states_where_the_agent_is_at_ease():
    comfort, stated = human_agent(SUBJECT).comfort, subject_quantities(SUBJECT)
    neutral, first, last, weight = np.reshape([item.value for item in stated if item.group == "ease"], (10, 4)).T
    np.testing.assert_allclose(np.radians(neutral), comfort.neutral, atol=1e-15)
    np.testing.assert_allclose(np.radians(neutral - first), comfort.room_lower)
    np.testing.assert_allclose(np.radians(last - neutral), comfort.room_upper)
    np.testing.assert_array_equal(weight, comfort.weight)


def test_states_masses_that_sum_to_the_body_and_a_source_for_everything():
    stated = subject_quantities(SUBJECT)
    assert sum(item.value for item in stated if item.name.endswith("mass")) == pytest.approx(68.0, abs=1e-9)
    assert [item.name for item in stated if item.group == "length"] == ["L1", "L2", "L3", "L4", "L5", "L6"]
    assert all(item.source.citation and item.source.confidence for item in stated)


def test_states_the_numbers_of_the_whole_person():
    """Oracle: the agent's own limits, comfort, stance and bodies."""
    agent, stated = whole_human_agent(SUBJECT), whole_quantities(SUBJECT)
    groups = {item.group: [other.value for other in stated if other.group == item.group] for item in stated}
    limits = agent.limits
    np.testing.assert_array_equal(groups["speed"], limits.velocity)
    ranges = np.c_[limits.q_lower, limits.q_upper]
    np.testing.assert_allclose(np.radians(groups["range of motion"]).reshape(20, 2), ranges)
    np.testing.assert_array_equal(np.reshape(groups["strength"], (20, 2)), np.c_[limits.tau_lower, limits.tau_upper])
    neutral, first, last, _ = np.radians(np.reshape(groups["ease"], (20, 4))).T
    np.testing.assert_allclose(neutral, agent.comfort.neutral, atol=1e-15)
    np.testing.assert_allclose(neutral - first, agent.comfort.room_lower)
    np.testing.assert_allclose(last - neutral, agent.comfort.room_upper)
    assert np.all(agent.comfort.room_lower > 0.0) and np.all(agent.comfort.room_upper > 0.0)
    assert groups["stance"] == [*agent.stance.soles[0], agent.stance.sway, agent.stance.friction]
    np.testing.assert_allclose(np.radians(groups["lean"]), [agent.lean.room, agent.lean.most])
    assert sum(item.value for item in stated if item.name.endswith(" mass")) == pytest.approx(68.0, abs=1e-9)
    assert all(item.source.citation and item.source.confidence for item in stated)
