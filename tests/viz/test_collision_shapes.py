"""The shapes that bodies are collided with hold the figures that are drawn; Sawyer's were measured on its meshes."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from liftopt.multibody.agent import Agent
from liftopt.multibody.solids import Solid, solids_of
from liftopt.scenario.build import agents_of, subject_of
from liftopt.scenario.model import load_scenario
from liftopt.viz.person_bodies import FREE_ARM, PersonBodies
from liftopt.viz.scene_person import person_parts
from liftopt.viz.scene_sawyer import sawyer_parts

SCENARIO = load_scenario()
HUMAN, ROBOT = agents_of(SCENARIO)
WHOLE, _ = agents_of(SCENARIO.replace({"human.body": "whole"}))
WORLD_BASE = np.array([[-1.0, 0.0, 0.0, 1.9], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.915], [0.0, 0.0, 0.0, 1.0]])
# [m], as far as simple shapes may miss a figure; a leg of the pedestal ends in a small foot.
ROUGH = 0.025


def _outside(part: Any, agent: Agent, coal_distance: ModuleType) -> float:
    """Return how far a part of a figure sticks out of the solids on its joint, at the zero pose [m]."""
    places = coal_distance.joint_placements(agent, np.zeros(len(agent.moving_joints)))
    names = list(agent.reduced().names)
    # The free arm is drawn hanging from the trunk, of which it is a rigid part in the model.
    body = part.body.replace(FREE_ARM, "Q3")
    joint = names.index(body) if body in names else 0
    gaps = [_gap(solid, places[joint], part.mesh.vertices) for solid in solids_of(agent) if solid.joint == joint]
    return float(np.min(gaps, axis=0).max())


def _gap(solid: Solid, T_world_joint: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return how far points (n, 3) are outside a capsule or box, by its own definition."""
    T_world_solid = T_world_joint @ solid.T_joint_solid
    own = (points - T_world_solid[:3, 3]) @ T_world_solid[:3, :3]
    half = np.array(solid.size) / 2.0 if solid.kind == "box" else np.array([0.0, 0.0, solid.size[1] / 2.0])
    return np.linalg.norm(own - np.clip(own, -half, half), axis=1) - solid.radius


@pytest.mark.parametrize("part", sawyer_parts("robot", WORLD_BASE), ids=lambda part: part.name)
def test_sawyers_shapes_hold_its_figure(part: Any, coal_distance: ModuleType) -> None:
    assert _outside(part, ROBOT, coal_distance) < ROUGH


@pytest.mark.parametrize("agent", [HUMAN, WHOLE], ids=["arm", "whole"])
@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize("limb", ["upper_arm", "forearm", "thigh", "shank"])
def test_a_persons_shapes_hold_the_limbs(limb: str, side: str, agent: Agent, coal_distance: ModuleType) -> None:
    person = SimpleNamespace(name=agent.name, joint_names=agent.model.names, grasps=())
    figure = person_parts(PersonBodies.of(person), subject_of(SCENARIO.first("person")))  # type: ignore[arg-type]
    (part,) = (part for part in figure if part.name == f"{side}_{limb}")
    assert _outside(part, agent, coal_distance) < ROUGH
