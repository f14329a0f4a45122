"""Wrong arguments raise an error that names them, and nothing dangles. Oracle: the documented exception."""

from __future__ import annotations

import gc
from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import liftopt.pinocchio_casadi as cpin


@pytest.fixture
def model(tree: pin.Model) -> Any:
    return cpin.Model(tree)


def _zeros(model: Any) -> tuple[ca.SX, ca.SX, ca.SX]:
    return ca.SX.zeros(model.nq), ca.SX.zeros(model.nv), ca.SX.zeros(model.nv)


@pytest.mark.parametrize(("position", "name"), [(0, "q"), (1, "v"), (2, "a")])
@pytest.mark.parametrize("algorithm", ["rnea", "computeRNEADerivatives", "forwardKinematics"])
def test_a_vector_of_wrong_size_is_named_with_the_expected_size(
    model: Any, algorithm: str, position: int, name: str
) -> None:
    arguments = list(_zeros(model))
    expected = arguments[position].numel()
    arguments[position] = ca.SX.zeros(expected + 1)
    with pytest.raises(ValueError, match=f"^{name}: expected {expected} entries, got {expected + 1} x 1"):
        getattr(cpin, algorithm)(model, model.createData(), *arguments)


def test_a_matrix_is_no_vector(model: Any) -> None:
    q, _, a = _zeros(model)
    with pytest.raises(ValueError, match=r"^v: expected"):
        cpin.rnea(model, model.createData(), q, ca.SX.zeros(2, model.nv // 2), a)


def test_a_row_vector_and_numbers_are_taken(model: Any) -> None:
    q, v, a = _zeros(model)
    rows = cpin.rnea(model, model.createData(), q.T, v.T, a.T)
    numbers = cpin.rnea(model, model.createData(), np.zeros(model.nq), np.zeros(model.nv), [0] * model.nv)
    assert ca.is_equal(ca.DM(rows), ca.DM(numbers))


def test_an_mx_is_refused(model: Any) -> None:
    _, v, a = _zeros(model)
    with pytest.raises(TypeError, match=r"casadi\.SX"):
        cpin.rnea(model, model.createData(), ca.MX.sym("q", model.nq), v, a)


def test_the_number_of_forces_is_checked(model: Any) -> None:
    forces = [cpin.Force.Zero()] * (model.njoints - 1)
    with pytest.raises(ValueError, match=f"fext: expected {model.njoints} forces.*got {model.njoints - 1}"):
        cpin.rnea(model, model.createData(), *_zeros(model), forces)


def test_the_type_of_forces_is_checked(model: Any) -> None:
    with pytest.raises(TypeError, match=r"fext: expected .*Force.*got <class 'int'>"):
        cpin.rnea(model, model.createData(), *_zeros(model), [0] * model.njoints)


def test_a_data_of_another_model_is_refused(model: Any) -> None:
    other = pin.Model()
    other.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "hinge")
    for algorithm, arguments in (
        (cpin.rnea, _zeros(model)),
        (cpin.computeRNEADerivatives, _zeros(model)),
        (cpin.forwardKinematics, _zeros(model)),
        (cpin.updateFramePlacements, ()),
        (cpin.computeJointJacobians, ()),
        (cpin.getFrameVelocity, (0,)),
        (cpin.crba, _zeros(model)[:1]),
    ):
        with pytest.raises(ValueError, match="data: created for another model"):
            algorithm(model, cpin.Model(other).createData(), *arguments)


@pytest.mark.parametrize("index", [-1, 10_000])
def test_frame_and_joint_indices_are_checked(model: Any, index: int) -> None:
    data, q = model.createData(), ca.SX.zeros(model.nq)
    identity = cpin.SE3.Identity()
    for call in (
        lambda: cpin.updateFramePlacement(model, data, index),
        lambda: cpin.getFrameVelocity(model, data, index),
        lambda: cpin.getFrameVelocity(model, data, index, identity),
        lambda: cpin.getVelocity(model, data, index),
        lambda: cpin.getFrameJacobian(model, data, index, cpin.LOCAL),
        lambda: cpin.getFrameJacobian(model, data, index, identity, cpin.LOCAL),
        lambda: cpin.getJointJacobian(model, data, index, cpin.LOCAL),
        lambda: cpin.computeFrameJacobian(model, data, q, index),
    ):
        with pytest.raises(IndexError, match=f"_id: expected 0 to .*, got {index}"):
            call()


def test_an_unknown_reference_frame_is_refused(model: Any) -> None:
    with pytest.raises(ValueError, match="reference_frame"):
        cpin.getFrameVelocity(model, model.createData(), 0, 7)


def test_sequences_check_their_index_and_count_from_the_end(model: Any) -> None:
    data = model.createData()
    for items in (model.inertias, model.jointPlacements, model.frames, data.oMi, data.oMf, data.v):
        for index in (len(items), -len(items) - 1):
            with pytest.raises(IndexError):
                items[index]
            if items is not model.frames:
                with pytest.raises(IndexError):
                    items[index] = items[0]
        assert items[-1] is items[len(items) - 1]
        assert len(list(items)) == len(items.tolist()) == len(items)


def test_a_frame_cannot_be_moved_to_a_joint_that_does_not_exist(model: Any) -> None:
    stray = cpin.Frame("stray", 99, 0, cpin.SE3.Identity(), cpin.OP_FRAME)
    with pytest.raises(TypeError):
        model.frames[1] = stray
    with pytest.raises(AttributeError):
        model.frames[1].parentJoint = 99


def test_a_data_outlives_its_model(tree: pin.Model) -> None:
    model = cpin.Model(tree)
    data, twin = model.createData(), cpin.Model(tree)
    del model
    gc.collect()
    q, v, a = _zeros(twin)
    found = cpin.rnea(twin, data, q, v, a)
    assert ca.is_equal(ca.DM(found), ca.DM(cpin.rnea(twin, twin.createData(), q, v, a)))


def test_items_outlive_the_names_of_their_owners(tree: pin.Model) -> None:
    expected = tree.jointPlacements[1].translation
    model = cpin.Model(tree)
    frames, placement, frame_placement = model.frames, model.jointPlacements[1], model.frames[1].placement
    items = iter(model.inertias)
    data = model.createData()
    cpin.framesForwardKinematics(model, data, ca.SX.sym("q", model.nq))
    last, oMf = data.oMf[model.nframes - 1], data.oMf
    shape = (4, 4)
    del model, data
    gc.collect()
    filler = [cpin.Model(tree) for _ in range(20)]
    assert np.array_equal(np.array(ca.DM(placement.translation))[:, 0], expected)
    assert [frame.name for frame in frames] == [frame.name for frame in tree.frames]
    assert len(list(items)) == tree.njoints
    assert last.homogeneous.shape == oMf[0].homogeneous.shape == frame_placement.homogeneous.shape == shape
    assert len(filler) == 20


def test_results_are_copies(model: Any) -> None:
    data = model.createData()
    q = ca.SX.sym("q", model.nq)
    _, v, a = _zeros(model)
    tau = cpin.rnea(model, data, q, v, a)
    tau[0] = 0
    assert not ca.is_equal(tau, data.tau)
