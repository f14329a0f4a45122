"""Files that are made and never written over."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from liftopt.errors import InputError

EXISTS = "exists already and is never written over: name another file"


def write_new(key: str, path: Path, text: str) -> None:
    """Write a file whole or not at all.

    Args:
        key: option that named the file, for messages.
        path: of the file; folders are made.
        text: what it holds.

    Raises:
        InputError: the file exists, or cannot be written.
    """
    check_new(key, path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".writing-") as work:
            part = Path(work) / "part"
            part.write_text(text, encoding="utf-8", newline="\n")
            os.replace(part, path)
    except (OSError, ValueError) as error:
        raise unwritable(key, path, error) from error


def check_new(key: str, path: Path) -> None:
    """Refuse a file that exists; for what takes long before it is written.

    Args:
        key: option that named the file, for messages.
        path: of the file.

    Raises:
        InputError: the file exists, or there cannot be one of this name.
    """
    try:
        if path.exists():
            raise InputError(key, str(path), EXISTS)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        raise unwritable(key, path, error) from error


def open_new(key: str, path: Path) -> int:
    """Return the descriptor of a new, empty file that only grows; its name is on the disk before this returns.

    Raises:
        InputError: the file exists, or cannot be made.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND | os.O_CLOEXEC, 0o644)
    except FileExistsError:
        raise InputError(key, str(path), EXISTS) from None
    except (OSError, ValueError) as error:
        raise unwritable(key, path, error) from error
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    except OSError:  # some network folders cannot; the lines themselves are synchronised one by one
        pass
    finally:
        os.close(folder)
    return descriptor


def unwritable(key: str, path: Path, error: Exception) -> InputError:
    """Return the error for a file that cannot be written."""
    return InputError(key, str(path), f"cannot be written: {getattr(error, 'strerror', None) or error}")
