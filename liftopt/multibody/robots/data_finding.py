"""What is noticed about the data of a robot from outside: never in silence, and with the way out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from liftopt.errors import NO_VALUE, InputError

Severity = Literal["refused", "warned", "assumed"]
SEVERITIES: tuple[Severity, ...] = ("refused", "warned", "assumed")


@dataclass(frozen=True)
class DataFinding:
    """One thing that is noticed.

    Attributes:
        code: which kind, such as ``"effort.same"``.
        severity: ``refused`` (it cannot lift with this), ``warned`` (results may be wrong) or ``assumed`` (a choice
            was made for something that the data leave open).
        where: link or joint, or several.
        value: that stands there, or ``NO_VALUE`` where none does.
        message: what is noticed, a clause.
        fix: what to do about it, a clause; of an assumption, how to choose otherwise.
    """

    code: str
    severity: Severity
    where: str
    value: object
    message: str
    fix: str

    @property
    def told(self) -> str:
        """The finding in one line."""
        value = "" if self.value is NO_VALUE else f" = {_plain(self.value)}"
        return f"{self.where}{value}: {self.message}; {self.fix}"

    def plain(self) -> dict[str, Any]:
        """Return it as JSON has it; a number that is none is its text."""
        value = None if self.value is NO_VALUE else _plain(self.value)
        return {
            "code": self.code,
            "severity": self.severity,
            "where": self.where,
            "value": value,
            "message": self.message,
            "fix": self.fix,
        }

    def refusal(self, source: str) -> InputError:
        """Return the error that says it."""
        value = self.value if self.value is NO_VALUE else _plain(self.value)
        return InputError(f"{source}: {self.where}", value, f"{self.message}; {self.fix}")


def alike(findings: Iterable[DataFinding]) -> list[list[DataFinding]]:
    """Return findings in groups that say the same of several links or joints, the groups in order."""
    groups: dict[tuple[str, str], list[DataFinding]] = {}
    for finding in findings:
        groups.setdefault((finding.code, finding.message), []).append(finding)
    return list(groups.values())


def told_together(findings: Sequence[DataFinding]) -> str:
    """Return findings that are ``alike`` in one line."""
    first, *others = findings
    return first.told + (f" (and {', '.join(other.where for other in others)})" if others else "")


def _plain(value: object) -> Any:
    if isinstance(value, float):
        return float(f"{value:.6g}") if value - value == 0.0 else str(value)
    return value if isinstance(value, (int, str)) or value is None else str(value)
