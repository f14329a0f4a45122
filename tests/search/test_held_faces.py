"""Arms stay outside the face that their hand holds; the oracle is the box's geometry, by hand."""

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


def outward(found: TeamSolids) -> dict[str, np.ndarray]:
    """Return the direction in which the object's partner of each pair is said to be, by the partner's name."""
    told = {}
    for p, normal in found.outward.items():
        pair = found.pairs[p]
        object_first = pair.one.owner == found.team.object.name
        told[pair.other.name if object_first else pair.one.name] = -normal if object_first else normal
    return told


@pytest.mark.parametrize("place", ["side", "handle"])
def test_an_arm_is_beside_the_side_that_it_holds(place: str) -> None:
    told = outward(solids(**{"object.grasps": {"human_right": place, "human_left": place}}))
    forearms = {name: normal for name, normal in told.items() if "forearm" in name}
    assert len(forearms) == 2
    for name, normal in told.items():
        side = "right" if "right" in name else "left"
        np.testing.assert_array_equal(normal, [0.0, OUTSIDE[side], 0.0])
    assert not any("thigh" in name or "chest" in name for name in told)


def test_nothing_is_known_of_arms_at_edges_of_free_ones_and_of_those_who_have_one() -> None:
    assert outward(solids()) == {}
    one = solids(**{"human.hands": ["left"], "object.grasps": {"human": "side"}})
    assert outward(one) and all("left" in name for name in outward(one))
    assert outward(solids(**{"human.body": "arm", "object.grasps": {"human": "side"}})) == {}
