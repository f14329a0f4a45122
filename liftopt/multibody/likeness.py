"""Whether a model is the one expected, or another's: two of one kind differ in no more than small numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

# As far as models of one person or robot may differ, which two versions of a description make.
PLACE = 0.01  # [m] of a joint, frame or centre of mass on the body that carries it
TURN = 0.02  # [rad] likewise
MASS = 0.05  # of a body, as a share of its own
LIGHT = 0.05  # [kg] of a body, which may come on top


def difference(model: pin.Model, expected: pin.Model, frames: Sequence[str]) -> str:
    """Return the first thing in which a model is another than expected, in words; empty if it is the same.

    Args:
        model: to be judged.
        expected: what it should be.
        frames: names of the frames that matter; ``expected`` has them.
    """
    names, wanted = list(model.names)[1:], list(expected.names)[1:]
    for k, name in enumerate(wanted):
        if names[k : k + 1] != [name]:
            own = f"its joint {k + 1} is {names[k]}, not {name}" if k < len(names) else f"it has no joint {name}"
            return f"{own} ({len(names)} joints, not {len(wanted)})" if len(names) != len(wanted) else own
    if len(names) > len(wanted):
        return f"it has {len(names)} joints, not {len(wanted)}"
    for frame in frames:
        if not model.existFrame(frame):
            return f"it has no frame {frame}"
    for i, name in enumerate(wanted, start=1):
        if model.joints[i].shortname() != expected.joints[i].shortname() or model.parents[i] != expected.parents[i]:
            return f"its joint {name} is of another kind, or on another body"
        if found := moved(model.jointPlacements[i], expected.jointPlacements[i]):
            return f"its joint {name} is {found}"
    for frame in frames:
        own, other = (each.frames[each.getFrameId(frame)] for each in (model, expected))
        if own.parentJoint != other.parentJoint:
            return f"its frame {frame} is on another body"
        if found := moved(own.placement, other.placement):
            return f"its frame {frame} is {found}"
    for i, name in enumerate(["base", *wanted]):
        mass, other_mass = model.inertias[i].mass, expected.inertias[i].mass
        if abs(mass - other_mass) > MASS * other_mass + LIGHT:
            return f"its body at {name} has {mass:.2f} kg, not {other_mass:.2f} kg"
        off = float(np.linalg.norm(model.inertias[i].lever - expected.inertias[i].lever))
        if off > PLACE and other_mass > LIGHT:
            return f"its body at {name} has its centre of mass {off:.3f} m from where it should be"
    return ""


def moved(placement: pin.SE3, expected: pin.SE3) -> str:
    """Return how far a placement is from where it should be, in words; empty if it is there."""
    away = float(np.linalg.norm(placement.translation - expected.translation))
    turned = float(np.linalg.norm(pin.log3(expected.rotation.T @ placement.rotation)))
    if away <= PLACE and turned <= TURN:
        return ""
    return f"{away:.3f} m and {np.degrees(turned):.0f} deg from where it should be"
