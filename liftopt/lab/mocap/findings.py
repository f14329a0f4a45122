"""What a recording shows that the model does not, and what was left aside."""

from __future__ import annotations

import numpy as np

from liftopt.lab.mocap.anatomy import Skeleton
from liftopt.lab.mocap.marker_map import Labels
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.scaling import ScaledSubject
from liftopt.lab.mocap.tracking import TrackedMotion


def findings(
    unused: Labels,
    recording: Recording,
    found: Skeleton,
    scaled: ScaledSubject,
    motion: TrackedMotion,
    joints: tuple[str, ...],
) -> list[str]:
    """Return what a user should know of a recording beside its numbers, one sentence each.

    Args:
        unused: labels that the mapping leaves aside.
        recording: as read.
        found: the skeleton of its markers.
        scaled: the person.
        motion: of the model.
        joints: (13,) names of its joints.
    """
    notes = []
    if unused:
        notes.append(f"{len(unused)} markers are not mapped and not used: {', '.join(unused[:20])}")
    if recording.analog is not None:
        notes.append(f"{len(recording.analog.labels)} analog channels are not converted to forces")
    turn = np.degrees(np.nanmax(found.pelvis_turn, axis=0) - np.nanmin(found.pelvis_turn, axis=0))
    notes.append(
        f"the pelvis turns by {turn[0]:.1f} deg in heading, {turn[1]:.1f} in pitch and {turn[2]:.1f} in roll; the "
        "model has no hips, so Q1 to Q3 are the trunk against the upright"
    )
    for name, what in (("pelvis", "pelvis"), ("scapula", "shoulder blade")):
        if name in found.segments:
            scatter = 1000.0 * float(np.sqrt(np.mean(found.segments[name].scatter ** 2)))
            notes.append(f"markers of the {what} keep their shape to {scatter:.1f} mm (rms)")
    travel = 1000.0 * found.shoulder_travel
    notes.append(
        f"the shoulder's centre ({found.shoulder_found}) travels {travel[0]:.0f}, {travel[1]:.0f}, {travel[2]:.0f} mm "
        "in the trunk (forward, sideways, up); the model has no clavicle and keeps it at its mean"
    )
    if scaled.estimated:
        each = ", ".join(f"{name} {value:.2f}" for name, value in scaled.stature_by.items())
        notes.append(f"the stature is estimated from segments ({each} m)")
    for joint, count in zip(joints, motion.at_limit.sum(axis=0), strict=True):
        if count:
            notes.append(f"{joint} is at the limit of its range in {count} of {len(motion.q)} frames")
    return notes
