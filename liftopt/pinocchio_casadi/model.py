"""Conversion of a double-precision ``pinocchio.Model`` into the extension's model on casadi.SX."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio

from .extension import extension

try:
    from liftopt.errors import ModelError
except ImportError:  # the wheel of its own stands without liftopt

    class ModelError(ValueError):  # type: ignore[no-redef]
        """A model cannot be used here."""


class Model(extension.Model):  # type: ignore[misc]
    """Articulated rigid body model whose inertias and placements may be symbolic.

    ``Model(pinocchio_model)`` copies joints, inertias, placements, frames, armature and gravity, in the same order and
    with the same indices. ``Model(model)`` copies one of these. Assign SX-valued objects to entries of ``inertias`` and
    ``jointPlacements`` and to ``frames[i].placement`` to make one function of them.

    Raises:
        ModelError: a joint's type is not supported; the message names the joint, its type and the supported ones.
        TypeError: the argument is no model.
    """

    def __init__(self, clone: Any) -> None:
        if isinstance(clone, extension.Model):
            super().__init__(clone)
            return
        if not isinstance(clone, pinocchio.Model):
            raise TypeError(f"Model: expected a pinocchio.Model, got {type(clone).__name__}")
        super().__init__()
        self.name = clone.name
        for joint_id in range(1, clone.njoints):
            self._copy_joint(clone, joint_id)
        self._set_frames([_frame(frame) for frame in clone.frames])
        self.inertias[0] = extension.Inertia(clone.inertias[0])
        self.armature = np.asarray(clone.armature)
        self.gravity = extension.Motion(clone.gravity)

    def copy(self) -> Model:
        """Return an independent copy."""
        return Model(self)

    __copy__ = copy

    def _copy_joint(self, source: pinocchio.Model, joint_id: int) -> None:
        joint, name = source.joints[joint_id], source.names[joint_id]
        kind = joint.shortname()
        supported = extension._supported_joints()
        if kind not in supported:
            raise ModelError(
                f"model {source.name!r}: joint {name!r} is a {kind}, which pinocchio_casadi does not support; "
                f"supported are {', '.join(supported)}"
            )
        axis = joint.extract().axis if kind.endswith("Unaligned") else np.zeros(3)
        placement = extension.SE3(source.jointPlacements[joint_id])
        self._add_joint(int(source.parents[joint_id]), kind, np.asarray(axis), placement, name)
        self.inertias[joint_id] = extension.Inertia(source.inertias[joint_id])


def _frame(source: pinocchio.Frame) -> Any:
    return extension.Frame(
        source.name,
        source.parentJoint,
        source.parentFrame,
        extension.SE3(source.placement),
        int(source.type),
        extension.Inertia(source.inertia),
    )
