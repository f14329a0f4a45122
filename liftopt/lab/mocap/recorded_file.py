"""A recorded lift on disk: recorded.nc (NetCDF-4), in the names and units of solution.nc, and the model as URDF."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import liftopt
from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.gaps import Gap
from liftopt.lab.mocap.recorded_lift import RecordedLift, RecordedWhole
from liftopt.multibody.person.anthropometry import LinkLengths
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_joints import HANDS

FILE, MODEL = "recorded.nc", "human_recorded.urdf"
# Name in the file -> field, dimensions, unit, meaning.
VARIABLES: dict[str, tuple[str, tuple[str, ...], str, str]] = {
    "time": ("time", ("time",), "s", "time on the recording's clock"),
    "human_q": ("q", ("time", "human_joint"), "rad", "human joint position (m for GT1 to GT3: the pelvis)"),
    "human_v": ("v", ("time", "human_joint"), "rad/s", "human joint velocity (m/s for GT1 to GT3)"),
    "human_a": ("a", ("time", "human_joint"), "rad/s^2", "human joint acceleration (m/s^2 for GT1 to GT3)"),
    "human_tau": ("tau", ("time", "human_joint"), "N m", "human joint torque (force in N for GT1 to GT3)"),
    "hand_position": ("hand_position", ("time", "xyz"), "m", "grasp point of the human's hand in the world"),
    "hand_force": ("hand_force", ("time", "xyz"), "N", "force of the hand on the object, world axes"),
    "ground_reaction_force": (
        "ground_force", ("time", "xyz"), "N", "force of the ground that the model's motion asks for, world axes",
    ),
    "ground_reaction_moment": (
        "ground_moment", ("time", "xyz"), "N m", "moment of the ground on the model at the foot origin, world axes",
    ),
    "plate_force": ("plate_force", ("time", "xyz"), "N", "force of the force plates on the person, world axes"),
    "marker_residual": ("residual", ("time", "marker"), "m", "distance of the measured marker from the model's"),
    "elbow_flexion": ("elbow_flexion", ("time",), "rad", "elbow flexion between joint centres, from the markers"),
    "object_position": ("object_position", ("time", "xyz"), "m", "mean of the object's markers in the world"),
    "object_quaternion": ("object_quaternion", ("time", "quat"), "1", "turn of the object since the first frame"),
}  # fmt: skip
# The same of a whole person's.
OF_WHOLE: dict[str, tuple[str, tuple[str, ...], str, str]] = {
    "grasp_position": ("grasp_position", ("time", "grasp", "xyz"), "m", "grasp points of the hands in the world"),
    "grasp_force": ("grasp_force", ("time", "grasp", "xyz"), "N", "force of each hand on the object, world axes"),
    "centre_of_pressure": (
        "centre_of_pressure", ("time", "xyz"), "m", "where the ground bears the model, in the world, on the floor",
    ),
    "plate_centre_of_pressure": (
        "plate_centre", ("time", "xyz"), "m", "where all force plates together bear the person, in the world",
    ),
    "elbow_flexions": ("elbow_flexion", ("time", "side"), "rad", "elbow flexion between joint centres of markers"),
    "knee_flexions": ("knee_flexion", ("time", "side"), "rad", "knee flexion between joint centres of markers"),
}  # fmt: skip
HEIGHTS = ("ankle", "knee", "hip", "ahead")


def save_recorded(lift: RecordedLift, out: Path) -> None:
    """Write recorded.nc and models/human_recorded.urdf into the folder ``out``, each whole or not at all.

    Raises:
        InputError: the folder or a file cannot be written.
    """
    try:
        (out / "models").mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=out, prefix=".writing-") as work:
            model, netcdf = Path(work) / MODEL, Path(work) / FILE
            model.write_text(lift.urdf, encoding="utf-8")
            _write(lift, netcdf)
            os.replace(model, out / "models" / MODEL)
            os.replace(netcdf, out / FILE)
    except OSError as error:
        raise InputError("--out", str(out), f"cannot be written: {error.strerror or error}") from error


def load_recorded(path: str | Path) -> RecordedLift:
    """Return the recorded lift of a folder that ``save_recorded`` wrote, or of its recorded.nc.

    Raises:
        InputError: there is none, or the file is no recorded lift.
    """
    import h5netcdf

    path = Path(path)
    path = path / FILE if path.is_dir() else path
    if not path.is_file():
        raise InputError(str(path), NO_VALUE, "no such file; liftopt mocap writes one")
    try:
        with h5netcdf.File(path, "r") as file:
            arrays, of_whole = _arrays(file, VARIABLES), _arrays(file, OF_WHOLE)
            joints, markers = (_texts(file.variables[name][...]) for name in ("human_joint", "marker"))
            about = json.loads(file.attrs["record"])
        whole = about.pop("whole", None)
        return RecordedLift(
            **arrays,
            whole=RecordedWhole(**of_whole, **whole | {"left": LinkLengths(**whole["left"])}) if whole else None,
            joint_names=joints,
            markers=markers,
            subject=Subject(**about.pop("subject")),
            lengths=LinkLengths(**about.pop("lengths")),
            gaps=tuple(Gap(**gap) for gap in about.pop("gaps")),
            notes=tuple(about.pop("notes")),
            carried=tuple(carried) if (carried := about.pop("carried")) else None,
            lifts=tuple((float(start), float(end)) for start, end in about.pop("lifts", ())),
            **about,
        )
    except (OSError, KeyError, TypeError, ValueError, AttributeError, RuntimeError) as error:
        raise InputError(str(path), NO_VALUE, f"is not a recorded lift: {error}") from error


def about(lift: RecordedLift) -> dict[str, Any]:
    """Return what is no time series, ready for JSON."""
    return {
        "source": lift.source,
        "rate": lift.rate,
        "cutoff": lift.cutoff,
        "subject": asdict(lift.subject),
        "stature_estimated": lift.stature_estimated,
        "stature_by": lift.stature_by,
        "lengths": asdict(lift.lengths),
        "force_from": lift.force_from,
        "carried": lift.carried,
        "lifts": lift.lifts,
        "gaps": [asdict(gap) for gap in lift.gaps],
        "notes": lift.notes,
    } | ({"whole": _about_whole(lift.whole)} if lift.whole else {})


def _about_whole(whole: RecordedWhole) -> dict[str, Any]:
    return {name: getattr(whole, name) for name in HEIGHTS} | {"left": asdict(whole.left)}


def _arrays(file: Any, variables: Mapping[str, tuple[str, tuple[str, ...], str, str]]) -> dict[str, Any]:
    """Return the arrays of a file by field, None where it has none."""
    return {
        field: np.array(file.variables[name][...]) if name in file.variables else None
        for name, (field, *_) in variables.items()
    }


def _write(lift: RecordedLift, path: Path) -> None:
    import h5netcdf
    import h5py

    labels = {"human_joint": lift.joint_names, "marker": lift.markers, "xyz": tuple("xyz"), "quat": tuple("xyzw")}
    values = {name: (getattr(lift, field), *rest) for name, (field, *rest) in VARIABLES.items()}
    if lift.whole:
        labels |= {"side": HANDS, "grasp": tuple(f"human_{hand}" for hand in HANDS)}
        values |= {name: (getattr(lift.whole, field), *rest) for name, (field, *rest) in OF_WHOLE.items()}
    with h5netcdf.File(path, "w") as file:
        file.dimensions["time"] = len(lift.time)
        for name, texts in labels.items():
            file.dimensions[name] = len(texts)
            variable = file.create_variable(name, (name,), dtype=h5py.string_dtype())
            variable[:] = np.array(texts, dtype=object)
            variable.attrs["units"] = "1"
            variable.attrs["long_name"] = f"names along {name}"
        for name, (array, dimensions, unit, meaning) in values.items():
            if array is not None:
                variable = file.create_variable(name, dimensions, data=np.asarray(array, dtype=float))
                variable.attrs["units"] = unit
                variable.attrs["long_name"] = meaning
        file.attrs["title"] = "liftopt: a recorded lift"
        file.attrs["source"] = lift.source
        file.attrs["versions"] = json.dumps({"liftopt": liftopt.__version__})
        file.attrs["record"] = json.dumps(about(lift) | {"urdf": lift.urdf}, allow_nan=False)


def _texts(values: Any) -> tuple[str, ...]:
    return tuple(text.decode() if isinstance(text, bytes) else str(text) for text in values)
