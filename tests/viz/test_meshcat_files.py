"""Where the viewer's file comes from: liftopt's own folder, an installed meshcat, or one line that says what to do."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from liftopt.errors import LiftoptError
from liftopt.viz import meshcat_files
from liftopt.viz.meshcat_files import LICENCES, MESHCAT, VIEWER, main, meshcat_text


@pytest.fixture
def source_tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of liftopt.viz as a source tree has it: without the viewer."""
    folder = tmp_path / "viz"
    folder.mkdir()
    monkeypatch.setattr(meshcat_files, "files", lambda package: folder)
    return folder


@pytest.fixture
def meshcat(source_tree: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a meshcat that is installed and must not be imported: its server takes a second and opens sockets."""
    package = source_tree.parent / "site-packages" / "meshcat"
    (package / "viewer" / "dist").mkdir(parents=True)
    (package / "__init__.py").write_text("raise AssertionError('imported')\n")
    (package / "viewer" / "LICENSE").write_text("MIT")
    for name in (VIEWER, *LICENCES[1:]):
        (package / "viewer" / "dist" / name).write_bytes(f"installed {name}\r\n".encode())
    monkeypatch.delitem(sys.modules, "meshcat", raising=False)
    monkeypatch.syspath_prepend(str(package.parent))
    return package


@pytest.fixture
def no_meshcat(source_tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "meshcat", None)


def test_a_source_tree_takes_it_from_the_installed_meshcat(meshcat: Path) -> None:
    assert meshcat_text(VIEWER) == f"installed {VIEWER}\n"
    assert meshcat_text("LICENSE") == "MIT"


def test_what_came_with_liftopt_goes_first(source_tree: Path, meshcat: Path) -> None:
    shipped = source_tree / "assets" / "meshcat"
    shipped.mkdir(parents=True)
    (shipped / VIEWER).write_text("shipped")
    assert meshcat_text(VIEWER) == "shipped"


@pytest.mark.usefixtures("no_meshcat")
def test_without_either_one_line_says_how_to_get_it() -> None:
    with pytest.raises(LiftoptError) as told:
        meshcat_text(VIEWER)
    assert VIEWER in str(told.value)
    assert f"pip install {MESHCAT}" in str(told.value)
    assert "\n" not in str(told.value)


def test_the_build_copies_viewer_and_licences_byte_by_byte(meshcat: Path, tmp_path: Path) -> None:
    out = tmp_path / "build" / "meshcat"
    assert main([str(out)]) == 0
    assert {file.name for file in out.iterdir()} == {VIEWER, *LICENCES}
    assert (out / VIEWER).read_bytes() == (meshcat / "viewer" / "dist" / VIEWER).read_bytes()


@pytest.mark.parametrize("missing", [f"dist/{VIEWER}", "LICENSE"])
def test_the_build_ends_where_a_file_is_missing(
    meshcat: Path, tmp_path: Path, missing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (meshcat / "viewer" / missing).unlink()
    out = tmp_path / "build" / "meshcat"
    assert main([str(out)]) == 1
    assert not out.exists()
    assert MESHCAT in capsys.readouterr().err
