"""Which file an address in a URDF means: ``package://``, ``model://``, ``file://``, or a path.

A package is looked for in the folders above the file that names it, which go by their names or by that in their
``package.xml``, then in those of ``ROS_PACKAGE_PATH`` and ``AMENT_PREFIX_PATH``, then beside and in the robots of
example-robot-data.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from liftopt.errors import LiftoptError
from liftopt.files.bounded_read import read_regular
from liftopt.multibody.robots.example_robot_data import share_folder

IN_PACKAGES = ("package://", "model://")
NAME = re.compile(r"<name>([^<]*)</name>")
LARGEST = 1_000_000  # bytes of a package.xml


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
        own = folder if folder.name == package or name_in(folder) == package else None
        for found in (own, folder / package, folder / "share" / package):
            if found is not None and found.is_dir():
                yield found


def name_in(folder: Path) -> str | None:
    """Return the package's name that the ``package.xml`` of a folder says: it need not be that of the folder."""
    try:
        text = read_regular(folder / "package.xml", LARGEST, "a package.xml").decode("utf-8", "replace")
    except (OSError, LiftoptError):
        return None
    found = NAME.search(text)
    return None if found is None else found[1].strip()


def _looked_in(beside: Path | None) -> Iterator[Path]:
    if beside is not None:
        yield from beside.absolute().parents
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        yield from (Path(entry) for entry in os.environ.get(variable, "").split(os.pathsep) if entry)
    share = share_folder()
    if share is not None:
        yield from (share.parent, share / "robots")
