"""What a joint of Tables 2 and 3 is to its user: anatomy for a person, the manufacturer's name for a robot."""

from __future__ import annotations

from collections.abc import Mapping

from liftopt.multibody.agent import Kind

ARM_JOINTS = tuple(f"Q{k}" for k in range(4, 11))
# The motion named is the positive direction of the joint, except where (-) says otherwise; right arm.
HUMAN_JOINTS = {
    "Q1": "trunk bend right",
    "Q2": "trunk flexion",
    "Q3": "trunk turn left",
    "Q4": "shoulder adduction",
    "Q5": "shoulder flexion",
    "Q6": "shoulder int. rotation",
    "Q7": "elbow flexion (-)",
    "Q8": "forearm supination",
    "Q9": "wrist extension",
    "Q10": "wrist ulnar deviation",
}
# Of the whole person; both arms have the right one's motions and signs.
WHOLE_JOINTS = {
    "ankle": "ankle dorsiflexion",
    "knee": "knee flexion",
    "hip": "hip flexion",
    **{f"{side}_{joint}": f"{side} {HUMAN_JOINTS[joint]}" for side in ("right", "left") for joint in ARM_JOINTS},
}
# The manufacturer's joint names; the sign is that of its angle where Table 3's is Q.
SAWYER_JOINTS = {
    "Q1": "right_j0",
    "Q2": "right_j1",
    "Q3": "right_j2",
    "Q4": "-right_j3",
    "Q5": "right_j4",
    "Q6": "right_j5",
    "Q7": "right_j6",
}


def joint_meanings(kind: Kind, model: str = "") -> Mapping[str, str]:
    """Return what the joints are, by their names without the agent's; nothing of a robot that has no table.

    Args:
        kind: of the agent.
        model: of a robot, as the scenario names it.
    """
    if kind == "person":
        return HUMAN_JOINTS | WHOLE_JOINTS
    return SAWYER_JOINTS if model == "sawyer" else {}
