"""Which module answers. Oracle: the documented choice, played through with stand-in modules."""

from __future__ import annotations

import importlib
import subprocess
import sys
from collections.abc import Iterator
from types import ModuleType

import pytest

import liftopt

PACKAGE = "liftopt.pinocchio_casadi"


def _imported() -> list[str]:
    return [name for name in sys.modules if name == PACKAGE or name.startswith(f"{PACKAGE}.")]


@pytest.fixture
def fresh(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let the package be imported anew; what was imported before, and nothing else, is there afterwards."""
    for name in _imported():
        monkeypatch.delitem(sys.modules, name)
    # A submodule is also an attribute of its parent.
    monkeypatch.setattr(liftopt, "pinocchio_casadi", None, raising=False)
    yield
    for name in _imported():
        del sys.modules[name]


@pytest.mark.usefixtures("fresh")
def test_an_importable_pinocchio_casadi_is_preferred(monkeypatch: pytest.MonkeyPatch) -> None:
    upstream = ModuleType("pinocchio.casadi")
    upstream.rnea = object()  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pinocchio.casadi", upstream)
    package = importlib.import_module(PACKAGE)
    assert package.rnea is upstream.rnea  # type: ignore[attr-defined]
    assert "rnea" in dir(package)
    with pytest.raises(AttributeError, match=r"backed by pinocchio\.casadi.*has no attribute 'crba'"):
        _ = package.crba


@pytest.mark.usefixtures("fresh")
def test_without_it_the_extension_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pinocchio.casadi", None)
    assert importlib.import_module(PACKAGE).rnea.__module__ == "_liftopt_pinocchio_casadi"


@pytest.mark.usefixtures("fresh")
def test_a_missing_extension_names_the_fix(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pinocchio.casadi", None)
    monkeypatch.setitem(sys.modules, "_liftopt_pinocchio_casadi", None)
    with pytest.raises(ImportError, match="reinstall liftopt with `pip install"):
        importlib.import_module(PACKAGE)


@pytest.mark.usefixtures("fresh")
@pytest.mark.parametrize("package", ["casadi", "pinocchio"])
def test_another_version_than_built_against_names_the_fix(monkeypatch: pytest.MonkeyPatch, package: str) -> None:
    monkeypatch.setitem(sys.modules, "pinocchio.casadi", None)
    extension = importlib.import_module("_liftopt_pinocchio_casadi")
    monkeypatch.setattr(extension, f"{package}_version", "0.0.1")
    with pytest.raises(ImportError, match=r"built against \w+ 0\.0\.1, but .* is installed; run `pip install"):
        importlib.import_module(PACKAGE)


def test_models_do_not_need_the_extension() -> None:
    code = (
        "import sys, liftopt.multibody.person.human, liftopt.multibody.robots.sawyer, liftopt.multibody.table\n"
        f"assert not any(name.startswith('{PACKAGE}') for name in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
