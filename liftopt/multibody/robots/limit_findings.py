"""What is wrong with the limits of a robot's joints, and what was taken for those that it lacks."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees, isfinite

from liftopt.errors import NO_VALUE
from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.data_finding import DataFinding
from liftopt.multibody.robots.description import LARGEST_NUMBER, RobotJoint
from liftopt.multibody.robots.joint_ranges import JointRange

ENOUGH = 3  # joints from which one value for all of them looks like a placeholder
LARGEST_EFFORT = 1000.0  # of a joint that turns [Nm]: the largest arms that work beside people have 450
LARGEST_VELOCITY = 20.0  # [rad/s]: fast arms have 4 to 6
ROUNDING = 1e-6  # [rad, m]
WIDEST = 8.0 * 3.141592653589793  # [rad]: four turns


def limit_findings(chain: RobotChain) -> Iterator[DataFinding]:
    """Give what is wrong with position, velocity and effort of the joints that move, and what is assumed."""
    soft = [ends for ends in chain.ranges if ends.source == "soft limits"]
    if soft:
        shown = ", ".join(f"{ends.joint.name} {ends.lower:.4g} to {ends.upper:.4g}" for ends in soft)
        message = f"within the limits, those of safety controllers hold: {shown}"
        yield DataFinding("range.soft", "assumed", "soft limits", NO_VALUE, message,
                          "give limits.JOINT.lower and .upper for others")  # fmt: skip
    for joint, ends in zip(chain.joints, chain.ranges, strict=True):
        yield from _range(joint, ends)
        yield from _largest(joint, "effort", joint.effort)
        yield from _largest(joint, "velocity", joint.velocity)
    turning = [joint for joint in chain.joints if joint.kind != "prismatic"]
    efforts = {joint.effort for joint in turning}
    if len(turning) >= ENOUGH and len(efforts) == 1 and (effort := turning[0].effort):
        message = f"the same on all {len(turning)} joints, it looks like a placeholder"
        yield DataFinding("effort.same", "warned", "effort", effort, message, _give("JOINT", "effort"))
    yield from _large("effort", turning, LARGEST_EFFORT, "the arms that work beside people have less")
    yield from _large("velocity", turning, LARGEST_VELOCITY, "no arm turns as fast")


def _large(name: str, joints: list[RobotJoint], from_here: float, message: str) -> Iterator[DataFinding]:
    """Give the joints whose limit is so large that it looks like a placeholder, all in one finding."""
    large = {joint.name: float(value) for joint in joints if (value := getattr(joint, name)) and value >= from_here}
    if large and all(isfinite(value) for value in large.values()):
        told = f"{message}, it looks like a placeholder: {', '.join(large)}"
        yield DataFinding(f"{name}.large", "warned", name, max(large.values()), told, _give("JOINT", name))


def _range(joint: RobotJoint, ends: JointRange) -> Iterator[DataFinding]:
    where, fix = f"joint {joint.name}: range", _give(joint.name, "lower and .upper")
    shown = f"{ends.lower:.4g} to {ends.upper:.4g}"
    if ends.source == "nothing":
        yield DataFinding("range.missing", "refused", where, NO_VALUE, f"a {joint.kind} joint needs one", fix)
    elif not (abs(ends.lower) <= LARGEST_NUMBER and abs(ends.upper) <= LARGEST_NUMBER):  # NaN is not, either
        yield DataFinding("range.value", "refused", where, shown, f"must be within {LARGEST_NUMBER:g}", fix)
    elif ends.lower > ends.upper:
        yield DataFinding("range.inverted", "refused", where, shown, "its lower end is above its upper end", fix)
    elif ends.lower == ends.upper:
        message = "it cannot move"
        yield DataFinding("range.empty", "refused", where, shown, message, f"{fix}, or lock it: locked.{joint.name}")
    elif joint.kind == "continuous":
        message = f"it turns without end; taken as {degrees(ends.lower):.0f} to {degrees(ends.upper):.0f} deg here"
        yield DataFinding("range.endless", "assumed", where, NO_VALUE, message, f"{fix} for another one")
    elif joint.kind != "prismatic" and ends.upper - ends.lower > WIDEST:
        yield DataFinding("range.wide", "warned", where, shown, "it is more than four turns", fix)
    if joint.soft_lower is not None and joint.soft_upper is not None and ends.source == "limits":
        lower, upper = joint.soft_lower, joint.soft_upper
        shown = f"{lower:.4g} to {upper:.4g}"
        if lower >= upper or lower >= ends.upper or upper <= ends.lower:
            message = "no part of its range lies between its soft limits, which are left aside"
            yield DataFinding("range.soft_outside", "warned", f"joint {joint.name}: soft limits", shown, message, fix)
        elif lower < ends.lower - ROUNDING or upper > ends.upper + ROUNDING:
            message = "they lie outside its limits, which hold"
            yield DataFinding("range.soft_wider", "assumed", f"joint {joint.name}: soft limits", shown, message,
                              f"{fix} for others")  # fmt: skip


def _largest(joint: RobotJoint, name: str, value: float | None) -> Iterator[DataFinding]:
    where = f"joint {joint.name}: {name}"
    if value is None:
        yield DataFinding(f"{name}.missing", "refused", where, NO_VALUE, "the URDF has none", _give(joint.name, name))
    elif not 0.0 < value <= LARGEST_NUMBER:
        message = f"must be positive, and at most {LARGEST_NUMBER:g}"
        yield DataFinding(f"{name}.value", "refused", where, value, message, _give(joint.name, name))


def _give(joint: str, name: str) -> str:
    return f"give limits.{joint}.{name} from the maker's data sheet"
