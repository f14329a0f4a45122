"""The main job of motion capture in one page: a recording and a mapping in, the recorded lift as joint motion out."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.interpolate import make_interp_spline

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.anatomy import skeleton
from liftopt.lab.mocap.c3d import read_c3d
from liftopt.lab.mocap.filtering import low_pass
from liftopt.lab.mocap.findings import findings
from liftopt.lab.mocap.gaps import fill_gaps, runs
from liftopt.lab.mocap.hand_force import HandForce
from liftopt.lab.mocap.marker_map import MarkerMap, mapped_markers
from liftopt.lab.mocap.object_motion import ObjectMotion, load_force, object_motion
from liftopt.lab.mocap.outliers import (
    Outlier,
    ShapeGroup,
    check_enough,
    outlier_notes,
    shown,
    without_far_points,
    without_outliers,
)
from liftopt.lab.mocap.recorded_lift import RecordedLift, rms
from liftopt.lab.mocap.recorded_person import RecordedPerson, recorded_person
from liftopt.lab.mocap.recording import TO_Z_UP, Recording, in_metres
from liftopt.lab.mocap.scaling import scale_subject
from liftopt.lab.mocap.tracking import track
from liftopt.lab.mocap.trc import read_trc
from liftopt.lab.mocap.trial_part import TrialPart, chosen_part, without_ignored
from liftopt.lab.mocap.wrist_centre import WRIST, needs_wrist, with_wrist_centre
from liftopt.multibody.trajectory import agent_trajectory
from liftopt.types import Array

CUTOFF = 6.0  # Hz, of markers and angles together
SHOULDER_TRAVEL = 0.1  # m that the acromion may come nearer to a marker of the trunk
FEWEST_FRAMES = 12  # for the filter and the spline
READERS = {".c3d": read_c3d, ".trc": read_trc}


@dataclass(frozen=True)
class Load:
    """What the hand carries.

    Attributes:
        measured: series of the hand's force, or None.
        mass: of the object, for an estimate where no force was measured; 0 for none [kg].
        share: of that load on the right hand.
    """

    measured: HandForce | None = None
    mass: float = 0.0
    share: float = 0.5


def read_recording(path: Path) -> Recording:
    """Return the markers of a C3D or TRC file.

    Raises:
        InputError: the ending is another, or the file cannot be read.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(str(path), NO_VALUE, f"is no recording of markers; {' and '.join(READERS)} files are")
    return reader(path)


def recorded_lift(
    recording: Recording,
    mapping: MarkerMap,
    load: Load | None = None,
    cutoff: float = CUTOFF,
    part: TrialPart | None = None,
) -> RecordedLift:
    """Return the lift that markers recorded.

    Args:
        recording: as read.
        mapping: of its markers.
        load: what the hand carries; None for nothing.
        cutoff: of the low-pass filter [Hz].
        part: of the trial that is used; None for all of it.

    Raises:
        InputError: recording and mapping do not go together, markers are where they cannot be in too many frames, or
            the subject is incomplete.
    """
    recording, mapping = chosen_part(recording, part or TrialPart()), without_ignored(mapping, part or TrialPart())
    mapped, unused = mapped_markers(recording, mapping)
    metres = in_metres(without_far_points(mapped), mapping.units or None, mapping.up)
    if len(metres.time) < FEWEST_FRAMES:
        raise InputError(recording.source, f"{len(metres.time)} frames", f"must be at least {FEWEST_FRAMES}")
    judged, outliers = _judged(metres, mapping)
    filled, gaps = fill_gaps(judged, mapping.by_segment())
    check_enough(filled, mapping.by_segment(), outliers)
    filled = with_wrist_centre(filled, mapping)
    smooth = replace(filled, points=low_pass(filled.points, filled.rate, cutoff, filters=2))
    found = skeleton(smooth, mapping)
    scaled = scale_subject(found, mapping)
    person = recorded_person(smooth, found, scaled)
    # What may be refused comes before the motion is followed, which takes longest.
    lifted, lost = _object(smooth, mapping, person, outliers, needed=load is not None and load.mass > 0.0)
    force, force_from = _force(smooth.time, mapping, person, lifted, load or Load())
    agent, limits = person.agent, person.agent.limits
    motion = track(
        agent.model,
        person.markers,
        person.targets,
        lower=limits.q_lower,
        upper=limits.q_upper,
        start=np.zeros(agent.model.nq),
    )
    q, v, a = _motion(smooth.time, motion.q, smooth.rate, cutoff, limits.q_lower, limits.q_upper)
    trajectory = agent_trajectory(agent, q, v, a, force)
    notes = [*smooth.notes, *outlier_notes(smooth, outliers), *lost]
    notes += findings(unused, recording, found, scaled, motion, trajectory.joint_names)
    off = np.degrees(-q[:, trajectory.joint_names.index("human_Q7")] - found.elbow_flexion)
    notes.append(
        "elbow flexion of the model is off that between the joint centres of the markers "
        f"by {rms(off):.1f} deg (rms), at most {np.nanmax(np.abs(off)):.1f}"
    )
    lifts = tuple((float(smooth.time[i]), float(smooth.time[j])) for i, j in lifted.lifts) if lifted else ()
    if len(lifts) > 1:
        times = ", ".join(f"{start:.2f} to {end:.2f} s" for start, end in lifts)
        notes.append(f"the object is lifted {len(lifts)} times, {times}; between these it lies. Choose one by --lift")
    return RecordedLift(
        source=recording.source,
        rate=smooth.rate,
        cutoff=cutoff,
        subject=scaled.subject,
        stature_estimated=scaled.estimated,
        stature_by=scaled.stature_by,
        lengths=scaled.lengths,
        urdf=agent.urdf,
        joint_names=trajectory.joint_names,
        time=smooth.time,
        q=q,
        v=v,
        a=a,
        tau=trajectory.tau,
        hand_position=trajectory.p_world_hold,
        hand_force=force,
        force_from=force_from,
        ground_force=trajectory.ground_force,
        ground_moment=trajectory.ground_moment,
        plate_force=_plate_force(smooth, person),
        markers=tuple(marker.label for marker in person.markers),
        residual=motion.residual,
        elbow_flexion=found.elbow_flexion,
        object_position=lifted.position if lifted else None,
        object_quaternion=lifted.quaternion if lifted else None,
        carried=lifts[0] if len(lifts) == 1 else None,
        gaps=gaps,
        notes=tuple(notes),
        lifts=lifts,
    )


def _judged(recording: Recording, mapping: MarkerMap) -> tuple[Recording, tuple[Outlier, ...]]:
    """Return the recording without outliers, and these; a wrist's centre is no better than the forearm's markers."""
    segments = mapping.by_segment()
    groups = [ShapeGroup(name, labels, labels) for name, labels in segments.items()]
    if "scapula" not in segments:
        acromion = mapping.landmark("acromion_right")
        groups.append(ShapeGroup("shoulder", (*segments["trunk"], *acromion), acromion, SHOULDER_TRAVEL))
    if not needs_wrist(mapping):
        return without_outliers(recording, groups)
    recording, outliers = without_outliers(recording, [group for group in groups if group.name != "hand"])
    hand = ShapeGroup("hand", (*segments["hand"], WRIST), segments["hand"])
    judged, more = without_outliers(with_wrist_centre(recording, mapping), [hand])
    return replace(recording, points=judged.points[:, :-1]), (*outliers, *more)


def _motion(
    time: Array, q: Array, rate: float, cutoff: float, lower: Array, upper: Array
) -> tuple[Array, Array, Array]:
    """Return filtered angles and their rates; a filter overshoots a limit that held, by what is clipped here."""
    spline = make_interp_spline(time, low_pass(q, rate, cutoff, filters=2), k=5)
    return np.clip(spline(time), lower, upper), spline.derivative(1)(time), spline.derivative(2)(time)


def _object(
    recording: Recording,
    mapping: MarkerMap,
    person: RecordedPerson,
    outliers: tuple[Outlier, ...],
    needed: bool,
) -> tuple[ObjectMotion | None, list[str]]:
    """Return the object's motion, or why there is none."""
    labels = mapping.by_segment().get("object", ())
    if not labels:
        return None, []
    points = recording.points[:, [recording.index(label) for label in labels]]
    try:
        lifted = object_motion(recording.time, person.world.place(points), recording.source)
        if not lifted.unseen.any():
            return lifted, []
        where = shown(recording, runs(lifted.unseen))
        return lifted, [f"the object is out of sight in {where}: its place there is that before and after"]
    except InputError as error:
        if needed:
            dropped = outlier_notes(recording, tuple(one for one in outliers if one.marker in labels))
            raise InputError(error.key, error.value, "; ".join([error.allowed, *dropped])) from None
        return None, [f"the object's motion is left out: {error}"]


def _force(
    time: Array, mapping: MarkerMap, person: RecordedPerson, lifted: ObjectMotion | None, load: Load
) -> tuple[Array, str]:
    if load.measured is not None:
        force, outside = load.measured.at(time)
        load.measured.check_covers([(float(time[i]), float(time[j])) for i, j in lifted.lifts] if lifted else [])
        turn = person.world.rotation @ TO_Z_UP[mapping.up]
        covers = f", which has none for {outside} of {len(time)} frames (0 N there)" if outside else ""
        return force @ turn.T, f"measured: {load.measured.source}{covers}"
    if not load.mass:
        return np.zeros((len(time), 3)), "none given: the torques are those of the empty hand"
    if lifted is None:
        raise InputError(
            "segments.object", NO_VALUE, "names no markers, so that the load cannot be told from its motion"
        )
    what = f"estimated: {load.share:.0%} of the force that moves {load.mass:g} kg as the object moved"
    return load_force(lifted, load.mass, load.share), what


def _plate_force(recording: Recording, person: RecordedPerson) -> Array | None:
    """Return (F, 3) the force of all plates on the person, world axes; the mean of the samples of each frame [N]."""
    if not recording.plates:
        return None
    total = np.zeros((len(recording.time), 3))
    for plate in recording.plates:
        each = max(round(plate.rate / recording.rate), 1)
        frames = plate.force[: each * len(total)].reshape(-1, each, 3).mean(axis=1)
        total[: len(frames)] += frames
    # Systems state the force on the plate or that of the plate; the ground can only push.
    return (total if total[:, 2].mean() >= 0.0 else -total) @ person.world.rotation.T
