"""A solution read back from disk: the folder that ``liftopt solve`` wrote, or its solution.nc."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from liftopt.checks import Check, Verification
from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.scenario import Scenario, load_scenario
from liftopt.scene import URDF_FILES, agents_of, object_of
from liftopt.solution import Solution, StartRecord
from liftopt.trajectory import AgentTrajectory, ObjectTrajectory, agent_trajectory, object_trajectory

Array = npt.NDArray[np.float64]
LARGEST_FILE = 500_000_000  # bytes; a lift on 400 intervals has some 300 kB


def load_result(path: str | Path) -> Solution:
    """Return the solution in a result folder, or beside a ``solution.nc``.

    Trajectories come from solution.nc, the models' limits from scenario.toml beside it.

    Raises:
        InputError: a file is missing, is no result of liftopt, or is damaged; it says which and why.
    """
    path = Path(path)
    file = path if path.name.endswith(".nc") else path / "solution.nc"
    if not file.is_file():
        raise InputError(str(path), NO_VALUE, f"is no result: there is no file {file.name} there")
    if file.stat().st_size > LARGEST_FILE:
        raise InputError(str(file), NO_VALUE, f"is no result: larger than {LARGEST_FILE} bytes")
    scenario = load_scenario(str(file.with_name("scenario.toml")))
    data, attributes = _read(file)
    try:
        return _solution(scenario, data, attributes, file.parent)
    except (KeyError, ValueError, TypeError, AttributeError, IndexError) as error:
        why = f"{type(error).__name__}: {error}"
        raise InputError(str(file), NO_VALUE, f"is no whole result of liftopt ({why})") from None


def _read(file: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    import h5netcdf

    try:
        with h5netcdf.File(file, "r") as source:
            data = {name: np.asarray(variable[...]) for name, variable in source.variables.items()}
            return data, dict(source.attrs)
    except (OSError, ValueError, KeyError, RuntimeError, TypeError) as error:
        why = " ".join(str(error).split())
        raise InputError(str(file), NO_VALUE, f"cannot be read as NetCDF-4: {why}") from None


def _solution(scenario: Scenario, data: dict[str, Any], attributes: dict[str, Any], folder: Path) -> Solution:
    record = json.loads(str(attributes["record"]))
    urdfs = _models(folder / "models")
    try:
        agents, held = agents_of(scenario, urdfs), object_of(scenario, urdfs)
    except ValueError as error:
        raise InputError(str(folder / "models"), NO_VALUE, f"holds a model that cannot be read ({error})") from None
    time = _array(data, "time", (len(data["time"]),))
    if not (np.diff(time) > 0.0).all():
        raise ValueError("time does not increase")
    knots = len(time)
    forces = _array(data, "grasp_force", (knots, len(agents), 3))
    # Files from before there were moments have none.
    moments = _array(data, "grasp_moment", forces.shape) if "grasp_moment" in data else np.zeros_like(forces)
    checks = tuple(Check(**check | _numbers(check, value=np.nan, limit=np.inf)) for check in record["checks"])
    return Solution(
        scenario=scenario,
        outcome=str(record["outcome"]),
        time=time,
        agents=tuple(_agent(agent, data, forces[:, i], moments[:, i]) for i, agent in enumerate(agents)),
        held=_object(held, data, forces.reshape(knots, -1), moments),
        urdfs=urdfs,
        objective=float(attributes["objective"]),
        objective_terms={name: float(attributes[f"objective_{name}"]) for name in record["objective_weights"]},
        objective_weights=record["objective_weights"],
        iterations=int(attributes["iterations"]),
        intervals=int(attributes["intervals"]),
        seconds=record["seconds"],
        starts=tuple(StartRecord(**start | _numbers(start, objective=np.nan)) for start in record["starts"]),
        kept_start=str(record["kept_start"]),
        verification=Verification(checks, float(attributes["kkt_error"]), float(record["kkt_tolerance"])),
        notes=tuple(record["notes"]),
    )


def _models(folder: Path) -> dict[str, str]:
    """Return the text of each URDF, by file name."""
    texts = {}
    for name in URDF_FILES.values():
        try:
            texts[name] = (folder / name).read_text(encoding="utf-8")
        except (OSError, ValueError) as error:
            why = error.strerror if isinstance(error, OSError) else error
            raise InputError(
                str(folder / name), NO_VALUE, f"cannot be read, and belongs to the result: {why}"
            ) from None
    return texts


def _agent(agent: Agent, data: dict[str, Any], force: Array, moment: Array) -> AgentTrajectory:
    shape = (len(force), agent.model.nv)
    q, v, a, tau = (_array(data, f"{agent.name}_{kind}", shape) for kind in ("q", "v", "a", "tau"))
    moving = [name not in agent.pinned for name in list(agent.model.names)[1:]]
    # What follows from the motion and the forces is computed again rather than stored.
    return replace(agent_trajectory(agent, q[:, moving], v[:, moving], a[:, moving], force, moment), tau=tau)


def _object(held: LiftedObject, data: dict[str, Any], forces: Array, moments: Array) -> ObjectTrajectory:
    kinds = ("", "_velocity", "_acceleration")
    pose, rate, second = (_array(data, f"{held.name}_pose{kind}", (len(forces), 6)) for kind in kinds)
    return object_trajectory(held, pose, rate, second, forces, moments)


def _numbers(entry: dict[str, Any], **otherwise: float) -> dict[str, float]:
    """Return the named entries as numbers; JSON has null for those that are not finite."""
    return {key: missing if entry[key] is None else float(entry[key]) for key, missing in otherwise.items()}


def _array(data: dict[str, Any], name: str, shape: tuple[int, ...]) -> Array:
    values = np.asarray(data[name], dtype=float)
    if values.shape != shape:
        raise ValueError(f"{name} has shape {values.shape}, expected {shape}")
    if not np.isfinite(values).all():
        raise ValueError(f"{name} holds values that are not finite")
    return values
