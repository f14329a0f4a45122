"""Distances of solids by coal: the oracle is another process in which another pair is the first that is measured."""

from __future__ import annotations

import subprocess
import sys
import tempfile

import pytest

MEASURE = """
import sys
import coal
import numpy as np
import pinocchio as pin
from liftopt.multibody.coal_shape import coal_shape
from liftopt.multibody.solids import Solid

def shape(kind, *size):
    solid = object.__new__(Solid)
    for name, value in (("kind", kind), ("size", size)):
        object.__setattr__(solid, name, value)
    return coal_shape(solid)

box, capsule = shape("box", 0.6, 0.4, 0.3), shape("capsule", 0.05, 0.4)
level, far = coal.Transform3s.Identity(), coal.Transform3s(np.eye(3), np.array([0.0, 2.0, 0.0]))
turned = coal.Transform3s(pin.rpy.rpyToMatrix(0.3, 0.4, 0.5), np.array([3.0, 1.0, 2.0]))
pairs = {"level": (box, level, capsule, far), "turned": (capsule, level, box, turned)}
for first in sys.argv[1:]:
    pair = pairs[first]
    print(first, coal.distance(*pair, coal.DistanceRequest(), coal.DistanceResult()).hex())
"""


def _measured(*order: str) -> dict[str, str]:
    """Return the distances of pairs, measured in this order by a process of their own."""
    command = [sys.executable, "-c", MEASURE, *order]
    run = subprocess.run(command, cwd=tempfile.gettempdir(), capture_output=True, text=True, check=True)
    return dict(line.split() for line in run.stdout.splitlines())


def test_distances_from_a_box_do_not_depend_on_which_pair_was_first() -> None:
    one, other = _measured("level", "turned"), _measured("turned", "level")
    assert one == other
    assert float.fromhex(one["level"]) == pytest.approx(2.0 - 0.2 - 0.05, abs=1e-6)
