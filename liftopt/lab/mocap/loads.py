"""What hands carry and the ground bears in a recording: the object, forces of the hands, force plates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.gaps import runs
from liftopt.lab.mocap.hand_force import HandForce
from liftopt.lab.mocap.map_file import AnyMap
from liftopt.lab.mocap.object_motion import ObjectMotion, load_force, object_motion
from liftopt.lab.mocap.outliers import Outlier, outlier_notes, shown
from liftopt.lab.mocap.recorded_person import WorldFrame
from liftopt.lab.mocap.recording import TO_Z_UP, Recording
from liftopt.types import Array

LEAST_BORNE = 5.0  # N on a plate that tell where it is pressed


@dataclass(frozen=True)
class Load:
    """What the hands carry.

    Attributes:
        measured: series of the right hand's force, or None.
        mass: of the object, for an estimate where no force was measured; 0 for none [kg].
        share: of that load on the right hand.
        left_measured: series of the left hand's force, or None; of a whole body.
        left_share: of that load on the left hand; None for all that the right one leaves.
    """

    measured: HandForce | None = None
    mass: float = 0.0
    share: float = 0.5
    left_measured: HandForce | None = None
    left_share: float | None = None


def carried_object(
    recording: Recording,
    mapping: AnyMap,
    world: WorldFrame,
    outliers: tuple[Outlier, ...],
    needed: bool,
) -> tuple[ObjectMotion | None, list[str]]:
    """Return the object's motion, or why there is none."""
    labels = mapping.by_segment().get("object", ())
    if not labels:
        return None, []
    points = recording.points[:, [recording.index(label) for label in labels]]
    try:
        lifted = object_motion(recording.time, world.place(points), recording.source)
        if not lifted.unseen.any():
            return lifted, []
        where = shown(recording, runs(lifted.unseen))
        return lifted, [f"the object is out of sight in {where}: its place there is that before and after"]
    except InputError as error:
        if needed:
            dropped = outlier_notes(recording, tuple(one for one in outliers if one.marker in labels))
            raise InputError(error.key, error.value, "; ".join([error.allowed, *dropped])) from None
        return None, [f"the object's motion is left out: {error}"]


def lift_spans(time: Array, lifted: ObjectMotion | None) -> tuple[tuple[tuple[float, float], ...], list[str]]:
    """Return from when to when each lift goes [s], and what to say where there are several."""
    spans = tuple((float(time[i]), float(time[j])) for i, j in lifted.lifts) if lifted else ()
    if len(spans) < 2:
        return spans, []
    times = ", ".join(f"{start:.2f} to {end:.2f} s" for start, end in spans)
    return spans, [f"the object is lifted {len(spans)} times, {times}; between these it lies. Choose one by --lift"]


def right_hand_force(
    time: Array, mapping: AnyMap, world: WorldFrame, lifted: ObjectMotion | None, load: Load
) -> tuple[Array, str]:
    """Return the force (F, 3) of the right hand on the object along the world's axes [N], and where it is from.

    Raises:
        InputError: the load is to be told from the object's motion, which is not known, or a series does not hold the
            lift.
    """
    if load.measured is not None:
        return _measured(load.measured, time, mapping, world, lifted)
    if not load.mass:
        return np.zeros((len(time), 3)), "none given: the torques are those of the empty hand"
    lifted = _known(lifted)
    what = f"estimated: {load.share:.0%} of the force that moves {load.mass:g} kg as the object moved"
    return load_force(lifted, load.mass, load.share), what


def both_hands_force(
    time: Array, mapping: AnyMap, world: WorldFrame, lifted: ObjectMotion | None, load: Load
) -> tuple[Array, str]:
    """Return the forces (F, 2, 3) of right and left hand on the object along the world's axes [N], and where from.

    A hand without a series bears its share of the force that the object's motion takes; the left one, unless its share
    is given, all that the right one leaves.

    Raises:
        InputError: as ``right_hand_force``.
    """
    series, none = (load.measured, load.left_measured), np.zeros((len(time), 3))
    forces: list[Array | None] = [None, None]
    words = ["", ""]
    for hand, one in enumerate(series):
        if one is not None:
            forces[hand], words[hand] = _measured(one, time, mapping, world, lifted)
    if not load.mass:
        known = [none if force is None else force for force in forces]
        if not any(words):
            return np.stack(known, axis=1), "none given: the torques are those of empty hands"
        words = [word or "none given" for word in words]
        return np.stack(known, axis=1), f"right hand {words[0]}; left hand {words[1]}"
    moving = load_force(_known(lifted), load.mass, 1.0)
    what = f"of the force that moves {load.mass:g} kg as the object moved"
    left = 1.0 - load.share if load.left_share is None else load.left_share
    for hand, share in enumerate((load.share, left)):
        if series[hand] is not None:
            continue
        other = forces[1 - hand] if series[1 - hand] is not None else None
        if other is not None and (hand == 0 or load.left_share is None):
            forces[hand] = np.where(moving.any(axis=1, keepdims=True), moving - other, 0.0)
            words[hand] = f"estimated: what the other hand leaves {what}"
        else:
            forces[hand], words[hand] = share * moving, f"estimated: {share:.0%} {what}"
    split = "" if any(series) else "; the share is given, as motion does not show how two hands share a load"
    return np.stack([none if force is None else force for force in forces], axis=1), (
        f"right hand {words[0]}; left hand {words[1]}{split}"
    )


def _measured(
    series: HandForce, time: Array, mapping: AnyMap, world: WorldFrame, lifted: ObjectMotion | None
) -> tuple[Array, str]:
    force, outside = series.at(time)
    series.check_covers([(float(time[i]), float(time[j])) for i, j in lifted.lifts] if lifted else [])
    turn = world.rotation @ TO_Z_UP[mapping.up]
    covers = f", which has none for {outside} of {len(time)} frames (0 N there)" if outside else ""
    return force @ turn.T, f"measured: {series.source}{covers}"


def _known(lifted: ObjectMotion | None) -> ObjectMotion:
    if lifted is None:
        raise InputError(
            "segments.object", NO_VALUE, "names no markers, so that the load cannot be told from its motion"
        )
    return lifted


def plate_force(recording: Recording, world: WorldFrame) -> Array | None:
    """Return (F, 3) the force of all plates on the person, world axes; the mean of the samples of each frame [N]."""
    if not recording.plates:
        return None
    total = np.zeros((len(recording.time), 3))
    for plate in recording.plates:
        frames = _by_frame(plate.force, plate.rate, recording)
        total[: len(frames)] += frames
    # Systems state the force on the plate or that of the plate; the ground can only push.
    return (total if total[:, 2].mean() >= 0.0 else -total) @ world.rotation.T


def plate_centre(recording: Recording, world: WorldFrame) -> Array | None:
    """Return (F, 3) the centre of pressure of all plates together in the world [m], NaN where they bear nothing."""
    if not recording.plates:
        return None
    borne, weighted = np.zeros(len(recording.time)), np.zeros((len(recording.time), 3))
    for plate in recording.plates:
        force = np.abs(plate.force[:, 2])
        centre = np.where(force[:, None] > LEAST_BORNE, plate.centre_of_pressure, 0.0)
        bearing = np.where(force > LEAST_BORNE, force, 0.0)
        frames = _by_frame(np.column_stack([bearing, bearing[:, None] * centre]), plate.rate, recording)
        borne[: len(frames)] += frames[:, 0]
        weighted[: len(frames)] += frames[:, 1:]
    known = borne > LEAST_BORNE
    middle = np.full_like(weighted, np.nan)
    middle[known] = world.place(weighted[known] / borne[known, None])
    return middle


def _by_frame(samples: Array, rate: float, recording: Recording) -> Array:
    """Return the mean of the samples of each frame."""
    each = max(round(rate / recording.rate), 1)
    return np.asarray(samples[: each * len(recording.time)].reshape(-1, each, samples.shape[1]).mean(axis=1))
