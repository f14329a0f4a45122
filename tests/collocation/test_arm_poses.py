"""Poses of the links of serial arms: Pinocchio in double precision, and the kernels of one model, are the oracles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.arm_poses import ArmPoseTopology, arm_pose_functions
from liftopt.collocation.kkt_poses import link_poses
from liftopt.collocation.pose_kernels import PoseTopology, pose_functions
from liftopt.collocation.separating_planes import pose_parts
from liftopt.multibody.agent import Agent, LiftedObject

ARMS = ("RRRRRR", "PRRPR", "P", "RPP")


def arm(kinds: str, seed: int = 0) -> pin.Model:
    """Return an arm with random placements, its base anywhere."""
    rng, model, joint = np.random.default_rng(seed), pin.Model(), 0
    for number, kind in enumerate(kinds):
        moving = pin.JointModelRZ() if kind == "R" else pin.JointModelPZ()
        place = pin.SE3(pin.exp3(rng.normal(size=3)), 0.4 * rng.normal(size=3))
        joint = model.addJoint(joint, moving, place, f"joint{number}")
    return model


@pytest.fixture
def agent(make_arm: Callable[..., Agent]) -> Agent:
    return replace(make_arm(1), model=arm("RPRR", 3), shares_kernels=True)


@pytest.mark.parametrize("kinds", ARMS)
def test_poses_and_their_derivatives(kinds: str, make_arm: Callable[..., Agent], rng: np.random.Generator) -> None:
    model = arm(kinds)
    joints = tuple(range(1, model.njoints))
    topology, others = ArmPoseTopology.of_links(model), PoseTopology.moving(model, joints)
    ours, theirs = arm_pose_functions(topology), pose_functions(others)
    q, m = rng.normal(size=model.nv), rng.normal(size=12 * model.nv)
    p, own = np.r_[1.0, topology.parameters], np.r_[1.0, others.parameters]
    values, slopes = link_poses(replace(make_arm(1), model=model), joints, q[None])
    for found, whole in (
        (ours.value(q, p).full().ravel(), values[0]),
        (ours.jacobian(q, p).full(), slopes[0]),
        (ours.gradient(q, p, m).full().ravel(), m @ slopes[0]),
        (ours.curvature(q, p, m).full(), theirs.curvature(q, own, m).full()),
    ):
        np.testing.assert_allclose(found, whole, rtol=0, atol=1e-14 * max(1.0, np.abs(whole).max()))


def test_one_kernel_serves_all_arms_with_the_same_joints() -> None:
    same = [ArmPoseTopology.of_links(arm("RPR", seed)) for seed in range(3)]
    assert len({topology.signature() for topology in same}) == 1
    assert same[0].signature() != ArmPoseTopology.of_links(arm("RRR")).signature()


def test_a_part_has_all_links_whichever_are_asked_for(
    agent: Agent, make_box: Callable[..., LiftedObject], monkeypatch: pytest.MonkeyPatch, rng: np.random.Generator
) -> None:
    monkeypatch.setenv("CC", "")
    (part,) = pose_parts([agent], make_box(np.eye(3)), [(2, 4), ()])
    assert part.joints == (1, 2, 3, 4)
    q = rng.normal(size=4)
    first = part.first_output(4)
    pose = part.kernel.value(q, np.r_[1.0, part.topology.parameters]).full().ravel()[first : first + 12]
    np.testing.assert_allclose(pose, link_poses(agent, (4,), q[None])[0][0], rtol=0, atol=1e-14)
