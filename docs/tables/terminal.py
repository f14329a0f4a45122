"""What the first command prints."""

from __future__ import annotations

from pathlib import Path

from drawings.stage import default_lift
from liftopt.assessment.text import verdict_text


def terminal() -> str:
    """Return the verdicts on the default lift as the terminal has them."""
    return f"```text\n{verdict_text(default_lift(), Path('results/table5')).rstrip()}\n```\n"
