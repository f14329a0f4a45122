"""A robot's file out of the package ``robot_descriptions``, where that is installed and has it in its cache.

The package fetches repositories from the network when its modules are imported. Here nothing is fetched: a description
that is not in its cache yet is refused, with the command that brings it.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import did_you_mean, nearest

PACKAGE, ENDING = "robot_descriptions", "_description"
CACHE, USUAL_CACHE = "ROBOT_DESCRIPTIONS_CACHE", "~/.cache/robot_descriptions"
FETCHED = re.compile(r"clone_to_cache\(\s*\"([^\"]+)\"")


@dataclass(frozen=True)
class PublicDescription:
    """A file that describes a robot.

    Attributes:
        path: of a URDF or xacro file.
        arguments: of a xacro file.
    """

    path: Path
    arguments: Mapping[str, str]


def is_public(word: str) -> bool:
    """Whether a word is the name of a description, as that package has them: ``iiwa14_description``."""
    return word.endswith(ENDING) and word.isidentifier()


def public_description(name: str) -> PublicDescription:
    """Return the file of a description.

    Raises:
        InputError: the package is not installed, has no such description of a kind that is read here, or has it not in
            its cache.
    """
    found = importlib.util.find_spec(PACKAGE)
    if found is None or not found.submodule_search_locations:
        raise InputError(name, NO_VALUE, f"the package {PACKAGE} has public descriptions: pip install {PACKAGE}")
    folder = Path(next(iter(found.submodule_search_locations)))
    source = folder / f"{name}.py"
    if not source.is_file():
        there = [path.stem for path in folder.glob(f"*{ENDING}.py")]
        raise InputError(name, NO_VALUE, f"{PACKAGE} has no such description{did_you_mean(nearest(name, there, 3))}")
    _refuse_uncached(name, source)
    try:
        module = importlib.import_module(f"{PACKAGE}.{name}")
    except Exception as error:  # of many kinds: of Git, of the network, of the package
        raise InputError(name, NO_VALUE, f"{PACKAGE} cannot give it: {' '.join(str(error).split())}") from None
    path = getattr(module, "URDF_PATH", None) or getattr(module, "XACRO_PATH", None)
    if path is None or not Path(path).is_file():
        raise InputError(name, NO_VALUE, f"{PACKAGE} has no URDF or xacro file of it")
    arguments = {} if hasattr(module, "URDF_PATH") else getattr(module, "XACRO_ARGS", {})
    return PublicDescription(Path(path), {key: str(value) for key, value in arguments.items()})


def _refuse_uncached(name: str, source: Path) -> None:
    repositories = importlib.import_module(f"{PACKAGE}._repositories").REPOSITORIES
    cache = Path(os.environ.get(CACHE, USUAL_CACHE)).expanduser()
    for fetched in FETCHED.findall(source.read_text(encoding="utf-8")):
        if fetched not in repositories or not (cache / repositories[fetched].cache_path).is_dir():
            brings = f"{PACKAGE} pull {name}"
            raise InputError(name, NO_VALUE, f"is not in the cache of {PACKAGE}; this fetches it: {brings}")
