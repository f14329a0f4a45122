"""The recorded lift put together from what its markers, its subject and its tracked motion say."""

from __future__ import annotations

from collections.abc import Sequence

from liftopt.lab.mocap.loads import plate_force
from liftopt.lab.mocap.object_motion import ObjectMotion
from liftopt.lab.mocap.recorded_lift import RecordedLift, RecordedWhole
from liftopt.lab.mocap.recorded_person import RecordedPerson
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.scaling import ScaledSubject
from liftopt.lab.mocap.taken_markers import TakenMarkers
from liftopt.lab.mocap.tracking import TrackedMotion
from liftopt.lab.mocap.whole_scaling import ScaledWhole
from liftopt.multibody.person.anthropometry import LinkLengths
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array


def assembled_lift(
    taken: TakenMarkers,
    smooth: Recording,
    cutoff: float,
    scaled: ScaledSubject | ScaledWhole,
    lengths: LinkLengths,
    person: RecordedPerson,
    motion: TrackedMotion,
    trajectory: AgentTrajectory,
    lifted: ObjectMotion | None,
    *,
    force_from: str,
    elbow_flexion: Array,
    lifts: tuple[tuple[float, float], ...],
    notes: Sequence[str],
    whole: RecordedWhole | None = None,
) -> RecordedLift:
    """Return the recorded lift.

    Args:
        taken: markers that were used.
        smooth: these, filtered.
        cutoff: of the filter [Hz].
        scaled: the subject.
        lengths: L1 to L6 of the recorded motion.
        person: the model that was tracked.
        motion: as tracked.
        trajectory: with rates and torques.
        lifted: how the object moved; None without one.
        force_from: where the hands' force is from.
        elbow_flexion: (K,) between the joint centres of the markers [rad].
        lifts: when the object is carried.
        notes: findings.
        whole: what only a whole person has.
    """
    return RecordedLift(
        source=smooth.source,
        rate=smooth.rate,
        cutoff=cutoff,
        subject=scaled.subject,
        stature_estimated=scaled.estimated,
        stature_by=scaled.stature_by,
        lengths=lengths,
        urdf=person.agent.urdf,
        joint_names=trajectory.joint_names,
        time=smooth.time,
        q=trajectory.q,
        v=trajectory.v,
        a=trajectory.a,
        tau=trajectory.tau,
        hand_position=trajectory.p_world_hold,
        hand_force=trajectory.load,
        force_from=force_from,
        ground_force=trajectory.ground_force,
        ground_moment=trajectory.ground_moment,
        plate_force=plate_force(smooth, person.world),
        markers=tuple(marker.label for marker in person.markers),
        residual=motion.residual,
        elbow_flexion=elbow_flexion,
        object_position=lifted.position if lifted else None,
        object_quaternion=lifted.quaternion if lifted else None,
        carried=lifts[0] if len(lifts) == 1 else None,
        gaps=taken.gaps,
        notes=tuple(notes),
        lifts=lifts,
        whole=whole,
    )
