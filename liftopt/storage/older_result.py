"""Results of earlier versions, which kept the scenario and the models in files beside solution.nc."""

from __future__ import annotations

from pathlib import Path

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.bounded_read import read_regular
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.scenario.urdf_files import urdf_files
from liftopt.storage.result_folder import MODELS, SCENARIO
from liftopt.storage.urdf_check import LARGEST_URDF

# While a result replaced another one, that stood here; what lies around it was a mix.
KEPT = ".older-result"


def scenario_beside(folder: Path) -> Scenario:
    """Return the scenario beside a solution.nc without one.

    Raises:
        InputError: there is none, it is wrong, or the result was never written to its end.
    """
    if (folder / KEPT).is_dir():
        why = (
            f"an earlier version was interrupted while it wrote a result here; the one before it is in {folder / KEPT}"
        )
        raise InputError(str(folder), NO_VALUE, why)
    if not (folder / SCENARIO).exists():
        why = "no such file; a result of an earlier version has one beside its solution.nc"
        raise InputError(str(folder / SCENARIO), NO_VALUE, why)
    return load_scenario(folder / SCENARIO)


def urdfs_beside(folder: Path, scenario: Scenario) -> dict[str, str]:
    """Return the models beside a solution.nc without them, unchecked, by the names of agents and object.

    Raises:
        InputError: one is missing or cannot be read.
    """
    return {name: _text(folder / MODELS / file) for name, file in urdf_files(scenario).items()}


def _text(path: Path) -> str:
    try:
        return read_regular(path, LARGEST_URDF, "no model of liftopt is that large").decode("utf-8")
    except FileNotFoundError:
        raise InputError(str(path), NO_VALUE, "cannot be read, and belongs to the result: no such file") from None
    except UnicodeDecodeError as error:
        raise InputError(str(path), NO_VALUE, f"is a model that cannot be read: {error}") from None
