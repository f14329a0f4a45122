"""A solution written to disk: solution.nc (NetCDF-4), scenario.toml and models/*.urdf, whole or not at all."""

from __future__ import annotations

import errno
import json
import os
import platform
from dataclasses import asdict
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

import liftopt
from liftopt.collocation.task import OBJECT_COORDINATES
from liftopt.errors import InputError
from liftopt.files.checksum import sealed
from liftopt.solution.accuracy import Accuracy
from liftopt.solution.solution import Solution
from liftopt.storage.netcdf_file import read_netcdf
from liftopt.storage.result_folder import MODELS, NETCDF, SCENARIO, UNSOLVED, locked, replace_result, standing_result

LIBRARIES = ("casadi", "pin", "numpy", "scipy", "h5netcdf")
Variable = tuple[tuple[str, ...], Any, str, str]


def save(solution: Solution, out: Path) -> Path:
    """Write a solution into the folder ``out``: all files or none, each whole; see ``result_folder``.

    What is no solution never replaces one: if there is one in ``out``, it goes to ``out/unsolved``.

    Returns:
        The folder that it was written to.

    Raises:
        InputError: the folder or a file cannot be written.
    """
    files = {f"{MODELS}/{name}": text.encode() for name, text in solution.urdfs.items()}
    files |= {SCENARIO: solution.scenario.to_toml().encode(), NETCDF: sealed(_netcdf(solution))}
    try:
        out.mkdir(parents=True, exist_ok=True)
        with locked(out, to_write=True):
            if solution.solved or not holds_more_than_an_iterate(out):
                replace_result(out, files)
                return out
            aside = out / UNSOLVED
            if aside.is_symlink():
                raise OSError(errno.ENOTDIR, f"{aside} is a link, and what is written there would be elsewhere")
            aside.mkdir(exist_ok=True)
            with locked(aside, to_write=True):
                replace_result(aside, files)
            return aside
    except OSError as error:
        raise InputError("--out", str(out), f"cannot be written: {error.strerror or error}") from error


def holds_more_than_an_iterate(folder: Path) -> bool:
    """Return whether a folder holds a result that is not certainly one of a solve that failed."""
    file = standing_result(folder) / NETCDF
    if not os.path.lexists(file):
        return False
    try:
        return bool(read_netcdf(file)[1]["verified"] != 0)
    except (InputError, OSError, LookupError, ValueError, TypeError):  # whatever it is, it may be worth something
        return True


def _netcdf(solution: Solution) -> bytes:
    import h5netcdf
    import h5py

    content = BytesIO()
    with h5netcdf.File(content, "w") as file:
        for name, labels in _coordinates(solution).items():
            file.dimensions[name] = len(labels)
            text = file.create_variable(name, (name,), dtype=h5py.string_dtype())
            text[:] = np.array(labels, dtype=object)
            text.attrs["units"] = "1"
            text.attrs["long_name"] = f"names along {name}"
        file.dimensions["time"] = len(solution.time)
        for name, (dimensions, values, unit, meaning) in _variables(solution).items():
            variable = file.create_variable(name, dimensions, data=np.asarray(values, dtype=float))
            variable.attrs["units"] = unit
            variable.attrs["long_name"] = meaning
        for key, value in _attributes(solution).items():
            file.attrs[key] = value
    return content.getvalue()


def _coordinates(solution: Solution) -> dict[str, tuple[str, ...]]:
    coordinates = {f"{agent.name}_joint": agent.joint_names for agent in solution.agents}
    return coordinates | {
        "xyz": ("x", "y", "z"),
        "quat": ("x", "y", "z", "w"),
        "twist": ("vx", "vy", "vz", "wx", "wy", "wz"),
        "grasp": tuple(agent.name for agent in solution.agents),
        "pose": OBJECT_COORDINATES,
    }


def _variables(solution: Solution) -> dict[str, Variable]:
    held, name = solution.object, solution.object.name
    variables: dict[str, Variable] = {"time": (("time",), solution.time, "s", "time of the knots")}
    for agent in solution.agents:
        dimensions = ("time", f"{agent.name}_joint")
        for kind, values, unit, meaning in (
            ("q", agent.q, "rad", "joint position (metres for the prismatic GT joints)"),
            ("v", agent.v, "rad/s", "joint velocity (m/s for the prismatic GT joints)"),
            ("a", agent.a, "rad/s^2", "joint acceleration (m/s^2 for the prismatic GT joints)"),
            ("tau", agent.tau, "N m", "joint torque (force in N for the prismatic GT joints)"),
        ):
            variables[f"{agent.name}_{kind}"] = (dimensions, values, unit, f"{agent.name} {meaning}")
    force, moment = (
        np.stack([getattr(agent, name) for agent in solution.agents], axis=1)
        for name in ("grasp_force", "grasp_moment")
    )
    body = f"of the {name}, world axes, at its centre of mass: linear then angular"
    return variables | {
        f"{name}_position": (("time", "xyz"), held.pose[:, :3], "m", f"centre of mass of the {name} in the world"),
        f"{name}_quaternion": (("time", "quat"), held.quaternion, "1", f"orientation of the {name} in the world"),
        f"{name}_velocity": (("time", "twist"), held.velocity, "m/s, rad/s", f"velocity {body}"),
        f"{name}_acceleration": (("time", "twist"), held.acceleration, "m/s^2, rad/s^2", f"acceleration {body}"),
        f"{name}_pose": (("time", "pose"), held.pose, "m, rad", f"six coordinates of the {name}, R = Rx Ry Rz"),
        f"{name}_pose_velocity": (("time", "pose"), held.pose_velocity, "m/s, rad/s", "their first derivatives"),
        f"{name}_pose_acceleration": (
            ("time", "pose"), held.pose_acceleration, "m/s^2, rad/s^2", "their second derivatives",
        ),
        "grasp_force": (("time", "grasp", "xyz"), force, "N", f"force of each agent on the {name}, world axes"),
        "grasp_moment": (
            ("time", "grasp", "xyz"), moment, "N m",
            f"moment of each agent on the {name} about its grasp point, world axes; 0 for a point grasp",
        ),
        "grasp_position": (("time", "grasp", "xyz"), held.grasp_position, "m", f"grasp points on the {name}, world"),
        "ground_reaction_force": (
            ("time", "xyz"), solution.ground_reaction_force, "N", "force of the ground on the human, world axes"
        ),
        "ground_reaction_moment": (
            ("time", "xyz"), solution.ground_reaction_moment, "N m",
            "moment of the ground on the human at the foot origin, world axes",
        ),
    }  # fmt: skip


def record(solution: Solution) -> dict[str, Any]:
    """Return what is neither trajectory nor scenario, ready for JSON: how it was found and verified."""
    return {
        "outcome": solution.outcome,
        "objective_weights": solution.objective_weights,
        "seconds": solution.seconds,
        "starts": [asdict(start) | {"objective": _finite(start.objective)} for start in solution.starts],
        "kept_start": solution.kept_start,
        # JSON knows no infinity: a check that is only reported has no limit.
        "checks": [
            asdict(check) | {"value": _finite(check.value), "limit": _finite(check.limit)}
            for check in solution.verification.checks
        ],
        "kkt_tolerance": solution.verification.kkt_tolerance,
        "notes": solution.notes,
        "accuracy": None if solution.accuracy is None else accuracy_record(solution.accuracy),
        "reasons": [asdict(reason) | {"amount": _finite(reason.amount)} for reason in solution.reasons],
        "remedies": [asdict(change) for change in solution.suggested_changes],
    }


def accuracy_record(accuracy: Accuracy) -> dict[str, Any]:
    """Return an accuracy ready for JSON; what could not be estimated is None."""
    return {key: _finite(value) if isinstance(value, float) else value for key, value in asdict(accuracy).items()}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _attributes(solution: Solution) -> dict[str, Any]:
    versions = {"liftopt": liftopt.__version__, "python": platform.python_version()}
    versions |= {library: version(library) for library in LIBRARIES}
    attributes: dict[str, Any] = {
        "title": f"liftopt: {solution.scenario.name}",
        "status": solution.status,
        "verified": int(solution.solved),
        "objective": solution.objective,
        "iterations": solution.iterations,
        "intervals": solution.intervals,
        "max_violation": solution.verification.max_violation,
        "kkt_error": solution.verification.kkt_error,
        "versions": json.dumps(versions),
        "assessment": json.dumps(solution.assessment.plain(), allow_nan=False),
        "record": json.dumps(record(solution), allow_nan=False),
    }
    attributes |= {f"objective_{name}": value for name, value in solution.objective_terms.items()}
    if (accuracy := solution.accuracy) is not None:
        attributes |= {
            "closure_between_knots": accuracy.closure,
            "balance_between_knots": accuracy.balance,
            "torque_excess_between_knots": accuracy.torque_excess,
            "objective_limit": accuracy.objective_limit,
            "objective_error": accuracy.objective_error,
            "objective_bar": accuracy.objective_bar,
        }
    return attributes | {f"{name}_seconds": value for name, value in solution.seconds.items()}
