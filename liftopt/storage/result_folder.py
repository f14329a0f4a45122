"""The folder of a result while it is written: whoever reads it finds the older result or the newer one, never a mix.

The result is one file, ``solution.nc``, which holds the scenario and the models too: renaming it into place makes the
newer result count, and this one renaming is the whole transaction. ``scenario.toml`` and ``models/*.urdf`` follow; they
are there for people and other tools, and nothing reads them back. Writers keep each other out by a lock on the folder,
which the system takes back from a process that dies; readers need none. Other files in the folder are never touched.

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
SCENARIO_TEXT, URDF_TEXT = "scenario", "urdf_"  # attributes of solution.nc; the latter goes on with a model's name
UNSOLVED = "unsolved"  # folder for the iterate of a failed solve, within that of a solved result
WORK_PREFIX = ".writing-result-"
LOCK_PATIENCE = 10.0  # seconds; a result is written in a tenth of one


def holds_result(folder: Path) -> bool:
    """Return whether there is a result in ``folder``, which need not exist."""
    try:
        return (folder / NETCDF).is_file()
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


def replace_result(folder: Path, netcdf: bytes, beside: Mapping[str, bytes]) -> None:
    """Write a result into a folder that is locked.

    Args:
        folder: exists.
        netcdf: content of solution.nc, which is the result.
        beside: contents of the files beside it, by path within the folder.

    Raises:
        OSError: a file cannot be written or moved. The older result stands, unless the error says otherwise.
    """
    if (folder / MODELS).is_symlink():
        raise OSError(errno.ENOTDIR, f"{folder / MODELS} is a link, and what is written there would be elsewhere")
    if (blocked := in_the_way(folder)) is not None:
        raise OSError(errno.EEXIST, f"{blocked} is in the way")
    _clear(folder)
    # Staged beside the targets, so that the renames stay on one file system, and all of them before the first is moved.
    with tempfile.TemporaryDirectory(dir=folder, prefix=WORK_PREFIX) as work:
        for name, content in {**beside, NETCDF: netcdf}.items():
            _write(Path(work) / name, content)
        os.replace(Path(work) / NETCDF, folder / NETCDF)
        for name in beside:
            try:
                (folder / name).parent.mkdir(exist_ok=True)
                os.replace(Path(work) / name, folder / name)
            except OSError as error:
                raise OSError(error.errno, f"{error.strerror} ({NETCDF} is written, {name} beside it is not)") from None


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


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other writers of the folder's result out; where nothing locks, nothing waits.

    Raises:
        InputError: another process has held it for ``LOCK_PATIENCE`` seconds.
    """
    descriptor = _locked_descriptor(folder)
    try:
        yield
    finally:
        if descriptor is not None:
            os.close(descriptor)


def _locked_descriptor(folder: Path) -> int | None:
    try:
        import fcntl

        descriptor = os.open(folder, os.O_RDONLY)
    except (ImportError, OSError):  # no such locks on this system, or no folder: using it says what is wrong
        return None
    until = time.monotonic() + LOCK_PATIENCE
    try:
        while True:
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                return descriptor
            except BlockingIOError:
                if time.monotonic() > until:
                    why = f"another process has been writing the result there for {LOCK_PATIENCE:g} s"
                    raise InputError(str(folder), NO_VALUE, why) from None
                time.sleep(0.01)
            except OSError:  # a network file system without locks
                os.close(descriptor)
                return None
    except BaseException:
        os.close(descriptor)
        raise
