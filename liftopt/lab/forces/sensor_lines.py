"""What a line on a serial port says: a number for each channel, with the device's clock before them or not."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

NUMBER = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)")
CLOCK = re.compile(rb"\d{1,12}")  # millis() or micros() of a sketch

RISING = 3  # lines whose first number must rise before it is believed to be a clock


@dataclass(frozen=True)
class Reading:
    """One complete line.

    Attributes:
        time: of its arrival on the clock [s].
        values: for each channel, in the device's unit.
        stamp: what the device's own clock showed, in its own unit; None if it sends none.
    """

    time: float
    values: tuple[float, ...]
    stamp: int | None = None


@dataclass(frozen=True)
class Garbage:
    """A line that is no reading, as it arrived."""

    time: float
    text: str


@dataclass(frozen=True)
class Aside:
    """A line that is kept as it arrived, for all that it may be no reading.

    Attributes:
        time: on the clock [s].
        text: of the line.
        reason: completes "this line ...".
    """

    time: float
    text: str
    reason: str


CUT = "may have begun before the connection did"
HELD = "follows as a reading if its first number proves a clock"


@dataclass(frozen=True)
class Connection:
    """The port was lost, or was found again.

    Attributes:
        time: on the clock [s].
        up: the port is open.
        reason: of the loss.
    """

    time: float
    up: bool
    reason: str = ""


Event = Reading | Garbage | Aside | Connection


class SensorLines:
    """Lines of a number for each channel, separated by commas, semicolons or blanks; one behind the last is allowed.

    A whole number before them is taken for the device's clock as soon as it is larger than any reading, after rising
    over three lines or more: a channel too many does not do that. Lines before that are held until then.

    Args:
        channels: numbers in a line.
        largest: reading that can be meant, in the device's unit; what lies beyond lost a character on its way.
    """

    def __init__(self, channels: int, largest: float) -> None:
        self.channels, self.largest = channels, largest
        self._has_clock = False
        self._held: list[tuple[Reading, Aside]] = []

    def take(self, now: float, line: bytes) -> Iterator[Event]:
        """Yield what a line that arrived at ``now`` [s] says, and what held ones before it do."""
        found = parse_line(line, self.channels, self.largest)
        if found is None or (found[1] is None and self._has_clock):
            yield from self.end()
            yield Garbage(now, shown(line))
            return
        values, stamp = found
        if stamp is None or self._has_clock:
            yield from self.end()
            yield Reading(now, values, stamp)
            return
        last = self._held[-1][0].stamp if self._held else None
        if last is not None and stamp <= last:
            yield from self.end()
        held = Aside(now, shown(line), HELD)
        self._held.append((Reading(now, values, stamp), held))
        if len(self._held) < RISING or not is_beyond(stamp, self.largest):
            yield held
            return
        self._has_clock = True
        yield from (reading for reading, _ in self._held)
        self._held = []

    def end(self) -> Iterator[Event]:
        """Yield held lines as what they are when nothing tells more of them: no readings."""
        held, self._held = self._held, []
        yield from (Garbage(one.time, one.text) for _, one in held)


def parse_line(line: bytes, channels: int, largest: float) -> tuple[tuple[float, ...], int | None] | None:
    """Return the values and, where a whole number stands before them, that; None if the line is no sensible reading."""
    fields = re.split(rb"\s*[,;]\s*|\s+", line.strip())
    if len(fields) > 1 and not fields[-1]:
        fields.pop()
    stamp = None
    if len(fields) == channels + 1 and CLOCK.fullmatch(fields[0]):
        stamp = int(fields.pop(0))
    if len(fields) != channels or not all(NUMBER.fullmatch(field) for field in fields):
        return None
    values = tuple(float(field) for field in fields)
    # A converter's noise may dip below zero a little, and its reference may be a little below the supply.
    sensible = all(value >= -0.05 * largest and not is_beyond(value, largest) for value in values)
    return (values, stamp) if sensible else None


def is_beyond(value: float, largest: float) -> bool:
    """Return whether a number is larger than any reading."""
    return value > 1.05 * largest


def shown(line: bytes) -> str:
    """Return a line as text, shortened."""
    text = line.strip().decode("ascii", errors="backslashreplace")
    return repr(text if len(text) <= 120 else text[:117] + "...")
