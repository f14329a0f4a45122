"""One function for every subject, tool and table: masses, centres, inertias and placements as symbols.

Oracle: Pinocchio in double precision on models with those numbers put in; worst relative error 1e-12.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pinocchio as pin

import liftopt.pinocchio_casadi as cpin


def _symmetric(six: ca.SX) -> ca.SX:
    return ca.vertcat(
        ca.horzcat(six[0], six[1], six[3]), ca.horzcat(six[1], six[2], six[4]), ca.horzcat(six[3], six[4], six[5])
    )


def _symbolic_function(model: pin.Model) -> ca.Function:
    """Return the function of a state and of all parameters of ``model`` to torques, derivatives and a frame."""
    symbolic, last, parameters = cpin.Model(model), model.nframes - 1, []
    for joint in range(1, model.njoints):
        mass, lever, six = ca.SX.sym("m"), ca.SX.sym("c", 3), ca.SX.sym("I", 6)
        rotation, translation = ca.SX.sym("R", 3, 3), ca.SX.sym("p", 3)
        symbolic.inertias[joint] = cpin.Inertia(mass, lever, _symmetric(six))
        symbolic.jointPlacements[joint] = cpin.SE3(rotation, translation)
        parameters += [mass, lever, six, rotation, translation]
    grasp, armature, gravity = ca.SX.sym("grasp", 3), ca.SX.sym("armature", model.nv), ca.SX.sym("g", 3)
    symbolic.frames[last].placement.translation = grasp
    symbolic.armature = armature
    symbolic.gravity.linear = gravity
    parameters += [grasp, armature, gravity]

    q, v, a = (ca.SX.sym(name, n) for name, n in (("q", model.nq), ("v", model.nv), ("a", model.nv)))
    tau = cpin.rnea(symbolic, symbolic.createData(), q, v, a)
    derivatives = cpin.computeRNEADerivatives(symbolic, symbolic.createData(), q, v, a)
    data = symbolic.createData()
    cpin.framesForwardKinematics(symbolic, data, q)
    jacobian = cpin.computeFrameJacobian(symbolic, symbolic.createData(), q, last, cpin.LOCAL_WORLD_ALIGNED)
    M = data.oMf[last]
    return ca.Function("f", [q, v, a, *parameters], [tau, *derivatives, M.rotation, M.translation, jacobian])


def _randomise(model: pin.Model, rng: np.random.Generator) -> list[np.ndarray]:
    """Give ``model`` new random parameters and return them in the order of the symbolic function."""
    values = []
    for joint in range(1, model.njoints):
        square = rng.normal(size=(3, 3))
        inertia = pin.Inertia(rng.uniform(0.1, 5.0), rng.normal(size=3), square @ square.T + np.eye(3))
        placement = pin.exp6(rng.normal(size=6))
        model.inertias[joint], model.jointPlacements[joint] = inertia, placement
        I = inertia.inertia  # noqa: E741
        six = np.array([I[0, 0], I[0, 1], I[1, 1], I[0, 2], I[1, 2], I[2, 2]])
        values += [inertia.mass, inertia.lever, six, placement.rotation, placement.translation]
    grasp, gravity = rng.normal(size=3), rng.normal(size=3)
    model.frames[model.nframes - 1].placement.translation = grasp
    model.armature = rng.uniform(0.0, 1.0, model.nv)
    model.gravity = pin.Motion(gravity, np.zeros(3))
    return [*values, grasp, model.armature.copy(), gravity]


def test_one_function_serves_every_set_of_parameters(pin_model: pin.Model) -> None:
    function, model, last = _symbolic_function(pin_model), pin_model.copy(), pin_model.nframes - 1
    rng = np.random.default_rng(2)
    for _ in range(3):
        parameters = _randomise(model, rng)
        pin.seed(int(rng.integers(2**31)))
        q = pin.randomConfiguration(model, np.full(model.nq, -2.0), np.full(model.nq, 2.0))
        v, a = rng.normal(size=(2, model.nv))
        # Kept by name: what Pinocchio returns are views of its data.
        data, dynamics = model.createData(), model.createData()
        pin.framesForwardKinematics(model, data, q)
        expected = [
            pin.rnea(model, model.createData(), q, v, a),
            *pin.computeRNEADerivatives(model, dynamics, q, v, a),
            data.oMf[last].rotation,
            data.oMf[last].translation,
            pin.computeFrameJacobian(model, model.createData(), q, last, pin.LOCAL_WORLD_ALIGNED),
        ]
        for found, reference in zip(function(q, v, a, *parameters), expected, strict=True):
            error = np.max(np.abs(np.array(found).reshape(reference.shape) - reference))
            assert error < 1e-12 * max(np.max(np.abs(reference)), 1e-3)


def test_the_model_it_came_from_is_left_alone(tree: pin.Model) -> None:
    before = [inertia.copy() for inertia in tree.inertias]
    symbolic = cpin.Model(tree)
    symbolic.inertias[1].mass = ca.SX.sym("m")
    assert all(a == b for a, b in zip(before, tree.inertias, strict=True))


def test_a_copy_is_independent(tree: pin.Model) -> None:
    symbolic = cpin.Model(tree)
    for copy in (symbolic.copy(), cpin.Model(symbolic)):
        copy.inertias[1].mass = ca.SX.sym("m")
        assert symbolic.inertias[1].mass.is_constant()
        assert not copy.inertias[1].mass.is_constant()
