"""Moco on one lift, in a process without liftopt's libraries: ``python moco_child.py LIFT ANSWER``."""

from __future__ import annotations

import json
import os
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import opensim as osim
from scipy.spatial.transform import Rotation

# The paper's lift's objective is then of order 1, as Moco advises; with ten times as much it takes a fifth more
# iterations, with a hundred times as much two fifths.
OBJECTIVE_SCALING = 0.001
LIGHTEST = 1e-6  # [kg], [kg m^2]


def lift_model(lift: dict[str, Any]) -> Any:
    """Return the model: every agent a chain of pin joints with torque actuators, held to the object at points."""
    model = osim.Model()
    model.setGravity(_vec3(lift["gravity"]))
    lifted = _object(model, lift["object"])
    for agent, grasp in zip(lift["agents"], lift["object"]["grasps"], strict=True):
        hand = _chain(model, agent)
        constraint = osim.PointConstraint(hand, _vec3(agent["grasp"]), lifted, _vec3(grasp))
        constraint.setName(f"grasp_{agent['name']}")
        model.addConstraint(constraint)
    model.finalizeConnections()
    return model


def solve(lift: dict[str, Any]) -> dict[str, Any]:
    """Solve with MocoCasADiSolver: Hermite-Simpson, implicit dynamics, Posa's method, forward differences, IPOPT."""
    study = osim.MocoStudy()
    problem = study.updProblem()
    problem.setModelAsCopy(lift_model(lift))
    problem.setTimeBounds(0.0, lift["duration"])
    effort = osim.MocoControlGoal("effort", OBJECTIVE_SCALING)
    states, controls = {}, {}
    for agent in lift["agents"]:
        for joint in agent["joints"]:
            path, control = f"/jointset/{joint['name']}_joint/{joint['name']}", f"/forceset/tau_{joint['name']}"
            states[path], controls[control] = joint, joint
            _state(problem, path, joint, [None, None])
            effort.setWeightForControl(control, lift["weights"][agent["name"]])
    name = lift["object"]["name"]
    for coordinate in lift["object"]["coordinates"]:
        path = f"/jointset/{name}_joint/{name}_{coordinate['name']}"
        states[path] = coordinate | {"name": f"{name}_{coordinate['name']}"}
        _state(problem, path, coordinate, coordinate["ends"])
    problem.addGoal(effort)
    solver = study.initCasADiSolver()
    _set_up(solver, lift)
    if lift["guess"] == "ours":
        solver.setGuess(_guess(solver, states, controls))
    else:
        solver.setGuess("bounds")
    began, busy = time.perf_counter(), time.process_time()
    solution = study.solve()
    seconds, cpu, good = time.perf_counter() - began, time.process_time() - busy, bool(solution.success())
    solution.unseal()
    terms = {term: solution.getObjectiveTerm(term) / OBJECTIVE_SCALING for term in solution.getObjectiveTermNames()}
    return {
        "seconds": seconds,
        "cpu_ms": 1e3 * cpu,
        "threads": os.cpu_count(),
        "success": good,
        "status": ("" if good else "not converged: ") + str(solution.getStatus()),
        "iterations": int(solution.getNumIterations()),
        "objective": float(solution.getObjective()) / OBJECTIVE_SCALING,
        "terms": terms,
        "time": solution.getTime().to_numpy().tolist(),
        "q": {state["name"]: _column(solution.getState(f"{path}/value")) for path, state in states.items()},
        "v": {state["name"]: _column(solution.getState(f"{path}/speed")) for path, state in states.items()},
        "a": {state["name"]: _column(solution.getDerivative(f"{path}/accel")) for path, state in states.items()},
        "torques": {joint["name"]: _column(solution.getControl(path)) for path, joint in controls.items()},
    }


def _set_up(solver: Any, lift: dict[str, Any]) -> None:
    """Choose what suits the lift best, and give the weights on accelerations and grasp forces their place."""
    solver.set_num_mesh_intervals(lift["intervals"])
    solver.set_multibody_dynamics_mode("implicit")
    solver.set_kinematic_constraint_method("Posa2016")
    solver.set_optim_finite_difference_scheme("forward")
    solver.set_optim_convergence_tolerance(lift["tolerance"])
    solver.set_optim_constraint_tolerance(lift["tolerance"])
    solver.set_minimize_implicit_multibody_accelerations(True)
    solver.set_implicit_multibody_accelerations_weight(OBJECTIVE_SCALING * lift["weights"]["acceleration"])
    # The multipliers of a point constraint are the components of its force.
    solver.set_minimize_lagrange_multipliers(True)
    solver.set_lagrange_multiplier_weight(OBJECTIVE_SCALING * lift["weights"]["force"])
    solver.set_parallel(1)  # all cores


def _column(values: Any) -> list[float]:
    column: list[float] = values.to_numpy().tolist()
    return column


def _state(problem: Any, path: str, state: dict[str, Any], ends: list[float | None]) -> None:
    """Bound a coordinate and its speed; at rest at both ends, and where ``ends`` says."""
    initial, final = (
        kind() if value is None else kind(value)
        for kind, value in zip((osim.MocoInitialBounds, osim.MocoFinalBounds), ends, strict=True)
    )
    problem.setStateInfo(f"{path}/value", osim.MocoBounds(*state["range"]), initial, final)
    speed = osim.MocoBounds(-state["speed"], state["speed"])
    problem.setStateInfo(f"{path}/speed", speed, osim.MocoInitialBounds(0.0), osim.MocoFinalBounds(0.0))


def _guess(solver: Any, states: dict[str, dict[str, Any]], controls: dict[str, dict[str, Any]]) -> Any:
    guess = solver.createGuess("bounds")
    guess.resampleWithNumTimes(len(next(iter(states.values()))["q"]))
    for path, state in states.items():
        guess.setState(f"{path}/value", _vector(state["q"]))
        guess.setState(f"{path}/speed", _vector(state["v"]))
        guess.setDerivative(f"{path}/accel", _vector(state["a"]))
    for path, joint in controls.items():
        guess.setControl(path, _vector(joint["tau"]))
    return guess


def _vector(values: list[float]) -> Any:
    return osim.Vector.createFromMat(np.array(values))


def _chain(model: Any, agent: dict[str, Any]) -> Any:
    """Add an agent; return the body of its hand."""
    bodies = [model.getGround()]
    for joint in agent["joints"]:
        name = joint["name"]
        body = _body(f"{name}_body", joint["body"])
        # A pin joint turns about z: a rotation that takes z to the axis stands on both of its sides.
        turn = Rotation.align_vectors([joint["axis"]], [[0.0, 0.0, 1.0]])[0]
        before = _angles(Rotation.from_matrix(joint["rotation"]) * turn)
        pin = osim.PinJoint(
            f"{name}_joint",
            bodies[joint["parent"]],
            _vec3(joint["translation"]),
            before,
            body,
            osim.Vec3(0),
            _angles(turn),
        )
        pin.updCoordinate().setName(name)
        model.addBody(body)
        model.addJoint(pin)
        bodies.append(body)
        actuator = osim.CoordinateActuator(name)
        actuator.setName(f"tau_{name}")
        actuator.setOptimalForce(1.0)
        actuator.setMinControl(joint["torque"][0])
        actuator.setMaxControl(joint["torque"][1])
        model.addForce(actuator)
    return bodies[agent["hand"]]


def _object(model: Any, lifted: dict[str, Any]) -> Any:
    """Add the object: three translations, then pitch and yaw about its own axes; no roll."""
    body = _body(lifted["name"], lifted["body"])
    transform = osim.SpatialTransform()
    axes = {"pitch": transform.upd_rotation2(), "yaw": transform.upd_rotation3()}
    axes |= {"x": transform.upd_translation1(), "y": transform.upd_translation2(), "z": transform.upd_translation3()}
    for name, axis in axes.items():
        names = osim.ArrayStr()
        names.append(f"{lifted['name']}_{name}")
        axis.setCoordinateNames(names)
        axis.set_function(osim.LinearFunction(1.0, 0.0))
    transform.upd_rotation1().set_function(osim.Constant(0.0))
    zero = osim.Vec3(0)
    joint = osim.CustomJoint(f"{lifted['name']}_joint", model.getGround(), zero, zero, body, zero, zero, transform)
    model.addBody(body)
    model.addJoint(joint)
    return body


def _body(name: str, body: dict[str, Any]) -> Any:
    """Return a body; Simbody takes no massless one between the joints of a ball, so that these weigh a milligram."""
    moments = body["moments"] if body["mass"] > LIGHTEST else [LIGHTEST] * 3 + [0.0] * 3
    return osim.Body(name, max(body["mass"], LIGHTEST), _vec3(body["centre"]), osim.Inertia(*moments))


def _angles(rotation: Rotation) -> Any:
    """Return OpenSim's angles of a rotation: body-fixed x, y, z."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # at a right angle about y the third is chosen: so be it
        return _vec3(rotation.as_euler("XYZ"))


def _vec3(values: Any) -> Any:
    return osim.Vec3(*(float(value) for value in values))


if __name__ == "__main__":
    answer = solve(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
    Path(sys.argv[2]).write_text(json.dumps(answer), encoding="utf-8")
