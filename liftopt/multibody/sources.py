"""Where the numbers of the models come from, and how far each can be trusted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Confidence = Literal["verified", "computed", "secondary", "unverified", "estimate"]


@dataclass(frozen=True)
class Source:
    """The origin of a set of numbers.

    Attributes:
        citation: publication, data set or file, precise enough to look the numbers up.
        confidence: ``verified`` (compared with the file cited), ``computed`` (from verified data), ``secondary``
            (read in a second-hand source), ``unverified`` (as known in the literature, not compared with it),
            ``estimate`` (chosen for this model).
    """

    citation: str
    confidence: Confidence

    @property
    def told(self) -> str:
        """The citation in one line, with how far it was checked."""
        return f"{self.citation} ({self.confidence})"


DE_LEVA_1996 = Source(
    "de Leva (1996), J Biomech 29:1223-1230, Table 4 (adjusted Zatsiorsky-Seluyanov parameters), as transcribed in "
    "deleva.m by R. Gurchiek (2018); the arm and trunk rows agree with Zatsiorsky (2002), Table A2.11",
    "verified",
)
ANSUR_II = Source(
    "ANSUR II public data (US Army, 2012; 4082 men, 1986 women): ordinary least squares on stature and body mass",
    "computed",
)
DE_LEVA_AND_ANSUR = Source(
    "suprasternale height (ANSUR II regression) less the height of suprasternale above the shoulder joint centres "
    "(de Leva 1996: length of 'trunk' less that of 'trunk3')",
    "computed",
)
DE_LEVA_BELOW_OMPHALION = Source(
    "hip: omphalion height (ANSUR II regression) less the lower trunk (de Leva 1996); knee: between hip and lateral "
    "malleolus in the proportion of his thigh and shank",
    "computed",
)
DE_LEVA_ON_ANSUR = Source(
    "de Leva (1996) mass fractions, centres of mass and radii of gyration; arm segments in his lengths, trunk and legs "
    "on heights and breadths from ANSUR II regressions; lumped by the parallel-axis theorem",
    "computed",
)
AAOS = Source(
    "AAOS column of Norkin & White, Measurement of Joint Motion, Appendix A, Table A.1",
    "secondary",
)
AAOS_SPINE = Source(
    "AAOS thoracolumbar values as quoted by Norkin & White and by Magee",
    "unverified",
)
AAOS_LEGS = Source(
    "AAOS values of hip (flexion 120, extension 30 deg), knee (135) and ankle (plantar flexion 50), as commonly quoted",
    "unverified",
)
STANDING_ANKLE = Source(
    "Baumbach et al. (2014), BMC Musculoskelet Disord 15:246: 39 deg of dorsiflexion [36 to 42], standing on it, knee "
    "bent by 75 deg, 20 adults",
    "verified",
)
SHOULDER_ADDUCTION = Source("common clinical value of shoulder adduction across the body", "unverified")
STOBBE_1982 = Source(
    "Stobbe (1982), static strength, 50th percentile, as tabulated in Chaffin, Andersson & Martin, Occupational "
    "Biomechanics",
    "unverified",
)
SCALED_GYMNAST = Source(
    "scaled down for the general population from the torque curves of one gymnast (Millard2016TorqueMuscle in RBDL)",
    "estimate",
)
ANDERSON_2007 = Source(
    "Anderson, Madigan & Nussbaum (2007), J Biomech 40:3105-3113, Table 3, isometric, age 18 to 25, as transcribed in "
    "Millard2016TorqueMuscle (RBDL); the mean over the angles of a lift, of two legs",
    "secondary",
)
MODEL_CHOICE = Source("chosen for this model", "estimate")
RETHINK = Source(
    "Rethink Robotics, sawyer_robot, commit d1ef3d0, sawyer_description/urdf/sawyer_base.urdf.xacro (Apache-2.0)",
    "verified",
)
