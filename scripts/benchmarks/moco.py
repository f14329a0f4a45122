"""The same lift in OpenSim Moco, by direct collocation with IPOPT, as who knows Moco would set it up.

The same chains, inertias, torque, joint and speed limits, grasps, gravity, poses and rest at the ends, mesh, objective
and start. Moco's best for the paper's lift: implicit dynamics, controls in Nm, Posa's method for the grasps, forward
differences, an objective of order 1, Moco's 1e-3 for both tolerances, all cores. Bordalba's method takes several
times as long an iteration. The cap on the grasp force and the half-space in front of the body, which Moco has no word
for, are left out; whether its solution keeps to them is measured.

OpenSim brings another CasADi, which cannot be loaded beside ours: it runs in a process of its own (``moco_child.py``)
that knows the lift from a file and is ended when its time is over.
"""

from __future__ import annotations

import importlib.util
import json
import re
import subprocess
import sys
import tempfile
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.beside import Beside, said
from benchmarks.case import Case
from benchmarks.goals import Row
from benchmarks.moco_path import as_answer, on_our_models
from liftopt.collocation.motion import Motion, motion_at, objective_weights
from liftopt.multibody.agent import Agent
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array

TOLERANCE, FINE = 1e-3, 1e-6
AXES = {"RX": [1.0, 0.0, 0.0], "RY": [0.0, 1.0, 0.0], "RZ": [0.0, 0.0, 1.0]}
# The object's coordinates but its roll, which two point grasps cannot turn and which is locked.
POSE = {"x": 0, "y": 1, "z": 2, "pitch": 4, "yaw": 5}
ITERATION = re.compile(r"^ *(\d+)r? +[-+.\de]+ +[-+.\de]+ ", re.MULTILINE)


def measure(case: Case, seconds: float) -> tuple[Row, ...]:
    """Time Moco on a case's lift and mesh: from our start, from its own naive guess, and to our tolerance."""
    if importlib.util.find_spec("opensim") is None:
        return (Row(None, "skipped: OpenSim is not installed; pip install opensim"),) * 3
    naive = _beside_ours(case.from_zero(), TOLERANCE, seconds, "bounds")
    return _beside_ours(case, TOLERANCE, seconds), naive, _beside_ours(case, FINE, seconds)


def _beside_ours(case: Case, tolerance: float, seconds: float, guess: str = "ours") -> Row:
    case = replace(case, scenario=case.scenario.replace({"solver.tolerance": float(f"{tolerance:g}")}))
    beside = Beside(case)
    found = _run(describe(case) | {"tolerance": tolerance, "guess": guess}, seconds)
    ours = beside.finish()
    how = f"N = {case.spline.intervals}, tolerance {tolerance:g}"
    how += ": " if guess == "ours" else ", from the middle of its bounds, ours from control points 0: "
    if "seconds" not in found:
        return Row(None, f"{how}{found['status']}. Ours: {said(ours)}", {}, {"beside": ours})
    there = on_our_models(case, found)
    by_simpson = [f"{name} {_by_simpson(case, result.x):.1f}" for name, result in beside.results.items()]
    note = (
        f"{how}{found['status']}, {found['iterations']} iterations, {found['threads']} threads, processor "
        f"{1e-3 * found['cpu_ms']:.1f} s, J {found['objective']:.1f} (by our models {there.objective:.1f}, gap of the "
        f"grasps {there.closure:.1g} m, torques {there.torque:.1g} Nm and balance {there.balance:.1g} N off, limits "
        f"exceeded by {there.excess:.1g}). Ours, one thread: {said(ours)}; J at Moco's points by its rule: "
        f"{', '.join(by_simpson)}"
    )
    details = {key: found[key] for key in ("seconds", "cpu_ms", "threads", "status", "terms")}
    details |= {"on_our_models": asdict(there), "beside": ours}
    counted = {key: found[key] for key in ("iterations", "objective")}
    return Row(1e3 * found["seconds"] if found["success"] else None, note, counted if found["success"] else {}, details)


def _by_simpson(case: Case, x: Array) -> float:
    """Return the objective of ours where Moco has its points and by its rule: on one mesh the trapezoid's is higher."""
    return on_our_models(case, as_answer(describe(replace(case, start=x)))).objective


def _run(lift: dict[str, Any], seconds: float) -> dict[str, Any]:
    """Return what ``moco_child.py`` found, or only its ``status``."""
    with tempfile.TemporaryDirectory() as folder:
        given, answer = Path(folder) / "lift.json", Path(folder) / "answer.json"
        given.write_text(json.dumps(lift), encoding="utf-8")
        command = [sys.executable, str(Path(__file__).with_name("moco_child.py")), str(given), str(answer)]
        try:
            # OpenSim leaves files where it runs.
            run = subprocess.run(command, cwd=folder, capture_output=True, timeout=seconds, check=False)
        except subprocess.TimeoutExpired as late:
            reached = ITERATION.findall((late.stdout or b"").decode(errors="replace"))
            return {"status": f"not converged after {seconds:g} s, {reached[-1] if reached else 0} iterations"}
        if not answer.exists():
            lines = (run.stdout + run.stderr).decode(errors="replace").strip().splitlines()
            return {"status": f"failed: {lines[-1] if lines else 'no message'}"}
        found: dict[str, Any] = json.loads(answer.read_text(encoding="utf-8"))
    return found


def describe(case: Case) -> dict[str, Any]:
    """Return a lift and its start as plain numbers; SI, world axes or those of the body."""
    problem, task, lifted = case.problem, case.problem.task, case.problem.team.object
    phase = np.linspace(0.0, 1.0, 2 * case.spline.intervals + 1)  # Moco's knots and the points midway
    motion = motion_at(problem, case.spline, case.start, phase)
    grasps = [lifted.model.frames[lifted.model.getFrameId(name)].placement.translation for name in lifted.grasp_frames]
    return {
        "intervals": case.spline.intervals,
        "duration": task.duration,
        "gravity": lifted.model.gravity.linear.tolist(),
        "weights": objective_weights(problem),
        "agents": [_agent(*pair) for pair in zip(problem.team.agents, motion.agents, strict=True)],
        "object": {
            "name": lifted.name,
            "body": _body(lifted.model.inertias[1]),
            "grasps": [point.tolist() for point in grasps],
            "coordinates": _coordinates(case, motion),
        },
    }


def _agent(agent: Agent, moved: AgentTrajectory) -> dict[str, Any]:
    chain, limits = agent.reduced(), agent.limits
    joints = []
    for j, name in enumerate(agent.moving_joints):
        joint, placement = chain.joints[j + 1], chain.jointPlacements[j + 1]
        kind = joint.shortname()
        axis = joint.extract().axis.tolist() if kind.endswith("Unaligned") else AXES[kind.removeprefix("JointModel")]
        joints.append(
            {
                "name": name,
                "parent": chain.parents[j + 1],
                "axis": axis,
                "rotation": placement.rotation.tolist(),
                "translation": placement.translation.tolist(),
                "body": _body(chain.inertias[j + 1]),
                "range": [limits.q_lower[j], limits.q_upper[j]],
                "speed": limits.velocity[j],
                "torque": [limits.tau_lower[j], limits.tau_upper[j]],
                "q": moved.q[:, moved.moving][:, j].tolist(),
                "v": moved.v[:, moved.moving][:, j].tolist(),
                "a": moved.a[:, moved.moving][:, j].tolist(),
                "tau": moved.tau[:, moved.moving][:, j].tolist(),
            }
        )
    frame = chain.frames[chain.getFrameId(agent.grasps[0].frame)]
    return {
        "name": agent.name,
        "joints": joints,
        "hand": frame.parentJoint,
        "grasp": frame.placement.translation.tolist(),
    }


def _coordinates(case: Case, motion: Motion) -> list[dict[str, Any]]:
    task, found = case.problem.task, []
    for name, i in POSE.items():
        ends = [None if np.isnan(pose[i]) else float(pose[i]) for pose in (task.start, task.end)]
        found.append(
            {
                "name": name,
                "range": [task.pose_lower[i], task.pose_upper[i]],
                "speed": task.pose_velocity[i],
                "ends": ends,
                "q": motion.object.pose[:, i].tolist(),
                "v": motion.object.pose_velocity[:, i].tolist(),
                "a": motion.object.pose_acceleration[:, i].tolist(),
            }
        )
    return found


def _body(inertia: pin.Inertia) -> dict[str, Any]:
    """Return mass, centre of mass and the moments of inertia about it: xx, yy, zz, xy, xz, yz."""
    moments = inertia.inertia
    upper = [moments[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return {"mass": inertia.mass, "centre": inertia.lever.tolist(), "moments": upper}
