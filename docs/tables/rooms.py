"""The rooms of the code, from their own first lines."""

from __future__ import annotations

import ast
from pathlib import Path

import liftopt
from tables import table

ROOT = Path(liftopt.__file__).parent


def rooms() -> str:
    """Return every folder of the package with what it says of itself and how many files it has."""
    rows = []
    for init in sorted(ROOT.rglob("__init__.py")):
        room = init.parent.relative_to(ROOT).as_posix()
        if room != ".":
            said = (ast.get_docstring(ast.parse(init.read_text(encoding="utf-8"))) or "").partition("\n")[0]
            files = [path for path in init.parent.glob("*.py") if path != init]
            rows.append((f"`{room}/`", said, len(files)))
    return table(("room", "what it is for", "files"), rows)
