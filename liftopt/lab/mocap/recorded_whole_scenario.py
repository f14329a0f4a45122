"""A recorded lift of a whole person as a scenario: the same person alone, both hands where they held, box and time.

The object keeps its place over the feet at the start and at the end of the time in which it is carried. Its box is as
large as the hands are apart; each hand that bore some of it holds where it held, as seen in the object's axes, and in
the way whose reference orientation is nearest to the recorded hand. The person bears all of it: there is no robot.

Left out are that feet, legs and trunk are not those of the recording, what stands in the way, and that the recorded
arm may start in motion. Markers show neither the object's sides nor its centre of mass: these are in the middle of its
markers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from liftopt.lab.mocap.recorded_lift import RecordedLift, RecordedWhole
from liftopt.multibody.edges import HOLDS
from liftopt.multibody.person.holds import hand_on
from liftopt.multibody.person.whole_joints import HANDS
from liftopt.multibody.urdf import load_model
from liftopt.scenario.hands import BOTH, Hand
from liftopt.scenario.model import Scenario, scenario_from_dict
from liftopt.types import Array

HEIGHT = 0.25  # m of the box: markers do not show it
LEAST = 0.2  # m of its depth and width
IDLE = 0.02  # of the other hand's force; one that bears no more does not hold


def whole_scenario(lift: RecordedLift, whole: RecordedWhole, mass: float, name: str) -> Scenario:
    """Return the scenario of a whole person's recorded lift.

    Args:
        lift: with an object that is carried once.
        whole: what it has of the whole person.
        mass: of the object [kg].
        name: of the scenario.

    Raises:
        InputError: a value is out of a scenario's range.
    """
    assert lift.object_position is not None
    assert lift.object_quaternion is not None
    assert lift.carried is not None
    carried = (lift.time >= lift.carried[0]) & (lift.time <= lift.carried[1])
    turn = np.array([pin.Quaternion(one).toRotationMatrix() for one in lift.object_quaternion[carried]])
    away = whole.grasp_position[carried] - lift.object_position[carried, None]
    held = np.einsum("kji,kgj->kgi", turn, away).mean(axis=0)
    hands = np.einsum("kji,kgjl->kgil", turn, _hands(lift)[carried])
    start, end = lift.over_lift(lift.object_position, 2)
    person = lift.subject
    holding = _holding(whole.grasp_force[carried])
    grasps = {
        (f"human_{hand}" if len(holding) > 1 else "human"): {
            "place": _hold(hands[:, i], hand),
            "position": [to_thousandths(x) for x in held[i]],
        }
        for i, hand in holding.items()
    }
    depth, width, height = 2.0 * np.abs(held[list(holding)]).max(axis=0)
    tables: dict[str, Any] = {
        "schema": 2,
        "name": name,
        "duration": to_thousandths(lift.carried[1] - lift.carried[0]),
        "agents": {
            "human": {
                "kind": "person",
                "stature": to_thousandths(person.stature),
                "mass": person.mass,
                "sex": person.sex,
                "body": "whole",
                "hands": list(holding.values()),
            }
        },
        "object": {
            "name": "box",
            "mass": mass,
            "depth": max(to_thousandths(depth), LEAST),
            "width": max(to_thousandths(width), LEAST),
            "height": max(to_thousandths(height), HEIGHT),
            "grasps": grasps,
        },
        "task": {
            "start": {"x": to_thousandths(start[0]), "z": to_thousandths(start[2])},
            "end": {"x": to_thousandths(end[0]), "z": to_thousandths(end[2])},
        },
    }
    return scenario_from_dict(tables)


def _holding(force: Array) -> dict[int, Hand]:
    """Return the hands that bear something (K, 2, 3) by their number; both where no force is known."""
    peak = np.linalg.norm(force, axis=2).max(axis=0)
    return {i: hand for i, hand in enumerate(BOTH) if peak[i] > IDLE * peak.max() or not peak.any()}


def _hands(lift: RecordedLift) -> Array:
    """Return R_world_hand (K, 2, 3, 3) of right and left hand."""
    model = load_model(lift.urdf)
    data, frames = model.createData(), [model.getFrameId(f"human_{hand}_grasp") for hand in HANDS]
    turns = np.zeros((len(lift.q), len(HANDS), 3, 3))
    for k, q in enumerate(lift.q):
        pin.framesForwardKinematics(model, data, q)
        for i, frame in enumerate(frames):
            turns[k, i] = data.oMf[frame].rotation
    return turns


def _hold(hands: Array, hand: Hand) -> str:
    """Return the way to hold that turns a hand least from R_object_hand (K, 3, 3), on average."""
    near = {hold: float((hands * hand_on(hold, hand)).sum(axis=(1, 2)).mean()) for hold in HOLDS}
    return max(near, key=lambda hold: near[hold])


def to_thousandths(value: float) -> float:
    """Return a length [m] or a time [s] to three digits after the point."""
    return round(float(value), 3)
