"""Oracle of every test here: Pinocchio in double precision at random states; worst relative error 1e-12."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import liftopt.pinocchio_casadi as cpin

TOLERANCE = 1e-12
SAMPLES = 4
REFERENCE_FRAMES = (cpin.WORLD, cpin.LOCAL, cpin.LOCAL_WORLD_ALIGNED)
Array = np.ndarray


@dataclass(frozen=True)
class State:
    """A configuration, velocity, acceleration and (6, njoints) forces on the joints in their local frames."""

    q: Any
    v: Any
    a: Any
    forces: Any


def symbols(model: pin.Model) -> State:
    return State(
        ca.SX.sym("q", model.nq), ca.SX.sym("v", model.nv), ca.SX.sym("a", model.nv), ca.SX.sym("f", 6, model.njoints)
    )


def random_state(model: pin.Model, rng: np.random.Generator) -> State:
    pin.seed(int(rng.integers(2**31)))
    q = pin.randomConfiguration(model, np.full(model.nq, -2.0), np.full(model.nq, 2.0))
    return State(q, rng.normal(size=model.nv), rng.normal(size=model.nv), rng.normal(size=(6, model.njoints)))


def relative_error(found: Array, expected: Array) -> float:
    assert found.size == expected.size
    found = found.reshape(expected.shape)
    return float(np.max(np.abs(found - expected), initial=0.0) / max(np.max(np.abs(expected), initial=0.0), 1e-3))


def compare(
    model: pin.Model,
    symbolic: Callable[[Any, State], list[Any]],
    numeric: Callable[[pin.Model, State], list[Array]],
) -> None:
    """Compare the outputs of one algorithm on both sides at random states."""
    state = symbols(model)
    function = ca.Function("f", list(vars(state).values()), symbolic(cpin.Model(model), state))
    rng = np.random.default_rng(1)
    for _ in range(SAMPLES):
        sample = random_state(model, rng)
        found = function.call(list(vars(sample).values()))
        errors = [relative_error(np.array(x), y) for x, y in zip(found, numeric(model, sample), strict=True)]
        assert max(errors) < TOLERANCE, errors


def force_list(forces: Array) -> pin.StdVec_Force:
    fext = pin.StdVec_Force()
    for column in forces.T:
        fext.append(pin.Force(column))
    return fext


def symbolic_forces(forces: Any) -> Any:
    fext = cpin.StdVec_Force()
    for joint in range(forces.shape[1]):
        fext.append(cpin.Force(forces[:, joint]))
    return fext


def derivatives(model: pin.Model, state: State, *fext: pin.StdVec_Force) -> list[Array]:
    # Pinocchio returns views of its data here, which must outlive them.
    data = model.createData()
    return [x.copy() for x in pin.computeRNEADerivatives(model, data, state.q, state.v, state.a, *fext)]


def test_rnea(pin_model: pin.Model) -> None:
    compare(
        pin_model,
        lambda m, s: [cpin.rnea(m, m.createData(), s.q, s.v, s.a)],
        lambda m, s: [pin.rnea(m, m.createData(), s.q, s.v, s.a)],
    )


def test_rnea_with_external_forces(pin_model: pin.Model) -> None:
    compare(
        pin_model,
        lambda m, s: [cpin.rnea(m, m.createData(), s.q, s.v, s.a, symbolic_forces(s.forces))],
        lambda m, s: [pin.rnea(m, m.createData(), s.q, s.v, s.a, force_list(s.forces))],
    )


def test_rnea_derivatives(pin_model: pin.Model) -> None:
    compare(
        pin_model,
        lambda m, s: list(cpin.computeRNEADerivatives(m, m.createData(), s.q, s.v, s.a)),
        derivatives,
    )


def test_rnea_derivatives_with_external_forces(pin_model: pin.Model) -> None:
    compare(
        pin_model,
        lambda m, s: list(cpin.computeRNEADerivatives(m, m.createData(), s.q, s.v, s.a, symbolic_forces(s.forces))),
        lambda m, s: derivatives(m, s, force_list(s.forces)),
    )


@pytest.mark.parametrize("convention", [cpin.Convention.LOCAL, cpin.Convention.WORLD])
def test_crba(pin_model: pin.Model, convention: Any) -> None:
    compare(
        pin_model,
        lambda m, s: [cpin.crba(m, m.createData(), s.q, convention)],
        lambda m, s: [pin.crba(m, m.createData(), s.q, convention)],
    )


def test_placements_of_all_joints_and_frames(pin_model: pin.Model) -> None:
    def placements(module: Any, model: Any, state: State) -> list[Any]:
        data = model.createData()
        module.forwardKinematics(model, data, state.q)
        module.updateFramePlacements(model, data)
        return [M.homogeneous for M in (*data.oMi, *data.oMf)]

    compare(pin_model, lambda m, s: placements(cpin, m, s), lambda m, s: placements(pin, m, s))


def test_placement_by_each_way_to_it(pin_model: pin.Model) -> None:
    def placements(module: Any, model: Any, state: State) -> list[Any]:
        data, last = model.createData(), model.nframes - 1
        module.framesForwardKinematics(model, data, state.q)
        one = model.createData()
        module.forwardKinematics(model, one, state.q)
        M = module.updateFramePlacement(model, one, last)
        return [data.oMf[last].homogeneous, M.rotation, M.translation]

    compare(pin_model, lambda m, s: placements(cpin, m, s), lambda m, s: placements(pin, m, s))


@pytest.mark.parametrize("reference_frame", REFERENCE_FRAMES)
def test_velocities_and_accelerations(pin_model: pin.Model, reference_frame: Any) -> None:
    def motions(module: Any, model: Any, state: State) -> list[Any]:
        data, last, placement = model.createData(), model.nframes - 1, module.SE3.Identity()
        placement.translation = np.array([0.1, -0.2, 0.3])
        joint = model.njoints - 1
        module.forwardKinematics(model, data, state.q, state.v, state.a)
        found = [
            module.getVelocity(model, data, joint, reference_frame),
            module.getAcceleration(model, data, joint, reference_frame),
        ]
        for get in (module.getFrameVelocity, module.getFrameAcceleration, module.getFrameClassicalAcceleration):
            found.append(get(model, data, last, reference_frame))
            found.append(get(model, data, joint, placement, reference_frame))
        return [motion.vector for motion in found] + [data.v[joint].linear, data.a[joint].angular]

    compare(pin_model, lambda m, s: motions(cpin, m, s), lambda m, s: motions(pin, m, s))


@pytest.mark.parametrize("reference_frame", REFERENCE_FRAMES)
def test_jacobians(pin_model: pin.Model, reference_frame: Any) -> None:
    def jacobians(module: Any, model: Any, state: State) -> list[Any]:
        data, last, joint, placement = model.createData(), model.nframes - 1, model.njoints - 1, module.SE3.Identity()
        placement.translation = np.array([0.1, -0.2, 0.3])
        found = [module.computeJointJacobians(model, data, state.q)]
        module.updateFramePlacements(model, data)
        found.append(module.getJointJacobian(model, data, joint, reference_frame))
        found.append(module.getFrameJacobian(model, data, last, reference_frame))
        found.append(module.getFrameJacobian(model, data, joint, placement, reference_frame))
        found.append(module.computeFrameJacobian(model, model.createData(), state.q, last, reference_frame))
        found.append(module.computeFrameJacobian(model, model.createData(), state.q, last))
        other = model.createData()
        module.forwardKinematics(model, other, state.q)
        found.append(module.computeJointJacobians(model, other))
        return [np.array(x) if module is pin else x for x in found]

    compare(pin_model, lambda m, s: jacobians(cpin, m, s), lambda m, s: jacobians(pin, m, s))
