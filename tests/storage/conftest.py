"""What the tests of result files share: a result to break, and how to change a solution.nc from inside."""

from __future__ import annotations

import shutil
import signal
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import pytest

from liftopt.commands.cli import main
from liftopt.files.checksum import DIGEST_BYTES, with_checksum

PATIENCE = 60  # seconds for one command, only so that a hang fails
Change = Callable[[h5py.File], object]


@pytest.fixture(scope="module")
def kept(solved: Callable[..., Any]) -> Any:
    """A solved lift and its folder; neither is to be changed."""
    return solved("table5", "solver.intervals=10", "solver.starts=1")


@pytest.fixture
def folder(kept: Any, tmp_path: Path) -> Path:
    """A copy of the result that may be broken."""
    return Path(shutil.copytree(kept.folder, tmp_path / "result"))


@pytest.fixture(scope="session")
def rewritten() -> Callable[..., None]:
    """Return a function that changes a folder's solution.nc and its checksum, as somebody who knows how would."""

    def rewrite(folder: Path, change: Change, checksum: bool = True) -> None:
        path = folder / "solution.nc"
        path.write_bytes(path.read_bytes()[:-DIGEST_BYTES])
        with h5py.File(path, "r+") as file:
            change(file)
        if checksum:
            path.write_bytes(with_checksum(path.read_bytes()))

    return rewrite


@pytest.fixture(scope="session")
def retext(rewritten: Callable[..., None]) -> Callable[..., None]:
    """Return a function that changes one text of a solution.nc: its scenario, or a model."""

    def change(folder: Path, attribute: str, new: Callable[[str], str]) -> None:
        rewritten(folder, partial(_set_text, attribute=attribute, new=new))

    return change


def _set_text(file: h5py.File, attribute: str, new: Callable[[str], str]) -> None:
    file.attrs[attribute] = new(str(file.attrs[attribute]))


@pytest.fixture(scope="session")
def as_of_old(rewritten: Callable[..., None]) -> Callable[[Path], None]:
    """Return a function that makes a result one of earlier versions: scenario and models stand beside it alone."""

    def strip(file: h5py.File) -> None:
        for name in [name for name in file.attrs if name == "scenario" or name.startswith("urdf_")]:
            del file.attrs[name]

    return lambda folder: rewritten(folder, strip)


@pytest.fixture
def refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Iterator[Callable[[list[str]], str]]:
    """Return a function that runs a command and returns its one line on stderr, empty if it went on to work."""

    def begin(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("liftopt.search.solve.solve", begin)
    monkeypatch.setattr("liftopt.viz.viewer_page.playback_page", begin)
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")

    def too_late(*_: object) -> None:
        raise TimeoutError(f"no answer within {PATIENCE} s")

    def run(command: list[str]) -> str:
        capsys.readouterr()
        before = {*tmp_path.rglob("*")}
        signal.alarm(PATIENCE)
        status = main(command)
        signal.alarm(0)
        out, err = capsys.readouterr()
        assert {*tmp_path.rglob("*")} == before
        assert out == ""
        assert err.startswith("liftopt: error: ")
        assert err.endswith("\n")
        assert len(err.splitlines()) == 1, err
        assert status == (130 if err == "liftopt: error: interrupted\n" else 2)
        return "" if status == 130 else err

    handler = signal.signal(signal.SIGALRM, too_late)
    yield run
    signal.alarm(0)
    signal.signal(signal.SIGALRM, handler)
