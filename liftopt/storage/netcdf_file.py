"""A solution.nc read from disk, whatever somebody has made of it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.bounded_read import read_regular
from liftopt.files.checksum import has_checksum
from liftopt.storage.netcdf_sandbox import Contents, contents, unpacked

LARGEST_FILE = 50_000_000  # bytes; a lift on 400 intervals has some 300 kB
SIGNATURE = b"\x89HDF\r\n\x1a\n"
READ = "import sys; sys.path[:] = sys.argv[1:]; from liftopt.storage.netcdf_sandbox import main; main()"
READ_PATIENCE = 20.0  # seconds; reading takes a tenth of one


def read_netcdf(path: Path) -> Contents:
    """Return the numbers and attributes of a NetCDF-4 file.

    As liftopt wrote it, which its checksum tells, it is read here. If it is not, because another program wrote it or it
    is damaged, a process of its own reads it, which may end or last without harm.

    Raises:
        FileNotFoundError: there is none.
        InputError: it cannot be read, or is damaged.
    """
    image, why = read_regular(path, LARGEST_FILE, "no result of liftopt is that large"), "it is no HDF5 file"
    if image.startswith(SIGNATURE):
        try:
            return contents(image) if has_checksum(image) else _apart(image)
        except (OSError, ValueError, KeyError, RuntimeError, TypeError, MemoryError) as error:
            why = " ".join(str(error).split()) or type(error).__name__
    raise InputError(str(path), NO_VALUE, f"cannot be read as NetCDF-4: {why}")


def _apart(image: bytes) -> Contents:
    """Let another process read; raises ValueError where that cannot."""
    # Isolated: a module in the folder where the user stands, which may be a stranger's, is not taken for one of ours.
    paths = [*filter(None, sys.path), str(Path(__file__).parents[2])]
    # HDF5's own filters, and none that is loaded from a folder.
    environment = os.environ | {"HDF5_PLUGIN_PRELOAD": "::"}
    command = [sys.executable, "-I", "-c", READ, *map(os.path.abspath, paths)]
    try:
        run = subprocess.run(
            command, input=image, env=environment, capture_output=True, timeout=READ_PATIENCE, check=False
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"it is damaged: reading it takes more than {READ_PATIENCE:g} s") from None
    if run.returncode < 0:
        raise ValueError("it is damaged: the HDF5 library crashes on it")
    if run.returncode:
        raise ValueError(run.stderr.decode(errors="replace").strip().split("\n")[-1] or "it is damaged")
    return unpacked(run.stdout)
