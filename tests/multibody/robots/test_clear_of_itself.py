"""Robots from outside can keep clear of themselves. Oracle: coal's distances in random postures."""

from __future__ import annotations

from itertools import combinations

import pytest

pytest.importorskip("yourdfpy")

from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.multibody.solid_pairs import solid_pairs
from liftopt.multibody.solids import solids_of

NOT_INSTALLED = "example-robot-data is not installed (it is in 'test')"
POSTURES = 40
SCATTER = 0.25  # three standard deviations of the share of 40 postures


@pytest.mark.skipif(share_folder() is None, reason=NOT_INSTALLED)
@pytest.mark.parametrize("name", ["ur5", "panda", "baxter_left", "tiago_lifting", "z1"])
def test_only_parts_that_overlap_in_most_postures_may(name, known_agent, table, coal_distance, rng):
    agent = known_agent(name)
    kept = {pair.told for pair in solid_pairs((agent,), table) if pair.within_body}
    solids = solids_of(agent)
    bearing = sorted({solid.joint for solid in solids})
    overlaps = dict.fromkeys(combinations(range(len(solids)), 2), 0)
    for q in rng.uniform(agent.limits.q_lower, agent.limits.q_upper, (POSTURES, len(agent.posture))):
        at = coal_distance.joint_placements(agent, q)
        for i, j in overlaps:
            one, other = solids[i], solids[j]
            overlaps[i, j] += coal_distance.distance(one, at[one.joint], other, at[other.joint]) <= 0.0
    for (i, j), count in overlaps.items():
        share = count / POSTURES  # of other postures than those that decide
        if f"{solids[i].told} and {solids[j].told}" in kept:
            assert share < 0.5 + SCATTER
        elif abs(bearing.index(solids[i].joint) - bearing.index(solids[j].joint)) > 1:
            assert share > 0.5 - SCATTER
