"""A scenario from wherever it stands: a TOML file, one that is shipped, or the result that it was solved for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import MOST, did_you_mean, nearest
from liftopt.files.toml_text import toml
from liftopt.scenario.file import LARGEST_FILE, no_scenario, shipped_scenarios
from liftopt.scenario.keys import Changes, changes_in
from liftopt.scenario.model import Scenario, load_scenario, scenario_from_dict
from liftopt.storage.older_result import scenario_beside
from liftopt.storage.result_folder import NETCDF, SCENARIO_TEXT, results_in


def scenario_or_solved(source: str | Path | None = None, changes: Changes = ()) -> Scenario:
    """Return the scenario of a TOML file, or the one that a result was solved for.

    Args:
        source: path of the file, the name of a shipped scenario (a str), or a result folder or its solution.nc; None is
            ``"table5"``.
        changes: entries that differ, as ``load_scenario`` takes them.

    Raises:
        InputError: what ``source`` names cannot be read, or does not describe a scenario.
    """
    if source is None or source in shipped_scenarios():
        return load_scenario(source, changes)
    path = Path(source)
    try:
        of_result, there = path.name == NETCDF or path.is_dir(), path.exists() or path.is_symlink()
    except (OSError, ValueError):  # too long a name, a NUL: reading it says so
        of_result, there = False, True
    if not of_result:
        if not there:
            raise no_scenario(path, _results_like(path))
        return load_scenario(path, changes)
    from liftopt.storage.netcdf_file import read_netcdf  # brings numpy, which bad input need not wait for

    file = path if path.name == NETCDF else path / NETCDF
    try:
        _, attributes = read_netcdf(file)
    except FileNotFoundError:
        offer = did_you_mean([str(entry) for entry in results_in(file.parent)][:MOST])
        why = f"is not a file, nor a result folder with a {NETCDF}{offer}"
        raise InputError(str(source), NO_VALUE, why) from None
    return scenario_of(file, attributes).replace(dict(changes_in(changes)))


def scenario_of(file: Path, attributes: Mapping[str, Any]) -> Scenario:
    """Return the scenario of a result, given the path of its solution.nc and its attributes.

    Raises:
        InputError: there is none, or it is wrong.
    """
    if SCENARIO_TEXT not in attributes:
        return scenario_beside(file.parent)
    text = attributes[SCENARIO_TEXT]
    try:
        if not isinstance(text, str) or len(text) > LARGEST_FILE:
            raise ValueError("it is no short text")
        return scenario_from_dict(toml(text))
    except (InputError, ValueError, RecursionError) as error:  # ValueError: TOMLDecodeError too
        raise InputError(str(file), NO_VALUE, f"holds a scenario that cannot be read: {error}") from None


def _results_like(path: Path) -> list[str]:
    """Return the results beside a path that it may have meant."""
    there = {entry.name: str(entry) for entry in results_in(path.parent)}
    stem = path.name if path.name in there else path.name.removesuffix(path.suffix)
    return [there[name] for name in nearest(stem, there)]
