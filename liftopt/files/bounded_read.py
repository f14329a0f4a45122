"""Files of the user's as bytes, however odd the path: never more than was asked for, and nothing that might not end."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from liftopt.errors import NO_VALUE, InputError

MOST_LOOKED_AT = 1000  # entries of a folder where something is looked for


def read_regular(path: Path, largest: int, what: str) -> bytes:
    """Return the content of a file.

    Args:
        path: of the file; a folder, a device or a pipe, which might never end, is refused.
        largest: number of bytes it may have.
        what: what is expected there, a clause for messages (``"a scenario is a TOML file"``).

    Raises:
        FileNotFoundError: there is none.
        InputError: it cannot be read, is no file, or is larger.
    """
    shown = str(path)
    try:
        if path.exists() and not path.is_file():
            raise InputError(shown, NO_VALUE, f"is not a file; {what}")
        with open(path, "rb", opener=_without_waiting) as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise InputError(shown, NO_VALUE, f"is not a file; {what}")
            content = file.read(largest + 1)
    except FileNotFoundError:
        raise
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(shown, NO_VALUE, f"cannot be read: {reason}") from None
    if len(content) > largest:
        raise InputError(shown, NO_VALUE, f"is larger than {largest} bytes; {what}")
    return content


def first_entries(folder: Path) -> list[Path]:
    """Return the first ``MOST_LOOKED_AT`` entries of a folder in order; none if it cannot be looked into."""
    try:
        return sorted(entry for entry, _ in zip(folder.iterdir(), range(MOST_LOOKED_AT), strict=False))
    except (OSError, ValueError):
        return []


def _without_waiting(path: str, flags: int) -> int:
    """Open a path that may have become a pipe since it was looked at."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
