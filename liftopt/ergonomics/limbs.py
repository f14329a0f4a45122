"""Which arms and legs a person's model has, by the names of its joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array

RIGHT, LEFT = "right", "left"
SHOULDER = "Q4"  # the first joint of an arm
LEGS = ("ankle", "knee", "hip")


@dataclass(frozen=True)
class Arm:
    """One arm that moves.

    Attributes:
        side: ``"right"`` or ``"left"``.
        prefix: what its joints and frames begin with, ``"human_"`` or ``"human_left_"``.
    """

    side: str
    prefix: str

    @property
    def outward(self) -> float:
        """Sign of the way out of the body along an axis to the left."""
        return -1.0 if self.side == RIGHT else 1.0


def arms_of(person: AgentTrajectory) -> tuple[Arm, ...]:
    """Return the arms that a person's model moves, the right one first; one that has no side's name is the right."""
    if f"{person.name}_{SHOULDER}" in person.joint_names:
        return (Arm(RIGHT, f"{person.name}_"),)
    return tuple(Arm(side, f"{person.name}_{side}_") for side in (RIGHT, LEFT))


def grasps_of(person: AgentTrajectory, arm: Arm) -> list[int]:
    """Return the numbers of the grasps that an arm's hand holds with; none where it is free."""
    return [i for i, grasp in enumerate(person.grasps) if grasp.frame.startswith(arm.prefix)]


def holding_arms(person: AgentTrajectory) -> tuple[Arm, ...]:
    """Return the arms whose hands hold the object."""
    return tuple(arm for arm in arms_of(person) if grasps_of(person, arm))


def hand_force(person: AgentTrajectory, arm: Arm) -> Array:
    """Return the force (K, 3) of an arm's hand on the object, world axes [N]."""
    return np.asarray(person.grasp_force[:, grasps_of(person, arm)].sum(axis=1))


def has_legs(person: AgentTrajectory) -> bool:
    """Return whether a person's legs move."""
    return f"{person.name}_{LEGS[0]}" in person.joint_names


def joint_angle(person: AgentTrajectory, joint: str) -> Array:
    """Return the angle (K,) of a joint by its name without the person's, 0 where the model has no such joint [deg]."""
    name = f"{person.name}_{joint}"
    if name not in person.joint_names:
        return np.zeros(len(person.q))
    return np.asarray(np.degrees(person.q[:, person.joint_names.index(name)]))
