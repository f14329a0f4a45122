"""A run that is cut short: the oracle is the older result, which must stand whole or be replaced by a whole one."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from liftopt.storage.reader import load_result

PATIENCE = 300.0  # [s], only so that a hang fails
# Ctrl-C in the callback of a weak reference, as Python's import system has them: an exception cannot go on there.
IN_A_CALLBACK = """
import signal, weakref
signal.signal(signal.SIGINT, signal.default_int_handler)
from liftopt.files.interrupt import interrupts

class Thing: pass

thing = Thing()
reference = weakref.ref(thing, lambda _: signal.raise_signal(signal.SIGINT))
try:
    with interrupts() as found:
        del thing
        print("on")
        found.check()
        print("lost")
except KeyboardInterrupt:
    print("interrupted")
"""
# A shell may start the tests in the background, where Ctrl-C is ignored; the command has it as on a terminal.
SOLVE = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
print("begun", flush=True)
from liftopt.commands.cli import main
sys.exit(main(["solve", "--out", sys.argv[1], "--set", "solver.starts=2"]))
"""


def _child(code: str, *arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", code, *arguments]
    # Not in the source tree, which would be imported instead of what is installed.
    return subprocess.Popen(
        command, cwd=tempfile.gettempdir(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def _contents(folder: Path) -> dict[str, bytes]:
    return {f.relative_to(folder).as_posix(): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file()}


# From the first imports to the solve; a whole run takes some 4 s on an idle machine.
@pytest.mark.parametrize("after", [0.2, 0.4, 0.8, 1.2, 2.0])
def test_ctrl_c_leaves_no_result_and_no_trace(after: float, tmp_path: Path) -> None:
    out = tmp_path / "made" / "result"
    run = _child(SOLVE, str(out))
    assert run.stdout is not None and run.stdout.readline() == "begun\n"
    time.sleep(after)
    os.kill(run.pid, signal.SIGINT)
    _, err = run.communicate(timeout=PATIENCE)
    if run.returncode == 0 or out.exists():  # it was written already
        assert load_result(out).solved
        return
    assert not out.exists()
    if "liftopt: error:" in err:
        assert run.returncode == 130
        assert err == "liftopt: error: interrupted\n"
        assert list(tmp_path.iterdir()) == []
    else:  # the command itself was still being imported
        assert "KeyboardInterrupt" in err


def test_ctrl_c_where_python_drops_it_is_neither_printed_nor_lost() -> None:
    out, err = _child(IN_A_CALLBACK).communicate(timeout=PATIENCE)
    assert out.split() == ["on", "interrupted"]
    assert err == ""


def test_ctrl_c_inside_the_solver_is_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """CasADi takes an exception from a signal handler for a failed evaluation: the solve would go on."""
    from liftopt.collocation.solvers import ipopt
    from liftopt.scenario.model import load_scenario
    from liftopt.search.solve import solve

    usual, evaluations = ipopt._Stop.eval_buffer, []

    def eval_and_interrupt(self: Any, arguments: Any, results: Any) -> int:
        evaluations.append(None)
        if len(evaluations) == 7:
            signal.raise_signal(signal.SIGINT)
        return usual(self, arguments, results)

    monkeypatch.setattr(ipopt._Stop, "eval_buffer", eval_and_interrupt)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            solve(load_scenario("table5", ["solver.name=ipopt", "solver.starts=1", "solver.time_limit=3600"]))
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert len(evaluations) == 7


@pytest.mark.parametrize("after", [1.0, 2.5])
def test_killed_solve_leaves_the_older_result_whole(after: float, solved: Callable[..., Any], tmp_path: Path) -> None:
    older = solved("table5_near", "solver.starts=2").folder
    out = Path(shutil.copytree(older, tmp_path / "result"))
    run = _child(SOLVE, str(out))
    time.sleep(after)
    run.kill()
    run.communicate(timeout=PATIENCE)
    assert _contents(out) == _contents(older) or load_result(out).solved
