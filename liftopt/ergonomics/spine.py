"""The load on the lumbar spine at L5/S1: what passes through a cut there, and a single equivalent muscle's share.

The net force and moment are exact for the model. Compression is an estimate: one muscle behind the disc bears the whole
moment of extension, one beside it the whole lateral moment, both pull along the disc's normal, and nothing pulls
against them (Chaffin 1969, as in NIOSH's guides). Pressure in the abdomen is left out, as it hardly unloads the spine
(McGill & Norman 1987). Co-contraction is left out too: it may add up to 45 % (Granata & Marras 1995). A muscle's lever
arm in such models is 0.05 to 0.075 m; the shorter one goes with the limit, the longer one makes its share a third less.
Shear is that of the net force: muscles that pull across the disc are not in the model.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.ergonomics.lift import Lift, R_world_person, model_of, subject_in
from liftopt.multibody.agent import Agent
from liftopt.multibody.disc import Lumbosacral
from liftopt.multibody.person.lumbar_levers import EXTENSOR, FLANK, FLEXOR
from liftopt.multibody.person.lumbosacral import UP, lumbosacral
from liftopt.multibody.sources import Source
from liftopt.multibody.trajectory import AgentTrajectory, cross, turned
from liftopt.types import Array

BASE = "Q1"  # first joint of the trunk; what carries it is the pelvis
SHEAR_LIMIT, SHEAR_FREQUENT = 1000.0, 700.0  # [N]
SHEAR_SOURCE = Source(
    "Gallagher & Marras (2012), Clin Biomech 27:973-978: 1000 N up to 100 times a day, 700 N up to 1000 times",
    "unverified",
)


@dataclass(frozen=True)
class SpineLoad:
    """What passes from pelvis to trunk through L5/S1 at K times; arrays (K,), along axes of the disc.

    Attributes:
        axial: net force along the disc's normal, pressing positive [N].
        shear: net force along the disc that pushes the trunk forward off the sacrum, positive to the front [N].
        side_shear: the same to the left [N].
        extension: net moment that the back bears, positive where it holds a trunk that would fall forward [Nm].
        lateral: net moment about the disc's forward axis, positive where it bends the trunk to the right [Nm].
        twist: net moment about the disc's normal, positive to the left [Nm].
    """

    axial: Array
    shear: Array
    side_shear: Array
    extension: Array
    lateral: Array
    twist: Array

    def compression_at(self, extensor: float) -> Array:
        """Return the compression (K,) [N] where the back's muscle has this lever arm [m]."""
        back = np.where(self.extension > 0.0, self.extension / extensor, -self.extension / FLEXOR)
        return np.asarray(self.axial + back + np.abs(self.lateral) / FLANK)

    @property
    def compression(self) -> Array:
        """Compression (K,) by the lever arms of this module [N]."""
        return self.compression_at(EXTENSOR)

    @property
    def shear_size(self) -> Array:
        """Magnitude (K,) of the shear, sideways too [N]."""
        return np.asarray(np.hypot(self.shear, self.side_shear))


def spine_load(lift: Lift, person: AgentTrajectory) -> SpineLoad:
    """Return the load on the lumbar spine of a person at every time of a lift, whatever the body below it."""
    upright = R_world_person(lift, person.name)
    return load_through(model_of(lift, person.name), person, upright, lumbosacral(subject_in(lift, person.name)))


def load_through(agent: Agent, person: AgentTrajectory, upright: Array, disc: Lumbosacral) -> SpineLoad:
    """Return the load on a person's disc.

    It is what the trunk's first joint transmits by RNEA, less what the object does to the hands, and what the part of
    the pelvis above the disc takes.

    Args:
        agent: the person's model.
        person: its motion and forces at K times.
        upright: (3, 3) forward, left and up in the world where the person stands upright.
        disc: where it is in the pelvis, and what lies above it there.
    """
    model, times = agent.model, len(person.q)
    data = model.createData()
    base = model.getJointId(f"{agent.name}_{BASE}")
    pelvis = model.parents[base]
    pin.forwardKinematics(model, data, pin.neutral(model))
    # The pelvis as a frame of its link: at the base of the spine, its axes forward, left and up.
    link_pelvis = data.oMi[pelvis].actInv(pin.SE3(upright, data.oMi[base].translation))
    above = link_pelvis.act(disc.between)
    wrench, place, axes = np.zeros((times, 6)), np.zeros((times, 3)), np.zeros((times, 3, 3))
    for k in range(times):
        pin.forwardKinematics(model, data, person.q[k])  # RNEA places no joint in the world
        pin.rnea(model, data, person.q[k], person.v[k], person.a[k])
        own = above * data.a_gf[pelvis] + data.v[pelvis].cross(above * data.v[pelvis])
        wrench[k] = (data.oMi[base].act(data.f[base]) + data.oMi[pelvis].act(own)).vector
        pose = data.oMi[pelvis] * link_pelvis
        axes[k], place[k] = pose.rotation, pose.act(-disc.below * UP)
    total = wrench[:, :3] + person.load
    hands = cross(person.grasp_position, person.grasp_force) + person.grasp_moment
    about_origin = wrench[:, 3:] + hands.sum(axis=1)
    in_pelvis = axes.swapaxes(1, 2)
    force_pelvis = turned(in_pelvis, total)
    moment_pelvis = turned(in_pelvis, about_origin - cross(place, total))
    return SpineLoad(
        axial=force_pelvis @ disc.normal,
        shear=-force_pelvis @ disc.forward,
        side_shear=-force_pelvis[:, 1],
        extension=-moment_pelvis[:, 1],
        lateral=moment_pelvis @ disc.forward,
        twist=moment_pelvis @ disc.normal,
    )
