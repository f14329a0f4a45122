"""The recorded box lift (pyomeca's test data), predicted around the shelves that it was recorded with."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import coal
import numpy as np
import pinocchio as pin
import pytest

from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.search.solve import solve
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution

pytestmark = pytest.mark.long
SCRIPT = Path(__file__).parents[3] / "scripts" / "check_box_lift.py"
WHENEVER = {"solver.time_limit": 3600.0}  # however slow the machine is
TIMES = 317  # at which it is looked; no multiple of the mesh's intervals


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("check_box_lift", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # its dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def record(script: ModuleType, box_lift: Path) -> RecordedLift:
    lift: RecordedLift = script.read(box_lift)
    return lift


@pytest.fixture(scope="module")
def with_shelves(script: ModuleType, record: RecordedLift) -> Solution:
    return solve(script.box_scenario(record, "natural").replace(WHENEVER))


def apart(size: tuple[float, ...], pose: coal.Transform3s, board: coal.Box, at: coal.Transform3s) -> float:
    """Return the signed distance of a box and a board [m]."""
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    request.enable_signed_distance = True
    return float(coal.distance(coal.Box(*size), pose, board, at, request, result))


def test_the_recorded_box_passes_these_shelves(script: ModuleType, record: RecordedLift) -> None:
    """The assumed size of box and boards: put under where the recorded box stands, none is in its recorded way."""
    centres = script.box_centres(record, TIMES)
    turns = [pin.Quaternion(one).normalized().matrix() for one in record.over_lift(record.object_quaternion, TIMES)]
    size = (script.DEPTH, script.DEPTH, script.HEIGHT)  # the handles stick out beside the boards
    board = coal.Box(script.DEPTH - script.FINGERS, script.DEPTH, script.BOARD)
    below = np.array([script.FINGERS / 2, 0.0, -script.HEIGHT / 2 - script.GAP - script.BOARD / 2])
    for stands in (centres[0], centres[-1]):
        at = coal.Transform3s(np.eye(3), stands + below)
        poses = [coal.Transform3s(turn, centre) for turn, centre in zip(turns, centres, strict=True)]
        assert min(apart(size, pose, board, at) for pose in poses) > -0.003


def test_it_is_solved_and_clear(with_shelves: Solution) -> None:
    """Measured by coal on the object's trajectory at times that no solver saw, and as verified for all bodies."""
    assert with_shelves.solved, with_shelves.status
    assert with_shelves.clearance is not None
    assert min(item.distance for item in with_shelves.clearance.closest) > -1e-3
    box, dense = with_shelves.scenario.object, resample(with_shelves, 16)
    for shelf in with_shelves.scenario.obstacles:
        board = coal.Box(*shelf.box)
        at = coal.Transform3s(np.eye(3), np.array(shelf.position))
        for pose, (x, y, z, w) in zip(dense.object.pose, dense.object.quaternion, strict=True):
            turn = pin.Quaternion(w, x, y, z).matrix()
            held = coal.Transform3s(turn, pose[:3])
            assert apart((box.depth, box.width, box.height), held, board, at) > -1.5e-3


def test_the_shelves_draw_the_box_out(script: ModuleType, record: RecordedLift, with_shelves: Solution) -> None:
    """The recording draws it 0.45 m towards the person; nothing but a shelf asks a prediction to do so."""
    free = script.distance(solve(script.box_scenario(record, "natural", shelves=False).replace(WHENEVER)), record)
    found = script.distance(with_shelves, record)
    assert free.drawn_out < 0.3 < 0.35 < found.drawn_out < 0.55
    assert found.hand[0] < free.hand[0]
    assert found.box[0] < free.box[0]


def test_how_near_to_the_recording(script: ModuleType, record: RecordedLift, with_shelves: Solution) -> None:
    """Bands about what was measured; elbow and abduction are far off, and the documentation says so."""
    found = script.distance(with_shelves, record)
    assert max(found.hand) < 0.11
    assert max(found.box) < 0.11
    assert found.angles["humeral_elevation"] < 15.0
    assert found.angles["twist"] < 15.0
    assert found.angles["elbow"] < 50.0


def test_a_hand_around_the_handle_keeps_the_wrist_as_recorded(
    script: ModuleType, record: RecordedLift, with_shelves: Solution
) -> None:
    """A palm under an edge bends the wrist; the recorded hand holds a handle."""
    around = solve(with_shelves.scenario.replace(script.AROUND_HANDLE))
    assert around.solved, around.status
    wrist = script.distance(around, record).angles["wrist_flexion"]
    assert wrist < 15.0 < 30.0 < script.distance(with_shelves, record).angles["wrist_flexion"]
