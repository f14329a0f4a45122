"""The ten joints of the person: which motion is positive, how far they go and how strong they are."""

from __future__ import annotations

from math import radians
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from matplotlib.figure import Figure

from drawings.motions import Motion, show
from drawings.stage import agents, bodies, default_lift
from liftopt.multibody.joint_curves import JointCurve, human_curves
from liftopt.types import Array


class Look(NamedTuple):
    """How one joint is looked at: in the posture ``rest`` [deg], the tracer off the wrist's end or the head [m]."""

    view: str
    turn_deg: float
    rest: dict[str, float]
    tracer: tuple[float, float, float]
    from_head: bool = False
    near: bool = False


BENT = {"Q7": -90.0}
LOOKS = {
    "Q1": Look("front", 25.0, {}, (0.0, 0.0, 0.16), from_head=True),
    "Q2": Look("right", 30.0, {}, (0.0, 0.0, 0.16), from_head=True),
    "Q3": Look("above", 35.0, BENT, (0.06, 0.0, 0.0)),
    "Q4": Look("front", 50.0, {}, (0.0, -0.08, -0.06)),
    "Q5": Look("right", 55.0, {}, (0.06, 0.0, -0.06)),
    "Q6": Look("above", 45.0, BENT, (0.08, 0.0, 0.0)),
    "Q7": Look("right", 75.0, {}, (0.06, 0.0, -0.06)),
    "Q8": Look("front", 70.0, BENT, (0.0, -0.11, 0.0), near=True),
    "Q9": Look("right", 45.0, {}, (0.04, 0.0, -0.09), near=True),
    "Q10": Look("front", 28.0, {}, (0.0, -0.03, -0.1), near=True),
}


def person_joints() -> Figure:
    """Return ten panels; the motion shown is the one that an anatomist counts as positive."""
    person, solution = bodies()["human"], default_lift()
    who = solution.scenario.agents["human"]
    figure = Figure(figsize=(8.6, 6.6))
    panels = figure.subplots(2, 5)
    figure.subplots_adjust(left=0.01, right=0.99, top=0.86, bottom=0.02, wspace=0.08, hspace=0.36)
    for axes, curve in zip(panels.flat, human_curves(solution["human"]), strict=True):
        sign = -1 if "\N{MINUS SIGN}" in curve.label else +1
        show(axes, person, _motion(curve.joint, sign), _title(curve, sign))
    figure.suptitle(
        f"Joints of the person ({who.sex}, {who.stature:g} m): the arrow is "
        "the positive motion in plots and reports",
        fontsize=9.5, y=0.985,
    )  # fmt: skip
    return figure


def _title(curve: JointCurve, sign: int) -> str:
    low, high = (sign * edge for edge in curve.q_limits[::sign])  # in the signs of Table 2, as in solution.nc
    weak, strong = (sign * edge for edge in curve.tau_limits[::sign])
    words = curve.label.partition(" (")[0]
    which = "+" if sign > 0 else "\N{MINUS SIGN}"
    return (
        f"{words}\n{curve.joint} {which}\nrange {_number(low)} to {_number(high)}\N{DEGREE SIGN}\n"
        f"torque {_number(weak)} to {_number(strong)} Nm"
    )


def _number(value: float) -> str:
    return f"{value + 0.0:.3g}".replace("-", "\N{MINUS SIGN}")


def _motion(joint: str, sign: int) -> Motion:
    look, body = LOOKS[joint], bodies()["human"]
    rest = np.zeros(body.model.nq)
    for name, degrees in look.rest.items():
        rest[body.model.idx_qs[body.model.getJointId(f"human_{name}")]] = radians(degrees)
    hand = _hand(rest)
    start = np.array([0.0, 0.0, 1.75]) if look.from_head else hand
    turn = sign * radians(look.turn_deg)
    return Motion(f"human_{joint}", look.view, turn, rest, start + look.tracer, _window(look, hand))


def _hand(q: Array) -> Array:
    model, data = bodies()["human"].model, bodies()["human"].model.createData()
    pin.framesForwardKinematics(model, data, q)
    return np.array(data.oMf[model.getFrameId(agents()[0].grasps[0].frame)].translation)


def _window(look: Look, hand: Array) -> tuple[float, float, float, float]:
    """Return what is shown: the whole upper body, or the forearm and hand."""
    if look.near:
        across = float(hand[0] if look.view == "right" else hand[1])
        return (across - 0.25, across + 0.25, float(hand[2]) - 0.17, float(hand[2]) + 0.35)
    if look.view == "above":
        return (-0.35, 0.6, -0.7, 0.55)
    return (-0.55, 0.65, 0.62, 2.0) if look.view == "right" else (-0.72, 0.5, 0.62, 2.0)
