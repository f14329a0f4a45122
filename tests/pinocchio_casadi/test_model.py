"""Conversion of a model. Oracle: the pinocchio.Model that it came from."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import liftopt.pinocchio_casadi as cpin
from liftopt.errors import ModelError


def test_joints_and_frames_keep_names_order_and_indices(pin_model: pin.Model) -> None:
    model = cpin.Model(pin_model)
    for attribute in ("nq", "nv", "njoints", "nframes", "name"):
        assert getattr(model, attribute) == getattr(pin_model, attribute)
    for attribute in ("names", "parents", "idx_qs", "nqs", "idx_vs", "nvs"):
        assert list(getattr(model, attribute)) == list(getattr(pin_model, attribute))
        assert type(getattr(model, attribute)) is type(getattr(pin_model, attribute))
    assert model.names[0] == "universe"
    for name in pin_model.names:
        assert model.getJointId(name) == pin_model.getJointId(name)
        assert model.existJointName(name)
    for frame, expected in zip(model.frames, pin_model.frames, strict=True):
        assert (frame.name, frame.parentJoint, frame.parentFrame, frame.type) == (
            expected.name,
            expected.parentJoint,
            expected.parentFrame,
            expected.type,
        )
        assert model.existFrame(frame.name)
        assert model.getFrameId(frame.name) == pin_model.getFrameId(frame.name)
        assert model.getFrameId(frame.name, frame.type) == pin_model.getFrameId(frame.name, frame.type)


def test_an_unknown_name_gives_the_count_as_upstream_does(tree: pin.Model) -> None:
    model = cpin.Model(tree)
    assert model.getFrameId("nowhere") == model.nframes
    assert model.getJointId("nowhere") == model.njoints
    assert not model.existFrame("nowhere")


def test_parameters_are_copied(pin_model: pin.Model) -> None:
    def numbers(x: ca.SX) -> np.ndarray:
        return np.array(ca.DM(x))

    model = cpin.Model(pin_model)
    for inertia, expected in zip(model.inertias, pin_model.inertias, strict=True):
        assert np.array_equal(numbers(inertia.mass), [[expected.mass]])
        assert np.array_equal(numbers(inertia.lever)[:, 0], expected.lever)
        assert np.array_equal(numbers(inertia.inertia), expected.inertia)
    for placement, reference in zip(model.jointPlacements, pin_model.jointPlacements, strict=True):
        assert np.array_equal(numbers(placement.homogeneous), reference.homogeneous)
    assert np.array_equal(numbers(model.armature)[:, 0], pin_model.armature)
    assert np.array_equal(numbers(model.gravity.vector)[:, 0], pin_model.gravity.vector)


def test_an_unsupported_joint_is_refused_by_name(kinova: pin.Model) -> None:
    continuous = next(name for name, joint in zip(kinova.names, kinova.joints, strict=True) if joint.nq == 2)
    with pytest.raises(ModelError, match=f"{continuous}.*JointModelRUBZ.*supported are .*JointModelRZ"):
        cpin.Model(kinova)


@pytest.mark.parametrize("joint", [pin.JointModelPlanar(), pin.JointModelComposite(pin.JointModelRX())])
def test_planar_and_composite_joints_are_refused(joint: pin.JointModel) -> None:
    model = pin.Model()
    model.addJoint(0, joint, pin.SE3.Identity(), "odd_one")
    with pytest.raises(ModelError, match=f"odd_one.*{joint.shortname()}"):
        cpin.Model(model)


def test_a_model_of_something_else_is_refused() -> None:
    with pytest.raises(TypeError, match=r"expected a pinocchio\.Model, got str"):
        cpin.Model("human.urdf")
