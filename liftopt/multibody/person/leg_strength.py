"""Static strength of both legs together, each direction apart, by the isometric curves of Anderson et al. (2007)."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians, sin

from liftopt.multibody.person.subject import Sex, Subject
from liftopt.multibody.sources import ANDERSON_2007, Source

LEGS = 2.0
GRAVITY = 9.81  # [m/s^2], by which the table's torques are normalised: they are shares of weight times stature


@dataclass(frozen=True)
class IsometricCurve:
    """Largest torque of one joint over its angle: ``peak * cos(width * (angle - best))``, of weight times stature.

    Attributes:
        peak: at the best angle.
        width: of the cosine [1/rad].
        best: angle of the largest torque [rad], in the signs of ``LEG_RANGES``.
    """

    peak: float
    width: float
    best: float

    def mean(self, lower: float, upper: float) -> float:
        """Return the mean of the curve between two angles [rad]."""
        rise = sin(self.width * (upper - self.best)) - sin(self.width * (lower - self.best))
        return self.peak * rise / (self.width * (upper - lower))


@dataclass(frozen=True)
class LegStrength:
    """Strength of one joint of one leg in one direction.

    Attributes:
        joint: ``"ankle"``, ``"knee"`` or ``"hip"``.
        sign: +1 or -1, the direction of the joint angle that the torque drives.
        motion: its anatomical name.
        curve: by sex.
        source: of the curve.
    """

    joint: str
    sign: int
    motion: str
    curve: dict[Sex, IsometricCurve]
    source: Source = ANDERSON_2007

    def of(self, subject: Subject) -> float:
        """Return what both legs of the subject can do [Nm], positive: the mean over the angles of a lift."""
        lower, upper = (radians(angle) for angle in USED[self.joint])
        share = self.curve[subject.sex].mean(lower, upper)
        return round(LEGS * share * subject.mass * GRAVITY * subject.stature, 6)


# Angles of a lift [deg], from upright to a deep squat: where the mean is taken. The strength itself does not vary.
USED = {"ankle": (0.0, 39.0), "knee": (0.0, 120.0), "hip": (0.0, 110.0)}


def _strength(joint: str, sign: int, motion: str, male: IsometricCurve, female: IsometricCurve) -> LegStrength:
    return LegStrength(joint, sign, motion, {"male": male, "female": female})


LEG_STRENGTHS: tuple[LegStrength, ...] = (
    _strength("ankle", -1, "plantar flexion", IsometricCurve(0.095, 1.391, 0.408), IsometricCurve(0.104, 1.399, 0.424)),
    _strength("ankle", +1, "dorsiflexion", IsometricCurve(0.033, 1.51, -0.187), IsometricCurve(0.027, 1.079, -0.302)),
    _strength("knee", -1, "knee extension", IsometricCurve(0.163, 1.258, 1.133), IsometricCurve(0.159, 1.187, 1.274)),
    _strength("knee", +1, "knee flexion", IsometricCurve(0.087, 0.869, 0.522), IsometricCurve(0.08, 0.873, 0.635)),
    _strength("hip", -1, "hip extension", IsometricCurve(0.161, 0.958, 0.932), IsometricCurve(0.181, 0.697, 1.242)),
    _strength("hip", +1, "hip flexion", IsometricCurve(0.113, 0.738, -0.214), IsometricCurve(0.127, 0.65, -0.35)),
)
