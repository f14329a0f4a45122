"""The scenario that a command is given: a file, a shipped one, or that of a result."""

from __future__ import annotations

from pathlib import Path

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import MOST, did_you_mean, nearest
from liftopt.scenario.file import no_scenario, shipped_scenarios
from liftopt.scenario.keys import Changes
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.storage.result_folder import NETCDF, SCENARIO, locked, results_in, standing_result


def scenario_or_solved(source: str | None, changes: Changes = ()) -> Scenario:
    """Return the scenario of a file or a shipped one, or that a result was solved for.

    Args:
        source: as ``load_scenario`` takes it, or a result folder or its solution.nc.
        changes: likewise.

    Raises:
        InputError: there is none, or it describes no scenario.
    """
    if source is None or source in shipped_scenarios():
        return load_scenario(source, changes)
    path = Path(source)
    folder = path.parent if path.name == NETCDF else path
    try:
        of_result, there = path.name == NETCDF or path.is_dir(), path.exists()
    except (OSError, ValueError):  # too long, a NUL: reading it says so
        of_result, there = False, True
    if of_result:
        with locked(folder, to_write=False):
            path = standing_result(folder) / SCENARIO
            if not path.is_file():
                offer = did_you_mean([str(entry) for entry in results_in(folder)][:MOST])
                raise InputError(source, NO_VALUE, f"is not a file, nor a result folder with a {SCENARIO}{offer}")
            return load_scenario(path, changes)
    if not there:
        beside = {entry.name: str(entry) for entry in results_in(path.parent)}
        raise no_scenario(path, [beside[name] for name in nearest(path.name, beside)])
    return load_scenario(path, changes)
