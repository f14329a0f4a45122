"""An arrow that grows and turns with a force."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from liftopt.types import Array
from liftopt.viz.playback import ForceTrack, continuous
from liftopt.viz.scene_commands import Command, set_object
from liftopt.viz.scene_mesh import Mesh, cylinder, merged
from liftopt.viz.scene_part import Colour

SHAFT_RADIUS, HEAD_RADIUS, HEAD_LENGTH = 0.010, 0.026, 0.07  # [m]
LONGEST = 0.40  # [m]: of the largest force shown
SMALLEST = 1e-4  # of a scale: a node of size zero cannot be inverted


def metres_per_newton(forces: Iterable[Array]) -> float:
    """Return the scale of arrows for forces, each (K, 3) [N].

    It is 1, 2 or 5 times a power of ten, so that a reader can tell a force from an arrow's length.
    """
    largest = max(1e-3, *(float(np.linalg.norm(force, axis=1).max()) for force in forces))
    wanted = LONGEST / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted * (1.0 + 1e-9)))


def arrow_mesh(start: Array, along: Array) -> Mesh | None:
    """Return an arrow from ``start`` (3,), as long as ``along`` (3,) [m]; None if that is next to nothing."""
    length = float(np.linalg.norm(along))
    if length < HEAD_RADIUS:
        return None
    head = min(HEAD_LENGTH, 0.5 * length)
    slim, neck = head / HEAD_LENGTH, start + (1.0 - head / length) * along
    shaft = cylinder(start, neck, slim * SHAFT_RADIUS, edge=0.001)
    return merged([shaft, cylinder(neck, start + along, slim * HEAD_RADIUS, end_radius=0.0015, edge=0.001)])


def arrow_commands(root: str, colour: Colour, opacity: float) -> list[Command]:
    """Return the commands that draw an arrow along z at ``root``: a shaft 1 m long and a head, both to be scaled."""
    shaft = cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), SHAFT_RADIUS, edge=0.001)
    head = cylinder((0.0, 0.0, 0.0), (0.0, 0.0, HEAD_LENGTH), HEAD_RADIUS, end_radius=0.0015, edge=0.001)
    return [
        set_object(f"{root}/shaft/mesh", shaft, colour, opacity, on_top=True),
        set_object(f"{root}/head/mesh", head, colour, opacity, on_top=True),
    ]


def arrow_values(root: str, track: ForceTrack, metres_per_newton: float) -> dict[str, dict[str, Array]]:
    """Return what moves by node: the arrow starts at the grasp point and is as long as the force is large.

    Below the length of its head the whole arrow shrinks, so that its length still tells the force.
    """
    size = np.linalg.norm(track.force, axis=1)
    length = size * metres_per_newton
    head = np.minimum(HEAD_LENGTH, 0.5 * length)
    shrunk = np.maximum(head / HEAD_LENGTH, SMALLEST)
    shaft = np.stack([shrunk, shrunk, np.maximum(length - head, SMALLEST)], axis=1)
    up = np.zeros_like(track.force)
    up[:, 2] = length - head
    return {
        root: {"position": track.point, "quaternion": from_z(track.force)},
        f"{root}/shaft": {"scale": shaft},
        f"{root}/head": {"position": up, "scale": np.repeat(shrunk[:, None], 3, axis=1)},
    }


def from_z(vectors: Array) -> Array:
    """Return quaternions (K, 4) x y z w that turn z to ``vectors`` (K, 3); a vanishing one keeps the turn before it."""
    turns = np.zeros((len(vectors), 4))
    last = np.array([0.0, 0.0, 0.0, 1.0])
    for k, vector in enumerate(vectors):
        size = float(np.linalg.norm(vector))
        if size > 1e-9:
            x, y, z = vector / size
            # Half-angle formula; straight down, any axis across will do.
            turn = np.array([-y, x, 0.0, 1.0 + z]) if z > -1.0 + 1e-9 else np.array([1.0, 0.0, 0.0, 0.0])
            last = turn / np.linalg.norm(turn)
        turns[k] = last
    return continuous(turns)
