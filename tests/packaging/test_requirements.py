"""What pyproject.toml asks for. The oracle is what the code imports, and what the other lists say."""

from __future__ import annotations

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from liftopt.viz.meshcat_files import LICENCES, MESHCAT, VIEWER

pytestmark = pytest.mark.long
ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
OWN_WHEEL = tomllib.loads((ROOT / "liftopt/pinocchio_casadi/pyproject.toml").read_text(encoding="utf-8"))
# Distributions whose module has another name, and modules that are parts of another distribution.
DISTRIBUTIONS = {"pinocchio": "pin", "serial": "pyserial", "markupsafe": "jinja2"} | dict.fromkeys(
    ("annotated_types", "pydantic_core", "typing_extensions"), "pydantic"
)
# Compiled here, or a part of Python from 3.11 on.
OURS = {"liftopt", "_liftopt_banded", "_liftopt_pinocchio_casadi"}
# Run as the build runs it, but without a compiler: then it imports the same and compiles nothing.
SHIP = """
import json, sys
from liftopt.search import ship_kernels
ship_kernels.main([sys.argv[1]])
files = {name: module.__file__ for name, module in sys.modules.items() if name.partition(".")[0] == "liftopt"}
print(json.dumps({"files": [file for file in files.values() if file], "loaded": list(sys.modules)}))
"""


def listed(requirements: list[str]) -> dict[str, str]:
    """Return version bounds by the name of the distribution."""
    found = {}
    for requirement in requirements:
        match = re.fullmatch(r"([\w.-]+)\s*([^;]*?)\s*(;.*)?", requirement)
        assert match is not None, requirement
        found[match[1].lower().replace("_", "-")] = match[2]
    return found


BUILD = listed(PROJECT["build-system"]["requires"])
PLAIN = listed(PROJECT["project"]["dependencies"])
EXTRAS = {name: listed(entries) for name, entries in PROJECT["project"]["optional-dependencies"].items()}


def imported(file: Path) -> set[str]:
    """Return the distributions that a file's import statements name."""
    modules: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            modules |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            modules.add(str(node.module).partition(".")[0])
    return modules - OURS - sys.stdlib_module_names


def distributions(modules: set[str]) -> set[str]:
    return {DISTRIBUTIONS.get(name, name).lower().replace("_", "-") for name in modules}


def test_the_build_has_all_that_compiling_the_kernels_imports(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is missing there would leave the kernels out of the wheel, and say so in a line that nobody reads."""
    monkeypatch.setenv("CC", "")
    command = [sys.executable, "-c", SHIP, str(tmp_path)]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    told: dict[str, Any] = json.loads(run.stdout.splitlines()[-1])
    loaded = {name.partition(".")[0] for name in told["loaded"]}
    needed = set().union(*(imported(Path(file)) for file in told["files"])) & loaded
    assert {"casadi", "numpy", "pinocchio"} <= needed
    assert distributions(needed) - BUILD.keys() == set()


def configure_the_viewer(tmp_path: Path, path: Path) -> tuple[int, str, Path]:
    """Configure the part of the build that brings the viewer; what Python finds on ``path`` goes before all else."""
    cmake = shutil.which("cmake")
    if cmake is None:
        pytest.skip("no CMake; pip has its own while it builds")
    build = tmp_path / "build"
    command = [cmake, "-S", str(ROOT / "liftopt/viz"), "-B", str(build), f"-DPython_EXECUTABLE={sys.executable}"]
    environment = os.environ | {"PYTHONPATH": str(path)}
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    return run.returncode, run.stderr, build / "meshcat"


def test_the_build_brings_the_viewer_from_meshcat(tmp_path: Path) -> None:
    meshcat = tmp_path / "meshcat"
    (meshcat / "viewer" / "dist").mkdir(parents=True)
    (meshcat / "__init__.py").touch()
    (meshcat / "viewer" / "LICENSE").touch()
    for name in (VIEWER, *LICENCES[1:]):
        (meshcat / "viewer" / "dist" / name).write_text(name)
    status, told, made = configure_the_viewer(tmp_path, tmp_path)
    assert status == 0, told
    assert {file.name for file in made.iterdir()} == {VIEWER, *LICENCES}
    assert (made / VIEWER).read_text() == VIEWER


def test_the_build_ends_where_meshcat_is_missing(tmp_path: Path) -> None:
    """A wheel without the viewer would show so only when somebody asks for a page."""
    (tmp_path / "meshcat.py").touch()
    status, told, made = configure_the_viewer(tmp_path, tmp_path)
    assert status != 0
    assert VIEWER in told and "CMake Error" in told and "meshcat" in told
    assert not made.exists()


def test_only_the_build_asks_for_meshcat() -> None:
    """In the version that a source tree is told to install; as a dependency it would bring 20 packages."""
    assert f"meshcat{BUILD['meshcat']}" == MESHCAT
    assert [names for names in (PLAIN, *EXTRAS.values()) if "meshcat" in names] == []
    assert not (ROOT / "liftopt/viz/assets/meshcat").exists()


def test_a_package_has_the_same_bounds_wherever_it_is_asked_for() -> None:
    for name, entries in {"the build": BUILD, **EXTRAS}.items():
        for package in entries.keys() & PLAIN.keys():
            assert entries[package] == PLAIN[package], f"{package} in {name}"
    others = EXTRAS["lab"] | EXTRAS["crosscheck"] | EXTRAS["robots"]
    for package in EXTRAS["test"].keys() & others.keys():
        assert EXTRAS["test"][package] == others[package], package


def test_the_wheel_of_pinocchio_casadi_is_built_from_the_same_versions() -> None:
    build, plain = listed(OWN_WHEEL["build-system"]["requires"]), listed(OWN_WHEEL["project"]["dependencies"])
    assert build.items() <= BUILD.items()
    assert plain.items() <= PLAIN.items()
    assert f"=={OWN_WHEEL['project']['version']}" == PLAIN["pin"]


def test_everything_imported_is_asked_for_and_everything_asked_for_is_imported() -> None:
    found = {file: distributions(imported(file)) for file in (ROOT / "liftopt").rglob("*.py")}
    offered = PLAIN.keys() | EXTRAS["lab"].keys() | EXTRAS["crosscheck"].keys() | EXTRAS["robots"].keys()
    assert {str(file): names - offered for file, names in found.items() if names - offered} == {}
    assert PLAIN.keys() - set().union(*found.values()) == set()


def test_only_laboratory_crosscheck_and_robots_import_what_a_plain_install_has_not() -> None:
    for file in (ROOT / "liftopt").rglob("*.py"):
        rooms = file.relative_to(ROOT / "liftopt").parts
        if rooms[0] not in ("lab", "crosscheck"):
            more = EXTRAS["robots"].keys() if rooms[:2] == ("multibody", "robots") else set()
            assert distributions(imported(file)) - PLAIN.keys() - more == set(), file


def test_the_locked_versions_are_within_the_bounds() -> None:
    """What contributors and the tests ask for stands there, and nothing but names and versions does."""
    lines = (ROOT / "requirements/lock.txt").read_text(encoding="utf-8").splitlines()
    pins = [line.split("==") for line in lines if not line.startswith("#")]
    assert [pin for pin in pins if not (len(pin) == 2 and re.fullmatch(r"[\w.+]+", pin[1]))] == []
    locked = {canonicalize_name(name): version for name, version in pins}
    project = PROJECT["project"]
    extras = project["optional-dependencies"]
    for requirement in map(Requirement, [*project["dependencies"], *extras["test"], *extras["docs"]]):
        if requirement.marker is None:
            assert locked[canonicalize_name(requirement.name)] in requirement.specifier, requirement


def test_the_installation_page_tells_what_every_package_is_for() -> None:
    page = (ROOT / "docs/installation.md").read_text(encoding="utf-8").replace("_", "-")
    for names in (PLAIN, *EXTRAS.values()):
        assert [name for name in names if f"`{name}`" not in page] == []
    assert [extra for extra in EXTRAS if f"`{extra}`" not in page] == []
