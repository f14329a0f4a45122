"""All plots of a lift: what they are, and writing them as SVG, PNG or PDF."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from matplotlib import rc_context
from matplotlib.figure import Figure

from liftopt.assessment.who import listed, who_is
from liftopt.errors import InputError
from liftopt.multibody.agent import Kind
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.solution.solution import Solution
from liftopt.viz import FORMATS
from liftopt.viz.own_meshes import figures_of
from liftopt.viz.plots_clearance import clearance
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_effort import posture_score, strength_used
from liftopt.viz.plots_forces import grasp_forces, ground_reaction, object_motion
from liftopt.viz.plots_joints import human_angles, human_arm, human_torques, robot_angles, robot_torques
from liftopt.viz.plots_recorded import recorded_angles
from liftopt.viz.plots_snapshots import snapshots
from liftopt.viz.plots_spine import spine_load
from liftopt.viz.plots_standing import centre_of_pressure
from liftopt.viz.plots_style import STYLE, head
from liftopt.viz.robot_words import joint_words

PNG_DPI = 200


@dataclass(frozen=True)
class Plot:
    """One plot of a lift.

    Attributes:
        name: of its file.
        caption: what it shows, and which figure of the paper it is the predicted side of; in ``PLOTS``, ``{all}``
            stands for everybody in the lift.
        draw: makes it; call it in ``rc_context(STYLE)``.
        head: whom it is about, written above it where there are several of a kind.
    """

    name: str
    caption: str
    draw: Callable[[Lift], Figure]
    head: str = ""


@dataclass(frozen=True)
class AgentPlot:
    """One plot of each agent of a kind.

    Attributes:
        kind: of the agents.
        name: of its file where there is one of the kind only.
        what: end of the file's name where there are several, after the agent's.
        caption: as that of a plot; ``{who}`` stands for the agent, ``{signs}`` for those of a robot's joints.
        draw: makes that of one agent.
        standing: whether it is of those only who stand on soles.
    """

    kind: Kind
    name: str
    what: str
    caption: str
    draw: Callable[[Lift, AgentTrajectory], Figure]
    standing: bool = False

    def is_of(self, agent: AgentTrajectory) -> bool:
        """Return whether there is one of an agent."""
        return agent.kind == self.kind and (agent.stance is not None or not self.standing)


PLOTS: tuple[Plot | AgentPlot, ...] = (
    Plot(
        "snapshots",
        "The lift at five moments, as the playback shows it. Fig. 11 of the paper.",
        snapshots,
    ),
    AgentPlot(
        "person",
        "human_arm",
        "arm",
        "Shoulder and elbow flexion of {who}: angle and torque, flexion positive. Predicted side of Figs. 13 and "
        "14 of the paper.",
        human_arm,
    ),
    AgentPlot(
        "person",
        "human_angles",
        "angles",
        "All joint angles of {who} within their ranges of motion. Zero is upright, the arm hanging, palm forward.",
        human_angles,
    ),
    AgentPlot(
        "person",
        "recorded_angles",
        "recorded",
        "Angles of {who} by the height of the wrist, over a band around how one person lifted a box with two hands: "
        "mean and standard deviation of five lifts (AnyBody's repository), at least 5 deg to each side; a trend, no "
        "norm. The elbow's angle is that between upper arm and forearm, the upper arm's that from the trunk's downward "
        "axis.",
        recorded_angles,
    ),
    AgentPlot(
        "person",
        "human_torques",
        "torques",
        "All joint torques of {who} and how much of the strength they use.",
        human_torques,
    ),
    Plot(
        "grasp_forces",
        "Force of {all} on the object by component, world axes, and who carries how much of the load. Predicted "
        "side of Fig. 15 of the paper, and its counterpart for the robot.",
        grasp_forces,
    ),
    AgentPlot(
        "robot",
        "robot_angles",
        "angles",
        "Joint angles of {who} in {signs}. Predicted side of Fig. 16 of the paper.",
        robot_angles,
    ),
    AgentPlot(
        "robot",
        "robot_torques",
        "torques",
        "Joint torques of {who} with the limits they were held to. Predicted side of Figs. 17 and 18 of the paper.",
        robot_torques,
    ),
    Plot(
        "object_motion",
        "Height of the object's centre, which is not that of the grasps, its tilt and speed.",
        object_motion,
    ),
    Plot(
        "clearance",
        "How near bodies come over the lift, by kind of pair; below zero they overlap. Where people lift with robots, "
        "also how far they are apart, and how fast their nearest points move against each other.",
        clearance,
    ),
    AgentPlot("person", "ground_reaction", "ground_reaction", "What the ground does to {who}.", ground_reaction),
    AgentPlot(
        "person",
        "centre_of_pressure",
        "centre_of_pressure",
        "Where the floor bears {who}: the centre of pressure under the feet, from above, and how far it stays within "
        "what of the soles bears, from the heels to the balls of the feet.",
        centre_of_pressure,
        standing=True,
    ),
    AgentPlot(
        "person",
        "strength_used",
        "strength_used",
        "Share of {who}'s strength that each joint uses over the lift.",
        strength_used,
    ),
    AgentPlot(
        "person",
        "spine_load",
        "spine_load",
        "Load on the lumbar spine of {who} at L5/S1: compression by a single equivalent muscle, shear and net moments, "
        "beside the limits of NIOSH and of Gallagher and Marras. An estimate.",
        spine_load,
    ),
    AgentPlot(
        "person",
        "posture_score",
        "posture_score",
        "RULA score of {who}'s posture and hand force over the lift, by its parts.",
        posture_score,
    ),
)


def plots_of(lift: Lift) -> tuple[Plot, ...]:
    """Return the plots of a lift: those of the lift as a whole, and those of everybody in it."""
    plots: list[Plot] = []
    agents = lift.dense.agents
    everybody = listed(who_is(agent, agents).label for agent in agents)
    for plot in PLOTS:
        if plot.name == "clearance" and lift.dense.clearance is None:
            continue
        if isinstance(plot, AgentPlot):
            plots += [_of(plot, agent, lift) for agent in agents if plot.is_of(agent)]
        else:
            plots.append(replace(plot, caption=plot.caption.format(all=everybody)))
    return tuple(plots)


def figure_names(agents: Sequence[AgentTrajectory], agent: AgentTrajectory) -> dict[str, str]:
    """Return the names of an agent's plots by what they show, ``"angles"``."""
    alone, plots = who_is(agent, agents).is_alone, [plot for plot in PLOTS if isinstance(plot, AgentPlot)]
    return {plot.what: plot.name if alone else f"{agent.name}_{plot.what}" for plot in plots if plot.is_of(agent)}


def _of(plot: AgentPlot, agent: AgentTrajectory, lift: Lift) -> Plot:
    agents = lift.dense.agents
    name, alone = figure_names(agents, agent)[plot.what], who_is(agent, agents).is_alone
    signs = joint_words(lift.dense.scenario, agent) if agent.kind == "robot" else ""
    caption = plot.caption.format(who=who_is(agent, agents).called, signs=signs)

    def draw(lift: Lift) -> Figure:
        return plot.draw(lift, lift.dense[agent.name])

    return Plot(name, caption, draw, "" if alone else agent.name)


def write_plots(solution: Solution, out: Path, formats: Iterable[str] = FORMATS) -> list[Path]:
    """Write every plot in each of ``formats`` to the folder ``out``, made if need be; return the files.

    Raises:
        InputError: the folder cannot be written.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        lift, files = Lift.of(solution, figures_of(solution)), []
        for plot in plots_of(lift):
            figure = drawn(plot, lift)
            for kind in formats:
                files.append(out / f"{plot.name}.{kind}")
                files[-1].write_bytes(rendered(figure, kind))
    except OSError as error:
        raise InputError("--out", str(out), f"cannot be written: {error.strerror or error}") from None
    return files


def drawn(plot: Plot, lift: Lift) -> Figure:
    """Return the figure of ``plot``."""
    with rc_context(STYLE):
        figure = plot.draw(lift)
        if plot.head:
            head(figure, plot.head)
        return figure


def rendered(figure: Figure, kind: str) -> bytes:
    """Return a figure as ``"svg"``, ``"png"`` or ``"pdf"``; the same figure always gives the same bytes."""
    stream = io.BytesIO()
    metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {}}[kind]
    with rc_context(STYLE):
        figure.savefig(stream, format=kind, dpi=PNG_DPI, metadata=metadata)
    return stream.getvalue()
