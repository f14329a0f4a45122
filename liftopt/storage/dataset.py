"""A solution as a dataset of xarray, with labels and units: what solution.nc holds."""

from __future__ import annotations

import json
import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
import xarray as xr

from liftopt.collocation.task import OBJECT_COORDINATES
from liftopt.solution.solution import Solution
from liftopt.storage.record import record
from liftopt.storage.result_folder import SCENARIO_TEXT, URDF_TEXT
from liftopt.types import Array

LIBRARIES = ("casadi", "pin", "numpy", "scipy", "h5netcdf")


# Dimensions, values and attributes, as xarray takes them.
Variable = tuple[tuple[str, ...], Array, dict[str, str]]


def to_xarray(solution: Solution) -> xr.Dataset:
    """Return a solution as the dataset that solution.nc holds: SI units, ``units`` and ``long_name`` on each variable.

    Dimensions: ``time``, ``<agent>_joint``, ``xyz``, ``quat`` (x y z w), ``twist`` (linear then angular), ``grasp``,
    ``pose``. The coordinate ``<agent>_joint_kind`` says which joints are prismatic; the variables along
    ``<agent>_joint`` have ``units_prismatic`` for those.
    """
    names = {
        name: ((name,), np.array(labels, dtype=object), {"units": "1", "long_name": f"names along {name}"})
        for name, labels in _labels(solution).items()
    }
    return xr.Dataset(_variables(solution), coords=names | _kinds(solution), attrs=_attributes(solution))


def _variable(dimensions: tuple[str, ...], values: Array, units: str, long_name: str) -> Variable:
    return dimensions, values, {"units": units, "long_name": long_name}


def _labels(solution: Solution) -> dict[str, tuple[str, ...]]:
    labels = {f"{agent.name}_joint": agent.joint_names for agent in solution.agents}
    return labels | {
        "xyz": ("x", "y", "z"),
        "quat": ("x", "y", "z", "w"),
        "twist": ("vx", "vy", "vz", "wx", "wy", "wz"),
        "grasp": tuple(grasp.name for agent in solution.agents for grasp in agent.grasps),
        "pose": OBJECT_COORDINATES,
    }


def _kinds(solution: Solution) -> dict[str, Variable]:
    """Return whether joints are revolute or prismatic, by which the units of what stands along them differ."""
    return {
        f"{agent.name}_joint_kind": _variable(
            (f"{agent.name}_joint",),
            np.where(agent.sliding, "prismatic", "revolute").astype(object),
            "1",
            f"kinds of the joints of {agent.name}; units_prismatic are those of prismatic ones",
        )
        for agent in solution.agents
    }


def _variables(solution: Solution) -> dict[str, Variable]:
    variables = {"time": _variable(("time",), solution.time, "s", "time of the knots")}
    for agent in solution.agents:
        dimensions = ("time", f"{agent.name}_joint")
        for kind, values, unit, of_prismatic, meaning in (
            ("q", agent.q, "rad", "m", "joint position (metres for prismatic joints)"),
            ("v", agent.v, "rad/s", "m/s", "joint velocity (m/s for prismatic joints)"),
            ("a", agent.a, "rad/s^2", "m/s^2", "joint acceleration (m/s^2 for prismatic joints)"),
            ("tau", agent.tau, "N m", "N", "joint torque (force in N for prismatic joints)"),
        ):
            variable = _variable(dimensions, values, unit, f"{agent.name} {meaning}")
            variable[2]["units_prismatic"] = of_prismatic
            variables[f"{agent.name}_{kind}"] = variable
    return variables | _of_object(solution) | _of_grasps(solution) | _of_ground(solution)


def _of_object(solution: Solution) -> dict[str, Variable]:
    lifted, name = solution.object, solution.object.name
    twist, pose = ("time", "twist"), ("time", "pose")
    body = f"of the {name}, world axes, at its centre of mass: linear then angular"
    second = "m/s^2, rad/s^2"
    return {
        f"{name}_position": _variable(
            ("time", "xyz"), lifted.pose[:, :3], "m", f"centre of mass of the {name} in the world"
        ),
        f"{name}_quaternion": _variable(
            ("time", "quat"), lifted.quaternion, "1", f"orientation of the {name} in the world"
        ),
        f"{name}_velocity": _variable(twist, lifted.velocity, "m/s, rad/s", f"velocity {body}"),
        f"{name}_acceleration": _variable(twist, lifted.acceleration, second, f"acceleration {body}"),
        f"{name}_pose": _variable(pose, lifted.pose, "m, rad", f"six coordinates of the {name}, R = Rx Ry Rz"),
        f"{name}_pose_velocity": _variable(pose, lifted.pose_velocity, "m/s, rad/s", "their first derivatives"),
        f"{name}_pose_acceleration": _variable(pose, lifted.pose_acceleration, second, "their second derivatives"),
    }


def _of_grasps(solution: Solution) -> dict[str, Variable]:
    lifted, dimensions = solution.object, ("time", "grasp", "xyz")
    force, moment = (
        np.concatenate([getattr(agent, name) for agent in solution.agents], axis=1)
        for name in ("grasp_force", "grasp_moment")
    )
    about = f"moment of each grasp on the {lifted.name} about its grasp point, world axes; 0 for a point grasp"
    return {
        "grasp_force": _variable(dimensions, force, "N", f"force of each grasp on the {lifted.name}, world axes"),
        "grasp_moment": _variable(dimensions, moment, "N m", about),
        "grasp_position": _variable(
            dimensions, lifted.grasp_position, "m", f"grasp points on the {lifted.name}, world"
        ),
    }


def _of_ground(solution: Solution) -> dict[str, Variable]:
    """Return the ground's reaction on every person, the first one's without a name in front."""
    variables, dimensions = {}, ("time", "xyz")
    for k, person in enumerate(solution.persons):
        prefix = f"{person.name}_" if k else ""
        force = f"force of the ground on the {person.name}, world axes"
        moment = f"moment of the ground on the {person.name} at the foot origin, world axes"
        variables[f"{prefix}ground_reaction_force"] = _variable(dimensions, person.ground_force, "N", force)
        variables[f"{prefix}ground_reaction_moment"] = _variable(dimensions, person.ground_moment, "N m", moment)
        if (pressure := person.centre_of_pressure) is not None:
            where = f"centre of pressure of the {person.name} on the floor, in the world"
            variables[f"{prefix}centre_of_pressure"] = _variable(dimensions, pressure, "m", where)
    return variables


def _attributes(solution: Solution) -> dict[str, Any]:
    versions = {"liftopt": _version("liftopt"), "python": platform.python_version()}
    versions |= {library: _version(library) for library in LIBRARIES}
    attributes: dict[str, Any] = {
        "title": f"liftopt: {solution.scenario.name}",
        "status": solution.status,
        "verified": int(solution.solved),
        "objective": solution.objective,
        "preset": solution.scenario.objective.preset,
        "iterations": solution.iterations,
        "intervals": solution.intervals,
        "max_violation": solution.verification.max_violation,
        "kkt_error": solution.verification.kkt_error,
        "versions": json.dumps(versions),
        "assessment": json.dumps(solution.assessment.plain(), allow_nan=False),
        "record": json.dumps(record(solution), allow_nan=False),
        SCENARIO_TEXT: solution.scenario.to_toml(),
    }
    attributes |= {f"{URDF_TEXT}{name}": text for name, text in solution.urdfs.items()}
    attributes |= {f"objective_{name}": value for name, value in solution.objective_terms.items()}
    if (accuracy := solution.accuracy) is not None:
        attributes |= {
            "closure_between_knots": accuracy.closure,
            "balance_between_knots": accuracy.balance,
            "torque_excess_between_knots": accuracy.torque_excess,
            "compression_excess_between_knots": accuracy.compression_excess,
            "objective_limit": accuracy.objective_limit,
            "objective_error": accuracy.objective_error,
            "objective_bar": accuracy.objective_bar,
        }
    return attributes | {f"{name}_seconds": value for name, value in solution.seconds.items()}


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:  # a source tree that was never installed
        return "0+unknown"
