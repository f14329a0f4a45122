"""Variables and attributes of solution.nc, read from one."""

from __future__ import annotations

import inspect
import re

import xarray as xr

from drawings.stage import default_result
from liftopt.solution.solution import Solution
from tables import table

# What an attribute means, by a pattern of its name; the first that fits. One that none fits ends the build.
MEANINGS = {
    r"title": "liftopt and the name of the scenario",
    r"status": "solved, or why not, in one line",
    r"verified": "1 if it is solved and its own verification agrees",
    r"objective": "weighted sum of the terms",
    r"preset": "of the objective: which terms it has",
    r"objective_limit": "the objective on ever finer meshes, extrapolated",
    r"objective_error": "objective / objective_limit - 1",
    r"objective_bar": "by how much the limit may be off, either way",
    r"objective_\w+": "unweighted integral of this term: an agent's squared torques (preset natural: of their shares "
    "of strength), accelerations (natural: times (duration / 2 s)^4), grasp forces; range of motion, the object's "
    "tilt; where it has a weight, the load on the spine",
    r"iterations": "of the solver, from the start that was kept",
    r"intervals": "N of the mesh",
    r"max_violation": "largest value among the checks that must hold at the knots to 1e-6",
    r"kkt_error": "first-order optimality",
    r"versions": "JSON: of liftopt, Python and libraries",
    r"assessment": "JSON: the findings",
    r"record": "JSON: starts, checks, notes, weights, suggested changes",
    r"scenario": "TOML: the scenario as solved",
    r"urdf_\w+": "URDF of this agent or of the object, as solved",
    r"closure_between_knots": "largest distance of a hand from its point on the object, on a ten times finer grid [m]",
    r"balance_between_knots": "largest residual of the object's balance there [N, Nm]",
    r"torque_excess_between_knots": "most that a torque exceeds its limit there [Nm]",
    r"compression_excess_between_knots": "most that the compression of a spine exceeds its limit there [N]",
    r"(solve|evaluation|setup|total)_seconds": "wall time of this part [s]",
}


def variables() -> str:
    """Return the variables of the default lift's file, with their dimensions and units."""
    with _opened() as data:
        rows = [
            (f"`{name}`", ", ".join(map(str, entry.dims)), entry.attrs["units"], entry.attrs["long_name"])
            for name, entry in data.variables.items()
            if name not in data.dims or name == "time"
        ]
    return table(("variable", "dimensions", "units", "meaning"), rows)


def attributes() -> str:
    """Return the attributes of the default lift's file, the type of each and what it means."""
    with _opened() as data:
        rows = [
            (f"`{name}`", "text" if isinstance(value, str) else "number", _meaning(str(name)))
            for name, value in data.attrs.items()
        ]
    return table(("attribute", "type", "meaning"), rows)


def _meaning(name: str) -> str:
    for pattern, meaning in MEANINGS.items():
        if re.fullmatch(pattern, name):
            return meaning
    raise LookupError(f"attribute {name} of solution.nc is not described in docs/tables/result.py")


def solution_attributes() -> str:
    """Return the attributes of a solution, from the docstring of the class that holds them."""
    told = inspect.getdoc(Solution) or ""
    told = told.partition("Attributes:\n")[2].partition("\n\n")[0]
    rows = []
    for line in re.sub(r"\n {8,}", " ", told).splitlines():
        names, _, meaning = line.strip().partition(": ")
        rows.append((", ".join(f"`{name}`" for name in names.split(", ")), meaning.replace("``", "`")))
    return table(("attribute", "what it is"), rows)


def _opened() -> xr.Dataset:
    return xr.open_dataset(default_result() / "solution.nc", engine="h5netcdf")
