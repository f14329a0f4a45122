"""A person's posture over time as an observer with a goniometer would note it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.ergonomics.lift import Lift, R_world_person, model_of, subject_in
from liftopt.ergonomics.limbs import Arm, arms_of, hand_force, has_legs, joint_angle
from liftopt.multibody.agent import Agent
from liftopt.multibody.person.anthropometry import feet_apart
from liftopt.multibody.trajectory import GRAVITY, AgentTrajectory
from liftopt.types import Array

TRUNK, SHOULDER, ELBOW, WRIST = "Q3", "Q4", "Q7", "Q9"  # joints of Table 2 whose links begin there


@dataclass(frozen=True)
class ArmPosture:
    """One arm and its hand at K times; angles in deg, arrays (K,), alike on both sides.

    Attributes:
        side: ``"right"`` or ``"left"``.
        upper_arm_flexion: of the upper arm against the trunk, seen from the side; negative is backwards.
        upper_arm_out: angle of the upper arm out of the trunk's sagittal plane; positive is away from the body.
        elbow_flexion: 0 is a straight arm.
        wrist_across: how far the wrist is past the trunk's sagittal plane, on the other arm's side [m].
        wrist_outside: how far it is outside the shoulder joint [m].
        pronation: of the forearm, from the middle of its range; 0 is the thumb up.
        wrist_flexion: towards the palm positive.
        wrist_deviation: to the little finger positive.
        hand_load: magnitude of the force on the hand [kg], that is N / 9.81 m/s^2.
    """

    side: str
    upper_arm_flexion: Array
    upper_arm_out: Array
    elbow_flexion: Array
    wrist_across: Array
    wrist_outside: Array
    pronation: Array
    wrist_flexion: Array
    wrist_deviation: Array
    hand_load: Array


@dataclass(frozen=True)
class Posture:
    """Legs, trunk and arms at K times; angles in deg, arrays (K,); legs that do not move are straight.

    Attributes:
        ankle, knee, hip: flexion from upright stance, of both legs.
        heavier_foot: share of the weight on the foot that bears more of it; half where the legs do not move.
        trunk_flexion, trunk_bend, trunk_turn: against the pelvis: forward, to the right, to the left.
        trunk_inclination: of the trunk against the vertical, forward, whatever bends: hip, trunk or both.
        load: magnitude of the force on both hands together [kg], that is N / 9.81 m/s^2.
        arms: those that move, the right one first.
    """

    ankle: Array
    knee: Array
    hip: Array
    heavier_foot: Array
    trunk_flexion: Array
    trunk_bend: Array
    trunk_turn: Array
    trunk_inclination: Array
    load: Array
    arms: tuple[ArmPosture, ...]

    def arm(self, side: str) -> ArmPosture:
        """Return the arm of one side."""
        return next(arm for arm in self.arms if arm.side == side)


def posture_of(lift: Lift, person: AgentTrajectory) -> Posture:
    """Return the posture of a person at every time of a lift."""
    apart = feet_apart(subject_in(lift, person.name))
    return posture_by(model_of(lift, person.name), person, R_world_person(lift, person.name), apart)


def posture_by(agent: Agent, person: AgentTrajectory, upright: Array, apart: float) -> Posture:
    """Return the posture of a person at K times.

    Args:
        agent: the person's model.
        person: its motion and forces.
        upright: (3, 3) forward, left and up in the world where the person stands upright.
        apart: distance between the middles of the feet [m].
    """
    arms = arms_of(person)
    points, up = _placed(agent, upright, person.q, arms)
    return Posture(
        ankle=joint_angle(person, "ankle"),
        knee=joint_angle(person, "knee"),
        hip=joint_angle(person, "hip"),
        heavier_foot=_heavier_foot(person, upright, apart),
        trunk_flexion=joint_angle(person, "Q2"),
        trunk_bend=joint_angle(person, "Q1"),
        trunk_turn=joint_angle(person, "Q3"),
        # Out of the plane through the body from side to side; a trunk that only bends sideways is not inclined.
        trunk_inclination=np.degrees(np.arctan2(up[:, 0], np.copysign(np.hypot(up[:, 1], up[:, 2]), up[:, 2]))),
        load=np.linalg.norm(person.load, axis=1) / GRAVITY,
        arms=tuple(_arm(agent, person, arm, *points[arm]) for arm in arms),
    )


def _heavier_foot(person: AgentTrajectory, upright: Array, apart: float) -> Array:
    """Return the share (K,) of the weight on the foot that bears more: how far aside the centre of pressure is."""
    if not has_legs(person):
        return np.full(len(person.q), 0.5)
    to_the_left = (person.ground_moment @ upright)[:, 0] / person.ground_force[:, 2]
    return np.asarray(0.5 + np.abs(to_the_left) / apart)


def _arm(agent: Agent, person: AgentTrajectory, arm: Arm, shoulder: Array, elbow: Array, wrist: Array) -> ArmPosture:
    upper = (elbow - shoulder) / np.linalg.norm(elbow - shoulder, axis=1, keepdims=True)
    limits, forearm = agent.limits, agent.moving_joints.index(f"{arm.prefix}Q8")
    middle = np.degrees((limits.q_lower + limits.q_upper) / 2)[forearm]
    own = arm.prefix.removeprefix(f"{person.name}_")
    return ArmPosture(
        side=arm.side,
        upper_arm_flexion=np.degrees(np.arctan2(upper[:, 0], -upper[:, 2])),
        upper_arm_out=np.degrees(np.arcsin(np.clip(arm.outward * upper[:, 1], -1.0, 1.0))),
        elbow_flexion=-joint_angle(person, f"{own}Q7"),
        wrist_across=-arm.outward * wrist[:, 1],
        wrist_outside=arm.outward * (wrist[:, 1] - shoulder[:, 1]),
        pronation=middle - joint_angle(person, f"{own}Q8"),
        wrist_flexion=-joint_angle(person, f"{own}Q9"),
        wrist_deviation=joint_angle(person, f"{own}Q10"),
        hand_load=np.linalg.norm(hand_force(person, arm), axis=1) / GRAVITY,
    )


def _placed(
    agent: Agent, upright: Array, q: Array, arms: tuple[Arm, ...]
) -> tuple[dict[Arm, tuple[Array, Array, Array]], Array]:
    """Return shoulder, elbow and wrist (K, 3) of each arm, and the way up along the trunk (K, 3) as the person stands.

    The points are seen from the trunk's link, in axes of the trunk: forward, left, up.

    Args:
        agent: the person's model.
        upright: (3, 3) those axes in the world where the person stands upright.
        q: (K, n) its joints.
        arms: that are placed.
    """
    model = agent.model
    data = model.createData()
    trunk = model.getFrameId(f"{agent.name}_{TRUNK}_link")
    frames = [model.getFrameId(f"{arm.prefix}{joint}_link") for arm in arms for joint in (SHOULDER, ELBOW, WRIST)]
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    R_link_trunk = data.oMf[trunk].rotation.T @ upright
    placed, up = np.zeros((len(frames), len(q), 3)), np.zeros((len(q), 3))
    for k, posture in enumerate(q):
        pin.framesForwardKinematics(model, data, posture)
        rotation = data.oMf[trunk].rotation @ R_link_trunk
        up[k] = upright.T @ rotation[:, 2]
        for i, frame in enumerate(frames):
            placed[i, k] = rotation.T @ (data.oMf[frame].translation - data.oMf[trunk].translation)
    return {arm: (placed[3 * i], placed[3 * i + 1], placed[3 * i + 2]) for i, arm in enumerate(arms)}, up
