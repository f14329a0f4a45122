"""The places of a base and of grasp points as parameters of kernels, so that one serves every place and heading."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
import pinocchio as pin

from liftopt.collocation.dynamics import Topology, clean_rotation
from liftopt.collocation.spatial_symbols import Placed
from liftopt.types import Array

PLACE_SIZE = 5  # x, y, z, cosine and sine of the heading
# Stands for a coordinate of zero that is to be a parameter: no sum with a real length or force sees it [m].
NEXT_TO_ZERO = 1e-200
AnyTopology = TypeVar("AnyTopology", bound=Topology)


def in_base_axes(model: pin.Model, T_world_base: Array) -> pin.Model:
    """Return a model, which is in the world, as its base sees it."""
    local, T_base_world = model.copy(), pin.SE3(T_world_base).inverse()
    for j in range(1, model.njoints):
        if not model.parents[j]:
            moved = T_base_world * model.jointPlacements[j]
            local.jointPlacements[j] = pin.SE3(clean_rotation(moved.rotation), moved.translation)
    return local


def place_parameters(T_world_base: Array) -> Array:
    """Return the numbers (5,) of an upright base."""
    return np.array([*T_world_base[:3, 3], *T_world_base[:2, 0]])


def base_of(place: Any) -> Placed:
    """Return the base in the world from the symbols (5,) of its place."""
    import casadi as ca

    cosine, sine = place[3], place[4]
    turned = ca.vertcat(ca.horzcat(cosine, -sine, 0), ca.horzcat(sine, cosine, 0), ca.horzcat(0, 0, 1))
    return Placed(turned, place[:3])


def held_anywhere(topology: AnyTopology) -> AnyTopology:
    """Return a topology whose grasp points are all parameters, whichever of their coordinates are zero."""
    entries = topology.entries.copy()
    points = entries[len(entries) - 3 * len(topology.frames) :]
    points[points == 0.0] = NEXT_TO_ZERO
    return replace(topology, entries=entries)
