"""One finding on a solution, and the assessment that all findings make."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, overload

# The gravest first.
SEVERITIES = ("error", "warning", "caution", "info")
ERROR, WARNING, CAUTION, INFO = SEVERITIES
MATHEMATICS, PERSON, ROBOT, CLEARANCE = "mathematics", "person", "robot", "clearance"
SUBJECTS = (PERSON, ROBOT, CLEARANCE, MATHEMATICS)
VERDICT = "verdict"


@dataclass(frozen=True)
class Finding:
    """One thing to know of a solution.

    Attributes:
        code: what kind it is, ``"person.posture"``: what it is about, then what was found. ``"verdict.person"``,
            ``"verdict.robot"``, ``"verdict.mathematics"`` and ``"verdict.clearance"`` lead every assessment, one for
            everybody who lifts.
        severity: ``"error"`` (the numbers are no prediction), ``"warning"`` (a limit or a guide's value is
            exceeded, or no strength or torque is left: change something), ``"caution"`` (near a limit, or at one that
            shapes the result) or ``"info"``.
        title: in a few words.
        message: in one or two sentences that stand alone.
        agent: name of who it is about; None for the lift as a whole.
        joint: name of the joint, as in solution.nc; None where it is not about one.
        time: when [s]; None where it is not about one moment.
        value: what was found, between the knots too.
        limit: what it is compared with, in the same unit; None where there is no limit.
        unit: of both.
        source: where the limit or the method comes from, and how far that was checked.

    Raises:
        ValueError: the severity is unknown, or a number is not finite.
    """

    code: str
    severity: str
    title: str
    message: str
    agent: str | None = None
    joint: str | None = None
    time: float | None = None
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        if self.severity not in SEVERITIES:
            raise ValueError(f"severity is {self.severity!r:.60}, must be one of {', '.join(SEVERITIES)}")
        for name in ("time", "value", "limit"):
            number = getattr(self, name)
            if number is not None and not math.isfinite(number):
                raise ValueError(f"{name} of {self.code!r:.60} is {number}")

    @property
    def subject(self) -> str:
        """What it is about: ``"person"``, ``"robot"``, ``"mathematics"``, ``"clearance"``...; of a verdict too."""
        first, _, rest = self.code.partition(".")
        return rest if first == VERDICT else first

    @property
    def rank(self) -> int:
        """0 for the gravest severity, rising."""
        return SEVERITIES.index(self.severity)


@dataclass(frozen=True)
class Assessment(Sequence[Finding]):
    """All findings on a solution: the verdicts first, then the others, the gravest first in each part.

    Attributes:
        findings: in that order.
    """

    findings: tuple[Finding, ...] = ()

    @staticmethod
    def of(findings: Sequence[Finding]) -> Assessment:
        """Return the assessment that findings make, in its order."""
        return Assessment(tuple(sorted(findings, key=_order)))

    @overload
    def __getitem__(self, index: int) -> Finding: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Finding, ...]: ...
    def __getitem__(self, index: int | slice) -> Finding | tuple[Finding, ...]:
        """Return one finding, or several."""
        return self.findings[index]

    def __len__(self) -> int:
        """Return how many findings there are."""
        return len(self.findings)

    def __iter__(self) -> Iterator[Finding]:
        """Go through the findings."""
        return iter(self.findings)

    @property
    def verdicts(self) -> tuple[Finding, ...]:
        """The verdicts on the mathematics, on clearance and on everybody who lifts, the gravest first."""
        return tuple(finding for finding in self.findings if finding.code.startswith(f"{VERDICT}."))

    def verdict(self, subject: str, agent: str | None = None) -> Finding:
        """Return the verdict on ``"person"``, ``"robot"``, ``"mathematics"`` or ``"clearance"``.

        Args:
            subject: what it is about.
            agent: name of one of several of the kind; None takes the gravest verdict.

        Raises:
            KeyError: there is none.
        """
        for finding in self.verdicts:
            if finding.subject == subject and agent in (None, finding.agent):
                return finding
        raise KeyError(subject)

    def about(self, subject: str, agent: str | None = None) -> tuple[Finding, ...]:
        """Return what was found on a subject, or on one agent of the kind, the verdict left out."""
        return tuple(
            finding
            for finding in self.findings
            if finding.code.startswith(f"{subject}.") and agent in (None, finding.agent)
        )

    def plain(self) -> list[dict[str, Any]]:
        """Return the findings ready for JSON."""
        return [asdict(finding) for finding in self.findings]


def percent(share: float) -> str:
    """Return a share of a limit in percent; what is a little below or above it is not rounded to 100."""
    text = f"{100 * share:.0f}"
    return text if text != "100" else f"{100 * share:.1f}".removesuffix(".0")


def graver(one: str, other: str) -> str:
    """Return the graver of two severities."""
    return min(one, other, key=SEVERITIES.index)


def _order(finding: Finding) -> tuple[bool, int, int]:
    subject = SUBJECTS.index(finding.subject) if finding.subject in SUBJECTS else len(SUBJECTS)
    if finding.severity == ERROR and finding.subject == MATHEMATICS:  # what the others follow from
        subject = -1
    if finding.severity == WARNING and finding.subject == CLEARANCE:  # bodies that overlap make no motion
        subject = -1
    return not finding.code.startswith(f"{VERDICT}."), finding.rank, subject
