"""A solution written to disk: solution.nc, which is the result, and files for people and other tools beside it."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from liftopt.errors import InputError, LiftoptError
from liftopt.files.checksum import with_checksum
from liftopt.scenario.urdf_files import urdf_files
from liftopt.solution.solution import Solution
from liftopt.storage.dataset import to_xarray
from liftopt.storage.netcdf_file import read_netcdf
from liftopt.storage.result_folder import MODELS, NETCDF, SCENARIO, UNSOLVED, locked, replace_result
from liftopt.storage.solved_scenario import scenario_of


def save(solution: Solution, out: Path) -> Path:
    """Write a solution into the folder ``out``: whole or not at all; see ``result_folder``.

    What is no solution never replaces one: if there is one in ``out``, it goes to ``out/unsolved``.

    Returns:
        The folder that it was written to.

    Raises:
        InputError: the folder or a file cannot be written.
    """
    content = with_checksum(netcdf_bytes(solution))
    beside = {SCENARIO: solution.scenario.to_toml().encode()}
    beside |= {
        f"{MODELS}/{file}": solution.urdfs[name].encode() for name, file in urdf_files(solution.scenario).items()
    }
    try:
        out.mkdir(parents=True, exist_ok=True)
        with locked(out):
            if solution.solved or not holds_more_than_an_iterate(out):
                _put(out, content, beside)
                return out
            aside = out / UNSOLVED
            if aside.is_symlink():
                raise OSError(errno.ENOTDIR, f"{aside} is a link, and what is written there would be elsewhere")
            aside.mkdir(exist_ok=True)
            with locked(aside):
                _put(aside, content, beside)
            return aside
    except OSError as error:
        raise InputError("--out", str(out), f"cannot be written: {error.strerror or error}") from error


def _put(folder: Path, content: bytes, beside: dict[str, bytes]) -> None:
    """Write a result, and remove the models of the one before it that this one does not have."""
    left_over = _models_of(folder) - set(beside)
    replace_result(folder, content, beside)
    for name in left_over:
        (folder / name).unlink(missing_ok=True)


def _models_of(folder: Path) -> set[str]:
    """Return the models beside the result in a folder, by their paths within it; none if there is no result."""
    file = folder / NETCDF
    if not os.path.lexists(file):
        return set()
    try:
        scenario = scenario_of(file, read_netcdf(file).attributes)
    except (LiftoptError, OSError):
        return set()
    return {f"{MODELS}/{name}" for name in urdf_files(scenario).values()}


def files_of(solution: Solution) -> tuple[str, ...]:
    """Return the files that ``save`` writes, by their paths within the folder."""
    return (*(f"{MODELS}/{file}" for file in urdf_files(solution.scenario).values()), SCENARIO, NETCDF)


def holds_more_than_an_iterate(folder: Path) -> bool:
    """Return whether a folder holds a result that is not certainly one of a solve that failed."""
    file = folder / NETCDF
    if not os.path.lexists(file):
        return False
    try:
        return bool(read_netcdf(file)[1]["verified"] != 0)
    except (InputError, OSError, LookupError, ValueError, TypeError):  # whatever it is, it may be worth something
        return True


def netcdf_bytes(solution: Solution) -> bytes:
    """Return a solution's dataset as a NetCDF-4 file; the same solution gives the same bytes."""
    dataset = to_xarray(solution)
    whole = {name: {"_FillValue": None} for name in dataset.variables}  # nothing is missing
    return bytes(dataset.to_netcdf(engine="h5netcdf", encoding=whole))
