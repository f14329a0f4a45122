"""The recorded box lift with its shelves: predicted as the paper does, as people lift, and around the shelves.

``python scripts/check_box_lift.py`` reads the recording (``--data``), takes from it the person, where the box stands on
either shelf and how long the lift takes, solves the lifts and prints how far each is from the recording: root mean
square differences over the lift, in Markdown. Where the recording is not there it says so and does nothing.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pinocchio as pin

from liftopt.ergonomics.motion import motion_of
from liftopt.errors import LiftoptError
from liftopt.lab.mocap.from_markers import read_recording, recorded_lift
from liftopt.lab.mocap.loads import Load
from liftopt.lab.mocap.map_file import load_marker_map
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.lab.mocap.recorded_scenario import recorded_scenario
from liftopt.scenario.keys import changes_in
from liftopt.scenario.model import Scenario, scenario_from_dict
from liftopt.scenario.task import GraspPlace
from liftopt.search.solve import solve
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution
from liftopt.types import Array

DATA = Path(__file__).parents[2] / "shared" / "data" / "box_lift"
PERSON_MASS, BOX_MASS = 60.0, 6.0  # [kg], taken for granted: the file tells neither
# From the markers [m]: four on the corners of the top, four on two handles that stick out aside, 46 mm below the top.
DEPTH, WIDTH, HANDLE_BELOW_TOP = 0.30, 0.46, 0.046
# No marker is lower than the handles. The place on the upper shelf is 0.22 m higher, so that what stands on the lower
# one, a board and some room are not higher than that.
HEIGHT = 0.15
MARKERS_TO_CENTRE = np.array([0.088, 0.0, -0.051])  # [m] from the mean of the markers, in the box's axes
BOARD, GAP = 0.02, 0.001  # [m] thickness of a shelf, and what lies between it and the box
FINGERS = 0.05  # [m] by which the box sticks out over the shelf's front
ASIDE = 0.7  # m from the robot's base to the left handle
BASE_HEIGHT = 1.2  # [m]
# Of the preset: up to 60 deg from a palm under an edge. Hands hold a handle from any side.
AROUND_HANDLE = {"human.grasp_turn_deg": 120.0}
AMOUNTS = {"elbow": "elbow", "humeral_elevation": "humeral elevation", "abduction": "abduction",
           "wrist_flexion": "wrist", "twist": "twist"}  # fmt: skip


@dataclass(frozen=True)
class Distance:
    """How far a prediction is from the recording.

    Attributes:
        angles: root mean square differences of the person's angles by name [deg].
        hand, box: of the paths of hand and box from where they start, forward and up [m].
        drawn_out: how far the box comes towards the person [m].
        risen: how far it rises above its start [m].
    """

    angles: dict[str, float]
    hand: tuple[float, float]
    box: tuple[float, float]
    drawn_out: float
    risen: float


def read(folder: Path) -> RecordedLift:
    """Return the recorded lift."""
    mapping = load_marker_map("box_lift")
    subject = mapping.subject.changed(mass=PERSON_MASS)
    return recorded_lift(
        read_recording(folder / "markers_analogs.c3d"), mapping.changed(subject=subject), Load(mass=BOX_MASS)
    )


def box_scenario(record: RecordedLift, preset: str, shelves: bool = True) -> Scenario:
    """Return the scenario of the box with its handles, on and off two shelves.

    The person holds the right handle where the recorded hand is; a robot whose torques have no weight stands aside and
    holds the left one. The lower shelf is under the box as it stands at first, the upper one as it stands at last. They
    are as deep as the box but for the room of the fingers, and narrower than from handle to handle.

    Args:
        record: the recorded lift.
        preset: of the objective.
        shelves: False leaves them out.
    """
    before = recorded_scenario(record, BOX_MASS)
    person, below = before.first("person"), HANDLE_BELOW_TOP - HEIGHT / 2  # of the centre, above the handles
    centres = []
    for place in (before.task.start, before.task.end):
        assert isinstance(place, GraspPlace)
        assert place.human_distance is not None
        centres.append((round(place.human_distance + DEPTH / 2, 3), round(place.height + below, 3)))
    (start_x, start_z), (end_x, end_z) = centres
    y = round(float(record.over_lift(record.hand_position, 2)[:, 1].mean()) + WIDTH / 2, 3)
    boards = [
        {
            "name": name,
            "box": [DEPTH - FINGERS, DEPTH, BOARD],
            "position": [round(x + FINGERS / 2, 3), y, round(z - HEIGHT / 2 - GAP - BOARD / 2, 3)],
        }
        for name, (x, z) in zip(("lower_shelf", "upper_shelf"), centres, strict=True)
    ]
    held_x = (start_x + end_x) / 2 - DEPTH / 2
    robot = {
        "kind": "robot",
        "model": "sawyer",
        "weight": 0.0,
        "max_grasp_moment": person.max_grasp_moment,  # a hand's, which it stands for
        "base": {"x": round(held_x, 3), "y": WIDTH / 2 + ASIDE, "z": BASE_HEIGHT, "yaw_deg": -90.0},
    }
    objective: dict[str, object] = {"preset": preset}
    if preset == "paper":
        objective["force_weight"] = before.objective.force_weight
    return scenario_from_dict(
        {
            "schema": 2,
            "name": "box_lift",
            "duration": before.duration,
            "agents": {
                "human": {"kind": "person", "stature": person.stature, "mass": person.mass, "sex": person.sex},
                "robot": robot,
            },
            "object": {
                "name": "box", "mass": BOX_MASS, "depth": DEPTH, "width": WIDTH, "height": HEIGHT,
                "grasps": {"human": [-DEPTH / 2, -WIDTH / 2, -below], "robot": [-DEPTH / 2, WIDTH / 2, -below]},
            },
            "task": {
                "standing_distance": before.task.standing_distance,
                "start": {"x": start_x, "y": y, "z": start_z},
                "end": {"x": end_x, "y": y, "z": end_z},
            },
            "obstacles": boards if shelves else [],
            "objective": objective,
        }
    )  # fmt: skip


def distance(solution: Solution, record: RecordedLift) -> Distance:
    """Return how far a solved lift is from the recorded one, over the time in which the box is away from its places."""
    dense = between_knots(solution)
    person, samples = dense.persons[0], len(dense.time)
    recorded = replace(person, q=record.over_lift(record.q, samples))
    ours, theirs = motion_of(dense, person), motion_of(dense, recorded)
    hand = _travel(person.p_world_hold) - _travel(record.over_lift(record.hand_position, samples))
    path = _travel(dense.object.pose[:, :3])
    box = path - _travel(box_centres(record, samples))
    return Distance(
        angles={name: _rms(getattr(ours, name) - getattr(theirs, name)) for name in AMOUNTS},
        hand=(_rms(hand[:, 0]), _rms(hand[:, 2])),
        box=(_rms(box[:, 0]), _rms(box[:, 2])),
        drawn_out=float(-path[:, 0].min()),
        risen=float(path[:, 2].max()),
    )


def box_centres(record: RecordedLift, samples: int) -> Array:
    """Return (samples, 3) where the centre of the recorded box is in the world [m].

    At first it stands level and square to the person: its handles and the hand are in one line with its markers.
    """
    assert record.object_position is not None
    assert record.object_quaternion is not None
    turns = [pin.Quaternion(one).matrix() for one in record.over_lift(record.object_quaternion, samples)]
    offsets = np.stack([turn @ MARKERS_TO_CENTRE for turn in turns])
    return np.asarray(record.over_lift(record.object_position, samples) + offsets, float)


def _travel(path: Array) -> Array:
    return np.asarray(path - path[0], float)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def table(record: RecordedLift, overrides: list[str]) -> Iterator[str]:
    """Yield the comparison, one line a lift."""
    cases = {
        "`paper`, a long object between hand and robot, as `liftopt scenario` has it": recorded_scenario(
            record, BOX_MASS
        ),
        "`paper`, the box by its handles": box_scenario(record, "paper", shelves=False),
        "`paper`, with its shelves": box_scenario(record, "paper"),
        "`natural`, the box by its handles": box_scenario(record, "natural", shelves=False),
        "`natural`, with its shelves": box_scenario(record, "natural"),
        "the same, the hand free to turn around the handle": box_scenario(record, "natural").replace(AROUND_HANDLE),
    }
    heads = [*AMOUNTS.values(), "hand forward", "hand up", "box forward", "box up", "drawn out [m]", "risen [m]"]
    yield "| lift | " + " | ".join(heads) + " |"
    yield "| --- " * (len(heads) + 1) + "|"
    for name, scenario in cases.items():
        try:
            solution = solve(scenario.replace(dict(changes_in(overrides))))
        except LiftoptError as error:
            yield f"| {name} | {error} |"
            continue
        if not solution.solved:
            yield f"| {name} | {solution.status} |"
            continue
        off = distance(solution, record)
        cells = [f"{value:.0f}" for value in off.angles.values()]
        cells += [f"{value:.3f}" for value in (*off.hand, *off.box)]
        yield f"| {name} | " + " | ".join([*cells, f"{off.drawn_out:.2f}", f"{off.risen:.2f}"]) + " |"
    centres = _travel(box_centres(record, 201))
    blank = " | ".join([""] * (len(heads) - 2))
    yield f"| recorded | {blank} | {-centres[:, 0].min():.2f} | {centres[:, 2].max():.2f} |"


def main() -> int:
    """Read, solve, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=DATA, help="folder with markers_analogs.c3d")
    parser.add_argument("--set", action="append", default=[], dest="overrides", metavar="KEY=VALUE")
    args = parser.parse_args()
    if not (args.data / "markers_analogs.c3d").is_file():
        print(f"{args.data}: the recorded box lift (test data of pyomeca) is not there; name its folder by --data")
        return 0
    for line in table(read(args.data), args.overrides):
        print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
