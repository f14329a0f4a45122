"""A result while it is written: killed, out of room, forbidden or crowded, the older or the newer one stands whole.

The oracle is the older result's bytes and those of the newer one written in peace.
"""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.scenario.model import load_scenario
from liftopt.storage.reader import load_result
from liftopt.storage.result_folder import NETCDF, locked
from liftopt.storage.writer import save

# Saves a result into copies of a folder, each time killed just before another one of the calls that change it.
DIE_EVERYWHERE = """
import os, shutil, signal, sys
from pathlib import Path
from liftopt.storage import writer
from liftopt.scenario.model import load_scenario
from liftopt.storage.reader import load_result
newer, older, work = load_result(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3])
content = writer.netcdf_bytes(newer)  # which takes the time and touches no file
writer.netcdf_bytes = lambda solution: content
os.fsync = lambda descriptor: None
CALLS = ("rename", "replace", "mkdir", "rmdir", "unlink", "fsync")

def die_at(at):
    count = [0]
    def counted(usual):
        def call(*arguments, **options):
            count[0] += 1
            if count[0] == at:
                os.kill(os.getpid(), signal.SIGKILL)
            return usual(*arguments, **options)
        return call
    for name in CALLS:
        setattr(os, name, counted(getattr(os, name)))

def saved(folder, at):
    child = os.fork()
    if not child:
        die_at(at)
        writer.save(newer, folder)
        os._exit(0)
    return os.waitpid(child, 0)[1]

at = 1
while True:
    folder = work / f"{at:03}"
    shutil.copytree(older, folder)
    if saved(folder, at) == 0:
        break
    at += 1
"""
WRITE_ON_AND_ON = """
import sys
from pathlib import Path
from liftopt.scenario.model import load_scenario
from liftopt.storage.reader import load_result
from liftopt.storage.writer import save
one, other = load_result(sys.argv[1]), load_result(sys.argv[2])
print("ready", flush=True)
while True:
    save(one, Path(sys.argv[3]))
    save(other, Path(sys.argv[3]))
"""


class Pair(NamedTuple):
    """Two results of different scenarios, as saved; the newer's files with what belongs to them."""

    older: Path
    newer: Path


@pytest.fixture(scope="module")
def pair(solved: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> Pair:
    """Return two results that stand in their folders beside a file of the user's."""
    folder = tmp_path_factory.mktemp("pair")
    for name, result in (("older", solved("table5_near", *CHEAP)), ("newer", solved("table5", *CHEAP))):
        shutil.copytree(result.folder, folder / name)
        (folder / name / "notes.txt").write_text("the user's")
        (folder / name / "models" / "own.urdf").write_text("the user's")
    return Pair(folder / "older", folder / "newer")


CHEAP = ("solver.intervals=10", "solver.starts=1")


def _everything(folder: Path) -> dict[str, bytes]:
    return {f.relative_to(folder).as_posix(): f.read_bytes() for f in folder.rglob("*") if f.is_file()}


def test_a_writer_killed_before_any_of_its_calls_leaves_the_older_or_the_newer_result(
    pair: Pair, tmp_path: Path
) -> None:
    command = [sys.executable, "-c", DIE_EVERYWHERE, str(pair.newer), str(pair.older), str(tmp_path)]
    subprocess.run(command, check=True, timeout=120)
    older, newer = ((folder / NETCDF).read_bytes() for folder in pair)
    folders = sorted(tmp_path.iterdir())
    standing = [(folder / NETCDF).read_bytes() for folder in folders]
    assert len(folders) > 15
    one_rename = standing.index(newer)
    assert standing == [older] * one_rename + [newer] * (len(folders) - one_rename)
    assert one_rename > 0
    # What stands beside it comes after the result, and is read by nobody.
    mixed = folders[one_rename]
    assert (mixed / "scenario.toml").read_bytes() == (pair.older / "scenario.toml").read_bytes()
    assert load_result(mixed).scenario.name == load_scenario("table5").name
    last = load_result(pair.newer)
    for folder in folders:
        save(last, folder)
        assert _everything(folder) == _everything(pair.newer)


def test_a_killed_first_writer_leaves_no_result_or_all_of_it(pair: Pair, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "out").mkdir()
    command = [sys.executable, "-c", DIE_EVERYWHERE, str(pair.newer), str(tmp_path / "empty"), str(tmp_path / "out")]
    subprocess.run(command, check=True, timeout=120)
    newer = (pair.newer / NETCDF).read_bytes()
    files = [folder / NETCDF for folder in sorted((tmp_path / "out").iterdir())]
    assert {file.read_bytes() if file.exists() else None for file in files} == {None, newer}


def test_a_reader_beside_a_writer_never_sees_a_mix(pair: Pair, tmp_path: Path) -> None:
    """Of the two results that are written in turn, one has 21 knots and the scenario table5."""
    out = Path(shutil.copytree(pair.older, tmp_path / "out"))
    command = [sys.executable, "-c", WRITE_ON_AND_ON, str(pair.older), str(pair.newer), str(out)]
    expected = {name: load_result(folder) for name, folder in (("table5_near", pair.older), ("table5", pair.newer))}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as writer:
        assert writer.stdout is not None
        assert writer.stdout.readline() == "ready\n"
        seen = [load_result(out) for _ in range(10)]
        writer.kill()
    for solution in [*seen, load_result(out)]:
        whole = expected[solution.scenario.name]
        assert solution.urdfs == whole.urdfs
        assert (solution.objective, solution.time.tolist()) == (whole.objective, whole.time.tolist())


def test_a_writer_does_not_wait_for_ever_and_a_reader_not_at_all(
    pair: Pair, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("liftopt.storage.result_folder.LOCK_PATIENCE", 0.1)
    out = Path(shutil.copytree(pair.older, tmp_path / "out"))
    with locked(out):
        assert load_result(out).scenario.name == "table5_near"
        with pytest.raises(InputError, match=r"another process has been writing the result there for 0\.1 s"):
            save(load_result(pair.newer), out)
    assert _everything(out) == _everything(pair.older)


@pytest.fixture
def small_disk(pair: Pair, tmp_path: Path) -> Iterator[Path]:
    """Return a result on a file system of its own that has hardly any room left."""
    disk = tmp_path / "disk"
    disk.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=260k", "tmpfs", str(disk)]
    if os.geteuid() != 0 or shutil.which("mount") is None or subprocess.run(command, check=False).returncode:
        pytest.skip("a small file system can be mounted by root only")
    try:
        shutil.copytree(pair.older, disk / "result")
        yield disk
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_a_full_disk_keeps_the_older_result(pair: Pair, small_disk: Path) -> None:
    with pytest.raises(InputError, match="No space left on device"):
        save(load_result(pair.newer), small_disk / "result")
    assert _everything(small_disk / "result") == _everything(pair.older)


def test_a_disk_that_turns_read_only_keeps_the_older_result(
    pair: Pair, small_disk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    assert load_result(small_disk / "result").scenario.name == "table5_near"
    with pytest.raises(InputError, match="Read-only file system"):
        save(load_result(pair.newer), small_disk / "result")
    assert main(["solve", "--out", str(small_disk / "result")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert _everything(small_disk / "result") == _everything(pair.older)


@pytest.mark.parametrize("room", [0, 900, 27_000, 100_000])
def test_files_that_may_not_grow_keep_the_older_result(room: int, pair: Pair, tmp_path: Path) -> None:
    """Needs no rights: the system refuses to write beyond a limit of this process."""
    out, newer = Path(shutil.copytree(pair.older, tmp_path / "out")), load_result(pair.newer)
    before, ignored = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, before[1]))
    try:
        with pytest.raises(InputError, match="File too large"):
            save(newer, out)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert _everything(out) == _everything(pair.older)


def test_links_lead_no_file_out_of_the_folder(pair: Pair, tmp_path: Path) -> None:
    out, elsewhere = Path(shutil.copytree(pair.older, tmp_path / "out")), tmp_path / "elsewhere"
    shutil.move(out / "models", elsewhere)
    before = _everything(elsewhere)
    (out / "models").symlink_to(elsewhere)
    with pytest.raises(InputError, match="is a link"):
        save(load_result(pair.newer), out)
    assert main(["solve", "--out", str(out)]) == 2
    (out / "models").unlink()
    (out / "scenario.toml").unlink()
    (out / "scenario.toml").symlink_to(elsewhere / "human_arm.urdf")
    save(load_result(pair.newer), out)
    assert _everything(elsewhere) == before
    written, newer = _everything(out), _everything(pair.newer)
    assert {name: written[name] for name in newer if "own" not in name} == {
        name: content for name, content in newer.items() if "own" not in name
    }
