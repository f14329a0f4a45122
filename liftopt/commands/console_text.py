"""What a command prints, as text."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console


def captured(show: Callable[[Console], None]) -> str:
    """Return what ``show`` prints on a console, without the blanks at the ends of lines."""
    from rich.console import Console

    console = Console()
    with console.capture() as capture:
        show(console)
    return "\n".join(line.rstrip() for line in capture.get().split("\n"))
