"""Why a solve found nothing and which keys to change, on a terminal: at most ``MOST_LINES`` lines."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from liftopt.assessment.mathematics import setting
from liftopt.solution.finding import CAUTION, ROBOT
from liftopt.solution.infeasibility_report import InfeasibilityReason
from liftopt.solution.solution import Solution

MOST_LINES = 12
MOST_REASONS = 3  # besides those in the status
MOST_DATA = 2  # of what is doubtful about the data of robots


def failure_text(solution: Solution, out: Path, folder: Path) -> str:
    """Return what is in the way, and the changes with which the lift was solved, by key and value.

    Args:
        solution: not solved.
        out: folder that was asked for.
        folder: that the iterate was written to.
    """
    lines = [f"no verified solution: {' '.join(solution.status.split())}", *_reasons(solution.status, solution.reasons)]
    lines += [f"  to check: {' '.join(message.split())}" for message in _doubtful(solution)]
    room = MOST_LINES - len(lines) - 1
    if solution.suggested_changes and room > 1:
        lines.append("With one of these, given by --set KEY=VALUE or in the file, it was solved and verified:")
        lines += [f"  {setting(change)}  ({change.message})" for change in solution.suggested_changes[: room - 1]]
    where = f"The best iterate, which is no lift, is in {folder}"
    lines.append(f"{where}; the solved result in {out} is as it was" if folder != out else f"{where}, marked as such")
    return "\n".join(lines) + "\n"


def _doubtful(solution: Solution) -> list[str]:
    """Return what is doubtful about the data of robots."""
    found = [finding for finding in solution.assessment if finding.code == f"{ROBOT}.data"]
    return [finding.message for finding in found if finding.severity == CAUTION][:MOST_DATA]


def _reasons(status: str, reasons: Sequence[InfeasibilityReason]) -> list[str]:
    others = [reason.message for reason in reasons if reason.message not in status]
    return [f"  in the way: {' '.join(message.split())}" for message in others[:MOST_REASONS]]
