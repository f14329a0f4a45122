"""Poses of the links of somebody who stands: Pinocchio in double precision is the oracle."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.standing_poses import StandingPoseTopology, standing_pose_functions
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.placement import Placement

JOINTS = (2, 6, 13, 20)
PLACES = (Placement(), Placement(0.4, -0.3, 0.8), Placement(-1.0, 0.0, np.pi))


@pytest.mark.parametrize("place", PLACES)
def test_values_are_pinocchios(place: Placement, rng: np.random.Generator) -> None:
    model = whole_human_agent(Subject(1.7, 68.0, "female"), place=place).reduced()
    topology = StandingPoseTopology.standing(model, JOINTS, place.T_world_base)
    q, data = rng.normal(size=model.nv), model.createData()
    c = standing_pose_functions(topology).value(q, np.r_[1.0, topology.parameters]).full().reshape(-1, 12)
    pin.forwardKinematics(model, data, q)
    for joint, pose in zip(JOINTS, c, strict=True):
        expected = np.r_[data.oMi[joint].translation, data.oMi[joint].rotation.T.ravel()]
        np.testing.assert_allclose(pose, expected, rtol=0, atol=1e-14)


def test_one_kernel_serves_everybody_everywhere() -> None:
    """Equal signatures, other parameters."""
    topologies = [
        StandingPoseTopology.standing(whole_human_agent(who, place=place).reduced(), JOINTS, place.T_world_base)
        for who in (Subject(1.55, 50.0, "female"), Subject(1.95, 110.0, "male"))
        for place in PLACES
    ]
    assert len({topology.signature() for topology in topologies}) == 1
    assert len({topology.parameters.tobytes() for topology in topologies}) == len(topologies)
