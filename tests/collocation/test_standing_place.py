"""Grasp points as parameters: the functions of a topology that has zeros among them are the oracle."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from liftopt.collocation.dynamics import KnotFunctions, Topology, object_functions
from liftopt.collocation.standing_place import held_anywhere
from liftopt.collocation.wrench_dynamics import WrenchTopology, wrench_object_functions
from liftopt.multibody.agent import LiftedObject

EDGE = np.array([[-0.3, 0.2, -0.05], [-0.3, -0.2, -0.05], [0.3, 0.0, -0.05]])
HANDLES = np.array([[0.0, 0.2, 0.0], [0.0, -0.2, 0.0], [0.3, 0.0, 0.1]])


@pytest.mark.parametrize("builder", [object_functions, wrench_object_functions])
def test_one_kernel_serves_every_grasp(
    builder: Callable[[Topology], KnotFunctions], make_box: Callable[..., LiftedObject], rng: np.random.Generator
) -> None:
    """Hands on an edge and on handles: equal signatures, and the outputs and slopes of a kernel of their own."""
    signatures = []
    for points in (EDGE, HANDLES):
        lifted = make_box(points)
        own = WrenchTopology.holding(lifted.model, lifted.grasp_frames)
        anywhere = held_anywhere(own)
        signatures.append(anywhere.signature())
        assert len(anywhere.parameters) > len(own.parameters)
        functions, expected = builder(anywhere), builder(own)
        y = rng.normal(size=functions.value.size1_in(0))
        for role in ("value", "jacobian"):
            found, known = (
                getattr(f, role)(y, np.r_[1.3, topology.parameters]).full()
                for f, topology in ((functions, anywhere), (expected, own))
            )
            np.testing.assert_allclose(found, known, rtol=0, atol=1e-14 * np.abs(known).max())
    assert signatures[0] == signatures[1]
