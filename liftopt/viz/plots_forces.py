"""Grasp forces with the load share (Fig. 15, and the same for the robot), ground reaction, the object's motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from liftopt.assessment.who import hand_of, who_is
from liftopt.multibody.trajectory import AgentTrajectory, grasps_of
from liftopt.solution.grasp_loads import FREE_FALL, shares
from liftopt.types import Array
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import FAINT, INK, LINES, VERMILION, draw, legend_above, panels, percent, time_axes
from liftopt.viz.who import stand_opposite

# The axes of the world as a person and a robot see them who stand opposite each other, and for any others.
PAIRED = ("x, towards the robot", "y, to the person's left", "z, up")
COMPONENTS = ("x", "y", "z, up")


def grasp_forces(lift: Lift) -> Figure:
    """Return the force of each grasp on the object by component, and each one's share of the load."""
    solution = lift.dense
    agents, grasps = solution.agents, list(grasps_of(solution.agents))
    moments = any(grasp.moments for *_, grasp in grasps)
    figure, grid = panels(len(grasps) + 1 + moments, height=1.75)
    each, share = [line[0] for line in grid[: len(grasps)]], grid[len(grasps)][0]
    cap = solution.scenario.limits.max_grasp_force
    for axes, (_, agent, own, _) in zip(each, grasps, strict=True):
        _components(axes, lift, agent, own, cap)
    lows, highs = zip(*(axes.get_ylim() for axes in each), strict=True)
    for axes in each:  # one scale for all
        axes.set_ylim(min(lows), max(highs))
        legend_above(axes, 4)
    parts = _load_parts(agents)
    for i, (name, part) in enumerate(parts.items()):
        draw(share, solution.time, 100 * part, LINES[i % len(LINES)], name, lift.factor)
    share.axhline(100.0 / len(parts), color=FAINT, linewidth=0.8, zorder=1)
    low, high = share.get_ylim()
    share.set_ylim(min(low, 0.0), max(high, 100.0))
    share.set(title="Load share: part of the vertical grasp force", ylabel="share of the load [%]")
    legend_above(share, len(parts))
    if low >= 0.0 and high <= 100.0:
        share.set_yticks(range(0, 101, 25))
    if moments:
        _moments(grid[len(grasps) + 1][0], lift)
    time_axes(grid, float(solution.time[-1]))
    return figure


def _load_parts(agents: Sequence[AgentTrajectory]) -> dict[str, Array]:
    """Return the share of the load (K,) of each agent by name; of each hand of one who lifts alone."""
    if len(agents) > 1:
        return {agent.name: part for agent, part in zip(agents, shares(agents), strict=True)}
    (agent,) = agents
    total = np.where(np.abs(agent.load[:, 2]) < FREE_FALL, np.nan, agent.load[:, 2])
    return {grasp.name: agent.grasp_force[:, own, 2] / total for own, grasp in enumerate(agent.grasps)}


def ground_reaction(lift: Lift, agent: AgentTrajectory) -> Figure:
    """Return what the ground does to a person: force, and moment at the feet."""
    solution = lift.dense
    figure, grid = panels(2, height=1.4)
    force, moment = (line[0] for line in grid)
    change = agent.ground_force.copy()
    change[:, 2] -= change[0, 2]
    weight = float(agent.ground_force[0, 2])
    about = ("about x (sideways)", "about y (forward)", "about z (twist)")
    for i, (axis, line) in enumerate(zip("xyz", LINES, strict=False)):
        extra = f" less {weight:.0f} N at rest" if axis == "z" else ""
        draw(force, solution.time, change[:, i], line, axis + extra, lift.factor)
        label = about[i] if stand_opposite(solution.scenario) else about[i][:7]
        draw(moment, solution.time, agent.ground_moment[:, i], line, label, lift.factor)
    force.set(title=f"Ground reaction force on {who_is(agent, solution.agents).called}", ylabel="force [N]")
    moment.set(title="Ground reaction moment at the feet", ylabel="moment [Nm]")
    for axes in (force, moment):
        axes.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1)
        legend_above(axes, 3)
    time_axes(grid, float(solution.time[-1]))
    return figure


def object_motion(lift: Lift) -> Figure:
    """Return the object's height, its pitch and yaw, and its speed."""
    solution, pose = lift.dense, lift.dense.object.pose
    figure, grid = panels(3, height=1.1)
    height, turn, speed = (line[0] for line in grid)
    draw(height, solution.time, pose[:, 2], LINES[0], knots=lift.factor)
    height.set(title=f"Height of the {solution.object.name}'s centre of mass", ylabel="height of centre [m]")
    limits, paired = solution.scenario.limits, stand_opposite(solution.scenario)
    down, turned = ("the robot's side down", "to the person's left") if paired else ("the x side down", "from x to y")
    for column, line, name, limit in (
        (4, LINES[0], f"pitch, + {down}", limits.table_pitch_deg),
        (5, LINES[1], f"yaw, + {turned}", limits.table_yaw_deg),
    ):
        draw(turn, solution.time, np.degrees(pose[:, column]), line, f"{name} (limit ±{limit:g})", lift.factor)
    turn.set(title="Tilt", ylabel="angle [deg]")
    turn.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1)
    legend_above(turn, 2, 0.3)
    draw(speed, solution.time, np.linalg.norm(solution.object.velocity[:, :3], axis=1), LINES[0], knots=lift.factor)
    speed.set(title="Speed of its centre of mass", ylabel="speed [m/s]")
    time_axes(grid, float(solution.time[-1]))
    return figure


def _moments(axes: Axes, lift: Lift) -> None:
    turning = [entry for entry in grasps_of(lift.dense.agents) if entry[-1].moments]
    for g, agent, own, grasp in turning:
        line, label = LINES[g % len(LINES)], f"{grasp.name} (cap {grasp.max_moment:g} Nm)"
        draw(axes, lift.dense.time, np.linalg.norm(agent.grasp_moment[:, own], axis=1), line, label, lift.factor)
    axes.set(title=f"Moment of the hands on the {lift.dense.object.name}, magnitude", ylabel="moment [Nm]")
    legend_above(axes, len(turning))


def _components(axes: Axes, lift: Lift, agent: AgentTrajectory, own: int, cap: float) -> None:
    time, force = lift.dense.time, agent.grasp_force[:, own]
    called = who_is(agent, lift.dense.agents).called
    if len(agent.grasps) > 1:
        called = f"the {hand_of(agent.grasps[own].name, who_is(agent, lift.dense.agents))} of {called}"
    labels = PAIRED if stand_opposite(lift.dense.scenario) else COMPONENTS
    for values, line, label in zip(force.T, LINES, labels, strict=False):
        draw(axes, time, values, line, label, lift.factor)
    magnitude = np.linalg.norm(force, axis=1)
    axes.plot(percent(time), magnitude, color=INK, linewidth=0.9, label="magnitude")
    axes.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1)
    if magnitude.max() > 0.6 * cap:
        axes.axhline(cap, color=VERMILION, linewidth=1.0, linestyle=(0, (6, 2)))
    axes.set_title(
        f"Force of {called} on the {lift.dense.object.name}: at most {magnitude.max():.0f} N (cap {cap:g} N)"
    )
    axes.set_ylabel("force [N]")
