"""What a recording of a whole person shows that the model does not, and what was left aside."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from liftopt.lab.mocap.recorded_lift import rms
from liftopt.lab.mocap.taken_markers import TakenMarkers
from liftopt.lab.mocap.tracking import TrackedMotion
from liftopt.lab.mocap.whole_map import SIDES, WholeMap
from liftopt.lab.mocap.whole_person import WholePerson
from liftopt.lab.mocap.whole_scaling import ScaledWhole
from liftopt.lab.mocap.whole_skeleton import WholeSkeleton, foot_travel
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.types import Array


def whole_findings(
    taken: TakenMarkers,
    found: WholeSkeleton,
    scaled: ScaledWhole,
    person: WholePerson,
    motion: TrackedMotion,
    trajectory: AgentTrajectory,
    mapping: WholeMap,
) -> list[str]:
    """Return what a user should know of a recording beside its numbers, one sentence each."""
    notes = []
    if taken.unused:
        notes.append(f"{len(taken.unused)} markers are not mapped and not used: {', '.join(taken.unused[:20])}")
    if taken.recording.analog is not None:
        notes.append(f"{len(taken.recording.analog.labels)} analog channels are not converted to forces")
    notes += [*_legs(found, person), *_centres(found, mapping), *_trunk(found, person), *_shoulders(found)]
    if scaled.estimated:
        each = ", ".join(f"{name} {value:.2f}" for name, value in scaled.stature_by.items())
        notes.append(f"the stature is estimated from segments ({each} m)")
    notes += [f"no marker shows {joint}: it is held at its comfortable angle" for joint in person.held]
    for joint, count in zip(trajectory.joint_names, motion.at_limit.sum(axis=0), strict=True):
        if count:
            notes.append(f"{joint} is at the limit of its range in {count} of {len(motion.q)} frames")
    for side, shown in zip(SIDES, found.elbow_flexion.T, strict=True):
        of_model = -trajectory.q[:, trajectory.joint_names.index(f"{trajectory.name}_{side}_Q7")]
        notes.append(_off(f"{side} elbow flexion", of_model - shown))
    knee = trajectory.q[:, trajectory.joint_names.index(f"{trajectory.name}_knee")]
    notes.append(_off("knee flexion", knee - found.knee_flexion.mean(axis=1), "the mean of both legs"))
    pressure, stance = trajectory.centre_of_pressure, trajectory.stance
    if pressure is not None and stance is not None:
        back, front, aside = stance.soles[0]
        outside = (pressure[:, 0] < back) | (pressure[:, 0] > front) | (np.abs(pressure[:, 1]) > aside)
        if outside.any():
            notes.append(
                f"the centre of pressure that the model's motion asks for is off its soles in {outside.sum()} of "
                f"{len(pressure)} frames, x from {np.nanmin(pressure[:, 0]):.3f} to {np.nanmax(pressure[:, 0]):.3f} m "
                f"(soles from {back:.3f} to {front:.3f})"
            )
    return notes


def _legs(found: WholeSkeleton, person: WholePerson) -> Iterator[str]:
    flexion = np.degrees(found.knee_flexion)
    apart = flexion[:, 0] - flexion[:, 1]
    right, left = (person.world.place(np.nanmedian(found.centres.joint[side, "ankle"], axis=0)) for side in SIDES)
    first, ahead = ("right", right[0] - left[0]) if right[0] >= left[0] else ("left", left[0] - right[0])
    yield (
        f"both legs are followed as one: the right knee bends {np.nanmean(apart):+.1f} deg more than the left on "
        f"average, they differ by {np.nanmax(np.abs(apart)):.1f} deg at most; the {first} foot stands "
        f"{100 * ahead:.1f} cm ahead of the other, the ankles {100 * abs(right[1] - left[1]):.1f} cm apart sideways"
    )
    away = ", ".join(f"{side} {1000 * np.nanmax(foot_travel(found.centres, side)):.0f} mm" for side in SIDES)
    rise = ", ".join(f"{side} {1000 * _rise(found.centres.joint[side, 'ankle'][:, 2]):.0f} mm" for side in SIDES)
    yield f"the feet are taken to stand: ankles move along the floor by up to {away} and rise by up to {rise}"
    floor = 1000.0 * person.world.translation[2]
    yield (
        f"the floor is {abs(floor):.0f} mm {'below' if floor > 0.0 else 'above'} the recording's zero of height: as "
        "far below the ankles as the stature implies"
    )
    sway = 1000.0 * person.sway
    yield (
        f"the hips sway sideways from {sway.min():+.0f} to {sway.max():+.0f} mm from over the ankles (left is "
        "positive), which legs in one plane cannot: this is taken off all markers above them"
    )


def _centres(found: WholeSkeleton, mapping: WholeMap) -> Iterator[str]:
    one_sided = [
        name
        for name in ("knee", "ankle", "elbow")
        if not (mapping.landmark(name, "right") or mapping.landmark(f"{name}_medial", "right"))
    ]
    if one_sided:
        yield (
            f"{', '.join(one_sided)}: a marker on the outer side only; the centre is half a mean breadth of the "
            "person's sex inwards"
        )
    for name, (right, left) in found.by_side.items():
        if np.isfinite([right, left]).all():
            where = "; in the model's plane " + f"{found.lengths[name]:.3f} m" if name in ("thigh", "shank") else ""
            yield f"{name.replace('_', ' ')}: right {right:.3f}, left {left:.3f} m{where}"


def _trunk(found: WholeSkeleton, person: WholePerson) -> Iterator[str]:
    if not found.centres.has_pelvis:
        yield "no marker shows how the pelvis is inclined: it goes along with the trunk"
        return
    how = "as it is while standing" if found.stands else "a mean of people, as nobody stands upright in the trial"
    yield f"the pelvis counts as upright at an inclination of {np.degrees(found.pelvic_tilt):.1f} deg ({how})"
    forward, aside = found.axes["pelvis"].rotation[:, :, 0], found.axes["pelvis"].rotation[:, :, 1]
    yaw = np.degrees(np.unwrap(np.arctan2(forward[:, 1], forward[:, 0])))
    roll = np.degrees(np.arcsin(np.clip(aside[:, 2], -1.0, 1.0)))
    turned, rolled = (np.ptp(angle[np.isfinite(angle)]) for angle in (yaw, roll))
    yield (
        f"the pelvis turns by {turned:.1f} deg in heading and {rolled:.1f} in roll, which the model's legs cannot: its "
        "trunk takes them"
    )


def _shoulders(found: WholeSkeleton) -> Iterator[str]:
    for side in SIDES:
        place = found.axes["trunk"].seen(found.centres.joint[side, "shoulder"])
        travel = 1000.0 * (np.nanmax(place, axis=0) - np.nanmin(place, axis=0))
        yield (
            f"the {side} shoulder's centre travels {travel[0]:.0f}, {travel[1]:.0f}, {travel[2]:.0f} mm in the trunk "
            "(forward, sideways, up); the model has no clavicle and keeps it at its mean"
        )


def _off(what: str, off: Array, of: str = "that") -> str:
    degrees = np.degrees(off)
    return (
        f"{what} of the model is off {of} between the joint centres of the markers by {rms(degrees):.1f} deg (rms), at "
        f"most {np.nanmax(np.abs(degrees)):.1f}"
    )


def _rise(height: Array) -> float:
    return float(np.nanmax(height) - np.nanmedian(height))
