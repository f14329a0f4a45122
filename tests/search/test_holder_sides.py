"""Where arms, legs and trunk of those who hold a box belong; the oracle is the box's geometry, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from liftopt.collocation.problem import Team
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import load_scenario
from liftopt.search.team_solids import TeamSolids

BOX = {"object.depth": 0.6, "object.width": 0.4, "object.height": 0.3, "human.body": "whole"}
OUTSIDE = {"right": -1.0, "left": 1.0}


def solids(**changes: object) -> TeamSolids:
    scenario = load_scenario("table5", {**BOX, **changes})
    return TeamSolids.of(Team(agents_of(scenario), object_of(scenario), (), ()), ())


def sides(found: TeamSolids, of_arms: bool) -> dict[str, np.ndarray]:
    """Return the direction from the object in which arms, or legs and trunk, of its holders belong, by their names."""
    told = {}
    for p, side in found.sides.items():
        pair = found.pairs[p]
        assert side.object_is_first == (pair.one.owner == found.team.object.name)
        name = pair.other.name if side.object_is_first else pair.one.name
        if of_arms == any(word in name for word in ("arm", "hand")):
            told[name] = side.normals * (-1.0 if side.object_is_first else 1.0)
    return told


@pytest.mark.parametrize("place", ["side", "handle"])
def test_an_arm_is_beside_the_side_that_it_holds(place: str) -> None:
    told = sides(solids(**{"object.grasps": {"human_right": place, "human_left": place}}), True)
    assert sum("forearm" in name for name in told) == 2
    for name, normals in told.items():
        np.testing.assert_array_equal(normals, [[0.0, OUTSIDE["right" if "right" in name else "left"], 0.0]])


def test_an_arm_whose_hand_is_underneath_is_below_or_on_the_side_of_who_holds() -> None:
    told = sides(solids(**{"object.grasps": {"human_right": "bottom", "human_left": "bottom"}}), True)
    assert sum("forearm" in name for name in told) == 2
    for normals in told.values():
        np.testing.assert_allclose(normals, [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]], atol=1e-15)


def test_nothing_is_known_of_arms_at_edges_of_free_ones_and_of_those_who_have_one() -> None:
    assert sides(solids(), True) == {}
    one = sides(solids(**{"human.hands": ["left"], "object.grasps": {"human": "side"}}), True)
    assert one and all("left" in name for name in one)
    assert solids(**{"human.body": "arm", "object.grasps": {"human": "side"}}).sides == {}


def test_legs_and_trunk_are_behind_what_is_held() -> None:
    told = sides(solids(), False)
    assert sum("thigh" in name for name in told) == 2
    for normals in told.values():
        np.testing.assert_allclose(normals, [[-1.0, 0.0, 0.0]], atol=1e-15)
