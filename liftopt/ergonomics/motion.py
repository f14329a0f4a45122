"""How a person moves in a lift: angles that show whether it is a motion that people make, and the hand's path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.signal import find_peaks

from liftopt.ergonomics.lift import Lift, model_of
from liftopt.ergonomics.limbs import Arm, holding_arms
from liftopt.ergonomics.posture import WRIST, posture_of
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array

PROMINENT = 0.1  # share of the highest speed by which a peak stands out from the dips beside it


@dataclass(frozen=True)
class Motion:
    """Trunk, one arm and its hand at K times; angles in deg, arrays (K,), alike on both sides.

    Attributes:
        elbow: flexion; 0 is a straight arm.
        humeral_elevation: angle between the upper arm and the trunk's downward axis.
        abduction: the part of that elevation that leads sideways, away from the body: the component about the forward
            axis of the shortest rotation from the hanging arm.
        wrist_flexion: towards the palm positive.
        wrist_deviation: to the little finger positive.
        wrist_bend: angle between hand and forearm, of both together.
        twist: of the trunk about its own axis, to the left positive.
        wrist_height: of the wrist joint above the floor [m].
        path_over_chord: length of the hand's path over the distance between its ends.
        speed_peaks: number of peaks of the hand's speed.
        trunk_inclination: of the trunk against the vertical, forward.
        knee: flexion; None of one whose legs do not move.
    """

    elbow: Array
    humeral_elevation: Array
    abduction: Array
    wrist_flexion: Array
    wrist_deviation: Array
    wrist_bend: Array
    twist: Array
    wrist_height: Array
    path_over_chord: float
    speed_peaks: int
    trunk_inclination: Array
    knee: Array | None


def motion_of(lift: Lift, person: AgentTrajectory) -> Motion:
    """Return how a person moves at every time of a lift; a finer grid sees what is between the knots.

    Of two arms that hold, the right one is measured; the path is that of the middle between the hands.
    """
    arm, posture = holding_arms(person)[0], posture_of(lift, person)
    limb = posture.arm(arm.side)
    flexion, out = np.radians(limb.upper_arm_flexion), np.radians(limb.upper_arm_out)
    forward, sideways, down = np.sin(flexion) * np.cos(out), np.sin(out), np.cos(flexion) * np.cos(out)
    elevation = np.arccos(np.clip(down, -1.0, 1.0))
    level = np.hypot(forward, sideways)
    bend = np.cos(np.radians(limb.wrist_flexion)) * np.cos(np.radians(limb.wrist_deviation))
    path = person.p_world_hold
    length = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
    return Motion(
        elbow=limb.elbow_flexion,
        humeral_elevation=np.degrees(elevation),
        abduction=np.degrees(elevation * np.divide(sideways, level, out=np.zeros_like(level), where=level > 0.0)),
        wrist_flexion=limb.wrist_flexion,
        wrist_deviation=limb.wrist_deviation,
        wrist_bend=np.degrees(np.arccos(np.clip(bend, -1.0, 1.0))),
        twist=posture.trunk_turn,
        wrist_height=_wrist_height(lift, person, arm),
        path_over_chord=length / float(np.linalg.norm(path[-1] - path[0])),
        speed_peaks=_peaks(np.linalg.norm(np.gradient(path, lift.time, axis=0), axis=1)),
        trunk_inclination=posture.trunk_inclination,
        knee=posture.knee if person.stance is not None else None,
    )


def _wrist_height(lift: Lift, person: AgentTrajectory, arm: Arm) -> Array:
    agent = model_of(lift, person.name)
    data, frame = agent.model.createData(), agent.model.getFrameId(f"{arm.prefix}{WRIST}_link")
    height = np.zeros(len(person.q))
    for k, q in enumerate(person.q):
        pin.framesForwardKinematics(agent.model, data, q)
        height[k] = data.oMf[frame].translation[2]
    return height


def _peaks(speed: Array) -> int:
    rested = np.concatenate([[0.0], speed, [0.0]])  # a peak at an end is one too
    return len(find_peaks(rested, prominence=PROMINENT * float(speed.max()))[0])
