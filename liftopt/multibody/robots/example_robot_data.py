"""Where the package example-robot-data keeps its robots, if it is installed."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

PACKAGE = "example-robot-data"


def share_folder() -> Path | None:
    """Return the folder ``example-robot-data`` with the robots of the Python package, or None without it."""
    try:
        found = distribution(PACKAGE)
    except PackageNotFoundError:
        return None
    folder = Path(str(found.locate_file(f"cmeel.prefix/share/{PACKAGE}")))
    return folder if folder.is_dir() else None
