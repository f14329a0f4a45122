"""The kernel cache: compiled kernels, inside the package as it was installed, or in the user's cache folder.

A kernel is found by its key, a digest of all that it is made from. Its file carries the checksum of its own bytes and
appears by renaming, whole or not at all. It is loaded only from where nobody but its owner can write: the user's own
cache, and the package itself, whose folder is trusted as far as its code is. The package comes first; what was
installed with it needs no folder of the user's.

Between the look and the loading nobody else can put another file in its place: a cache folder is held open, and its
files are reached through it rather than by its path, which may lead through folders where others can rename things.
Files there that are links are not followed. What the user's own processes might do to the user's files is not guarded
against, since they could do anything else too.
"""

from __future__ import annotations

import os
import re
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar

from liftopt.files.checksum import has_checksum, with_checksum

# What no run has loaded for this long goes when something new is compiled: versions that are no longer installed.
UNUSED_DAYS = 90.0
LIBRARY_NAME = re.compile(r"[0-9a-f]{32}\.so")
WORK_PREFIX = ".new-"
OTHERS_WRITE = 0o022
PACKAGE = Path(__file__).parents[2]
Opened = TypeVar("Opened")


def find_library(key: str, open_library: Callable[[Path], Opened | None]) -> Opened | None:
    """Return what ``open_library`` makes of the first library of that key that is whole and trusted; None if none is.

    Args:
        key: of the library.
        open_library: loads a file; None if it cannot, and the next one is tried.
    """
    shipped, cache = PACKAGE / "kernels" / f"{key}.so", cache_folder()
    if (opened := _open(shipped, open_library, PACKAGE)) is not None or cache is None:
        return opened
    with _kept_open(cache) as folder:
        opened = _open_private(folder / f"{key}.so", open_library)
        if opened is not None:
            with suppress(OSError):
                os.utime(folder / f"{key}.so")  # in use
    return opened


def cache_folder() -> Path | None:
    """Return the folder that keeps compiled libraries, made if need be; None where none can be had.

    ``LIFTOPT_CACHE`` names it, otherwise it is the user's cache folder. A folder that others own or can write to is
    not used, since code is loaded from it.
    """
    from platformdirs import user_cache_dir

    named = os.environ.get("LIFTOPT_CACHE")
    folder = Path(named) if named else Path(user_cache_dir("liftopt")) / "kernels"
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    except OSError:
        return None
    return folder if _is_trusted(folder) else None


def keep(built: Path, folder: Path | None, open_library: Callable[[Path], Opened | None]) -> Opened | None:
    """Give a library just built its checksum, move it to ``folder`` if there is one, and open it there.

    Returns what ``open_library`` makes of it. Where it cannot be kept it is opened where it was built; it stays mapped
    when that file goes.
    """
    _add_checksum(built)
    if folder is None:
        return _open(built, open_library)
    with _kept_open(folder) as own:
        _drop_unused(own)
        return _open_private(_publish(built, own / built.name), open_library)


@contextmanager
def _kept_open(folder: Path) -> Iterator[Path]:
    """Hold a folder open and give a path that stays this very folder, whatever is renamed on the way to it."""
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError:  # it is gone, or this system opens no folders
        yield folder
        return
    own = Path(f"/proc/self/fd/{descriptor}")
    try:
        yield own if own.exists() else folder
    finally:
        os.close(descriptor)


def _open_private(path: Path, open_library: Callable[[Path], Opened | None]) -> Opened | None:
    """Open a library if it is a file, no link, in a folder where only the user can write."""
    try:
        private = _is_trusted(path.parent) and stat.S_ISREG(path.lstat().st_mode)
    except OSError:
        return None
    return _open(path, open_library) if private else None


def _open(path: Path, open_library: Callable[[Path], Opened | None], owner: Path | None = None) -> Opened | None:
    try:
        return open_library(path) if _is_trusted(path, owner) and _has_checksum(path) else None
    except OSError:
        return None


def _is_trusted(path: Path, owner: Path | None = None) -> bool:
    """Whether a path is the user's own and nobody else can write to it, or no more can than to the path ``owner``."""
    if not hasattr(os, "getuid"):
        return True
    status = path.stat()
    of = (os.getuid(), 0) if owner is None else (owner.stat().st_uid, owner.stat().st_mode)
    return status.st_uid == of[0] and not status.st_mode & OTHERS_WRITE & ~of[1]


def _has_checksum(path: Path) -> bool:
    return has_checksum(path.read_bytes())


def _add_checksum(path: Path) -> None:
    """Append the checksum, which a loader of shared libraries ignores, and make the file private."""
    path.chmod(0o600)
    path.write_bytes(with_checksum(path.read_bytes()))


def _publish(built: Path, target: Path) -> Path:
    """Copy beside the target and rename, so that the target is whole whenever it exists; fall back to ``built``."""
    try:
        with tempfile.TemporaryDirectory(dir=target.parent, prefix=WORK_PREFIX) as beside:
            copy = Path(beside) / target.name
            with copy.open("wb") as file:
                file.write(built.read_bytes())
                file.flush()
                os.fsync(file.fileno())
            copy.chmod(0o600)
            os.replace(copy, target)
    except OSError:
        return built
    return target


def _drop_unused(folder: Path) -> None:
    """Remove the libraries in a cache folder that no run has loaded for long; other files stay."""
    before = time.time() - 86400.0 * UNUSED_DAYS
    with suppress(OSError):
        for path in folder.iterdir():
            # Another process may have removed it meanwhile, or be loading it: then it compiles it again.
            with suppress(OSError):
                if LIBRARY_NAME.fullmatch(path.name) and path.stat().st_mtime < before and _has_checksum(path):
                    path.unlink()
