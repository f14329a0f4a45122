"""Grasp forces with the load share (Fig. 15, and the same for the robot), ground reaction, the object's motion."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.solution.grasp_loads import shares
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_style import FAINT, INK, LINES, VERMILION, draw, legend_above, panels, percent, time_axes

COMPONENTS = ("x, towards the robot", "y, to the person's left", "z, up")


def grasp_forces(lift: Lift) -> Figure:
    """Return the force of person and robot on the object by component, and each one's share of the load."""
    solution = lift.dense
    moments = [agent for agent in solution.agents if agent.grasp.moments]
    figure, grid = panels(3 + bool(moments), height=1.75)
    human, robot, share = (line[0] for line in grid[:3])
    cap = solution.scenario.limits.max_grasp_force
    for axes, agent in zip((human, robot), solution.agents, strict=True):
        _components(axes, lift, agent, cap)
    lows, highs = zip(human.get_ylim(), robot.get_ylim(), strict=True)
    for axes in (human, robot):  # one scale for both
        axes.set_ylim(min(lows), max(highs))
        legend_above(axes, 4)
    for agent, part, line in zip(solution.agents, shares(solution.agents), LINES, strict=False):
        draw(share, solution.time, 100 * part, line, agent.name, lift.factor)
    share.axhline(50.0, color=FAINT, linewidth=0.8, zorder=1)
    low, high = share.get_ylim()
    share.set_ylim(min(low, 0.0), max(high, 100.0))
    share.set(title="Load share: part of the vertical grasp force", ylabel="share of the load [%]")
    legend_above(share, 2)
    if low >= 0.0 and high <= 100.0:
        share.set_yticks(range(0, 101, 25))
    if moments:
        _moments(grid[3][0], lift, moments)
    time_axes(grid, float(solution.time[-1]))
    return figure


def ground_reaction(lift: Lift) -> Figure:
    """Return what the ground does to the person: force, and moment at the feet."""
    solution = lift.dense
    figure, grid = panels(2, height=1.4)
    force, moment = (line[0] for line in grid)
    change = solution.ground_reaction_force.copy()
    change[:, 2] -= change[0, 2]
    weight = float(solution.ground_reaction_force[0, 2])
    for i, (axis, line) in enumerate(zip("xyz", LINES, strict=False)):
        extra = f" less {weight:.0f} N at rest" if axis == "z" else ""
        draw(force, solution.time, change[:, i], line, axis + extra, lift.factor)
        label = ("about x (sideways)", "about y (forward)", "about z (twist)")[i]
        draw(moment, solution.time, solution.ground_reaction_moment[:, i], line, label, lift.factor)
    force.set(title="Ground reaction force on the person", ylabel="force [N]")
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
    limits = solution.scenario.limits
    for column, line, name, limit in (
        (4, LINES[0], "pitch, + the robot's side down", limits.table_pitch_deg),
        (5, LINES[1], "yaw, + to the person's left", limits.table_yaw_deg),
    ):
        draw(turn, solution.time, np.degrees(pose[:, column]), line, f"{name} (limit ±{limit:g})", lift.factor)
    turn.set(title="Tilt", ylabel="angle [deg]")
    turn.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1)
    legend_above(turn, 2, 0.3)
    draw(speed, solution.time, np.linalg.norm(solution.object.velocity[:, :3], axis=1), LINES[0], knots=lift.factor)
    speed.set(title="Speed of its centre of mass", ylabel="speed [m/s]")
    time_axes(grid, float(solution.time[-1]))
    return figure


def _moments(axes: Axes, lift: Lift, agents: list[AgentTrajectory]) -> None:
    for agent, line in zip(agents, LINES, strict=False):
        magnitude = np.linalg.norm(agent.grasp_moment, axis=1)
        draw(axes, lift.dense.time, magnitude, line, f"{agent.name} (cap {agent.grasp.max_moment:g} Nm)", lift.factor)
    axes.set(title=f"Moment of the hands on the {lift.dense.object.name}, magnitude", ylabel="moment [Nm]")
    legend_above(axes, 2)


def _components(axes: Axes, lift: Lift, agent: AgentTrajectory, cap: float) -> None:
    time = lift.dense.time
    for values, line, label in zip(agent.grasp_force.T, LINES, COMPONENTS, strict=False):
        draw(axes, time, values, line, label, lift.factor)
    magnitude = np.linalg.norm(agent.grasp_force, axis=1)
    axes.plot(percent(time), magnitude, color=INK, linewidth=0.9, label="magnitude")
    axes.axhline(0.0, color=FAINT, linewidth=0.8, zorder=1)
    if magnitude.max() > 0.6 * cap:
        axes.axhline(cap, color=VERMILION, linewidth=1.0, linestyle=(0, (6, 2)))
    axes.set_title(
        f"Force of the {'person' if agent.name == 'human' else agent.name} on the {lift.dense.object.name}: "
        f"at most {magnitude.max():.0f} N (cap {cap:g} N)"
    )
    axes.set_ylabel("force [N]")
