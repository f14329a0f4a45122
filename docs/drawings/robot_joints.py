"""The seven joints of Sawyer: axes, names and positive directions, in the posture that a search starts from."""

from __future__ import annotations

from math import radians

import numpy as np
import pinocchio as pin
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drawings.motions import Motion, fill, show
from drawings.stage import agents, bodies, default_lift, paint_bodies
from liftopt.multibody.joint_curves import robot_curves
from liftopt.types import Array
from liftopt.viz.outlines import VIEWS
from liftopt.viz.plots_style import BLUE

VIEW = {"Q1": "above", "Q3": "behind", "Q5": "behind", "Q7": "behind"}
TURN_DEG = 35.0
STICK = 0.16  # half the length of a drawn axis [m]


def robot_joints() -> Figure:
    """Return the arm with its axes, and a panel for every joint."""
    solution, robot = default_lift(), bodies()["robot"]
    figure = Figure(figsize=(8.6, 5.6))
    panels = figure.subplots(2, 4)
    figure.subplots_adjust(left=0.01, right=0.99, top=0.88, bottom=0.02, wspace=0.06, hspace=0.3)
    _axes_of_all(panels[0, 0])
    curves = robot_curves(solution["robot"], solution.scenario.agents["robot"].model)
    for axes, curve in zip(panels.flat[1:], curves, strict=True):
        title = (
            f"{curve.label}, arrow: +\nrange {curve.q_limits[0]:.0f} to {curve.q_limits[1]:.0f}\N{DEGREE SIGN}\n"
            f"torque \N{PLUS-MINUS SIGN}{curve.tau_limits[1]:.0f} Nm, speed {curve.v_limit:.0f}\N{DEGREE SIGN}/s"
        ).replace("-", "\N{MINUS SIGN}")
        show(axes, robot, _motion(curve.joint), title)
    return figure


def _rest() -> Array:
    rest = np.zeros(bodies()["robot"].model.nq)
    agent = agents()[1]
    for name, angle in zip(agent.moving_joints, agent.posture, strict=True):
        rest[agent.model.idx_qs[agent.model.getJointId(name)]] = angle
    return rest


def _motion(joint: str) -> Motion:
    body, rest, view = bodies()["robot"], _rest(), VIEW.get(joint, "right")
    data = body.model.createData()
    pin.framesForwardKinematics(body.model, data, rest)
    tip = np.array(data.oMf[body.model.getFrameId(agents()[1].grasps[0].frame)].translation)
    if joint == "Q7":  # about the tool's own axis: a point beside it
        tip += (0.0, 0.1, 0.0)
    x, y, z = tip
    window = {
        "above": (x - 0.25, x + 1.35, y - 1.0, y + 0.7),
        "behind": (-y - 0.65, -y + 0.65, z - 0.75, z + 0.75),
        "right": (x - 0.25, x + 1.35, z - 0.8, z + 0.8),
    }[view]
    return Motion(f"robot_{joint}", view, radians(TURN_DEG), rest, tip, window)


def _axes_of_all(axes: Axes) -> None:
    """Draw every joint's axis as a line through its origin; one along the line of sight is a ring."""
    body, rest = bodies()["robot"], _rest()
    data, view = body.model.createData(), VIEWS["right"]
    pin.forwardKinematics(body.model, data, rest)
    paint_bodies(axes, [(body, rest)], "right", lambda link, color: (0.9, 0.9, 0.91))
    for index, name in enumerate(agents()[1].moving_joints):
        place = data.oMi[body.model.getJointId(name)]
        origin, along = view[:2] @ place.translation, view @ place.rotation[:, 2]
        if abs(along[2]) > 0.7:
            axes.plot(*origin, "o", color=BLUE, markersize=7, markerfacecolor="white", markeredgewidth=1.6, zorder=7)
        else:
            ends = np.array([origin - STICK * along[:2], origin + STICK * along[:2]])
            axes.plot(*ends.T, color=BLUE, linewidth=1.2, linestyle=(0, (6, 1.5, 1.5, 1.5)), zorder=7)
        axes.annotate(name.removeprefix("robot_"), origin, xytext=((-9, 9) if index % 2 else (9, -13)),
                      textcoords="offset points", ha="center", fontsize=8,
                      fontweight="bold", color=BLUE, zorder=8)  # fmt: skip
    axes.set_title("axes, from the person's right\n(ring: along the line of sight)", fontsize=7.8, loc="center")
    fill(axes, (0.7, 2.35, 0.3, 1.75))
