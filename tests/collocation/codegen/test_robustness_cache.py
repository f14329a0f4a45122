"""Compiled libraries are loaded only if they are ours and whole, and a Ctrl-C acts whoever swallows it."""

from __future__ import annotations

import ctypes
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from liftopt.collocation.codegen import kernel_cache
from liftopt.collocation.codegen.kernel_cache import cache_folder, find_library, keep
from liftopt.commands.cli import main
from liftopt.files.checksum import DIGEST_BYTES, has_checksum, with_checksum
from liftopt.files.interrupt import interrupts

KEY = "0123456789abcdef" * 2
# Two of these begin at once on a cold cache; each looks, builds what is not there, and calls it.
BUILD_AND_CALL = """
import ctypes, subprocess, sys, tempfile
from pathlib import Path
from liftopt.collocation.codegen.kernel_cache import cache_folder, find_library, keep
def call(path):
    return ctypes.CDLL(str(path)).answer()
print("ready", flush=True)
sys.stdin.readline()
for i in range(12):
    answer = find_library(f"{i:032x}", call)
    if answer is None:
        with tempfile.TemporaryDirectory() as work:
            built = Path(work) / f"{i:032x}.so"
            source = f"int answer(void) {{ return {i}; }}"
            command = [sys.argv[1], "-shared", "-fPIC", "-x", "c", "-", "-o", str(built)]
            subprocess.run(command, input=source, text=True, check=True)
            answer = keep(built, cache_folder(), call)
    assert answer == i, answer
"""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the user's cache folder with one library, and a package without any."""
    monkeypatch.setattr(kernel_cache, "PACKAGE", tmp_path / "package")
    monkeypatch.setenv("LIFTOPT_CACHE", str(tmp_path / "open" / "cache"))
    folder = cache_folder()
    assert folder is not None
    put(folder, "ours")
    return folder


def put(folder: Path, text: str) -> Path:
    """Put a file with its checksum into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{KEY}.so"
    path.write_bytes(with_checksum(text.encode()))
    return path


def content(path: Path) -> str:
    """Open a library: what it holds but for its checksum."""
    return path.read_bytes()[:-DIGEST_BYTES].decode()


def test_a_folder_put_in_the_place_of_the_cache_is_not_looked_into(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the way to the cache leads through somebody else's folder, that one can rename it at any moment."""
    usual = kernel_cache._has_checksum

    def rename_after_the_look(path: Path) -> bool:
        whole = usual(path)
        (tmp_path / "open").rename(tmp_path / "away")
        put(tmp_path / "open" / "cache", "not ours")
        return whole

    assert find_library(KEY, content) == "ours"
    monkeypatch.setattr(kernel_cache, "_has_checksum", rename_after_the_look)
    assert find_library(KEY, content) == "ours"
    assert content(cache / f"{KEY}.so") == "not ours"


def test_a_link_in_the_cache_is_not_followed(cache: Path, tmp_path: Path) -> None:
    elsewhere = put(tmp_path / "elsewhere", "not ours")
    (cache / f"{KEY}.so").unlink()
    (cache / f"{KEY}.so").symlink_to(elsewhere)
    assert find_library(KEY, content) is None


@pytest.mark.parametrize("kind", ["a pipe", "a folder", "nothing", "short", "cut", "longer"])
def test_what_is_no_whole_file_in_the_cache_is_passed_over(kind: str, cache: Path) -> None:
    path = cache / f"{KEY}.so"
    raw = path.read_bytes()
    path.unlink()
    if kind == "a pipe":
        os.mkfifo(path)
    elif kind == "a folder":
        path.mkdir()
    else:
        path.write_bytes({"nothing": b"", "short": b"x" * 31, "cut": raw[1:], "longer": raw + b"\0"}[kind])
    assert find_library(KEY, content) is None


def test_an_empty_file_has_no_checksum() -> None:
    assert not has_checksum(b"")
    assert has_checksum(with_checksum(b""))


def test_a_shared_library_is_loaded_with_its_checksum_and_outlives_its_file(cache: Path, tmp_path: Path) -> None:
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("there is no C compiler")
    built = tmp_path / f"{'a' * 32}.so"
    command = [compiler, "-shared", "-fPIC", "-x", "c", "-", "-o", str(built)]
    subprocess.run(command, input="int answer(void) { return 42; }", text=True, check=True)
    library = keep(built, cache_folder(), lambda path: ctypes.CDLL(str(path)))
    assert library is not None
    shutil.rmtree(cache)
    assert library.answer() == 42


def test_two_processes_on_one_cold_cache_both_get_what_they_need(tmp_path: Path) -> None:
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("there is no C compiler")
    environment = os.environ | {"LIFTOPT_CACHE": str(tmp_path / "cache")}
    command = [sys.executable, "-c", BUILD_AND_CALL, compiler]
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    runs = [subprocess.Popen(command, env=environment, text=True, **pipes) for _ in range(2)]
    for run in runs:
        assert run.stdout is not None
        assert run.stdout.readline() == "ready\n"
    for run in runs:
        assert run.stdin is not None
        run.stdin.write("\n")
        run.stdin.flush()
    for run in runs:
        _, errors = run.communicate(timeout=120)
        assert run.returncode == 0, errors
    assert sorted(path.name for path in (tmp_path / "cache").iterdir()) == [f"{i:032x}.so" for i in range(12)]


@pytest.fixture
def ctrl_c_counts() -> Any:
    """Let Ctrl-C raise as on a terminal, though the tests may run in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("comes_out_as", [None, RuntimeError])
def test_a_swallowed_ctrl_c_ends_the_solve_at_its_next_step(
    comes_out_as: type[Exception] | None,
    ctrl_c_counts: None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """CasADi's bindings drop an exception while they try conversions, or make another one of it."""
    from liftopt.search.session import Session

    class Swallowing(Session):
        def solvers(self, problem: Any) -> Any:
            try:
                signal.raise_signal(signal.SIGINT)
            except KeyboardInterrupt:
                if comes_out_as is not None:
                    raise comes_out_as("failed to evaluate") from None
            return super().solvers(problem)

    monkeypatch.setattr("liftopt.search.solve.Session", Swallowing)
    assert main(["solve", "--out", str(tmp_path / "out"), "--set", "solver.starts=1"]) == 130
    assert capsys.readouterr().err == "liftopt: error: interrupted\n"
    assert list(tmp_path.iterdir()) == []
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_the_second_ctrl_c_ends_the_process_at_once() -> None:
    code = """
import signal
from liftopt.files.interrupt import interrupts
signal.signal(signal.SIGINT, signal.default_int_handler)
with interrupts():
    for _ in range(3):
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            print("swallowed", flush=True)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (130, "swallowed\n", "liftopt: error: interrupted\n")


def test_other_handlers_and_errors_without_a_ctrl_c_are_left_alone(ctrl_c_counts: None) -> None:
    with pytest.raises(ValueError, match="mine"), interrupts() as found:
        raise ValueError("mine")
    assert not found.noted
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with interrupts():
        signal.raise_signal(signal.SIGINT)
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
