"""The person's posture over time as an observer with a goniometer would note it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.multibody.agent import Agent
from liftopt.scenario.build import agents_of
from liftopt.solution.solution import Solution
from liftopt.solution.summary import GRAVITY

Array = npt.NDArray[np.float64]
TRUNK, SHOULDER, ELBOW, WRIST = "human_Q3_link", "human_Q4_link", "human_Q7_link", "human_Q9_link"


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


def posture_of(solution: Solution) -> Posture:
    """Return the posture of the person at every time of ``solution``."""
    agent, human = agents_of(solution.scenario, solution.urdfs)[0], solution.agents[0]
    q = {name: np.degrees(human.q[:, i]) for i, name in enumerate(human.joint_names)}
    shoulder, elbow, wrist = _in_trunk(agent, human.q)
    arm = (elbow - shoulder) / np.linalg.norm(elbow - shoulder, axis=1, keepdims=True)
    limits, names = agent.limits, agent.moving_joints
    middle = np.degrees((limits.q_lower + limits.q_upper) / 2)[names.index("human_Q8")]
    return Posture(
        trunk_flexion=q["human_Q2"],
        trunk_bend=q["human_Q1"],
        trunk_turn=q["human_Q3"],
        upper_arm_flexion=np.degrees(np.arctan2(arm[:, 0], -arm[:, 2])),
        upper_arm_out=np.degrees(np.arcsin(np.clip(-arm[:, 1], -1.0, 1.0))),
        elbow_flexion=-q["human_Q7"],
        wrist_left=wrist[:, 1],
        wrist_outside=shoulder[:, 1] - wrist[:, 1],
        pronation=middle - q["human_Q8"],
        wrist_flexion=-q["human_Q9"],
        wrist_deviation=q["human_Q10"],
        hand_load=np.linalg.norm(human.grasp_force, axis=1) / GRAVITY,
    )


def _in_trunk(agent: Agent, q: Array) -> tuple[Array, Array, Array]:
    """Return shoulder, elbow and wrist (K, 3) from the base of the spine; axes of the trunk: forward, left, up."""
    model = agent.model
    data = model.createData()
    trunk, *points = (model.getFrameId(name) for name in (TRUNK, SHOULDER, ELBOW, WRIST))
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    upright = data.oMf[trunk].rotation.copy()  # upright, the trunk's axes are those of the world
    placed = np.zeros((len(points), len(q), 3))
    for k, posture in enumerate(q):
        pin.framesForwardKinematics(model, data, posture)
        rotation = data.oMf[trunk].rotation @ upright.T
        for i, point in enumerate(points):
            placed[i, k] = rotation.T @ (data.oMf[point].translation - data.oMf[trunk].translation)
    return placed[0], placed[1], placed[2]
