"""Which result a path of the user's stands for, and what may have been meant by one that stands for none."""

from __future__ import annotations

from pathlib import Path

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import MOST, did_you_mean, nearest
from liftopt.scenario.file import shipped_scenarios
from liftopt.storage.result_folder import NETCDF, SCENARIO, holds_result, results_in

RESULTS = Path("results")  # where solve writes unless it is told otherwise


def result_file(path: Path) -> Path:
    """Return the NetCDF file of the result that a path stands for: that file, its folder, or the scenario beside it."""
    if path.name == SCENARIO and holds_result(path.parent):
        return path.parent / NETCDF
    return path if path.name.endswith(".nc") else path / NETCDF


def no_result(path: Path) -> InputError:
    """Return the error that says that a path stands for no result, and which may have been meant."""
    why = f"is no result: there is no file {result_file(path).name} there"
    if near := _near(path):
        return InputError(str(path), NO_VALUE, why + did_you_mean([str(folder) for folder in near]))
    if (path.suffix == ".toml" and path.is_file()) or str(path) in shipped_scenarios():
        return InputError(str(path), NO_VALUE, f"{why}; it is a scenario: liftopt solve {path} makes a result of it")
    folders = [path.parent, RESULTS] if path.parent == Path() else [path.parent]
    there = {folder.name: str(folder) for parent in reversed(folders) for folder in results_in(parent)}
    return InputError(
        str(path), NO_VALUE, why + did_you_mean([there[name] for name in nearest(_stem(path), there, MOST)])
    )


def _near(path: Path) -> list[Path]:
    """Return folders with results in a path, of its very name, or above it."""
    if inside := results_in(path):
        return inside[:MOST]
    if _stem(path) and holds_result(RESULTS / _stem(path)):
        return [RESULTS / _stem(path)]
    return [folder for folder in path.parents if folder != Path() and holds_result(folder)][:1]


def _stem(path: Path) -> str:
    return path.name.removesuffix(".nc").removesuffix(".toml")
