"""Joints over time as they are read: a person's in an anatomist's words and signs, a robot's by its maker's names."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from liftopt.multibody.joint_meanings import joint_meanings
from liftopt.multibody.joint_units import JointUnits
from liftopt.multibody.trajectory import AgentTrajectory, limit_share
from liftopt.types import Array


@dataclass(frozen=True)
class AnatomicalJoint:
    """One joint of a person as anatomy counts it.

    Attributes:
        joint: name without the person's, ``"Q7"``, ``"left_Q7"``, ``"knee"``.
        motion: the motion that is positive, ``"elbow flexion"``.
        opposite: the motion that is negative.
        sign: anatomical angle (and torque) over the model's, +1 or -1; both are zero in the zero pose (upright, arms
            hanging, palms forward).
        part: of the whole body that it belongs to, ``"left arm"``; empty of a person with one arm.
    """

    joint: str
    motion: str
    opposite: str
    sign: int
    part: str = ""

    @property
    def dh(self) -> str:
        """The joint of Table 2 with its sign, ``"-Q7"``; nothing of a leg, which Table 2 has not."""
        joint = self.joint.rpartition("_")[2]
        if joint in LEGS:
            return ""
        return joint if self.sign > 0 else f"\N{MINUS SIGN}{joint}"

    @property
    def label(self) -> str:
        """Both names, ``"Elbow flexion (-Q7)"``."""
        title = f"{self.motion[0].upper()}{self.motion[1:]}"
        return f"{title} ({self.dh})" if self.dh else title


ANATOMY: tuple[AnatomicalJoint, ...] = (
    AnatomicalJoint("Q1", "trunk bend to the right", "to the left", +1),
    AnatomicalJoint("Q2", "trunk flexion", "extension", +1),
    AnatomicalJoint("Q3", "trunk turn to the left", "to the right", +1),
    AnatomicalJoint("Q4", "shoulder abduction", "adduction", -1),
    AnatomicalJoint("Q5", "shoulder flexion", "extension", +1),
    AnatomicalJoint("Q6", "shoulder internal rotation", "external rotation", +1),
    AnatomicalJoint("Q7", "elbow flexion", "extension", -1),
    AnatomicalJoint("Q8", "forearm pronation", "supination", -1),
    AnatomicalJoint("Q9", "wrist flexion", "extension", -1),
    AnatomicalJoint("Q10", "wrist ulnar deviation", "radial deviation", +1),
)
LEGS: dict[str, AnatomicalJoint] = {
    "ankle": AnatomicalJoint("ankle", "ankle dorsiflexion", "plantarflexion", +1, "legs"),
    "knee": AnatomicalJoint("knee", "knee flexion", "extension", +1, "legs"),
    "hip": AnatomicalJoint("hip", "hip flexion", "extension", +1, "legs"),
}


@dataclass(frozen=True)
class JointCurve:
    """One joint over time in the signs it is shown in.

    Attributes:
        joint: short name, ``"Q7"``.
        label: for a reader, DH name included.
        part: of the body that it belongs to, where it has several.
        q: (K,) angle [deg], or position of a joint that slides [mm].
        v: (K,) speed, that per second.
        tau: (K,) torque [Nm] or force [N], positive in the positive direction of ``q``.
        q_limits, tau_limits: lower and upper limit of either.
        v_limit: of the speed, either way.
        share: (K,) torque as a fraction of the limit in its direction.
        units: of the joint.
    """

    joint: str
    label: str
    part: str
    q: Array
    v: Array
    tau: Array
    q_limits: tuple[float, float]
    tau_limits: tuple[float, float]
    v_limit: float
    share: Array
    units: JointUnits


def anatomy_of(human: AgentTrajectory) -> tuple[AnatomicalJoint, ...]:
    """Return the joints of a person that move, in the model's order: ten, or those of the whole body by its parts."""
    joints = [name.removeprefix(f"{human.name}_") for name in human.moving_joints]
    whole = any(joint in LEGS for joint in joints)
    return tuple(_anatomy(joint, whole=whole) for joint in joints)


def _anatomy(joint: str, *, whole: bool) -> AnatomicalJoint:
    if joint in LEGS:
        return LEGS[joint]
    side, _, name = joint.rpartition("_")
    (found,) = (item for item in ANATOMY if item.joint == name)
    if side:
        return replace(found, joint=joint, motion=f"{side} {found.motion}", part=f"{side} arm")
    return replace(found, part="trunk") if whole else found


def human_curves(human: AgentTrajectory) -> tuple[JointCurve, ...]:
    """Return the joints of a person that move, in anatomical signs."""
    return tuple(_curve(human, item.joint, item.label, item.sign, item.part) for item in anatomy_of(human))


def robot_curves(robot: AgentTrajectory, model: str) -> tuple[JointCurve, ...]:
    """Return the moving joints of the robot ``model`` as in Table 3, with the manufacturer's names beside them."""
    curves = []
    for name in np.array(robot.joint_names)[robot.moving]:
        joint = str(name).removeprefix(f"{robot.name}_")
        meaning = joint_meanings(robot.kind, model).get(joint, "").replace("-", "\N{MINUS SIGN}")
        curves.append(_curve(robot, joint, f"{joint} ({meaning})" if meaning else joint, +1))
    return tuple(curves)


def _curve(agent: AgentTrajectory, joint: str, label: str, sign: int, part: str = "") -> JointCurve:
    column = agent.joint_names.index(f"{agent.name}_{joint}")
    row = int(np.count_nonzero(agent.moving[:column]))
    limits, tau, units = agent.limits, agent.tau[:, column], agent.units[row]
    q = np.array([limits.q_lower[row], limits.q_upper[row]]) * units.factor
    lower, upper = float(limits.tau_lower[row]), float(limits.tau_upper[row])
    return JointCurve(
        joint=joint,
        label=label,
        part=part,
        q=sign * agent.q[:, column] * units.factor,
        v=sign * agent.v[:, column] * units.factor,
        tau=sign * tau,
        q_limits=(float(min(sign * q)), float(max(sign * q))),
        tau_limits=(min(sign * lower, sign * upper), max(sign * lower, sign * upper)),
        v_limit=float(limits.velocity[row] * units.factor),
        share=limit_share(agent)[:, row],
        units=units,
    )
