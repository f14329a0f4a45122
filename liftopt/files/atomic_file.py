"""A file written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from liftopt.errors import InputError


def write_whole(key: str, path: Path, content: bytes) -> None:
    """Write a file beside its place and rename it there; folders are made.

    Args:
        key: option that named the file or its folder, for messages.
        path: of the file; what stood there is replaced.
        content: what it holds.

    Raises:
        InputError: it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".writing-") as work:
            part = Path(work) / "part"
            part.write_bytes(content)
            os.replace(part, path)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        why = getattr(error, "strerror", None) or error
        raise InputError(key, str(path), f"cannot be written: {why}") from error
