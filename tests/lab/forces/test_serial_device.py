"""The reader of the serial port against a device on a pseudo-terminal that misbehaves as real ones do."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest

from liftopt.errors import InputError
from liftopt.lab.extra import load_extra
from liftopt.lab.forces.sensor_lines import Aside, Connection, Event, Garbage, Reading, SensorLines, parse_line
from liftopt.lab.forces.serial_device import SerialDevice


@pytest.fixture
def device(arduino: Any) -> SerialDevice:
    return SerialDevice(str(arduino.port), channels=3, largest=5.0)


@pytest.fixture
def events(device: SerialDevice) -> Iterator[Iterator[Event]]:
    stop = threading.Event()
    running = (event for event in device.events(stop) if not isinstance(event, Aside))
    yield running
    stop.set()
    assert not [event for event in running if isinstance(event, Reading)]


def test_lines_become_readings_in_order_and_with_their_time(arduino: Any, events: Iterator[Event]) -> None:
    arduino.send("the tail of a line\n1.0,2.0,3.0\r\n")
    before = time.monotonic()
    first = next(events)
    arduino.send("0.5;1;")
    arduino.send("2\n3\t4 5\n")
    assert isinstance(first, Reading)
    assert before <= first.time <= time.monotonic()
    assert [first.values, next(events).values, next(events).values] == [(1, 2, 3), (0.5, 1, 2), (3, 4, 5)]  # type: ignore[union-attr]


def test_the_first_line_may_have_begun_before_and_is_left_out(arduino: Any, events: Iterator[Event]) -> None:
    """A head cut off 12.5,0,0 would leave 2.5,0,0: three sensible numbers."""
    arduino.send("2.5,0,0\n1,1,1\n")
    assert next(events).values == (1, 1, 1)  # type: ignore[union-attr]


def test_garbage_is_told_apart_and_shown(arduino: Any, events: Iterator[Event]) -> None:
    arduino.send(b"\nFSR ready\n1,2\n1,2,3,4\n1,2,nan\n1,2,9\n1,,2\n\xff\xfe\x00\n\n1,2,3\n")
    seen = [next(events) for _ in range(8)]
    assert all(isinstance(event, Garbage) for event in seen[:7])
    assert seen[0].text == "'FSR ready'"  # type: ignore[union-attr]
    assert seen[6].text == repr(r"\xff\xfe\x00").replace(r"\\x00", r"\x00")  # type: ignore[union-attr]
    assert isinstance(seen[7], Reading)


def test_a_stream_without_newlines_is_given_up(arduino: Any, events: Iterator[Event]) -> None:
    """As at another baud rate: the memory must not grow, and readings come back once the lines do."""
    arduino.send(b"\n" + b"x" * 2000)
    seen = next(events)
    assert isinstance(seen, Garbage)
    assert len(seen.text) < 200
    arduino.send(b"x\n1,2,3\n")
    assert next(event for event in events if isinstance(event, Reading)).values == (1, 2, 3)


def test_a_device_that_vanishes_and_comes_back_is_read_on(arduino: Any, events: Iterator[Event]) -> None:
    arduino.send("\n1,1,1\n2,2,")
    assert isinstance(next(events), Reading)
    time.sleep(0.3)  # let the half line be read before the device goes
    unplugging = threading.Timer(0.1, arduino.unplug)
    unplugging.start()
    half, lost = next(events), next(events)
    assert isinstance(half, Garbage)
    assert half.text == "'2,2,'"
    assert isinstance(lost, Connection)
    assert not lost.up
    assert lost.reason
    unplugging.join()  # the loss is noticed before the thread is done with the old device
    arduino.plug_in()
    back = next(events)
    assert isinstance(back, Connection)
    assert back.up
    arduino.send("boot\n3,3,3\n")
    assert next(events).values == (3, 3, 3)  # type: ignore[union-attr]


def test_a_port_that_is_not_there_or_is_taken_is_named(arduino: Any, device: SerialDevice, tmp_path: Any) -> None:
    with pytest.raises(InputError, match="no such port"):
        SerialDevice(str(tmp_path / "ttyACM9"), 3, 5.0)
    with pytest.raises(InputError, match=r"^--port = .* is in use by another program"):
        SerialDevice(str(arduino.port), 3, 5.0)
    device.close()
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot be opened"):
        SerialDevice(str(tmp_path / "file"), 3, 5.0)


@pytest.mark.parametrize(
    ("line", "found"),
    [
        (b" 1 2\t3\r", ((1.0, 2.0, 3.0), None)),
        (b".5,-0.01,5.2", ((0.5, -0.01, 5.2), None)),
        (b"1,2,3,", ((1.0, 2.0, 3.0), None)),
        (b"1; 2; 3;\r", ((1.0, 2.0, 3.0), None)),
        (b"1250,1,2,3", ((1.0, 2.0, 3.0), 1250)),
        (b"1250 1 2 3 ", ((1.0, 2.0, 3.0), 1250)),
        (b"1250,1,2,3,", ((1.0, 2.0, 3.0), 1250)),
        (b"12.5,1,2,3", None),  # a clock shows whole numbers
        (b"1,2,", None),
        (b"1,,2,3", None),
        (b"1,2,3,,", None),
        (b"1e0,2,3", None),
        (b"1,2,inf", None),
        (b"1_0,2,3", None),
        (b"1,2,5.3", None),
        (b"1,2,-0.3", None),
        (b"", None),
        (b",", None),
        (b"\xd9\xa1,2,3", None),  # a digit, but none of a converter's
    ],
)
def test_a_line_is_a_sensible_number_for_each_channel(line: bytes, found: Any) -> None:
    assert parse_line(line, 3, 5.0) == found


def _read(lines: list[str], largest: float) -> list[Event]:
    sensors = SensorLines(2, largest)
    events = [event for k, line in enumerate(lines) for event in sensors.take(0.05 * k, line.encode())]
    return [event for event in [*events, *sensors.end()] if not isinstance(event, Aside)]


def test_a_clock_is_believed_once_no_channel_could_show_it_and_nothing_before_is_lost() -> None:
    """Counts up to 1023: millis of the first second could be a channel's."""
    events = _read([f"{50 * k},{k},7" for k in range(40)], 1023.0)
    assert events == [Reading(0.05 * k, (float(k), 7.0), 50 * k) for k in range(40)]


def test_a_channel_too_many_is_not_taken_for_a_clock() -> None:
    """A third sensor that rises and falls: leaving it out would shift nothing, but it was never named."""
    events = _read([f"{500 + 20 * (k % 20)},{k},7" for k in range(40)], 1023.0)
    assert len(events) == 40
    assert all(isinstance(event, Garbage) for event in events)


def test_a_line_that_lost_its_clock_is_no_reading() -> None:
    """Else what is left of the line could be shifted by a channel."""
    events = _read(["5000,1,2", "5050,1,2", "5100,1,2", "1,2", "5200,3,4", "12,4,5"], 5.0)
    assert [type(event) for event in events] == [Reading, Reading, Reading, Garbage, Reading, Reading]


def test_a_missing_package_is_named_with_what_installs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(InputError, match=r'not installed; it is needed to read a serial.*pip install "liftopt\[lab\]"'):
        SerialDevice("any", 3, 5.0)
    with pytest.raises(InputError, match="no_such_package: the package is not installed"):
        load_extra("no_such_package", "do this")
