"""A solution written to disk: solution.nc (NetCDF-4), scenario.toml and models/*.urdf, whole or not at all."""

from __future__ import annotations

import json
import os
import platform
import shutil
import tempfile
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

import liftopt
from liftopt.collocation.task import OBJECT_COORDINATES
from liftopt.errors import InputError
from liftopt.scenario import scenario_to_toml
from liftopt.solution import Solution

LIBRARIES = ("casadi", "pin", "numpy", "scipy", "h5netcdf")
Variable = tuple[tuple[str, ...], Any, str, str]


def save(solution: Solution, out: Path) -> None:
    """Write a solution into the folder ``out``: all files or none, each whole, solution.nc last.

    Raises:
        InputError: the folder or a file cannot be written.
    """
    try:
        (out / "models").mkdir(parents=True, exist_ok=True)
        # Staged beside the targets, so that the renames stay on one file system.
        with tempfile.TemporaryDirectory(dir=out, prefix=".writing-") as work:
            staged: dict[Path, Path] = {}
            for name, text in solution.urdfs.items():
                staged[out / "models" / name] = _write(Path(work) / name, text)
            staged[out / "scenario.toml"] = _write(Path(work) / "scenario.toml", scenario_to_toml(solution.scenario))
            netcdf = Path(work) / "solution.nc"
            _write_netcdf(solution, netcdf)
            staged[out / "solution.nc"] = netcdf
            for source in staged.values():
                _flush(source)
            _move(staged, Path(work))
    except OSError as error:
        raise InputError("--out", str(out), f"cannot be written: {error.strerror or error}") from error


def _write(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def _flush(path: Path) -> None:
    with path.open("rb") as file:
        os.fsync(file.fileno())


def _move(staged: dict[Path, Path], work: Path) -> None:
    """Move each file to its target, or none: what stood there before comes back if a move fails."""
    before: list[tuple[Path, Path | None]] = []
    try:
        for i, (target, source) in enumerate(staged.items()):
            older = work / f"older-{i}" if target.exists() else None
            if older is not None:
                shutil.copyfile(target, older)
            before.append((target, older))
            os.replace(source, target)
    except BaseException:  # a Ctrl-C too
        for target, older in before:
            if older is None:
                target.unlink(missing_ok=True)
            else:
                shutil.move(older, target)
        raise


def _write_netcdf(solution: Solution, path: Path) -> None:
    import h5netcdf
    import h5py

    with h5netcdf.File(path, "w") as file:
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
    held, name = solution.held, solution.held.name
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
    }


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
        "record": json.dumps(record(solution), allow_nan=False),
    }
    attributes |= {f"objective_{name}": value for name, value in solution.objective_terms.items()}
    return attributes | {f"{name}_seconds": value for name, value in solution.seconds.items()}
