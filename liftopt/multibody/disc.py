"""A cut through an agent's trunk at a disc, and what presses there: exact axial force and moments, and muscles.

Three joints that never move, put at the cut, transmit what passes there: one that would slide along the disc's normal
the axial force, two that would turn about its axes the lateral and the extending moment. So whatever knows the
generalised forces of a tree, and their derivatives, knows these too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.types import Array

CUT_JOINTS = 3  # axial force pressing positive [N], lateral moment to the right, moment that extends [Nm]
ROUNDED = 1e-9  # turns of a link's axes against the person's are by quarters; what is left of them is rounding


@dataclass(frozen=True)
class Lumbosacral:
    """The disc in the pelvis, whose axes are forward, left and up where the person stands upright.

    Attributes:
        below: distance of its centre below the base of the spine, where the trunk turns [m].
        normal: (3,) unit vector out of the sacrum's upper face.
        forward: (3,) unit vector along that face, to the front.
        between: what lies between it and the base of the spine; about the base of the spine, axes of the pelvis.
    """

    below: float
    normal: Array
    forward: Array
    between: pin.Inertia


@dataclass(frozen=True)
class Disc:
    """A disc that must not be pressed with more than so much.

    What presses is the axial force and what muscles beside it pull, each row of ``factors`` one choice of muscles: the
    largest of them counts.

    Attributes:
        joint: name of the joint that carries the trunk, at the base of the spine.
        upright: (3, 3) forward, left and up in the world where the agent stands upright.
        place: where the disc is in the link that carries that joint.
        factors: (m, 3) of axial force, lateral moment and extending moment [1, 1/m, 1/m].
        muscles: (m,) which muscles pull in each row.
        most: largest compression [N].
        unit: compression that counts as one [N].
    """

    joint: str
    upright: Array
    place: Lumbosacral
    factors: Array
    muscles: tuple[str, ...]
    most: float
    unit: float


def cut_model(model: pin.Model, disc: Disc) -> pin.Model:
    """Return a model with joints at a disc that never move, before the joint that carries the trunk.

    Their generalised forces, in the order of ``CUT_JOINTS``, are what passes there. The link that carried the trunk
    keeps what is below the disc. Frames keep their numbers.
    """
    base = int(model.getJointId(disc.joint))
    pelvis, data = int(model.parents[base]), model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    spine = model.jointPlacements[base].translation
    axes = np.asarray(data.oMi[pelvis].rotation.T @ disc.upright)
    axes = np.where(np.abs(axes - np.round(axes)) < ROUNDED, np.round(axes) + 0.0, axes)
    link_pelvis = pin.SE3(axes, spine)
    above = link_pelvis.act(disc.place.between)
    centre = pin.SE3(np.eye(3), link_pelvis.act(np.array([0.0, 0.0, -disc.place.below])))
    found, number = pin.Model(), {0: 0}
    found.gravity = model.gravity
    for j in range(1, model.njoints):
        parent, placement = number[int(model.parents[j])], model.jointPlacements[j]
        if j == base:
            normal, forward = axes @ disc.place.normal, axes @ disc.place.forward
            turns = (pin.JointModelRevoluteUnaligned(axis) for axis in (forward, -axes[:, 1]))
            for i, moving in enumerate((pin.JointModelPrismaticUnaligned(normal), *turns)):
                at = pin.SE3.Identity() if i else centre
                parent = found.addJoint(parent, moving, at, f"{disc.joint}_cut_{i}")
            found.appendBodyToJoint(parent, above, centre.inverse())
            placement = centre.inverse() * placement
        number[j] = found.addJoint(parent, model.joints[j], placement, model.names[j])
        body = model.inertias[j]
        if j == pelvis:
            left = body.toDynamicParameters() - above.toDynamicParameters()
            body = pin.Inertia.FromDynamicParameters(left)
        found.appendBodyToJoint(number[j], body, pin.SE3.Identity())
    for frame in list(model.frames)[1:]:
        found.addFrame(
            pin.Frame(frame.name, number[int(frame.parentJoint)], frame.parentFrame, frame.placement, frame.type), False
        )
    return found


def at_the_cut(model: pin.Model, joint: str) -> slice:
    """Return the places of the rates of the joints at the cut of a model that is cut before a joint."""
    first = int(model.idx_vs[model.getJointId(joint)])
    return slice(first - CUT_JOINTS, first)
