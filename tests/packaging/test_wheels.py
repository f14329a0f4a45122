"""Both wheels of scripts/build_wheel.py, in an environment with no compiler in reach and nothing else installed.

It takes wheels that are built: ``python scripts/build_wheel.py OUT``, then
``LIFTOPT_WHEELS=OUT pytest tests/packaging``. Oracles: the solve of the environment that runs the tests, Pinocchio's
inverse dynamics in double precision, and pip's own record of pin's files.
"""

from __future__ import annotations

import base64
import csv
import hashlib
import json
import os
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from liftopt.viz.meshcat_files import LICENCES

# The viewer's file of meshcat 0.3.2, as that wheel's own record has it.
VIEWER = "sha256=3Qe5X7aVfPbBjufPOQm26yghSZUUJCgXGmDXbDNYIR8"
LIFTOPT, OWN = "liftopt-*.whl", "liftopt_pinocchio_casadi-*.whl"
RNEA = """
import casadi, numpy, pinocchio
import pinocchio.casadi as cpin
model = pinocchio.buildSampleModelManipulator()
symbolic = cpin.Model(model)
state = [casadi.SX.sym(name, model.nv) for name in "qva"]
tau = casadi.Function("tau", state, [cpin.rnea(symbolic, symbolic.createData(), *state)])
numbers = numpy.random.default_rng(0).normal(size=(3, model.nv))
print(abs(numpy.array(tau(*numbers)).ravel() - pinocchio.rnea(model, model.createData(), *numbers)).max())
"""
EVERY_PROCESSOR = """
from liftopt.collocation.codegen.simd_kernels import PROCESSORS, load_simd_kernels
from liftopt.collocation.problem import kernel_requests
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import load_scenario
requests = kernel_requests(agents_of(load_scenario()), object_of(load_scenario()))
print(*(load_simd_kernels(requests, extensions=extensions)[0].lanes for extensions in PROCESSORS))
"""
BACKEND = "import liftopt.pinocchio_casadi as cpin; print(cpin.rnea.__module__)"


class Bare:
    """A virtual environment with liftopt's wheel and what it depends on."""

    def __init__(self, folder: Path) -> None:
        self.bin, self.cache = folder / "bin", folder / "kernels"
        self.cache.mkdir(mode=0o700, parents=True)
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)

    def __call__(self, command: str, *arguments: str) -> str:
        """Run a command of the environment, where there is no other, and return what it prints."""
        environment = {"PATH": str(self.bin), "HOME": str(self.cache.parent), "LIFTOPT_CACHE": str(self.cache)}
        words = [str(self.bin / command), *arguments]
        run = subprocess.run(words, env=environment, cwd=self.cache.parent, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stdout + run.stderr
        return run.stdout

    def install(self, wheel: Path) -> None:
        """Install a wheel, and from the index only wheels."""
        command = [str(self.bin / "python"), "-m", "pip", "install", "-q", "--only-binary", ":all:", str(wheel)]
        subprocess.run(command, check=True)

    def solve(self, out: str) -> dict[str, Any]:
        """Solve the default lift by command line and return what it tells."""
        told: dict[str, Any] = json.loads(self("liftopt", "solve", "table5", "--json", "--out", out))
        return told


@pytest.fixture(scope="module")
def wheels() -> Path:
    """Return the folder with both wheels."""
    named = os.environ.get("LIFTOPT_WHEELS")
    if named is None:
        pytest.skip("no wheels: run scripts/build_wheel.py OUT and set LIFTOPT_WHEELS=OUT")
    return Path(named).resolve()


@pytest.fixture(scope="module")
def bare(wheels: Path, tmp_path_factory: pytest.TempPathFactory) -> Bare:
    """Return an environment with liftopt's wheel alone."""
    made = Bare(tmp_path_factory.mktemp("bare"))
    (wheel,) = wheels.glob(LIFTOPT)
    made.install(wheel)
    return made


@pytest.fixture(scope="module")
def solved_bare(bare: Bare) -> dict[str, Any]:
    """Return what a solve tells before the second wheel is there."""
    return bare.solve("alone")


@pytest.fixture(scope="module")
def both(bare: Bare, solved_bare: dict[str, Any], wheels: Path) -> Bare:
    """Return the environment with the second wheel too."""
    assert solved_bare["solved"]
    (wheel,) = wheels.glob(OWN)
    bare.install(wheel)
    return bare


def test_the_wheels_say_on_which_systems_they_run(wheels: Path) -> None:
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    for pattern in (LIFTOPT, OWN):
        (wheel,) = wheels.glob(pattern)
        assert re.search(rf"-{python}-{python}-manylinux_2_\d+_\w+\.whl$", wheel.name)


def test_the_viewer_and_its_licences_are_inside(wheels: Path) -> None:
    (wheel,) = wheels.glob(LIFTOPT)
    with zipfile.ZipFile(wheel) as file:
        kind, _, digest = VIEWER.partition("=")
        content = file.read("liftopt/viz/assets/meshcat/main.min.js")
        assert base64.urlsafe_b64encode(hashlib.new(kind, content).digest()).decode().rstrip("=") == digest
        (metadata,) = (name for name in file.namelist() if name.endswith(".dist-info/METADATA"))
        folder = metadata.replace("METADATA", "licenses/")
        names = [name for name in file.namelist() if not name.endswith("/")]
        licences = {name.removeprefix(folder) for name in names if name.startswith(folder)}
        expression = re.search(r"^License-Expression: (.*)$", file.read(metadata).decode(), re.MULTILINE)
    assert expression is not None
    assert set(expression[1].split(" AND ")) == {"BSD-3-Clause", "MIT", "Apache-2.0"}
    assert licences == {"LICENSE", *(f"meshcat/{name}" for name in LICENCES)}


def test_it_solves_as_this_environment_does(
    bare: Bare, solved_bare: dict[str, Any], solved: Callable[..., Any]
) -> None:
    """Nothing is compiled there: the kernels are found, and the answer is bit by bit that of kernels compiled here."""
    assert solved_bare["solved"]
    assert solved_bare["objective"]["total"] == solved("table5").solution.objective
    assert list(bare.cache.iterdir()) == []
    assert "virtual machine" not in bare("liftopt", "solve", "table5", "--details", "--out", "details")


def test_it_has_kernels_for_the_vectors_of_every_processor(bare: Bare) -> None:
    assert bare("python", "-c", EVERY_PROCESSOR).split() == ["8", "4", "2"]


def test_it_shows_what_it_solved(bare: Bare, solved_bare: dict[str, Any]) -> None:
    assert solved_bare["solved"]
    bare("liftopt", "view", "alone", "--html", "lift.html")
    bare("liftopt", "report", "alone", "--html", "report.html")
    assert (bare.cache.parent / "lift.html").stat().st_size > 1_000_000


def test_pinocchio_casadi_computes_what_pinocchio_does(both: Bare) -> None:
    assert float(both("python", "-c", RNEA)) < 1e-12


def test_the_example_of_its_readme_runs(both: Bare) -> None:
    readme = (Path(__file__).parents[2] / "liftopt/pinocchio_casadi/README.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"^```python\n(.*?)^```$", readme, flags=re.MULTILINE | re.DOTALL)
    assert both("python", "-c", example + "print(inverse_dynamics)").startswith("rnea:")


def test_pinocchio_casadi_leaves_the_files_of_pin_alone(both: Bare) -> None:
    (record,) = both.bin.parent.glob("lib/python*/site-packages/pin-*.dist-info/RECORD")
    checked = 0
    for name, digest, _ in csv.reader(record.read_text(encoding="utf-8").splitlines()):
        if digest:
            content = (record.parents[1] / name).read_bytes()
            kind, _, value = digest.partition("=")
            assert base64.urlsafe_b64encode(hashlib.new(kind, content).digest()).decode().rstrip("=") == value, name
            checked += 1
    assert checked > 10


def test_liftopt_goes_on_working_beside_it(both: Bare, solved_bare: dict[str, Any]) -> None:
    """It then uses that wheel's module, and says the same."""
    assert both("python", "-c", BACKEND).strip() == "pinocchio.casadi._liftopt_pinocchio_casadi"
    assert both.solve("beside")["objective"] == solved_bare["objective"]
    assert list(both.cache.iterdir()) == []
    both("liftopt", "crosscheck", "--samples", "5")
