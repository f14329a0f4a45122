"""The person of a recording as a model: measured lengths, feet that may move, markers on the links."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.lab.mocap.anatomy import Skeleton
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.scaling import ScaledSubject, measured_chain
from liftopt.lab.mocap.tracking import TrackedMarker
from liftopt.multibody.agent import Agent, Grasp, JointLimits
from liftopt.multibody.person.human import (
    NAME,
    VIRTUAL,
    chain_urdf,
    human_chain,
    human_limits,
    joint_bounds,
    placed_shapes,
)
from liftopt.multibody.person.range_of_motion import RANGES
from liftopt.multibody.urdf import HELD, joint_name, load_model
from liftopt.types import Array

# How far the base of the spine may move from where it is while standing [m], and how fast [m/s]: to squat and to walk.
BASE_TRAVEL, BASE_SPEED = 20.0, 5.0
SPINE_BASE = "spine base (pelvis)"
# The row of Table 2 whose link carries each segment's markers.
CARRIER = {"trunk": "Q3", "upper_arm": "Q6", "forearm": "Q8", "hand": "Q10"}


@dataclass(frozen=True)
class WorldFrame:
    """How the world of liftopt lies in the recording's metres with Z up: turned about Z, then shifted.

    Attributes:
        rotation: (3, 3) R_world_recording.
        translation: (3,) [m].
    """

    rotation: Array
    translation: Array

    def place(self, points: Array) -> Array:
        """Return points (..., 3) of the recording in the world [m]."""
        return points @ self.rotation.T + self.translation


@dataclass(frozen=True)
class RecordedPerson:
    """The person's model and what it is to follow.

    Attributes:
        agent: with all 13 joints moving; GT1 to GT3 carry the base of the spine along with the pelvis.
        world: where the recording lies: X is where the pelvis faces on average, the origin is on the ground under the
            base of the spine while standing. The ground is L1 below it: the recording's own zero of height is not used.
        markers: on the model; the first one is the base of the spine, carried by the markers of the pelvis.
        targets: (F, M, 3) their places in the world [m].
    """

    agent: Agent
    world: WorldFrame
    markers: tuple[TrackedMarker, ...]
    targets: Array


def recorded_person(recording: Recording, found: Skeleton, scaled: ScaledSubject) -> RecordedPerson:
    """Return the model of the person with the markers on it, and where these were."""
    agent = _agent(scaled)
    model, lengths = agent.model, scaled.lengths
    data = model.createData()
    pin.forwardKinematics(model, data, np.zeros(model.nq))
    base = np.array([0.0, 0.0, lengths.l1])
    shoulder = base + np.array([0.0, -lengths.l3, lengths.l2])
    elbow = shoulder - np.array([0.0, 0.0, lengths.l4])
    wrist = elbow - np.array([0.0, 0.0, lengths.l5])
    # Where each segment's anatomical frame is in the world when all joints are zero; its axes are those of the world.
    origins = {"trunk": base - scaled.spine_base, "upper_arm": shoulder, "forearm": elbow, "hand": wrist}

    followed = _spine_base(found, scaled)
    c, s = np.cos(found.heading), np.sin(found.heading)
    rotation = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    world = WorldFrame(rotation, base - rotation @ np.nanmean(followed[found.upright], axis=0))

    carrier = model.getJointId(joint_name(NAME, VIRTUAL[-1]))
    markers = [TrackedMarker(SPINE_BASE, carrier, data.oMi[carrier].actInv(base))]
    targets = [world.place(followed)]
    for name, row in CARRIER.items():
        segment, joint = found.segments[name], model.getJointId(joint_name(NAME, row))
        for label, place in zip(segment.labels, found.frames[name].seen(segment.shape), strict=True):
            markers.append(TrackedMarker(label, joint, data.oMi[joint].actInv(origins[name] + place)))
            targets.append(world.place(recording.points[:, recording.index(label)]))
    return RecordedPerson(agent, world, tuple(markers), np.stack(targets, axis=1))


def _spine_base(found: Skeleton, scaled: ScaledSubject) -> Array:
    """Return (F, 3) the base of the spine, fixed to the pelvis where the trunk has it while standing [m]."""
    trunk, pelvis, frame = found.segments["trunk"].poses, found.segments["pelvis"].poses, found.frames["trunk"]
    seen_by_trunk = trunk.to_world(frame.origin + frame.rotation @ scaled.spine_base)
    return pelvis.to_world(np.nanmean(pelvis.to_body(seen_by_trunk)[found.upright], axis=0))


def _agent(scaled: ScaledSubject) -> Agent:
    arm = human_limits(scaled.subject.sex)
    limits = JointLimits(
        q_lower=np.concatenate([np.full(3, -BASE_TRAVEL), arm.q_lower]),
        q_upper=np.concatenate([np.full(3, BASE_TRAVEL), arm.q_upper]),
        velocity=np.concatenate([np.full(3, BASE_SPEED), arm.velocity]),
        tau_lower=np.concatenate([np.full(3, -HELD.effort), arm.tau_lower]),
        tau_upper=np.concatenate([np.full(3, HELD.effort), arm.tau_upper]),
    )
    rows = (*VIRTUAL, *(item.joint for item in RANGES))
    # Shapes are the subject's own: they are only looked at.
    shapes = placed_shapes(human_chain(scaled.subject), scaled.subject)
    text = chain_urdf(measured_chain(scaled), joint_bounds(rows, limits), shapes)
    hand = f"{NAME}_grasp"
    return Agent(NAME, "person", text, load_model(text), (), (Grasp(NAME, hand),), (hand,), limits, np.zeros(len(rows)))
