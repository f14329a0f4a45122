"""The drawings of the documentation, made from the very models and a solved lift: numbers in them are never typed."""

from __future__ import annotations

from pathlib import Path

from matplotlib import rc_context

from drawings.frames import frames
from drawings.grasp import grasp
from drawings.house import house
from drawings.mesh import mesh
from drawings.person_joints import person_joints
from drawings.robot_joints import robot_joints
from drawings.scope import scope
from drawings.snapshots import lift
from liftopt.viz.plots_style import STYLE

DRAWINGS = (lift, frames, grasp, person_joints, robot_joints, scope, mesh, house)


def write_drawings(folder: Path) -> None:
    """Write every drawing as SVG into a folder, which is made; a drawing has the name of its function."""
    folder.mkdir(parents=True, exist_ok=True)
    for draw in DRAWINGS:
        with rc_context(STYLE):
            draw().savefig(folder / f"{draw.__name__}.svg", metadata={"Date": None})
