"""What an ergonomist and a robot engineer ask of a solution, as plain numbers ready for JSON.

Units stand in the key names (``_Nm``, ``_s``, ``_deg``; of a joint that slides ``_N``, ``_mm``); shares are fractions.
A number that does not exist (the load share of a body in free fall, the objective of a start that failed) is None.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from liftopt.multibody.joint_meanings import joint_meanings
from liftopt.multibody.trajectory import GRAVITY, grasps_of, limit_share
from liftopt.scenario.agents import Person
from liftopt.solution.effort import effort_in
from liftopt.solution.grasp_loads import shares, squeeze
from liftopt.solution.interpolation import between_knots
from liftopt.types import Array

if TYPE_CHECKING:
    from liftopt.multibody.trajectory import AgentTrajectory
    from liftopt.solution.solution import Solution


TERM_UNITS = {"acceleration": "rad^2/s^3, m^2/s^3", "force": "N^2 s", "range": "s", "tilt": "s", "spine": "s"}


def summary_dict(solution: Solution, out: Path | None = None, files: Sequence[str] = ()) -> dict[str, Any]:
    """Return the figures that sum up a solution; every number in it is finite or None.

    Peaks are taken between the knots too; of what is no solution, at the knots.

    Args:
        solution: solved or not.
        out: folder that it was written to, if any.
        files: that were written there, by their paths within it.
    """
    solved = bool(solution.solved)
    fine = between_knots(solution) if solved else solution
    return {
        "name": solution.scenario.name,
        "status": solution.status,
        "solved": solved,
        "exit_status": 0 if solved else 3,
        "reason": None if solved else solution.status,
        "reasons": [asdict(reason) for reason in solution.reasons],
        "suggested_changes": [asdict(change) for change in solution.suggested_changes],
        "assessment": solution.assessment.plain(),
        "out": None if out is None else str(out),
        "files": [] if out is None else [str(out / name) for name in files],
        "scenario": solution.scenario.to_dict(),
        "joints": {agent.name: _joints(fine, agent) for agent in fine.agents},
        "load_share": load_share(solution),
        "grasp_force": _grasp_force(fine),
        "grasp_moment": _grasp_moment(fine),
        **_ground_reactions(fine),
        "clearance": _clearance(solution),
        "objective": _objective(solution),
        "solver": {
            "intervals": int(solution.intervals),
            "iterations": int(solution.iterations),
            "seconds": {key: _number(value) for key, value in solution.seconds.items()},
            "starts": [
                {
                    "name": start.name,
                    "kept": start.name == solution.kept_start,
                    "status": start.status,
                    "objective": _number(start.objective),
                    "iterations": int(start.iterations),
                    "seconds": _number(start.seconds),
                }
                for start in solution.starts
            ],
        },
        "verification": _verification(solution),
        "accuracy": _accuracy(solution),
        "notes": list(solution.notes),
    }


def load_share(solution: Solution) -> dict[str, Any]:
    """Return who carries how much of the vertical grasp force: at every knot, and its range, for each agent."""
    return {
        "time_s": _numbers(solution.time),
        "agents": {
            agent.name: {"share": _numbers(share), **_range(share)}
            for agent, share in zip(solution.agents, shares(solution.agents), strict=True)
        },
    }


def _joints(solution: Solution, agent: AgentTrajectory) -> list[dict[str, Any]]:
    moving = np.flatnonzero(agent.moving)
    tau = agent.tau[:, moving]
    share, units, who = limit_share(agent), agent.units, solution.scenario.agents[agent.name]
    meanings = joint_meanings(agent.kind, getattr(who, "model", ""))
    rows = []
    for column, index in enumerate(moving):
        joint = agent.joint_names[index].removeprefix(f"{agent.name}_")
        at, worst = int(np.argmax(np.abs(tau[:, column]))), int(np.argmax(share[:, column]))
        unit = units[column]
        q, effort = agent.q[:, index] * unit.factor, f"peak_{unit.effort}"
        rows.append(
            {
                "joint": joint,
                "meaning": meanings.get(joint, ""),
                f"{effort}_{unit.tau}": _number(tau[at, column]),
                f"{effort}_at_s": _number(solution.time[at]),
                "share_of_limit": _number(share[at, column]),
                "largest_share_of_limit": _number(share[worst, column]),
                "largest_share_at_s": _number(solution.time[worst]),
                f"q_min_{unit.shown}": _number(q.min()),
                f"q_max_{unit.shown}": _number(q.max()),
            }
        )
    return rows


def _grasp_force(solution: Solution) -> dict[str, Any]:
    """Return the peak force of each grasp by name, and how hard they press the object together."""
    result: dict[str, Any] = {"limit_N": solution.scenario.limits.max_grasp_force, "agents": {}}
    for _, agent, own, grasp in grasps_of(solution.agents):
        size = np.linalg.norm(agent.grasp_force[:, own], axis=1)
        result["agents"][grasp.name] = _peak(size, solution.time, "N")
    if len(result["agents"]) > 1:
        result["squeeze"] = _peak(squeeze(solution.agents), solution.time, "N")
    return result


def _grasp_moment(solution: Solution) -> dict[str, Any]:
    """Return the peak moment of each grasp that transmits one, and its limit."""
    return {
        grasp.name: _peak(np.linalg.norm(agent.grasp_moment[:, own], axis=1), solution.time, "Nm")
        | {"limit_Nm": _number(grasp.max_moment)}
        for _, agent, own, grasp in grasps_of(solution.agents)
        if grasp.moments
    }


def _ground_reactions(solution: Solution) -> dict[str, Any]:
    """Return what the ground does to every person; as in solution.nc, the first one's without a name in front."""
    return {
        f"{person.name}_ground_reaction" if k else "ground_reaction": _ground_reaction(solution, person)
        for k, person in enumerate(solution.persons)
    }


def _ground_reaction(solution: Solution, person: AgentTrajectory) -> dict[str, Any]:
    force, moment = person.ground_force, person.ground_moment
    vertical = _peak(force[:, 2], solution.time, "N")
    weight = cast(Person, solution.scenario.agents[person.name]).mass * GRAVITY
    return {
        "vertical": vertical,
        "vertical_over_body_weight": None if vertical["peak_N"] is None else vertical["peak_N"] / weight,
        "horizontal": _peak(np.linalg.norm(force[:, :2], axis=1), solution.time, "N"),
        "moment": _peak(np.linalg.norm(moment, axis=1), solution.time, "Nm"),
        "moment_lateral": _peak(moment[:, 0], solution.time, "Nm"),
        "moment_sagittal": _peak(moment[:, 1], solution.time, "Nm"),
        "moment_vertical": _peak(moment[:, 2], solution.time, "Nm"),
    }


def _clearance(solution: Solution) -> dict[str, Any] | None:
    """Return the smallest distance by kind of pair, whose it is and when; None of what is no solution."""
    clearance = solution.clearance
    if clearance is None:
        return None
    first = {kind.kind: clearance.closest_of(kind.kind) for kind in clearance.kinds}
    return {
        "limit_m": solution.scenario.limits.clearance,
        "kinds": {
            kind: {"smallest_m": _number(item.distance), "at_s": _number(item.time), "between": item.pair.told}
            for kind, item in first.items()
            if item is not None
        },
    }


def _objective(solution: Solution) -> dict[str, Any]:
    effort = effort_in(solution.scenario).unit.replace("2", "^2")
    terms, units = {}, dict.fromkeys((agent.name for agent in solution.agents), effort) | TERM_UNITS
    for name, integral in solution.objective_terms.items():
        weight = solution.objective_weights[name]
        terms[name] = {
            "integral": _number(integral),
            "unit": units.get(name, ""),
            "weight": _number(weight),
            "weighted": _number(weight * integral),
        }
    return {"total": _number(solution.objective), "terms": terms}


def _verification(solution: Solution) -> dict[str, Any]:
    verification = solution.verification
    return {
        "passed": bool(verification.passed),
        "kkt_error": _number(verification.kkt_error),
        "kkt_tolerance": solution.scenario.solver.tolerance,
        "checks": [
            {
                "name": check.name,
                "value": _number(check.value),
                "limit": _number(check.limit),
                "unit": check.unit,
                "where": check.where,
                "passed": bool(check.passed),
            }
            for check in verification.checks
        ],
    }


def _accuracy(solution: Solution) -> dict[str, Any] | None:
    accuracy = solution.accuracy
    if accuracy is None:
        return None
    return {
        "closure_m": _number(accuracy.closure),
        "balance_SI": _number(accuracy.balance),
        "torque_excess_Nm": _number(accuracy.torque_excess),
        "compression_excess_N": _number(accuracy.compression_excess),
        "objective_limit": _number(accuracy.objective_limit),
        "objective_error": _number(accuracy.objective_error),
        "objective_bar": _number(accuracy.objective_bar),
        "compared_intervals": accuracy.intervals or None,
        "remark": accuracy.remark,
    }


def _peak(values: Array, time: Array, unit: str) -> dict[str, Any]:
    at = int(np.argmax(np.abs(values)))
    return {f"peak_{unit}": _number(values[at]), "at_s": _number(time[at])}


def _range(values: Array) -> dict[str, Any]:
    finite = values[np.isfinite(values)]
    return {
        "min": _number(finite.min()) if finite.size else None,
        "max": _number(finite.max()) if finite.size else None,
    }


def _numbers(values: Array) -> list[float | None]:
    return [_number(value) for value in values]


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
