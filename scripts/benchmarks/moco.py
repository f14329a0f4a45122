"""The same lift in OpenSim Moco, by direct collocation with IPOPT, as who knows Moco would set it up.

The same chains, inertias, torque, joint and speed limits, grasps, gravity, poses at the ends, mesh and start; Hermite
and Simpson, as Moco advises for models with constraints. What Moco has no word for is left out: rest includes no zero
acceleration, the grasp force has no cap, the objective is the squared torques alone. So its J is near ours, not ours.
OpenSim brings another CasADi, which cannot be loaded beside ours: it runs in a process of its own (``moco_child.py``)
that knows the lift from a file and is ended when its time is over.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.case import Case
from benchmarks.goals import Row
from liftopt.collocation.motion import Motion, motion_at
from liftopt.multibody.agent import Agent
from liftopt.trajectory import AgentTrajectory

TOLERANCE = 1e-3
AXES = {"RX": [1.0, 0.0, 0.0], "RY": [0.0, 1.0, 0.0], "RZ": [0.0, 0.0, 1.0]}
# The object's coordinates but its roll, which two point grasps cannot turn and which is locked.
POSE = {"x": 0, "y": 1, "z": 2, "pitch": 4, "yaw": 5}


def measure(case: Case, seconds: float) -> Row:
    """Time Moco on a case's lift and mesh; the time it was given is a lower bound if that was not enough."""
    if importlib.util.find_spec("opensim") is None:
        return Row(None, "skipped: OpenSim is not installed; pip install opensim")
    with tempfile.TemporaryDirectory() as folder:
        given, answer = Path(folder) / "lift.json", Path(folder) / "answer.json"
        given.write_text(json.dumps(describe(case)), encoding="utf-8")
        command = [sys.executable, str(Path(__file__).with_name("moco_child.py")), str(given), str(answer)]
        try:
            # OpenSim leaves files where it runs.
            run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=seconds, check=False)
        except subprocess.TimeoutExpired:
            return Row(1e3 * seconds, f"stopped after {seconds:g} s, not converged: a lower bound")
        if not answer.exists():
            lines = (run.stdout + run.stderr).strip().splitlines()
            return Row(None, f"failed: {lines[-1] if lines else 'no message'}")
        found = json.loads(answer.read_text(encoding="utf-8"))
    note = (
        f"N = {case.spline.intervals}, tolerance {TOLERANCE:g}, one thread: {found['status']}, "
        f"{found['iterations']} iterations, squared torques {found['objective']:.1f}"
    )
    return Row(1e3 * found["seconds"], note, {key: found[key] for key in ("iterations", "objective")}, found)


def describe(case: Case) -> dict[str, Any]:
    """Return a lift and its start as plain numbers; SI, world axes or those of the body."""
    problem, task, held = case.problem, case.problem.task, case.problem.team.held
    phase = np.linspace(0.0, 1.0, 2 * case.spline.intervals + 1)  # Moco's knots and the points midway
    motion = motion_at(problem, case.spline, case.start, phase)
    grasps = [held.model.frames[held.model.getFrameId(name)].placement.translation for name in held.grasp_frames]
    return {
        "tolerance": TOLERANCE,
        "intervals": case.spline.intervals,
        "duration": task.duration,
        "gravity": held.model.gravity.linear.tolist(),
        "agents": [_agent(*pair) for pair in zip(problem.team.agents, motion.agents, strict=True)],
        "object": {
            "name": held.name,
            "body": _body(held.model.inertias[1]),
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
            }
        )
    frame = chain.frames[chain.getFrameId(agent.grasp_frame)]
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
                "q": motion.held.pose[:, i].tolist(),
                "v": np.gradient(motion.held.pose[:, i], motion.time).tolist(),
            }
        )
    return found


def _body(inertia: pin.Inertia) -> dict[str, Any]:
    """Return mass, centre of mass and the moments of inertia about it: xx, yy, zz, xy, xz, yz."""
    moments = inertia.inertia
    upper = [moments[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return {"mass": inertia.mass, "centre": inertia.lever.tolist(), "moments": upper}
