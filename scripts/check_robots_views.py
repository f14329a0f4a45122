"""How does every robot look? All that are known by name on one sheet, or the lifts of some results.

``python scripts/check_robots_views.py robots.png`` draws each known robot that is installed, one arm of each, at ease
and on what it would stand on; names choose some. ``--solids`` draws the solids of its model in place of its own meshes,
``--side X Y Z`` is from where it is seen. ``--lifts FOLDER`` draws the end of each lift of the results in that folder
instead, person and robot. It prints for each robot the triangles that it is drawn with, how much they take of a page,
its solids, and the seconds of processor time for building its model and for its meshes.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import liftopt as lo
from liftopt.multibody.dh import rotation_z
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.multibody.robots.chosen_robot import chosen_robot
from liftopt.multibody.robots.known_robot import KnownRobot
from liftopt.multibody.robots.robot_agent import robot_agent
from liftopt.multibody.robots.robot_solids import robot_solids
from liftopt.multibody.solids import solids_of
from liftopt.viz.picture import picture_of
from liftopt.viz.robot_figure import figure_of
from liftopt.viz.robot_picture import THREE_QUARTER, robot_picture
from liftopt.viz.scene_commands import set_object
from liftopt.viz.shading import Image

COLUMNS, PIXELS, INCHES = 6, 320, 1.8
SAME = ("_right", "_limited", "_lifting", "_no_hand")  # end the names of robots that look as another does
STANDS, HEIGHT = 0.5, 0.75  # what is taller than so much stands on the floor itself, all else so high [m]


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw the sheet; the exit status is 1 where there is nothing to draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, metavar="FILE", help="the sheet, a PNG")
    parser.add_argument("names", nargs="*", metavar="NAME", help="robots, as `liftopt robots` lists them")
    parser.add_argument("--solids", action="store_true", help="draw the solids of the models")
    parser.add_argument(
        "--side", nargs=3, type=float, default=THREE_QUARTER, metavar=("X", "Y", "Z"), help="from where"
    )
    parser.add_argument("--lifts", type=Path, metavar="FOLDER", help="draw the results in this folder")
    args = parser.parse_args(arguments)
    panels = list(_lifts(args.lifts) if args.lifts else _robots(args.names, args.side, solids=args.solids))
    if not panels:
        print("there is nothing to draw: no such robot is installed, or the folder has no results", file=sys.stderr)
        return 1
    write_sheet(args.file, panels)
    print(f"Written to {args.file}")
    return 0


def view_of_robot(
    known: KnownRobot, side: Sequence[float] = THREE_QUARTER, size: tuple[int, int] = (PIXELS, PIXELS), *,
    solids: bool = False,
) -> Image:  # fmt: skip
    """Return a picture (H, W, 3) of a known robot, at ease and on what it would stand on; it prints figures on it."""
    chain = chosen_robot(known.name).examination().chain
    base = robot_solids(chain).base[:, 2]
    T_world_base = rotation_z(-np.radians(known.front_deg))
    T_world_base[2, 3] = -base.min() if np.ptp(base) > STANDS else HEIGHT - base.min()
    started = time.process_time()
    agent = robot_agent(
        known.description(), name="robot", T_world_base=T_world_base, base=known.base, grasp_frame=known.grasp_frame,
        locked=known.locked,
    )  # fmt: skip
    built = time.process_time()
    figure = () if solids else figure_of(chain)
    drawn = time.process_time()
    size_of_page = sum(len(json.dumps(set_object("", piece.mesh, piece.colour))) for piece in figure)
    print(
        f"{known.name:20} {sum(len(piece.mesh.triangles) for piece in figure):6} triangles "
        f"{size_of_page / 1e6:5.2f} MB {len(solids_of(agent)):3} solids  "
        f"model {built - started:4.1f} s  meshes {drawn - built:4.1f} s",
        flush=True,
    )
    return robot_picture(agent, figure, side=side, size=size)


def write_sheet(file: Path, panels: Sequence[tuple[str, Image]]) -> None:
    """Write pictures with their titles side by side into a PNG."""
    columns = min(COLUMNS, len(panels))
    rows = -(-len(panels) // columns)
    height, width = panels[0][1].shape[:2]
    figure = Figure(figsize=(INCHES * columns, INCHES * (height / width + 0.14) * rows))
    FigureCanvasAgg(figure)
    for number, (title, image) in enumerate(panels, start=1):
        axes = figure.add_subplot(rows, columns, number)
        axes.imshow(image)
        axes.set_title(title, fontsize=6, pad=2)
        axes.axis("off")
    figure.subplots_adjust(0.005, 0.005, 0.995, 0.97, 0.02, 0.12)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=PIXELS / INCHES)


def _robots(names: Sequence[str], side: Sequence[float], *, solids: bool) -> Iterator[tuple[str, Image]]:
    for known in known_robots().values():
        wanted = known.name in names if names else not known.name.endswith(SAME)
        if wanted and known.is_installed and known.own_urdf is None:
            yield f"{known.title}\n{known.maker}", view_of_robot(known, side, solids=solids)


def _lifts(folder: Path) -> Iterator[tuple[str, Image]]:
    for result in sorted(path.parent for path in folder.rglob("solution.nc")):
        solution = lo.load(result)
        yield result.name, picture_of(solution, float(solution.time[-1]), panel=(PIXELS, PIXELS))


if __name__ == "__main__":
    sys.exit(main())
