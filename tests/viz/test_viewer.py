"""``liftopt view`` as a program: one page, one server that ends, and clear words for what is wrong."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.request
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.storage.reader import load_result
from liftopt.viz.scene_sawyer_meshes import DESCRIPTION
from liftopt.viz.viewer import view
from liftopt.viz.viewer_page import playback_page
from liftopt.viz.viewer_server import HOST, PageServer

CHEAP = ("solver.intervals=10", "solver.starts=1")
PATIENCE = 60.0  # [s]
# A shell may start the tests in the background, where Ctrl-C is ignored; the command has it as on a terminal.
RUN = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from liftopt.commands.cli import main
sys.exit(main(["view", *sys.argv[1:]]))
"""
# A library that swallows an interrupt while it is imported.
SWALLOW = """
import builtins, signal
usual = builtins.__import__
def swallowing(name, *arguments, **more):
    if name == "liftopt.storage.reader":
        try:
            signal.raise_signal(signal.SIGINT)
        except BaseException:
            pass
    return usual(name, *arguments, **more)
builtins.__import__ = swallowing
"""


@pytest.fixture(scope="module")
def folder(solved: Callable[..., Any]) -> Path:
    return solved("table5", *CHEAP).folder


@contextmanager
def _viewing(folder: Path, *options: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    command = [sys.executable, "-u", "-c", RUN, str(folder), "--no-browser", *options]
    # Away from this folder: what is installed has the viewer, a source tree has not.
    process = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        assert line.startswith("Playing at http://"), line + process.stderr.read()  # type: ignore[union-attr]
        yield process, line.split()[2]
    finally:
        process.kill()
        process.communicate()


@pytest.mark.parametrize(("stop", "status"), [(signal.SIGINT, 0), (signal.SIGTERM, -signal.SIGTERM)])
def test_it_serves_the_very_page_and_nothing_outlives_it(
    folder: Path, tmp_path: Path, stop: signal.Signals, status: int
) -> None:
    view(folder, html=tmp_path / "page.html", progress=lambda line: None)
    with _viewing(folder) as (process, url):
        assert urllib.request.urlopen(url).read() == (tmp_path / "page.html").read_bytes()
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(url + "solution.nc")
        process.send_signal(stop)
        out, err = process.communicate(timeout=PATIENCE)
        assert process.returncode == status
        assert (out, err) == ("", "")
        with pytest.raises(ProcessLookupError):
            os.killpg(process.pid, 0)
        with pytest.raises(OSError, match="refused"):
            urllib.request.urlopen(url)


def test_an_interrupt_while_it_loads_is_not_lost(folder: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-c", SWALLOW + RUN, str(folder), "--html", str(tmp_path / "page.html")]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=PATIENCE)
    assert (run.returncode, run.stdout, run.stderr) == (130, "", "liftopt: error: interrupted\n")
    assert not (tmp_path / "page.html").exists()


def test_a_port_that_is_taken_is_stepped_over() -> None:
    with socket.socket() as taken:
        taken.bind((HOST, 0))
        taken.listen()
        port = taken.getsockname()[1]
        with PageServer("<p>", port) as server:
            assert server.server_address[0] == HOST
            assert server.server_address[1] != port
            with PageServer("<p>", server.server_address[1]) as second:
                assert second.url != server.url


def test_a_missing_and_a_broken_result_are_named_in_one_line(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = Path(shutil.copytree(folder, tmp_path / "broken"))
    (broken / "solution.nc").write_bytes(b"not a NetCDF file")
    for result, reason in (
        (tmp_path / "nowhere", "there is no file solution.nc"),
        (broken, "cannot be read as NetCDF"),
    ):
        assert main(["view", str(result), "--html", str(tmp_path / "page.html")]) == 2
        complaint = capsys.readouterr().err
        assert complaint.count("\n") == 1
        assert str(result) in complaint
        assert reason in complaint
    assert not (tmp_path / "page.html").exists()


def test_what_cannot_be_done_is_refused_with_the_reason(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--with"):
        view(folder, ghost=True)
    with pytest.raises(InputError, match="65535"):
        view(folder, port=70000)
    with pytest.raises(InputError, match="cannot be written"):
        view(folder, html=tmp_path / "no" / "such" / "folder.html")
    with pytest.raises(InputError, match="is no sawyer_description"):
        view(folder, html=tmp_path / "page.html", sawyer=tmp_path)


def test_a_browser_with_windows_is_opened_and_one_in_the_terminal_is_not(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []

    class Windowed(webbrowser.BaseBrowser):
        def open(self, url: str, new: int = 0, autoraise: bool = True) -> bool:
            opened.append(url)
            return True

    def ended(self: PageServer, poll_interval: float) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(PageServer, "serve_forever", ended)
    for browser, lines in ((Windowed(), 1), (webbrowser.GenericBrowser("false"), 2)):
        said: list[str] = []
        monkeypatch.setattr(webbrowser, "get", lambda browser=browser: browser)
        view(folder, progress=said.append)
        assert len(said) == lines
    assert len(opened) == 1
    assert opened[0].startswith(f"http://{HOST}:")


def test_a_status_that_looks_like_markup_stays_text(folder: Path) -> None:
    page = playback_page(replace(load_result(folder), outcome="</script><b>@SCRIPT@"))
    assert page.count("</script><b>") == 0
    assert page.count("@SCRIPT@") == 1  # in the data, as text


def test_the_script_is_the_command(folder: Path, tmp_path: Path) -> None:
    script = Path(__file__).parents[2] / "scripts" / "play.py"
    file = tmp_path / "page.html"
    run = subprocess.run(
        [sys.executable, str(script), str(folder), "--html", str(file)], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert file.stat().st_size > 1_000_000


def test_the_manufacturers_meshes_take_the_robots_place(folder: Path, tmp_path: Path) -> None:
    """A description made here, of cubes: each must turn up on the joint that moves its link."""
    import trimesh

    names = ["pedestal", "right_arm_base_link", "head", *(f"right_l{i}" for i in range(7))]
    (tmp_path / "urdf").mkdir()
    (tmp_path / "meshes").mkdir()
    links = []
    for name in names:
        trimesh.creation.box((0.1, 0.1, 0.1)).export(tmp_path / "meshes" / f"{name}.STL")
        mesh = f'<mesh filename="package://sawyer_description/meshes/{name}.DAE"/>'
        links.append(f'<link name="{name}"><visual><origin xyz="0 0 0"/><geometry>{mesh}</geometry></visual></link>')
    (tmp_path / DESCRIPTION).write_text(f"<robot>{''.join(links)}</robot>", encoding="utf-8")
    view(folder, html=tmp_path / "page.html", sawyer=tmp_path, progress=lambda line: None)
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    for path in ("ground/pedestal", "robot_Q1/head", "robot_Q1/right_l0", "robot_Q7/right_l6"):
        assert f'"path":"/lift/body/{path}"' in page
    assert "l0_shoulder" not in page
    (tmp_path / "meshes" / "right_l3.STL").write_bytes(b"")
    with pytest.raises(InputError, match="right_l3"):
        view(folder, html=tmp_path / "page.html", sawyer=tmp_path, progress=lambda line: None)
