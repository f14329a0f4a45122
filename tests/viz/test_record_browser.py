"""The page of ``liftopt record`` in a real browser, its device at the other end of a pseudo-terminal."""

from __future__ import annotations

import os
import threading
import tty
from collections.abc import Callable, Iterator
from datetime import datetime
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from liftopt.lab.forces.calibration import Calibration, Curve
from liftopt.lab.forces.force_file import read_forces
from liftopt.lab.forces.record_log import RecordLog
from liftopt.lab.forces.record_server import RecordServer
from liftopt.lab.forces.record_session import PRELOAD_READINGS, RecordSession
from liftopt.lab.forces.serial_device import SerialDevice
from liftopt.lab.forces.voltage_divider import Divider
from liftopt.types import Progress

SIX = ("finger1", "finger2", "finger3", "finger4", "thumb1", "thumb2")
CALIBRATION = Calibration(divider=Divider(), curves={"all": Curve(voltage=(0.0, 1.0, 4.0), force=(0.0, 2.0, 8.0))})


class Laboratory(NamedTuple):
    """The page in the browser and what stands behind it."""

    opened: Any
    print_line: Progress
    unplug: Callable[[], None]
    leave: Callable[[], None]
    file: Path

    def read(self, line: str) -> None:
        """Print a line and wait until the page shows it."""
        before = self.opened.run("liftopt.samples.length")
        self.print_line(line)
        self.opened.page.wait_for_function(f"liftopt.samples.length > {before}")

    def press(self, button: str, state: str) -> None:
        """Press a button and wait until the page says that state."""
        self.opened.page.click(f"#{button}")
        self.opened.page.wait_for_function(f"document.getElementById('state').textContent === '{state}'")

    def text(self, element: str) -> str:
        """Return what an element of the page shows."""
        return str(self.opened.page.inner_text(element))


@pytest.fixture
def laboratory(open_page: Callable[..., Any], tmp_path: Path) -> Iterator[Laboratory]:
    pytest.importorskip("serial", reason="pyserial is not installed (extra 'test')")
    device_end, host_end = os.openpty()
    tty.setraw(host_end)
    open_ends = [device_end, host_end]
    port, file, stop = tmp_path / "ttyACM0", tmp_path / "r.csv", threading.Event()
    port.symlink_to(os.ttyname(host_end))
    log = RecordLog(file, SIX, "V", "simulated", datetime.now().astimezone())
    session = RecordSession(SerialDevice(str(port), 6, 5.0), log, SIX, "V", CALIBRATION)
    server = RecordServer(session)
    threads = [threading.Thread(target=session.run, args=(stop,)), threading.Thread(target=server.serve_forever)]
    for thread in threads:
        thread.start()

    def unplug() -> None:
        port.unlink()
        while open_ends:
            os.close(open_ends.pop())

    def leave() -> None:
        if not stop.is_set():
            stop.set()
            server.shutdown()
            server.server_close()
            for thread in threads:
                thread.join()
            log.close()

    try:
        opened = open_page(server.url)
        os.write(device_end, b"\n")
        yield Laboratory(opened, lambda line: os.write(device_end, f"{line}\n".encode()) and None, unplug, leave, file)
        opened.page.close()
    finally:
        leave()
        if open_ends:
            unplug()


def _coloured(laboratory: Laboratory, canvas: str) -> int:
    """Return how many pixels of a plot are neither grey nor empty."""
    return int(
        laboratory.opened.run(
            f"(() => {{ const c = document.getElementById('{canvas}');"
            " const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0;"
            " for (let i = 0; i < d.length; i += 4)"
            " if (d[i + 3] > 128 && Math.max(d[i], d[i + 1], d[i + 2]) - Math.min(d[i], d[i + 1], d[i + 2]) > 60) n++;"
            " return n; })()"
        )
    )


def test_channels_and_the_hands_force_are_shown_live(laboratory: Laboratory) -> None:
    laboratory.read("1,1,1,1,0.5,0.25")
    assert laboratory.text("#hand") == "6.50 N"
    empty = _coloured(laboratory, "plot-channels")
    laboratory.read("1,1,1,1,0.5,5")
    assert _coloured(laboratory, "plot-channels") > empty
    rows = laboratory.text("#table").splitlines()
    assert rows[0].split() == ["finger1", "1.000", "V", "2.00", "N"]
    assert rows[5].split() == ["thumb2", "5.000", "V", "8.00", "N", "saturated/beyond"]
    assert laboratory.opened.run("document.getElementById('hand').className") == "flag"
    assert laboratory.text("#state") == "no trial marked"
    address = laboratory.opened.page.url
    assert all(url.startswith((address, "data:")) for url in laboratory.opened.requests)
    assert laboratory.opened.complaints == []


def test_the_buttons_take_the_preload_and_record_a_trial(laboratory: Laboratory) -> None:
    page = laboratory.opened.page
    laboratory.read("4,4,4,4,4,4")  # nobody asked for it
    laboratory.press("preload", "recording preload 1")
    assert page.is_disabled("#start")
    for _ in range(PRELOAD_READINGS):
        laboratory.print_line("0.1,0.1,0.1,0.1,0.2,0.2")
    page.wait_for_function("liftopt.state.mark === '' && liftopt.state.marked > 0")
    laboratory.press("start", "recording trial 1")
    assert page.is_disabled("#start")
    assert page.is_disabled("#preload")
    laboratory.read("1.1,1.1,1.1,1.1,0.7,0.7")
    assert laboratory.text("#hand") == "6.00 N"
    laboratory.press("stop", "no trial marked")
    assert page.is_disabled("#stop")
    assert "12 readings written (11 marked), trials: 1, preload 1 subtracted" in laboratory.text("#facts")
    (trial,) = read_forces(laboratory.file, CALIBRATION)
    assert trial.hand_force.tolist() == pytest.approx([6.0])
    assert laboratory.opened.complaints == []


def test_it_says_when_the_device_is_gone_and_when_the_recording_has_ended(laboratory: Laboratory) -> None:
    page = laboratory.opened.page
    laboratory.unplug()
    page.wait_for_function("document.getElementById('trouble').textContent.includes('connection')")
    laboratory.leave()
    page.wait_for_function("document.getElementById('trouble').textContent.includes('has ended')")
    assert all(page.is_disabled(button) for button in ("#preload", "#start", "#stop"))
