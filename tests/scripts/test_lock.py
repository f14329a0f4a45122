"""The locked versions are names and versions alone. Oracle: a report as pip writes it, made by hand."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
REPORT = {
    "environment": {"python_version": "3.11", "platform_machine": "x86_64", "platform_system": "Linux"},
    "install": [
        {"metadata": {"name": "numpy", "version": "2.4.6"}, "download_info": {"url": "https://somewhere/numpy.whl"}},
        {"metadata": {"name": "Jinja2", "version": "3.1.6"}, "download_info": {"url": "file:///somewhere/jinja2.whl"}},
    ],
}


@pytest.fixture(scope="module")
def script() -> ModuleType:
    """Return scripts/lock.py as a module."""
    spec = importlib.util.spec_from_file_location("lock", ROOT / "scripts/lock.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_names_and_versions_are_kept_and_places_are_not(script: ModuleType) -> None:
    text = script.locked(REPORT)
    assert [line for line in text.splitlines() if not line.startswith("#")] == ["Jinja2==3.1.6", "numpy==2.4.6"]
    assert "Python 3.11 and x86_64 Linux" in text
    assert "somewhere" not in text


def test_what_pip_refuses_ends_in_its_own_words(script: ModuleType) -> None:
    with pytest.raises(SystemExit, match="pip failed"):
        script.resolved(["not a requirement"])
