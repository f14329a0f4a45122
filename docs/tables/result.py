"""Variables and attributes of solution.nc, read from one."""

from __future__ import annotations

import inspect
import re

import xarray as xr

from drawings.stage import default_result
from liftopt.solution.solution import Solution
from tables import table


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
    """Return the attributes of the default lift's file and the type of each."""
    with _opened() as data:
        rows = [(f"`{name}`", "text" if isinstance(value, str) else "number") for name, value in data.attrs.items()]
    return table(("attribute", "type"), rows)


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
