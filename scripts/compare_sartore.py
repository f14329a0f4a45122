"""A humanoid and a person hold up a box at several heights: the models of Sartore et al., lifted by liftopt.

Sartore, Rapetti and Pucci (2022, Humanoids, "Optimization of Humanoid Robot Designs for Human-Robot Ergonomic Payload
Lifting") publish a humanoid, a person of 48 joints and a box, held at 0.8, 1.0, 1.2 and 1.5 m, statically. ``python
scripts/compare_sartore.py DIR`` takes the humanoid's right arm and the box from their files in DIR (``model.urdf``,
``humanSubject04_48dof.urdf``, ``box_idyn.urdf``) and liftopt's person of their person's mass, lifts the box by 0.1 m to
each height, and prints what person and robot need to hold it there at rest: the squared torques that their objective
adds up, and the largest shares of strength. Their file has no limits of effort worth the name (50000 Nm) and none for a
wrist; ``EFFORT`` [Nm] stands for them, an estimate for an arm of that size.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

import liftopt as lo
from liftopt.multibody.robots.read_robot import read_robot
from liftopt.scenario.model import scenario_from_dict

HEIGHTS = (0.8, 1.0, 1.2, 1.5)  # of the hands [m], as in their script
RISE, DURATION = 0.1, 2.0
STATURE = 1.75  # [m]: their person's is not stated
EFFORT = {"shoulder": 60.0, "elbow": 30.0, "wrist": 10.0}
SPEED = 3.0  # [rad/s]
ARM = tuple(
    f"r_{joint}"
    for joint in (
        "shoulder_pitch",
        "shoulder_roll",
        "shoulder_yaw",
        "elbow",
        "wrist_prosup",
        "wrist_pitch",
        "wrist_yaw",
    )
)
TORSO = ("torso_roll", "torso_pitch", "torso_yaw")
PELVIS_BELOW_HANDS = 0.25  # [m]: how far the humanoid's root is below the height of its hands; its legs adapt


def scenario_at(folder: Path, height: float, intervals: int = 20) -> lo.Scenario:
    """Return the lift that ends at a height of the hands [m]."""
    person, box = (read_robot(folder / name) for name in ("humanSubject04_48dof.urdf", "box_idyn.urdf"))
    limits = {
        joint: {"effort": next(n for part, n in EFFORT.items() if part in joint), "velocity": SPEED} for joint in ARM
    }
    robot: dict[str, Any] = {
        "kind": "robot",
        "model": str(folder / "model.urdf"),
        "grasp_frame": "r_hand_frame",
        "locked": dict.fromkeys(TORSO, 0.0),
        "limits": limits,
        "base": {"x": 1.2, "y": -0.15, "z": max(0.0, height - PELVIS_BELOW_HANDS)},
        "grasp": "point",
    }
    human = {"kind": "person", "stature": STATURE, "mass": round(person.mass, 2), "sex": "male", "grasp": "point"}
    return scenario_from_dict(
        {
            "schema": 2,
            "name": "sartore",
            "duration": DURATION,
            "agents": {"human": human, "robot": robot},
            "object": {"name": "box", "mass": round(box.mass, 3), "depth": 0.5, "width": 0.5, "height": 0.025},
            "task": {
                "standing_distance": 1.2,
                "rest": "acceleration",
                "start": {"height": height - RISE, "human_distance": "free"},
                "end": {"height": height, "human_distance": "free"},
            },
            "objective": {"preset": "paper"},
            "limits": {"clearance": "off"},
            "solver": {"intervals": intervals},
        }
    )


def held(solution: lo.Solution) -> dict[str, float]:
    """Return what person and robot need at the end, by name."""
    found = {}
    for agent in solution.agents:
        torque = agent.tau[-1][agent.moving]
        found[f"{agent.name} sum of squares [N2m2]"] = float(np.sum(torque**2))
        found[f"{agent.name} largest [Nm]"] = float(np.abs(torque).max())
    return found


def main() -> int:
    """Print a row a height."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="DIR", help="with the three URDF files")
    parser.add_argument("--heights", type=float, nargs="*", default=HEIGHTS, metavar="M", help="of the hands")
    args = parser.parse_args()
    for height in args.heights:
        solution = lo.solve(scenario_at(args.folder.absolute(), height))
        told = held(solution) if solution.status == "solved" else {}
        print(height, solution.status, *(f"{name} {value:.3g}" for name, value in told.items()), sep=" | ", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
