"""Markers of the whole body in, the recorded lift of the whole person out: legs, trunk and both arms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liftopt.lab.mocap.assembled_lift import assembled_lift
from liftopt.lab.mocap.filtering import angles_and_rates, low_pass
from liftopt.lab.mocap.loads import Load, both_hands_force, carried_object, lift_spans, plate_centre
from liftopt.lab.mocap.map_file import without_lacking
from liftopt.lab.mocap.outliers import outlier_notes, without_outliers
from liftopt.lab.mocap.recorded_lift import RecordedLift, RecordedWhole
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.scaling import told_sex
from liftopt.lab.mocap.taken_markers import taken_markers
from liftopt.lab.mocap.tracking import track
from liftopt.lab.mocap.trial_part import TrialPart, without_ignored
from liftopt.lab.mocap.whole_centres import joint_centres
from liftopt.lab.mocap.whole_findings import whole_findings
from liftopt.lab.mocap.whole_map import WholeMap
from liftopt.lab.mocap.whole_person import whole_person
from liftopt.lab.mocap.whole_scaling import scale_whole
from liftopt.lab.mocap.whole_skeleton import whole_skeleton
from liftopt.multibody.trajectory import agent_trajectory

# Weight of the shoulder's abduction beside the squared distances of markers [m^2/rad^2], and how far it goes in peace
# [rad]. With the arm ahead of the trunk, as in a stoop, abduction and turn are about one axis, and both could run away
# against each other until the arm is bent over. Elsewhere the markers of an arm weigh some hundred times as much.
EASE, AT_EASE = 3e-3, np.radians(20.0)


def whole_lift(recording: Recording, mapping: WholeMap, load: Load, cutoff: float, part: TrialPart) -> RecordedLift:
    """Return the lift of a whole person; arguments and errors as ``recorded_lift``."""
    mapping, lacking = without_lacking(recording, without_ignored(mapping, part))
    sex = told_sex(mapping.subject)
    taken = taken_markers(recording, mapping, part, lambda metres: without_outliers(metres, mapping.shape_groups()))
    filled = taken.filled
    smooth = replace(filled, points=low_pass(filled.points, filled.rate, cutoff, filters=2))
    found = whole_skeleton(smooth, mapping, joint_centres(smooth, mapping, sex))
    scaled = scale_whole(found, mapping.subject)
    person = whole_person(smooth, mapping, found, scaled)
    # What may be refused comes before the motion is followed, which takes longest.
    lifted, lost = carried_object(smooth, mapping, person.world, taken.outliers, needed=load.mass > 0.0)
    force, force_from = both_hands_force(smooth.time, mapping, person.world, lifted, load)
    agent, limits = person.agent, person.agent.limits
    lower, upper = limits.q_lower.copy(), limits.q_upper.copy()
    for joint in person.held:
        column = agent.moving_joints.index(joint)
        lower[column] = upper[column] = agent.posture[column]
    weight = np.array([EASE if joint.endswith("_Q4") else 0.0 for joint in agent.moving_joints])
    ease = weight, np.full_like(weight, AT_EASE)
    motion = track(
        agent.model, person.markers, person.targets, lower=lower, upper=upper, start=agent.posture, ease=ease
    )
    q, v, a = angles_and_rates(smooth.time, motion.q, smooth.rate, cutoff, lower, upper)
    trajectory = agent_trajectory(agent, q, v, a, force)
    lifts, several = lift_spans(smooth.time, lifted)
    notes = [*smooth.notes, *lacking, *outlier_notes(smooth, taken.outliers), *lost, *several]
    pressure = trajectory.centre_of_pressure
    notes += whole_findings(taken, found, scaled, person, motion, trajectory, mapping)
    return assembled_lift(
        taken,
        smooth,
        cutoff,
        scaled,
        scaled.lengths.links,
        person,
        motion,
        trajectory,
        lifted,
        force_from=force_from,
        elbow_flexion=found.elbow_flexion[:, 0],
        lifts=lifts,
        notes=notes,
        whole=RecordedWhole(
            grasp_position=trajectory.grasp_position,
            grasp_force=trajectory.grasp_force,
            centre_of_pressure=np.full_like(trajectory.load, np.nan) if pressure is None else pressure,
            plate_centre=plate_centre(smooth, person.world),
            elbow_flexion=found.elbow_flexion,
            knee_flexion=found.knee_flexion,
            left=scaled.lengths.left,
            ankle=scaled.lengths.ankle,
            knee=scaled.lengths.knee,
            hip=scaled.lengths.hip,
            ahead=scaled.lengths.ahead,
        ),
    )
