"""A recording in progress: what the device sends, what the buttons ask for, and what the page shows."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np

from liftopt.lab.forces.calibration import Calibration
from liftopt.lab.forces.force_file import KEYS, PRELOAD, TRIAL
from liftopt.lab.forces.force_record import hand_force, sensor_forces
from liftopt.lab.forces.record_log import RecordLog
from liftopt.lab.forces.sensor_lines import Aside, Connection, Garbage, Reading
from liftopt.lab.forces.serial_device import SerialDevice
from liftopt.types import Array

PRELOAD_READINGS = 10  # about 3 s at the rate of the paper's Arduino
SHOWN = 2000  # readings kept for the page, 10 minutes at that rate


class RecordSession:
    """Takes readings from a device, writes every one, marked or not, and keeps the latest for the page.

    Args:
        device: the source of readings.
        log: where they go.
        channels: (C,) names of the sensors, in the device's order.
        unit: of the device's values.
        calibration: of the sensors; without one, voltages alone are shown. What is written is the same.
    """

    def __init__(
        self,
        device: SerialDevice,
        log: RecordLog,
        channels: Sequence[str],
        unit: str,
        calibration: Calibration | None,
    ) -> None:
        self.device, self.log, self.channels, self.unit = device, log, tuple(channels), unit
        self.calibration = calibration
        self.garbage = self.losses = self.trials = self.preloads = self.marked = 0
        self._has_clock = False
        self._start = device.clock()
        self._lock = threading.Lock()
        self._mark, self._connected = "", True
        self._preload_rows: list[Array] = []
        self._preload = np.zeros(len(self.channels))
        self._samples: deque[dict[str, Any]] = deque(maxlen=SHOWN)
        self._count = self._left = 0

    def run(self, stop: threading.Event) -> None:
        """Take in what the device sends until ``stop`` is set."""
        for event in self.device.events(stop):
            with self._lock:
                at = event.time - self._start
                if isinstance(event, Reading):
                    if event.stamp is not None and not self._has_clock:
                        self._has_clock = True
                        self.log.remark(at, f"lines start with the device's clock, left out below; here: {event.stamp}")
                    self._take(at, event.values)
                elif isinstance(event, Aside):
                    self.log.remark(at, f"this line {event.reason}: {event.text}")
                elif isinstance(event, Garbage):
                    self.garbage += 1
                    self.log.remark(at, f"not understood: {event.text}")
                else:
                    self._connection(at, event)

    def start(self) -> str:
        """Begin a trial; return why not, or nothing."""
        with self._lock:
            if self._mark:
                return f"{self._mark} is being recorded: stop it first"
            self.trials += 1
            self._begin(f"{TRIAL} {self.trials}")
            return ""

    def stop(self) -> str:
        """End the trial or the preload; return why not, or nothing."""
        with self._lock:
            if not self._mark:
                return "nothing is being recorded"
            self._end()
            return ""

    def preload(self) -> str:
        """Begin to take the preload from the next readings of the unloaded sensors; return why not, or nothing."""
        with self._lock:
            if self._mark:
                return f"{self._mark} is being recorded: stop it first"
            self.preloads += 1
            self._preload_rows = []
            self._begin(f"{PRELOAD} {self.preloads}")
            return ""

    def live(self, after: int) -> dict[str, Any]:
        """Return the state and the samples whose number is above ``after``, as JSON takes it."""
        with self._lock:
            if after > self._count:  # a page that is older than this session
                after = 0
            return {
                "session": self._start,  # tells it from another one that was served here
                "channels": self.channels,
                "unit": self.unit,
                "calibrated": self.calibration is not None,
                "file": str(self.log.path),
                "port": self.device.port,
                "connected": self._connected,
                "now": self.device.clock() - self._start,
                "mark": self._mark,
                "trials": self.trials,
                "preloads": self.preloads,
                "preload": self._preload.tolist(),
                "rows": self.log.rows,
                "marked": self.marked,
                "garbage": self.garbage,
                "losses": self.losses,
                "problem": self.log.problem,
                "samples": [sample for sample in self._samples if sample["number"] > after],
            }

    def summary(self) -> str:
        """Return what was recorded, and a warning where no trial was marked or no line was understood."""
        lines = [
            f"Written to {self.log.path}: {self.log.rows} readings ({self.marked} of them marked); trials: "
            f"{self.trials}, preloads: {self.preloads}, lines not understood: {self.garbage}, connections lost: "
            f"{self.losses}"
        ]
        if not self.log.rows:
            lines.append(f"WARNING: NO READING WAS UNDERSTOOD; a line must hold {len(self.channels)} numbers")
        elif not self.trials:
            lines.append(
                "WARNING: NO TRIAL WAS MARKED. Every line is in the file; liftopt forces takes those without a mark "
                "as one trial"
            )
        return "\n".join(lines)

    def _take(self, at: float, values: tuple[float, ...]) -> None:
        self.log.row(at, self._mark, values)
        self.marked += bool(self._mark)
        self._count += 1
        sample: dict[str, Any] = {"number": self._count, "time": at, "mark": self._mark, "values": values}
        if self.calibration is not None:
            volts = self.calibration.divider.volts(np.array([values]), self.unit)
            force, flags = sensor_forces(self.channels, volts, self.calibration)
            if self._mark.startswith(PRELOAD):
                self._preload_rows.append(force[0])
                self._preload = np.mean(self._preload_rows, axis=0)
            own = force[0] - self._preload
            sample |= {
                "force": own.tolist(),
                "hand": float(hand_force(self.channels, own)),
                "flags": ["/".join(key for bit, key in KEYS.items() if flag & bit) for flag in flags[0]],
            }
        self._samples.append(sample)
        self._left -= 1
        if self._mark.startswith(PRELOAD) and self._left <= 0:
            self._end()

    def _connection(self, at: float, event: Connection) -> None:
        self._connected = event.up
        self.losses += not event.up
        self.log.remark(at, "connected again" if event.up else f"connection lost: {event.reason}")

    def _begin(self, mark: str) -> None:
        self._mark, self._left = mark, PRELOAD_READINGS
        self.log.remark(self.device.clock() - self._start, f"{mark} begins")

    def _end(self) -> None:
        self.log.remark(self.device.clock() - self._start, f"{self._mark} ends")
        self._mark = ""
