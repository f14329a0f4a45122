"""The object that is lifted: a box, with a slot where a hand reaches in for a handle."""

from __future__ import annotations

import numpy as np

from liftopt.multibody.dh import rotation_z, translation
from liftopt.scenario.grasps import placed_grasps
from liftopt.scenario.model import Scenario
from liftopt.viz.scene_mesh import block
from liftopt.viz.scene_part import Colour, Part

WOOD: Colour = (0.78, 0.60, 0.38)
HOLE: Colour = (0.16, 0.12, 0.08)
# Of a slot: its length and height, how far it stands out of the face so that it is seen, and its middle below the
# knuckles, from which the fingers bend into it [m].
SLOT, PROUD, BELOW = (0.115, 0.034), 0.0015, 0.012


def object_parts(scenario: Scenario) -> list[Part]:
    """Return what is drawn of the object, in its own axes."""
    box = scenario.object
    parts = [Part(box.name, "top", WOOD, block((0.0, 0.0, 0.0), (box.depth, box.width, box.height), edge=0.003))]
    for grasp in placed_grasps(scenario):
        if grasp.hold == "handle":
            slot = block((0.0, 0.0, -BELOW), (SLOT[0], 2.0 * PROUD, SLOT[1]), edge=0.001)
            at = translation(*grasp.point) @ rotation_z(0.5 * np.pi * grasp.quarters)
            parts.append(Part(box.name, f"handle_{grasp.name}", HOLE, slot.seen_from(at)))
    return parts
