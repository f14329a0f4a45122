"""The whole person of a recording as a model: measured lengths, markers on the links, feet that stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.lab.mocap.recorded_person import RecordedPerson, WorldFrame
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.rigid import were_seen
from liftopt.lab.mocap.tracking import TrackedMarker
from liftopt.lab.mocap.whole_centres import OUTWARD
from liftopt.lab.mocap.whole_map import SIDES, WholeMap
from liftopt.lab.mocap.whole_scaling import ScaledWhole
from liftopt.lab.mocap.whole_skeleton import WholeSkeleton
from liftopt.multibody.person.human import NAME
from liftopt.multibody.person.whole_body import whole_human_agent, whole_human_urdf
from liftopt.multibody.urdf import joint_name
from liftopt.types import Array

# The joint whose link carries each segment's markers; those of the arms stand after their side.
CARRIER = {"pelvis": "hip", "trunk": "Q3", "upper_arm": "Q6", "forearm": "Q8", "hand": "Q10"}
KNEES, HIPS = "knee centres", "hip centres"
# What shows the distal joint of a segment of the arm, where its markers do not show how it is turned.
DISTAL = {"upper_arm": "elbow", "forearm": "wrist", "hand": "knuckle"}


@dataclass(frozen=True)
class WholePerson(RecordedPerson):
    """The whole person's model and what it is to follow; the origin is on the ground midway between the ankles.

    Attributes:
        held: joints that no marker shows, held at their comfortable angle.
        sway: (F,) how far the middle of the hips is to the left of that of the ankles [m]: what legs that move in one
            plane cannot follow, and taken off all markers above them.
    """

    held: tuple[str, ...]
    sway: Array


def whole_person(recording: Recording, mapping: WholeMap, found: WholeSkeleton, scaled: ScaledWhole) -> WholePerson:
    """Return the model of the whole person with the markers on it, and where these were."""
    agent = whole_human_agent(scaled.subject, whole_human_urdf(scaled.subject, measured=scaled.lengths))
    model, lengths = agent.model, scaled.lengths
    data = model.createData()
    pin.forwardKinematics(model, data, np.zeros(model.nq))
    centres = found.centres
    c, s = np.cos(found.heading), np.sin(found.heading)
    rotation = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    feet = np.nanmean(centres.middle("ankle"), axis=0)
    world = WorldFrame(rotation, np.array([0.0, 0.0, lengths.ankle]) - rotation @ feet)
    sway = _filled(world.place(centres.pelvis.origin)[:, 1])
    aside = np.stack([0.0 * sway, sway, 0.0 * sway], axis=1)
    markers, targets = [], []

    def follow(label: str, joint: str, at_zero: Array, seen: Array) -> None:
        """Add a marker on a joint's link: where it is in the world when all joints are zero, and where it was."""
        number = model.getJointId(joint_name(NAME, joint))
        markers.append(TrackedMarker(label, number, data.oMi[number].actInv(at_zero)))
        targets.append(world.place(seen) - aside)

    def flat(points: Array) -> Array:
        """Return points in the plane of the hips' middle: both legs move as one."""
        off = world.place(points)[:, 1] - sway
        return np.asarray(points - off[:, None] * rotation[1])

    follow(KNEES, "ankle", np.array([0.0, 0.0, lengths.knee]), flat(centres.middle("knee")))
    follow(HIPS, "knee", np.array([0.0, 0.0, lengths.hip]), flat(centres.middle("hip")))
    segments, origins = mapping.by_segment(), _origins(scaled)
    for name, origin in origins.items():
        side, _, part = name.rpartition(" ")
        joint = f"{side}_{CARRIER[part]}" if side else CARRIER[part]
        placed = 0
        for label in segments.get(name.replace("_", " "), ()):
            seen = recording.points[:, recording.index(label)]
            local = found.axes[name].seen(seen)
            if were_seen(local).any():
                follow(label, joint, origin + local[were_seen(local)].mean(axis=0), seen)
                placed += 1
        centre = centres.joint.get((side, DISTAL.get(part, "")))
        if not placed and centre is not None and were_seen(centre).any():
            length = lengths.limbs[joint]
            follow(f"{side} {DISTAL[part]}", joint, origin - np.array([0.0, 0.0, length]), centre)
        if part == "trunk" and not placed:
            for one in SIDES:
                follow(f"{one} shoulder", joint, origins[f"{one} upper_arm"], centres.joint[one, "shoulder"])
    return WholePerson(agent, world, tuple(markers), np.stack(targets, axis=1), _held(found), sway)


def _origins(scaled: ScaledWhole) -> dict[str, Array]:
    """Return where each segment's axes are in the world when all joints are zero; they are those of the world."""
    lengths = scaled.lengths
    base = np.array([lengths.ahead, 0.0, lengths.links.l1])
    origins = {"pelvis": np.array([0.0, 0.0, lengths.hip]), "trunk": base - scaled.spine_base}
    for side, links in lengths.arms.items():
        outward = OUTWARD[side]
        shoulder = base + np.array([0.0, outward * links.l3, links.l2])
        elbow = shoulder - np.array([0.0, 0.0, links.l4])
        origins |= {
            f"{side} upper_arm": shoulder,
            f"{side} forearm": elbow,
            f"{side} hand": elbow - np.array([0.0, 0.0, links.l5]),
        }
    return origins


def _held(found: WholeSkeleton) -> tuple[str, ...]:
    """Return the joints that no marker shows: trunk and pelvis are one where these are not told apart."""
    held = [] if found.centres.has_pelvis else ["Q2"]
    for side in SIDES:
        if not were_seen(found.centres.across[side, "forearm"]).any():
            held.append(f"{side}_Q8")
        if not were_seen(found.centres.joint[side, "knuckle"]).any():
            held += [f"{side}_Q9", f"{side}_Q10"]
    return tuple(joint_name(NAME, joint) for joint in held)


def _filled(values: Array) -> Array:
    """Return values (F,) with unknown ones between those before and after; 0 where all are unknown."""
    known = np.flatnonzero(np.isfinite(values))
    if not known.size:
        return np.zeros_like(values)
    return np.asarray(np.interp(np.arange(len(values)), known, values[known]), float)
