"""A wheel is packed from what pip installed if that is whole and of this folder. Oracle: files put there by hand."""

from __future__ import annotations

import importlib.util
import zipfile
from importlib.metadata import PathDistribution
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
NAME = "liftopt/errors.py"


@pytest.fixture(scope="module")
def script() -> ModuleType:
    """Return scripts/build_wheel.py as a module."""
    spec = importlib.util.spec_from_file_location("build_wheel", ROOT / "scripts/build_wheel.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def installed(folder: Path, content: bytes, recorded: str) -> PathDistribution:
    """Return a distribution of one file, as pip leaves it."""
    info = folder / "liftopt-0.1.0.dist-info"
    for path in (info, folder / "liftopt"):
        path.mkdir()
    (folder / NAME).write_bytes(content)
    (info / "INSTALLER").write_text("pip\n")
    rows = [f"{NAME},sha256={recorded},", "../../../bin/liftopt,,", "liftopt-0.1.0.dist-info/INSTALLER,,"]
    (info / "RECORD").write_text("\n".join([*rows, "liftopt-0.1.0.dist-info/RECORD,,", ""]))
    return PathDistribution(info)


def test_what_was_installed_is_packed_and_what_pip_added_is_not(script: ModuleType, tmp_path: Path) -> None:
    content = (ROOT / NAME).read_bytes()
    assert dict(script._files(installed(tmp_path, content, script._digest(content)))) == {NAME: content}


def test_a_file_that_changed_since_is_refused(script: ModuleType, tmp_path: Path) -> None:
    content = (ROOT / NAME).read_bytes()
    with pytest.raises(SystemExit, match=f"{NAME} is not as it was installed"):
        list(script._files(installed(tmp_path, content + b"\n", script._digest(content))))


def test_a_file_that_is_not_this_folders_is_refused(script: ModuleType, tmp_path: Path) -> None:
    content = (ROOT / NAME).read_bytes() + b"\n"
    with pytest.raises(SystemExit, match=f"{NAME} is not the file of this folder"):
        list(script._files(installed(tmp_path, content, script._digest(content))))


@pytest.mark.parametrize(
    ("inside", "missing"), [("viz/assets/meshcat/main.min.js", "kernels"), ("kernels/a.so", "main.min.js")]
)
def test_a_wheel_without_kernels_or_viewer_is_refused(
    script: ModuleType, tmp_path: Path, inside: str, missing: str
) -> None:
    wheel = tmp_path / "liftopt-0.1.0-cp311-cp311-linux_x86_64.whl"
    with zipfile.ZipFile(wheel, "w") as file:
        file.writestr(f"liftopt/{inside}", b"")
    with pytest.raises(SystemExit, match=f"has no .*{missing}"):
        script._repaired(wheel, tmp_path)
