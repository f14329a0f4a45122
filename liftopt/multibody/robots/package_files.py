"""Which file an address in a URDF means: ``package://``, ``model://``, ``file://``, or a path.

A package is looked for in the folders above the file that names it, then in those of ``ROS_PACKAGE_PATH`` and
``AMENT_PREFIX_PATH``, then beside and in the robots of example-robot-data.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from liftopt.multibody.robots.example_robot_data import share_folder

IN_PACKAGES = ("package://", "model://")


def file_of(address: str, beside: Path | None) -> Path | None:
    """Return the file that an address means, or None where there is none.

    Args:
        address: as it stands in the URDF.
        beside: the file that names it, or None for a text that is no file.
    """
    for scheme in IN_PACKAGES:
        if address.startswith(scheme):
            package, _, rest = address.removeprefix(scheme).partition("/")
            found = (folder / rest for folder in package_folders(package, beside))
            return next((path for path in found if path.is_file()), None)
    if address.startswith("file://"):
        path = Path(unquote(address.removeprefix("file://")))
    else:
        path = Path(address) if beside is None else beside.parent / address
    return path if path.is_file() else None


def package_folders(package: str, beside: Path | None) -> Iterator[Path]:
    """Give the folders that a package of this name may be, those that exist."""
    for folder in _looked_in(beside):
        for found in (folder if folder.name == package else None, folder / package, folder / "share" / package):
            if found is not None and found.is_dir():
                yield found


def _looked_in(beside: Path | None) -> Iterator[Path]:
    if beside is not None:
        yield from beside.absolute().parents
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        yield from (Path(entry) for entry in os.environ.get(variable, "").split(os.pathsep) if entry)
    share = share_folder()
    if share is not None:
        yield from (share.parent, share / "robots")
