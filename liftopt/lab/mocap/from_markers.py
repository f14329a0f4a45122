"""The main job of motion capture in one page: a recording and a mapping in, the recorded lift as joint motion out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.anatomy import skeleton
from liftopt.lab.mocap.assembled_lift import assembled_lift
from liftopt.lab.mocap.c3d import read_c3d
from liftopt.lab.mocap.filtering import angles_and_rates, low_pass
from liftopt.lab.mocap.findings import findings
from liftopt.lab.mocap.loads import Load, carried_object, lift_spans, right_hand_force
from liftopt.lab.mocap.map_file import AnyMap
from liftopt.lab.mocap.marker_map import MarkerMap
from liftopt.lab.mocap.outliers import Outlier, ShapeGroup, outlier_notes, without_outliers
from liftopt.lab.mocap.recorded_lift import RecordedLift, rms
from liftopt.lab.mocap.recorded_person import recorded_person
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.scaling import scale_subject
from liftopt.lab.mocap.taken_markers import taken_markers
from liftopt.lab.mocap.tracking import track
from liftopt.lab.mocap.trc import read_trc
from liftopt.lab.mocap.trial_part import TrialPart, without_ignored
from liftopt.lab.mocap.whole_lift import whole_lift
from liftopt.lab.mocap.whole_map import WholeMap
from liftopt.lab.mocap.wrist_centre import WRIST, needs_wrist, with_wrist_centre
from liftopt.multibody.trajectory import agent_trajectory

CUTOFF = 6.0  # Hz, of markers and angles together
SHOULDER_TRAVEL = 0.1  # m that the acromion may come nearer to a marker of the trunk
READERS = {".c3d": read_c3d, ".trc": read_trc}


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
    mapping: AnyMap,
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
    if isinstance(mapping, WholeMap):
        return whole_lift(recording, mapping, load or Load(), cutoff, part or TrialPart())
    mapping = without_ignored(mapping, part or TrialPart())
    taken = taken_markers(recording, mapping, part or TrialPart(), lambda metres: _judged(metres, mapping))
    filled = with_wrist_centre(taken.filled, mapping)
    smooth, outliers = replace(filled, points=low_pass(filled.points, filled.rate, cutoff, filters=2)), taken.outliers
    found = skeleton(smooth, mapping)
    scaled = scale_subject(found, mapping)
    person = recorded_person(smooth, found, scaled)
    # What may be refused comes before the motion is followed, which takes longest.
    lifted, lost = carried_object(smooth, mapping, person.world, outliers, needed=load is not None and load.mass > 0.0)
    force, force_from = right_hand_force(smooth.time, mapping, person.world, lifted, load or Load())
    agent, limits = person.agent, person.agent.limits
    motion = track(
        agent.model,
        person.markers,
        person.targets,
        lower=limits.q_lower,
        upper=limits.q_upper,
        start=np.zeros(agent.model.nq),
    )
    q, v, a = angles_and_rates(smooth.time, motion.q, smooth.rate, cutoff, limits.q_lower, limits.q_upper)
    trajectory = agent_trajectory(agent, q, v, a, force)
    notes = [*smooth.notes, *outlier_notes(smooth, outliers), *lost]
    notes += findings(taken.unused, taken.recording, found, scaled, motion, trajectory.joint_names)
    off = np.degrees(-q[:, trajectory.joint_names.index("human_Q7")] - found.elbow_flexion)
    notes.append(
        "elbow flexion of the model is off that between the joint centres of the markers "
        f"by {rms(off):.1f} deg (rms), at most {np.nanmax(np.abs(off)):.1f}"
    )
    lifts, several = lift_spans(smooth.time, lifted)
    notes += several
    return assembled_lift(
        taken,
        smooth,
        cutoff,
        scaled,
        scaled.lengths,
        person,
        motion,
        trajectory,
        lifted,
        force_from=force_from,
        elbow_flexion=found.elbow_flexion,
        lifts=lifts,
        notes=notes,
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
