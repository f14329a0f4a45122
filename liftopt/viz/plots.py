"""All plots of a lift: what they are, and writing them as SVG, PNG or PDF."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from matplotlib import rc_context
from matplotlib.figure import Figure

from liftopt.errors import InputError
from liftopt.solution.solution import Solution
from liftopt.viz import FORMATS
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_effort import posture_score, strength_used
from liftopt.viz.plots_forces import grasp_forces, ground_reaction, object_motion
from liftopt.viz.plots_joints import human_angles, human_arm, human_torques, robot_angles, robot_torques
from liftopt.viz.plots_snapshots import snapshots
from liftopt.viz.plots_style import STYLE

PNG_DPI = 200


@dataclass(frozen=True)
class Plot:
    """One plot of a lift.

    Attributes:
        name: of its file.
        caption: what it shows, and which figure of the paper it is the predicted side of.
        draw: makes it; call it in ``rc_context(STYLE)``.
    """

    name: str
    caption: str
    draw: Callable[[Lift], Figure]


PLOTS: tuple[Plot, ...] = (
    Plot(
        "snapshots",
        "The lift at five moments, in the shapes of the models that were solved. Fig. 11 of the paper.",
        snapshots,
    ),
    Plot(
        "human_arm",
        "Shoulder and elbow flexion of the person: angle and torque, flexion positive. Predicted side of Figs. 13 and "
        "14 of the paper.",
        human_arm,
    ),
    Plot(
        "human_angles",
        "All joint angles of the person within their ranges of motion. Zero is upright, the arm hanging, palm forward.",
        human_angles,
    ),
    Plot("human_torques", "All joint torques of the person and how much of the strength they use.", human_torques),
    Plot(
        "grasp_forces",
        "Force of person and robot on the object by component, world axes, and who carries how much of the load. "
        "Predicted side of Fig. 15 of the paper, and its counterpart for the robot.",
        grasp_forces,
    ),
    Plot(
        "robot_angles",
        "Joint angles of the robot in the signs of the paper's Table 3, with the manufacturer's joint names. Predicted "
        "side of Fig. 16 of the paper.",
        robot_angles,
    ),
    Plot(
        "robot_torques",
        "Joint torques of the robot with the limits they were held to. Predicted side of Figs. 17 and 18 of the paper.",
        robot_torques,
    ),
    Plot(
        "object_motion",
        "Height of the object's centre (a scenario's heights are those of the edges held), its tilt and speed.",
        object_motion,
    ),
    Plot("ground_reaction", "What the ground does to the person.", ground_reaction),
    Plot("strength_used", "Share of the person's strength that each joint uses over the lift.", strength_used),
    Plot(
        "posture_score", "RULA score of the person's posture and hand force over the lift, by its parts.", posture_score
    ),
)


def write_plots(solution: Solution, out: Path, formats: Iterable[str] = FORMATS) -> list[Path]:
    """Write every plot in each of ``formats`` to the folder ``out``, made if need be; return the files.

    Raises:
        InputError: the folder cannot be written.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        lift, files = Lift.of(solution), []
        for plot in PLOTS:
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
        return plot.draw(lift)


def rendered(figure: Figure, kind: str) -> bytes:
    """Return a figure as ``"svg"``, ``"png"`` or ``"pdf"``; the same figure always gives the same bytes."""
    stream = io.BytesIO()
    metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {}}[kind]
    with rc_context(STYLE):
        figure.savefig(stream, format=kind, dpi=PNG_DPI, metadata=metadata)
    return stream.getvalue()
