"""Folders whose files belong together: they appear whole under their name, or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from liftopt.errors import InputError
from liftopt.files.new_file import unwritable

TAKEN = "exists already; files of two motions must not be mixed up: name another folder"


@contextmanager
def new_folder(key: str, path: Path) -> Iterator[Path]:
    """Give a folder to fill, which is renamed to ``path`` when the block ends well; if not, nothing stays.

    A folder that exists is refused, not replaced: a motion of an older solution beside one of this could be sent to a
    robot by mistake.

    Args:
        key: option that named the folder, for messages.
        path: of the folder; the folders above it are made.

    Raises:
        InputError: the folder exists, or cannot be written.
    """
    if os.path.lexists(path):
        raise InputError(key, str(path), TAKEN)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # Beside its target, so that the rename stays on one file system.
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".writing-") as work:
            part = Path(work) / "part"
            part.mkdir()
            yield part
            if path.exists():  # made meanwhile; an empty one would be replaced
                raise InputError(key, str(path), TAKEN)
            os.rename(part, path)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        raise unwritable(key, path, error) from error
