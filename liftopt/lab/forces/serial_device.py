"""A port on which an Arduino prints lines of numbers, through garbage, disconnections and reconnections."""

from __future__ import annotations

import errno
import termios
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from types import ModuleType
from typing import Any

from liftopt.errors import InputError
from liftopt.lab.extra import load_extra
from liftopt.lab.forces.sensor_lines import CUT, Aside, Connection, Event, Garbage, SensorLines, shown

LONGEST_LINE = 1000  # bytes without a newline: another baud rate, or another device
WAIT = 0.1  # s between looks at the stop signal
RETRY = 0.5  # s between attempts to connect again


class SerialDevice:
    """A device that sends one line per sample, as ``SensorLines`` reads it.

    Args:
        port: of the device, such as /dev/ttyACM0; better its name under /dev/serial/by-id, which stays.
        channels: numbers in a line.
        largest: reading that can be meant, in the device's unit.
        baud: bits per second.
        clock: gives the time of arrival [s].

    Raises:
        InputError: pyserial is not installed, or the port cannot be opened now.
    """

    def __init__(
        self, port: str, channels: int, largest: float, baud: int = 9600, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.port, self.channels, self.largest, self.baud, self.clock = port, channels, largest, baud, clock
        self._module: ModuleType = load_extra("serial", "read a serial port")
        try:
            self._serial: Any = self._open()
        except (OSError, termios.error, ValueError) as error:  # ValueError: a baud rate that no port has
            raise InputError("--port", port, self._why(error)) from None

    def events(self, stop: threading.Event) -> Iterator[Event]:
        """Yield what happens until ``stop`` is set, then close the port.

        The first line after a connection is no reading: it may have begun before.
        """
        try:
            while not stop.is_set():
                if self._serial is None:
                    self._reconnect(stop)
                    if self._serial is None:
                        return
                    yield Connection(self.clock(), True)
                yield from self._read(stop)
        finally:
            self.close()

    def close(self) -> None:
        """Give the port back."""
        serial, self._serial = self._serial, None
        if serial is not None:
            with suppress(OSError, termios.error):  # it is gone: there is nothing left to close
                serial.close()

    def _read(self, stop: threading.Event) -> Iterator[Event]:
        buffer, first, sensors = b"", True, SensorLines(self.channels, self.largest)
        while not stop.is_set():
            try:
                buffer += self._serial.read(max(1, self._serial.in_waiting))
            except (OSError, termios.error) as error:
                self.close()
                yield from sensors.end()
                if buffer:
                    yield Garbage(self.clock(), shown(buffer))
                yield Connection(self.clock(), False, " ".join(str(error).split()))
                return
            *lines, buffer = buffer.split(b"\n")
            now = self.clock()
            for line in lines:
                cut, first = first, False
                if not line.strip():
                    continue
                if cut:
                    yield Aside(now, shown(line), CUT)
                else:
                    yield from sensors.take(now, line)
            if len(buffer) > LONGEST_LINE:
                yield Garbage(now, shown(buffer))
                buffer, first = b"", True
        yield from sensors.end()

    def _open(self) -> Any:
        return self._module.Serial(self.port, self.baud, timeout=WAIT, exclusive=True)

    def _reconnect(self, stop: threading.Event) -> None:
        while not stop.wait(RETRY):
            try:
                self._serial = self._open()
                return
            except (OSError, termios.error):
                continue

    def _why(self, error: Exception) -> str:
        number = getattr(error, "errno", None)
        if number == errno.EACCES:
            return "may not be opened by this user; add the user to the group that owns it (dialout, on Debian)"
        if number in (errno.ENOENT, errno.ENXIO, errno.ENODEV):
            found = load_extra("serial.tools.list_ports", "list serial ports").comports()
            ports = ", ".join(sorted(port.device for port in found))
            return (
                f"no such port; there is {ports}" if ports else "no such port, and no other: is the device plugged in?"
            )
        if number in (errno.EAGAIN, errno.EWOULDBLOCK):
            return "is in use by another program"
        return f"cannot be opened: {' '.join(str(error).split())}"
