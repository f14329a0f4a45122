"""The files of meshcat's viewer. The build takes them from meshcat's wheel and puts them into liftopt's.

The command is ``python -m liftopt.viz.meshcat_files FOLDER``. The wheel of meshcat also brings a server and 20 packages
that no page of ours uses; that is why only the build needs it. A source tree has no such files: there an installed
meshcat is asked for them, which is found and not imported.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from liftopt.errors import LiftoptError

MESHCAT = "meshcat==0.3.2"  # as in the build's requirements: the version that the pages were made for
VIEWER = "main.min.js"  # with three.js inside
LICENCES = ("LICENSE", "main.min.js.LICENSE.txt", "main.min.js.THIRD_PARTY_LICENSES.json")


def meshcat_text(name: str) -> str:
    """Return the text of the viewer or of one of its licences.

    Raises:
        LiftoptError: it came neither with liftopt nor with an installed meshcat.
    """
    shipped = files("liftopt.viz") / "assets" / "meshcat" / name
    return (shipped if shipped.is_file() else _installed(name)).read_text(encoding="utf-8")


def _installed(name: str) -> Path:
    """Return the path of a file in the meshcat that is installed."""
    meshcat = find_spec("meshcat")
    if meshcat is not None and meshcat.origin is not None:
        viewer = Path(meshcat.origin).parent / "viewer"
        for path in (viewer / "dist" / name, viewer / name):
            if path.is_file():
                return path
    raise LiftoptError(f"no {name} for the viewer's page: install liftopt, or in a source tree `pip install {MESHCAT}`")


def main(arguments: Sequence[str]) -> int:
    """Copy viewer and licences into a folder, byte by byte; the exit status is 1 where one is missing."""
    (folder,) = map(Path, arguments)
    try:
        contents = {name: _installed(name).read_bytes() for name in (VIEWER, *LICENCES)}
    except LiftoptError as error:
        print(error, file=sys.stderr)
        return 1
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
