"""A recorded lift: the motion of a person's joints and of the object, as markers showed it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.gaps import Gap
from liftopt.lab.mocap.marker_map import Labels
from liftopt.multibody.person.anthropometry import LinkLengths
from liftopt.multibody.person.subject import Subject
from liftopt.solution.interpolation import linear
from liftopt.types import Array


@dataclass(frozen=True)
class RecordedWhole:
    """What a record of a whole person has more than one of trunk and right arm; K frames.

    Attributes:
        grasp_position, grasp_force: (K, 2, 3) of right and left hand, and their forces on the object [m, N].
        centre_of_pressure: (K, 3) that the model's motion asks for; NaN where the ground would have to pull [m].
        plate_centre: (K, 3) of all force plates together, or None; NaN where they bear nothing [m].
        elbow_flexion, knee_flexion: (K, 2) right and left, between joint centres of the markers [rad].
        left: L1 to L6 with the left arm, measured.
        ankle, knee, hip: heights of the model's joints when upright [m].
        ahead: how far its trunk begins ahead of the hips [m].
    """

    grasp_position: Array
    grasp_force: Array
    centre_of_pressure: Array
    plate_centre: Array | None
    elbow_flexion: Array
    knee_flexion: Array
    left: LinkLengths
    ankle: float
    knee: float
    hip: float
    ahead: float


@dataclass(frozen=True)
class RecordedLift:
    """A recorded lift in the terms of a solution: K frames, n joints, the world with X where the person faces.

    Of trunk and right arm n is 13: GT1 to GT3 follow the pelvis, and their forces are what the legs bear. Of a whole
    person it is 20.

    Attributes:
        source: the recording.
        rate, cutoff: frames a second, and the cut-off of the low-pass filter [Hz].
        subject: the person, for a prediction.
        stature_estimated: False if the stature was given.
        stature_by: stature that each segment implies [m].
        lengths: L1 to L6 of the model that was tracked, measured, with the right arm.
        urdf: that model.
        joint_names: (n,) ``human_GT1`` to ``human_Q10``, or ``human_ankle`` to ``human_left_Q10``.
        time: (K,) on the recording's clock [s].
        q, v, a, tau: (K, n) [rad or m, per s, per s^2, Nm or N].
        hand_position, hand_force: (K, 3) of ``human_grasp``, and its force on the object, world axes [m, N]; of a whole
            person the middle of both hands, and what they do together.
        force_from: where that force comes from, in words.
        ground_force, ground_moment: (K, 3) reaction of the ground that the model's motion asks for, at the foot origin;
            without a whole person its legs go along with the pelvis in one piece, so that it overstates what swaying
            and squatting take.
        plate_force: (K, 3) what force plates measured, world axes, or None [N].
        markers: (M,) labels of what was tracked.
        residual: (K, M) distance of each from the model's, NaN where not seen [m].
        elbow_flexion: (K,) of the right elbow between the joint centres that the markers show, without the model [rad].
        object_position, object_quaternion: (K, 3) [m] and (K, 4) x y z w since the first frame, or None.
        carried: time from and to which the object is away from where it lay [s]; None without an object, and where
            it is lifted several times until one lift is chosen.
        gaps: all gaps of the mapped markers.
        notes: what was repaired or left out, and what the model does not show.
        lifts: all such times, one for each lift [s].
        whole: what only a whole person has, or None.
    """

    source: str
    rate: float
    cutoff: float
    subject: Subject
    stature_estimated: bool
    stature_by: dict[str, float]
    lengths: LinkLengths
    urdf: str
    joint_names: tuple[str, ...]
    time: Array
    q: Array
    v: Array
    a: Array
    tau: Array
    hand_position: Array
    hand_force: Array
    force_from: str
    ground_force: Array
    ground_moment: Array
    plate_force: Array | None
    markers: Labels
    residual: Array
    elbow_flexion: Array
    object_position: Array | None
    object_quaternion: Array | None
    carried: tuple[float, float] | None
    gaps: tuple[Gap, ...]
    notes: tuple[str, ...]
    lifts: tuple[tuple[float, float], ...] = ()
    whole: RecordedWhole | None = None

    @property
    def body(self) -> str:
        """``"arm"`` or ``"whole"``, as a scenario's person has it."""
        return "whole" if self.whole else "arm"

    @property
    def residual_rms(self) -> Array:
        """(M,) root mean square residual of each marker [m]."""
        return np.array([rms(column) for column in self.residual.T])

    def over_lift(self, values: Array, samples: int = 101) -> Array:
        """Return ``values`` (K, ...) at ``samples`` times evenly spread over the lift: in normalised time.

        The lift is the time in which the object is carried, the whole recording if it has none.

        Raises:
            InputError: there are several lifts, and none was chosen.
        """
        if self.carried is None and len(self.lifts) > 1:
            shows = f"shows {len(self.lifts)} lifts, {self.lift_times()}: choose one by liftopt mocap --lift"
            raise InputError(self.source, NO_VALUE, shows)
        start, end = self.carried or (self.time[0], self.time[-1])
        rows = linear(self.time, values.reshape(len(self.time), -1), np.linspace(start, end, samples))
        return rows.reshape(samples, *values.shape[1:])

    def lift_times(self) -> str:
        """Return when each lift is, in words."""
        return ", ".join(f"{i} from {start:.2f} to {end:.2f} s" for i, (start, end) in enumerate(self.lifts, start=1))

    def of_lift(self, number: int) -> RecordedLift:
        """Return the same record with the lift of that number, counted from 1, as the one that counts.

        Raises:
            InputError: there is no such lift.
        """
        if not 1 <= number <= len(self.lifts):
            have = f"1 to {len(self.lifts)}: {self.lift_times()}" if self.lifts else "none: no object is lifted"
            raise InputError("--lift", number, f"{self.source} has the lifts {have}")
        return replace(self, carried=self.lifts[number - 1])


def rms(values: Array) -> float:
    """Return the root mean square of what is known of ``values``; NaN where nothing is."""
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else float("nan")
