"""C3D files, read through ezc3d."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.extra import check_extra
from liftopt.lab.recording import METRES, TO_Z_UP, AnalogChannels, Array, ForcePlate, Recording, checked_recording

PATIENCE = 300.0  # seconds for one file; a minute of markers and analog channels takes one


def read_c3d(path: Path) -> Recording:
    """Return the markers, analog channels and force plates of a C3D file.

    A point whose residual is negative was not seen. A file that holds fewer frames than its header says is read as far
    as it goes, and that is noted.

    Raises:
        InputError: the file cannot be read, is no C3D file or is damaged, has no markers or frames; or ezc3d is
            missing.
    """
    check_extra("ezc3d", "read C3D files")
    source = str(path)
    _look_at_start(path)
    arrays = _contents(path)
    about = json.loads(str(arrays["about"]))
    points, residuals = arrays["points"], arrays["residuals"]
    if residuals.shape == points.shape[:2]:
        points = np.where((residuals < 0.0)[:, :, None], np.nan, points)
    frames, notes = len(points), []
    if frames != about["stated"]:
        if not frames:
            raise InputError(source, NO_VALUE, f"is cut short: no frame is left of the {about['stated']} of its header")
        notes.append(
            f"the header says {about['stated']} frames, the file holds {frames}: it is cut short or mislabelled"
        )
    labels = about["labels"][: points.shape[1]]
    labels += [""] * (points.shape[1] - len(labels))
    if about["plate_error"]:
        notes.append(f"force plates are stated but could not be read: {about['plate_error']}")
    rate, screen = about["rate"], about["screen"].replace("+", "").upper()
    start = about["first"] / rate if rate > 0.0 else 0.0
    return checked_recording(
        Recording(
            source=source,
            rate=rate,
            time=start + np.arange(frames) / rate if rate > 0.0 else np.zeros(frames),
            labels=tuple(labels),
            points=np.asarray(points, dtype=float),
            units=about["units"] or None,
            up=screen if screen in TO_Z_UP else None,
            analog=_analog(arrays["analogs"], about),
            plates=_plates(arrays, about),
            notes=tuple(notes),
        )
    )


def _look_at_start(path: Path) -> None:
    source = str(path)
    try:
        if path.exists() and not path.is_file():
            raise InputError(source, NO_VALUE, "is not a file")
        with path.open("rb") as file:
            start = file.read(512)
    except FileNotFoundError:
        raise InputError(source, NO_VALUE, "no such file") from None
    except (OSError, ValueError) as error:
        raise InputError(source, NO_VALUE, f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if not start:
        raise InputError(source, NO_VALUE, "is empty")
    if len(start) < 2 or start[1] != 0x50:  # the key of every C3D file
        raise InputError(source, NO_VALUE, "is not a C3D file (its second byte is not 0x50)")
    if len(start) < 512:
        raise InputError(source, NO_VALUE, f"is cut short within its header: {len(start)} of 512 bytes")


def _contents(path: Path) -> dict[str, Any]:
    source = str(path)
    with tempfile.TemporaryDirectory(prefix="liftopt-c3d-") as folder:
        out = Path(folder) / "contents.npz"
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))}
        command = [sys.executable, "-m", "liftopt.lab.c3d_child", str(path.absolute()), str(out)]
        try:
            run = subprocess.run(
                command, env=environment, capture_output=True, text=True, timeout=PATIENCE, check=False, cwd=folder
            )
        except subprocess.TimeoutExpired:
            raise InputError(source, NO_VALUE, f"could not be read within {PATIENCE:g} s; it is damaged") from None
        if run.returncode < 0:
            raise InputError(
                source, NO_VALUE, "ezc3d crashes on it: its header or parameters are damaged or incomplete"
            )
        if run.returncode or not out.exists():
            reason = run.stderr.strip().split("\n")[-1]
            raise InputError(source, NO_VALUE, f"cannot be read as C3D: {reason or 'no reason was given'}")
        with np.load(out) as arrays:
            return dict(arrays)


def _analog(values: Array, about: dict[str, Any]) -> AnalogChannels | None:
    if not values.size:
        return None
    count = values.shape[1]
    labels = (about["analog_labels"] + [f"channel {i + 1}" for i in range(len(about["analog_labels"]), count)])[:count]
    units = (about["analog_units"] + [""] * count)[:count]
    return AnalogChannels(about["analog_rate"], tuple(labels), tuple(units), np.asarray(values, dtype=float))


def _plates(arrays: dict[str, Any], about: dict[str, Any]) -> tuple[ForcePlate, ...]:
    plates = []
    for i, (_, moment_unit, length_unit) in enumerate(about["plate_units"]):
        lever = METRES.get(str(moment_unit).lower().removeprefix("n"), METRES.get(str(length_unit).lower(), 1.0))
        metres = METRES.get(str(length_unit).lower(), 1.0)
        plates.append(
            ForcePlate(
                rate=about["analog_rate"],
                force=arrays[f"plate{i}_force"],
                moment=lever * arrays[f"plate{i}_moment"],
                centre_of_pressure=metres * arrays[f"plate{i}_center_of_pressure"],
                corners=metres * arrays[f"plate{i}_corners"],
            )
        )
    return tuple(plates)
