"""What ``liftopt solve`` prints of a solution."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from liftopt.assessment.text import details_text, verdict_text
from liftopt.commands.terminal import captured
from liftopt.solution.solution import Solution
from liftopt.solution.summary import summary_dict
from liftopt.storage.writer import files_of


def solved_text(solution: Solution, folder: Path, *, as_json: bool, details: bool) -> str:
    """Return one JSON object, or the verdicts on a solved lift and, where they are asked for, the details.

    Args:
        solution: solved or not.
        folder: that it was written to.
        as_json: one object instead of text.
        details: also all findings and the tables; of an iterate only how the solver fared.
    """
    if as_json:
        return json.dumps(summary_dict(solution, folder, files_of(solution)), allow_nan=False) + "\n"
    parts = [verdict_text(solution, folder)] if solution.solved else []
    if details:
        parts.append(details_text(solution.assessment) + _tables(summary_dict(solution, folder)))
    return "\n".join(parts)


def _tables(summary: dict[str, Any]) -> str:
    from liftopt.commands.summary_text import print_details  # it loads rich, which every other solve does without

    return captured(lambda console: print_details(summary, console))
