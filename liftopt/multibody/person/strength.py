"""Static strength of the human joints, each direction apart: 50th percentile men and women."""

from __future__ import annotations

from dataclasses import dataclass

from liftopt.multibody.person.subject import Sex, Subject
from liftopt.multibody.sources import SCALED_GYMNAST, STOBBE_1982, Source


@dataclass(frozen=True)
class Strength:
    """Largest torque of one joint of Table 2 in one direction.

    Attributes:
        joint: ``"Q1"`` to ``"Q10"``.
        sign: +1 or -1, the direction of the joint angle that the torque drives.
        motion: its anatomical name.
        torque: by sex [Nm], positive.
        source: of the torque.
    """

    joint: str
    sign: int
    motion: str
    torque: dict[Sex, float]
    source: Source

    def of(self, subject: Subject) -> float:
        """Return the torque of a subject [Nm], positive."""
        return self.torque[subject.sex]


def _strength(joint: str, sign: int, motion: str, male: float, female: float, source: Source) -> Strength:
    return Strength(joint, sign, motion, {"male": male, "female": female}, source)


STRENGTHS: tuple[Strength, ...] = (
    _strength("Q1", -1, "bend to the left", 159.0, 94.0, STOBBE_1982),
    _strength("Q1", +1, "bend to the right", 159.0, 94.0, STOBBE_1982),
    _strength("Q2", -1, "spine extension", 234.0, 184.0, STOBBE_1982),
    _strength("Q2", +1, "spine flexion", 143.0, 75.0, STOBBE_1982),
    _strength("Q3", -1, "turn to the right", 80.0, 45.0, SCALED_GYMNAST),
    _strength("Q3", +1, "turn to the left", 80.0, 45.0, SCALED_GYMNAST),
    _strength("Q4", -1, "shoulder abduction", 71.0, 37.0, STOBBE_1982),
    _strength("Q4", +1, "shoulder adduction", 67.0, 30.0, STOBBE_1982),
    _strength("Q5", -1, "shoulder extension", 67.0, 33.0, STOBBE_1982),
    _strength("Q5", +1, "shoulder flexion", 92.0, 40.0, STOBBE_1982),
    _strength("Q6", -1, "external rotation", 33.0, 19.0, STOBBE_1982),
    _strength("Q6", +1, "internal rotation", 52.0, 21.0, STOBBE_1982),
    _strength("Q7", -1, "elbow flexion", 77.0, 41.0, STOBBE_1982),
    _strength("Q7", +1, "elbow extension", 46.0, 27.0, STOBBE_1982),
    _strength("Q8", -1, "pronation", 13.0, 7.0, SCALED_GYMNAST),
    _strength("Q8", +1, "supination", 13.5, 7.5, SCALED_GYMNAST),
    _strength("Q9", -1, "wrist flexion", 20.0, 11.0, SCALED_GYMNAST),
    _strength("Q9", +1, "wrist extension", 10.0, 6.0, SCALED_GYMNAST),
    _strength("Q10", -1, "radial deviation", 15.0, 8.0, SCALED_GYMNAST),
    _strength("Q10", +1, "ulnar deviation", 15.0, 8.0, SCALED_GYMNAST),
)


def torque_limit(joint: str, sign: int, sex: Sex) -> float:
    """Return the signed torque limit [Nm] of one joint in the direction ``sign``: negative where the sign is."""
    (strength,) = (entry for entry in STRENGTHS if entry.joint == joint and entry.sign == sign)
    return sign * strength.torque[sex]
