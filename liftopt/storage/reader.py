"""A solution read back from disk: the folder that ``liftopt solve`` wrote, or its solution.nc."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from liftopt.assessment.assess import assessed
from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.likeness import difference
from liftopt.multibody.trajectory import AgentTrajectory, ObjectTrajectory, agent_trajectory, object_trajectory
from liftopt.scenario.build import agent_of, agents_of, object_of
from liftopt.scenario.model import Scenario
from liftopt.scenario.robot_agents import is_from_file
from liftopt.solution.checks import Verification
from liftopt.solution.clearance_of import clearance_of
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution
from liftopt.storage.netcdf_file import read_netcdf
from liftopt.storage.older_result import urdfs_beside
from liftopt.storage.record import read_assessment, read_record
from liftopt.storage.result_folder import SCENARIO_TEXT, URDF_TEXT
from liftopt.storage.result_path import no_result, result_file
from liftopt.storage.robot_check import lets_go, unlike_scenario
from liftopt.storage.solved_scenario import scenario_of
from liftopt.storage.urdf_check import check_urdf
from liftopt.types import Array

MOST_KNOTS = 10_000
LARGEST_VALUE = 1e12  # in SI units; the worst iterate of a solver that failed is far below
SAME_TIME = 1e-6  # of the duration


def load_result(path: str | Path) -> Solution:
    """Return the solution in a result folder; its ``solution.nc`` and its ``scenario.toml`` stand for it too.

    All of it comes from solution.nc; of results of earlier versions, scenario and models come from the files beside.
    Nothing is written, and the file is taken for what anybody may have made of it; see ``netcdf_file`` and
    ``urdf_check``.

    Raises:
        InputError: a file is missing, is no result of liftopt, is damaged, or holds a model of another robot or person
            than the scenario's; it says which and why.
    """
    path = Path(path)
    file = result_file(path)
    with suppress(OSError, ValueError):  # too long a name, a NUL: reading it says so
        if file.parent.is_file():
            raise no_result(path)
    try:
        data, attributes = read_netcdf(file)
    except FileNotFoundError:
        raise no_result(path) from None
    scenario = scenario_of(file, attributes)
    urdfs = _urdfs(file, attributes, scenario)
    # Of a robot that a file describes nothing is read again: that file may be gone, or be no robot at all.
    own = [name for name in scenario.agents if not is_from_file(scenario, name)]
    try:
        built: list[Agent | LiftedObject] = [*(agent_of(scenario, name) for name in own), object_of(scenario)]
        agents, lifted = agents_of(scenario, urdfs), object_of(scenario, urdfs)
        _check_models(file, scenario, built, (*agents, lifted))
        solution = _solution(scenario, urdfs, agents, lifted, data, attributes)
    except (ValueError, TypeError, AttributeError, LookupError, ArithmeticError, RecursionError) as error:
        why = f"{type(error).__name__}: {error}"
        raise InputError(str(file), NO_VALUE, f"is no whole result of liftopt ({why})") from None
    for name in scenario.agents:
        if solution.solved and name not in own and (found := lets_go(solution, name)):
            raise _other_model(file, name, found)
    return solution


def _urdfs(file: Path, attributes: Mapping[str, Any], scenario: Scenario) -> dict[str, str]:
    """Return the models of a result, each of them checked; raises InputError."""
    if SCENARIO_TEXT in attributes:
        urdfs = {
            name: str(attributes.get(f"{URDF_TEXT}{name}", "")) for name in (*scenario.agents, scenario.object.name)
        }
    else:
        urdfs = urdfs_beside(file.parent, scenario)
    for name, text in urdfs.items():
        try:
            check_urdf(text)
        except ValueError as error:
            raise InputError(str(file), NO_VALUE, f"the model of {name} cannot be read: {error}") from None
    return urdfs


def _check_models(
    file: Path, scenario: Scenario, built: Sequence[Agent | LiftedObject], given: Sequence[Agent | LiftedObject]
) -> None:
    """Raise InputError if the models of a result are not those of its scenario; small numbers may differ."""
    expected = {one.name: one for one in built}
    for one in given:
        if isinstance(one, Agent) and one.name not in expected:
            found = unlike_scenario(scenario, one)
        else:
            like = expected[one.name]
            frames = like.grasp_frames if isinstance(like, LiftedObject) else like.hands
            found = difference(one.model, like.model, frames)
        if found:
            raise _other_model(file, one.name, found)


def _other_model(file: Path, name: str, found: str) -> InputError:
    why = f"the model of {name} is not that of the result's scenario: {found}; solve again"
    return InputError(str(file), NO_VALUE, why)


def _solution(
    scenario: Scenario,
    urdfs: dict[str, str],
    agents: tuple[Agent, ...],
    lifted: LiftedObject,
    data: dict[str, Array],
    attributes: dict[str, Any],
) -> Solution:
    record = read_record(str(attributes["record"]), [agent.name for agent in agents])
    time, knots, intervals = data["time"], np.size(data["time"]), int(attributes["intervals"])
    if knots != intervals + 1 or knots > MOST_KNOTS:
        raise ValueError(f"time has {knots} values on {intervals} intervals")
    time = _array(data, "time", (knots,))
    if not (np.diff(time) > 0.0).all():
        raise ValueError("time does not increase")
    if not np.allclose(time[[0, -1]], (0.0, scenario.duration), rtol=0.0, atol=SAME_TIME * scenario.duration):
        raise ValueError(f"it lasts from {time[0]:g} to {time[-1]:g} s, its scenario {scenario.duration:g} s")
    forces = _array(data, "grasp_force", (knots, len(lifted.grasp_frames), 3))
    # Files from before there were moments have none.
    moments = _array(data, "grasp_moment", forces.shape) if "grasp_moment" in data else np.zeros_like(forces)
    solution = Solution(
        scenario=scenario,
        outcome=record.outcome,
        time=time,
        agents=tuple(
            _agent(agent, data, *own)
            for agent, *own in zip(agents, _split(agents, forces), _split(agents, moments), strict=True)
        ),
        object=_object(lifted, data, forces.reshape(knots, -1), moments),
        urdfs=urdfs,
        objective=float(attributes["objective"]),
        objective_terms={name: float(attributes[f"objective_{name}"]) for name in record.objective_weights},
        objective_weights=record.objective_weights,
        iterations=int(attributes["iterations"]),
        intervals=intervals,
        seconds=record.seconds,
        starts=record.starts,
        kept_start=record.kept_start,
        verification=Verification(record.checks, float(attributes["kkt_error"]), record.kkt_tolerance),
        notes=record.notes,
        accuracy=record.accuracy,
        reasons=record.reasons,
        suggested_changes=record.suggested_changes,
    )
    if "assessment" not in attributes:  # as files from before there was one
        return assessed(solution)
    return replace(
        solution,
        assessment=read_assessment(str(attributes["assessment"]), [agent.kind for agent in agents]),
        # What follows from the motion is computed again rather than stored.
        clearance=clearance_of(between_knots(solution)) if solution.solved else None,
    )


def _split(agents: Sequence[Agent], vectors: Array) -> list[Array]:
    """Return each agent's own of what all grasps have (K, grasps, 3)."""
    return np.split(vectors, np.cumsum([len(agent.grasps) for agent in agents])[:-1], axis=1)


def _agent(agent: Agent, data: dict[str, Any], force: Array, moment: Array) -> AgentTrajectory:
    shape = (len(force), agent.model.nv)
    q, v, a, tau = (_array(data, f"{agent.name}_{kind}", shape) for kind in ("q", "v", "a", "tau"))
    moving = [name not in agent.locked_joints for name in list(agent.model.names)[1:]]
    # What follows from the motion and the forces is computed again rather than stored.
    return replace(agent_trajectory(agent, q[:, moving], v[:, moving], a[:, moving], force, moment), tau=tau)


def _object(lifted: LiftedObject, data: dict[str, Any], forces: Array, moments: Array) -> ObjectTrajectory:
    kinds = ("", "_velocity", "_acceleration")
    pose, rate, second = (_array(data, f"{lifted.name}_pose{kind}", (len(forces), 6)) for kind in kinds)
    return object_trajectory(lifted, pose, rate, second, forces, moments)


def _array(data: dict[str, Any], name: str, shape: tuple[int, ...]) -> Array:
    values = np.asarray(data[name], dtype=float)
    if values.shape != shape:
        raise ValueError(f"{name} has shape {values.shape}, expected {shape}")
    if not np.isfinite(values).all():
        raise ValueError(f"{name} holds values that are not finite")
    if np.abs(values).max(initial=0.0) > LARGEST_VALUE:
        raise ValueError(f"{name} holds values beyond {LARGEST_VALUE:g}")
    return values
