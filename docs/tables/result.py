"""Variables and attributes of solution.nc, read from one."""

from __future__ import annotations

import xarray as xr

from drawings.stage import default_result
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


def _opened() -> xr.Dataset:
    return xr.open_dataset(default_result() / "solution.nc", engine="h5netcdf")
