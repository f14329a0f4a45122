"""A person's posture over time as an observer with a goniometer would note it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.ergonomics.lift import Lift, R_world_person, model_of
from liftopt.multibody.agent import Agent
from liftopt.multibody.trajectory import GRAVITY, AgentTrajectory
from liftopt.types import Array

TRUNK, SHOULDER, ELBOW, WRIST = "Q3", "Q4", "Q7", "Q9"  # joints of Table 2 whose links begin there


@dataclass(frozen=True)
class Posture:
    """Trunk, right arm and hand at K times; angles in deg, arrays (K,).

    Attributes:
        trunk_flexion, trunk_bend, trunk_turn: forward, to the right, to the left.
        upper_arm_flexion: of the upper arm against the trunk, seen from the side; negative is backwards.
        upper_arm_out: angle of the upper arm out of the trunk's sagittal plane; positive is away from the body.
        elbow_flexion: 0 is a straight arm.
        wrist_left: distance of the wrist to the left of the trunk's sagittal plane [m].
        wrist_outside: distance of the wrist to the right of the shoulder joint [m].
        pronation: of the forearm, from the middle of its range; 0 is the thumb up.
        wrist_flexion: towards the palm positive.
        wrist_deviation: to the little finger positive.
        hand_load: magnitude of the force on the hand [kg], that is N / 9.81 m/s^2.
    """

    trunk_flexion: Array
    trunk_bend: Array
    trunk_turn: Array
    upper_arm_flexion: Array
    upper_arm_out: Array
    elbow_flexion: Array
    wrist_left: Array
    wrist_outside: Array
    pronation: Array
    wrist_flexion: Array
    wrist_deviation: Array
    hand_load: Array


def posture_of(lift: Lift, person: AgentTrajectory) -> Posture:
    """Return the posture of a person at every time of a lift."""
    agent = model_of(lift, person.name)
    q = {name.removeprefix(f"{person.name}_"): np.degrees(person.q[:, i]) for i, name in enumerate(person.joint_names)}
    shoulder, elbow, wrist = _in_trunk(agent, R_world_person(lift, person.name), person.q)
    arm = (elbow - shoulder) / np.linalg.norm(elbow - shoulder, axis=1, keepdims=True)
    limits, names = agent.limits, agent.moving_joints
    middle = np.degrees((limits.q_lower + limits.q_upper) / 2)[names.index(f"{person.name}_Q8")]
    return Posture(
        trunk_flexion=q["Q2"],
        trunk_bend=q["Q1"],
        trunk_turn=q["Q3"],
        upper_arm_flexion=np.degrees(np.arctan2(arm[:, 0], -arm[:, 2])),
        upper_arm_out=np.degrees(np.arcsin(np.clip(-arm[:, 1], -1.0, 1.0))),
        elbow_flexion=-q["Q7"],
        wrist_left=wrist[:, 1],
        wrist_outside=shoulder[:, 1] - wrist[:, 1],
        pronation=middle - q["Q8"],
        wrist_flexion=-q["Q9"],
        wrist_deviation=q["Q10"],
        hand_load=np.linalg.norm(person.load, axis=1) / GRAVITY,
    )


def _in_trunk(agent: Agent, upright: Array, q: Array) -> tuple[Array, Array, Array]:
    """Return shoulder, elbow and wrist (K, 3) from the base of the spine; axes of the trunk: forward, left, up.

    Args:
        agent: the person's model.
        upright: (3, 3) those axes in the world where the person stands upright.
        q: (K, n) its joints.
    """
    model = agent.model
    data = model.createData()
    trunk, *points = (model.getFrameId(f"{agent.name}_{joint}_link") for joint in (TRUNK, SHOULDER, ELBOW, WRIST))
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    R_link_trunk = data.oMf[trunk].rotation.T @ upright
    placed = np.zeros((len(points), len(q), 3))
    for k, posture in enumerate(q):
        pin.framesForwardKinematics(model, data, posture)
        rotation = data.oMf[trunk].rotation @ R_link_trunk
        for i, point in enumerate(points):
            placed[i, k] = rotation.T @ (data.oMf[point].translation - data.oMf[trunk].translation)
    return placed[0], placed[1], placed[2]
