"""Reads one C3D file with ezc3d and writes what it holds as an .npz: run as a process of its own by ``c3d``.

Damaged parameters, and analog channels without scales, make ezc3d end the process with a segmentation fault, which no
caller could catch.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np


def contents(path: str) -> dict[str, Any]:
    """Return arrays and one JSON text ``about`` of a C3D file, all in the file's own units and axes."""
    import ezc3d

    plates: list[Any] = []
    plate_error = ""
    file = ezc3d.c3d(path)
    point, analog = file["parameters"].get("POINT", {}), file["parameters"].get("ANALOG", {})
    platform = file["parameters"].get("FORCE_PLATFORM", {})
    if int(np.ravel(_value(platform, "USED", [0]) or [0])[0]) > 0:
        try:
            plates = ezc3d.c3d(path, extract_forceplat_data=True)["data"]["platform"]
        except Exception as error:
            plate_error = str(error)
    header = file["header"]["points"]
    about = {
        "labels": _texts(point, "LABELS"),
        "units": (_texts(point, "UNITS") or [""])[0],
        "screen": (_texts(point, "Y_SCREEN") or [""])[0],
        "rate": float(header["frame_rate"]),
        "first": int(header["first_frame"]),
        "stated": _stated_frames(path, file["parameters"].get("TRIAL", {})),
        "analog_rate": float(file["header"]["analogs"]["frame_rate"]),
        "analog_labels": _texts(analog, "LABELS"),
        "analog_units": _texts(analog, "UNITS"),
        "plate_units": [[plate["unit_force"], plate["unit_moment"], plate["unit_position"]] for plate in plates],
        "plate_error": plate_error,
    }
    arrays = {
        "points": file["data"]["points"][:3].transpose(2, 1, 0),
        "residuals": file["data"]["meta_points"]["residuals"][0].T,
        "analogs": file["data"]["analogs"][0].T,
    }
    for i, plate in enumerate(plates):
        for key in ("force", "moment", "center_of_pressure", "corners"):
            arrays[f"plate{i}_{key}"] = np.asarray(plate[key]).T
    return arrays | {"about": json.dumps(about)}


def _stated_frames(path: str, trial: Any) -> int:
    """Return how many frames the file says it has; ezc3d itself tells how many it found."""
    with open(path, "rb") as file:
        start = file.read(512)
        file.seek(512 * (start[0] - 1) + 3)
        order: Any = "big" if file.read(1) == b"\x56" else "little"  # MIPS; Intel and DEC write the low byte first
    first, last = (int.from_bytes(start[at : at + 2], order) for at in (6, 8))
    # The header's 16 bits end at 65535 frames; longer trials have their ends in two words each.
    ends = [_value(trial, f"ACTUAL_{end}_FIELD", []) for end in ("START", "END")]
    if all(len(words) == 2 for words in ends):
        first, last = (int(low) % 65536 + 65536 * (int(high) % 65536) for low, high in ends)
    return last - first + 1


def _value(group: Any, name: str, default: Any) -> Any:
    return list(np.ravel(group[name]["value"])) if name in group else default


def _texts(group: Any, name: str) -> list[str]:
    # Beyond 255 channels C3D goes on in LABELS2, LABELS3...
    texts: list[str] = []
    for suffix in ("", *map(str, range(2, 10))):
        texts += [str(text).strip() for text in _value(group, name + suffix, [])]
    return texts


if __name__ == "__main__":
    try:
        np.savez(sys.argv[2], **contents(sys.argv[1]))
    except Exception as error:  # whatever ezc3d finds wrong with the file
        print(" ".join(str(error).split()) or type(error).__name__, file=sys.stderr)
        sys.exit(1)
