"""Recordings of markers as files that laboratories exchange."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from liftopt.lab.mocap.recording import Recording


def write_trc(recording: Recording, path: Path) -> None:
    """Write a recording in mm as a TRC file."""
    count, rate = len(recording.labels), recording.rate
    names = "\t\t\t".join(recording.labels)
    lines = [
        "PathFileType\t4\t(X/Y/Z)\tlift.trc",
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
        f"{rate:g}\t{rate:g}\t{len(recording.time)}\t{count}\tmm\t{rate:g}\t1\t{len(recording.time)}",
        f"Frame#\tTime\t{names}\t\t",
        "\t\t" + "\t".join(f"{axis}{i + 1}" for i in range(count) for axis in "XYZ"),
        "",
    ]
    for k, (time, frame) in enumerate(zip(recording.time, recording.points, strict=True)):
        lines.append(f"{k + 1}\t{time:.4f}\t" + "\t".join(f"{value:.5f}" for value in frame.ravel()))
    path.write_text("\n".join(lines) + "\n")


def write_c3d(recording: Recording, path: Path) -> None:
    """Write a recording in mm as a C3D file, by ezc3d."""
    import ezc3d

    file = ezc3d.c3d()
    values = np.ones((4, len(recording.labels), len(recording.time)))
    values[:3] = recording.points.transpose(2, 1, 0)
    file["data"]["points"] = values
    point = file["parameters"]["POINT"]
    point["RATE"]["value"], point["UNITS"]["value"] = [recording.rate], ["mm"]
    point["LABELS"]["value"] = list(recording.labels)
    file.write(str(path))
