"""The folder of a result while it is written: whoever reads it finds the older result or the newer one, never a mix.

A result is several files, and no system renames several at once. So before the first file is moved into place the
older ones are kept, as they stand, in ``.older-result``; after the last one that folder is renamed away, and this one
renaming is what makes the newer result count. As long as ``.older-result`` is there, it is the result: a reader looks
there, and the next writer puts it back first. Writers and readers keep each other out by a lock on the folder, which
the system takes back from a process that dies. Other files in the folder are never touched.

A solve that failed never replaces a solved result: its iterate is a result of its own, in the folder ``unsolved``
within.
"""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.bounded_read import first_entries

NETCDF, SCENARIO, MODELS = "solution.nc", "scenario.toml", "models"
URDF_FILES = {"human": "human_arm.urdf", "robot": "sawyer.urdf", "table": "table.urdf"}
# In the order in which they are put in place.
FILES = (*(f"{MODELS}/{name}" for name in URDF_FILES.values()), SCENARIO, NETCDF)
UNSOLVED = "unsolved"  # folder for the iterate of a failed solve, within that of a solved result
OLDER, WORK_PREFIX = ".older-result", ".writing-result-"
PATIENCE = 10.0  # seconds; a result is written in a tenth of one


def standing_result(folder: Path) -> Path:
    """Return where the files of the result in ``folder`` stand: there, or in what a writer that died had kept."""
    older = folder / OLDER
    return older if older.is_dir() and not older.is_symlink() else folder


def holds_result(folder: Path) -> bool:
    """Return whether there is a result in ``folder``, which need not exist."""
    try:
        return (standing_result(folder) / NETCDF).is_file()
    except (OSError, ValueError):  # too long a name, a NUL
        return False


def results_in(folder: Path) -> list[Path]:
    """Return the folders in ``folder`` that hold a result, of its first entries."""
    return [entry for entry in first_entries(folder) if holds_result(entry)]


def in_the_way(folder: Path) -> Path | None:
    """Return what stands in ``folder`` where a file of a result cannot replace it; None if nothing does."""
    models = folder / MODELS
    blocked = [folder / name for name in (NETCDF, SCENARIO) if (folder / name).is_dir()]
    blocked += [models] if models.is_symlink() or (models.exists() and not models.is_dir()) else []
    return blocked[0] if blocked else None


def replace_result(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write the files of a result into a folder that is locked for writing: all of them or none.

    Args:
        folder: exists.
        files: contents by path within the folder, those of ``FILES``.

    Raises:
        OSError: a file cannot be written or moved; the older result stands.
    """
    models = folder / MODELS
    if models.is_symlink():
        raise OSError(errno.ENOTDIR, f"{models} is a link, and what is written there would be elsewhere")
    put_back(folder)
    _clear(folder)
    made = not models.exists()
    # Staged beside the targets, so that the renames stay on one file system.
    with tempfile.TemporaryDirectory(dir=folder, prefix=WORK_PREFIX) as work:
        new, older = Path(work) / "new", Path(work) / "older"
        for name, content in files.items():
            _write(new / name, content)
        older.mkdir()
        for name in FILES:
            _keep(folder / name, older / name)
        os.rename(older, folder / OLDER)
        try:
            models.mkdir(exist_ok=True)
            for name in FILES:
                os.replace(new / name, folder / name)
            os.rename(folder / OLDER, older)
        except BaseException:  # a Ctrl-C too
            put_back(folder)
            if made:
                with suppress(OSError):
                    models.rmdir()
            raise


def put_back(folder: Path) -> None:
    """Put the result in ``.older-result`` back in its place, if there is one; it may be cut short and repeated."""
    older = folder / OLDER
    if standing_result(folder) != older:
        return
    with tempfile.TemporaryDirectory(dir=folder, prefix=WORK_PREFIX) as work:
        for name in FILES:
            if (older / name).is_file():
                _keep(older / name, Path(work) / name)
                (folder / name).parent.mkdir(exist_ok=True)
                os.replace(Path(work) / name, folder / name)
            else:
                (folder / name).unlink(missing_ok=True)
        os.rename(older, Path(work) / "older")


def _clear(folder: Path) -> None:
    """Remove what writers that were killed left behind; with the lock held, none of them is alive."""
    for path in folder.glob(f"{WORK_PREFIX}*"):
        with suppress(OSError):
            shutil.rmtree(path)


def _write(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def _keep(path: Path, at: Path) -> None:
    """Let a file also be ``at``, if there is one: by a second name, which takes no room, or as a copy."""
    if not os.path.lexists(path):
        return
    at.parent.mkdir(parents=True, exist_ok=True)
    try:
        os.link(path, at, follow_symlinks=False)
    except OSError:  # a file system without such names, or another owner's file
        shutil.copy2(path, at)


@contextmanager
def locked(folder: Path, *, to_write: bool) -> Iterator[None]:
    """Keep other writers of the folder's result out, and readers too ``to_write``; where nothing locks, nothing waits.

    Raises:
        InputError: another process has held it for ``PATIENCE`` seconds.
    """
    descriptor = _locked_descriptor(folder, to_write)
    try:
        yield
    finally:
        if descriptor is not None:
            os.close(descriptor)


def _locked_descriptor(folder: Path, to_write: bool) -> int | None:
    try:
        import fcntl

        descriptor = os.open(folder, os.O_RDONLY)
    except (ImportError, OSError):  # no such locks on this system, or no folder: using it says what is wrong
        return None
    kind, until = fcntl.LOCK_EX if to_write else fcntl.LOCK_SH, time.monotonic() + PATIENCE
    try:
        while True:
            try:
                fcntl.flock(descriptor, kind | fcntl.LOCK_NB)
                return descriptor
            except BlockingIOError:
                if time.monotonic() > until:
                    why = f"another process has been writing or reading the result there for {PATIENCE:g} s"
                    raise InputError(str(folder), NO_VALUE, why) from None
                time.sleep(0.01)
            except OSError:  # a network file system without locks
                os.close(descriptor)
                return None
    except BaseException:
        os.close(descriptor)
        raise
