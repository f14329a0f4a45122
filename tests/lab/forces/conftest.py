"""An Arduino on a pseudo-terminal: it prints what it is told, and can be unplugged and plugged in again."""

from __future__ import annotations

import os
import tty
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest


class SimulatedArduino:
    """The device end of a serial port.

    Args:
        folder: for the port's name, which stays the same when the device comes back.
    """

    def __init__(self, folder: Path) -> None:
        self.port = folder / "ttyACM0"
        self._ends: list[int] = []

    def plug_in(self) -> None:
        """Appear under the port's name."""
        device, host = os.openpty()
        tty.setraw(host)
        self._ends = [device, host]
        self.port.symlink_to(os.ttyname(host))

    def unplug(self) -> None:
        """Vanish, with all that was not read."""
        with suppress(FileNotFoundError):
            self.port.unlink()
        for end in self._ends:
            os.close(end)
        self._ends = []

    def send(self, text: str | bytes) -> None:
        """Print; nothing is added."""
        os.write(self._ends[0], text.encode() if isinstance(text, str) else text)


@pytest.fixture
def arduino(tmp_path: Path) -> Iterator[SimulatedArduino]:
    """Return a simulated device that is plugged in."""
    pytest.importorskip("serial", reason="pyserial is not installed (extra 'test')")
    device = SimulatedArduino(tmp_path)
    device.plug_in()
    yield device
    device.unplug()
