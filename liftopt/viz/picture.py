"""A picture of a lift without a browser: person, robot and object as the viewer shows them, at one time or several."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from liftopt.errors import InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.multibody.trajectory import grasps_of
from liftopt.solution.solution import Solution
from liftopt.types import Array
from liftopt.viz.camera import in_perspective
from liftopt.viz.own_meshes import Meshes, figures_of
from liftopt.viz.playback import playback_at
from liftopt.viz.scene import GHOSTLY, Cast, parts_of, path_mesh
from liftopt.viz.scene_arrow import arrow_mesh, metres_per_newton
from liftopt.viz.scene_part import GROUND, Part
from liftopt.viz.shading import Body, Image, render
from liftopt.viz.viewer_views import View, views_of
from liftopt.viz.who import colour_of

FORMATS = (".png", ".jpg", ".jpeg")
PANEL = (640, 500)  # width and height of the picture of one moment [pixels]
PATH_POINTS = 60
MARGIN = 0.06  # [m] around what is in view


def write_picture(
    solution: Solution,
    file: Path,
    time: float | Sequence[float] | None = None,
    view: str = "three-quarter",
    *,
    meshes: Meshes = False,
) -> None:
    """Write ``picture_of`` a lift to a file, whose folder is made if need be.

    Raises:
        InputError: the file cannot be written or has another ending than ``FORMATS``; or as ``picture_of``.
    """
    from matplotlib.image import imsave

    if file.suffix.lower() not in FORMATS:
        raise InputError("file", str(file), f"must end with one of {', '.join(FORMATS)}")
    image = picture_of(solution, time, view, meshes=meshes)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        imsave(file, image)
    except OSError as error:
        raise InputError("file", str(file), f"cannot be written: {error.strerror or error}") from None


def picture_of(
    solution: Solution,
    time: float | Sequence[float] | None = None,
    view: str = "three-quarter",
    panel: tuple[int, int] = PANEL,
    *,
    meshes: Meshes = False,
) -> Image:
    """Return a picture (H, W, 3) of a lift: a panel for each moment, side by side, all from the same place.

    Args:
        solution: what is shown, solved or not.
        time: one or several moments [s]; None: start, middle and end.
        view: a preset of the viewer: ``"three-quarter"``, ``"side"``, ``"front"``, ``"top"``, ``"hands"``,
            ``"person"``, ``"robot"``, or an agent's name where there are several of a kind.
        panel: width and height of each panel [pixels].
        meshes: where robots' own meshes are looked for, as ``figures_of`` has it.

    Raises:
        InputError: there is no such view, or a moment is not within the lift; it says which and what is allowed.
    """
    moments = _moments(solution, time)
    # The whole path of every hand is shown, and the view is that of the whole lift.
    path = np.linspace(0.0, float(solution.time[-1]), PATH_POINTS)
    playback = playback_at(solution, np.concatenate([path, moments]))
    cast = Cast(solution, playback, "/lift", figures=figures_of(solution, meshes))
    chosen = _view(cast, view)
    low, high = (np.array(corner) for corner in chosen.box)
    camera = in_perspective(chosen.side, low - MARGIN, high + MARGIN, panel)
    parts, marks = parts_of(cast), _paths(cast, len(path))
    panels = []
    for k in range(len(path), len(path) + len(moments)):
        bodies = [*bodies_at(cast, parts, k, chosen), *marks, *_arrows(cast, k)]
        panels.append(render(bodies, camera, panel))
    return np.concatenate(panels, axis=1)


def bodies_at(cast: Cast, parts: Sequence[Part], k: int, view: View | None = None) -> list[Body]:
    """Return the parts of a lift at a frame, where they are in the world.

    Args:
        cast: the lift.
        parts: of it, by ``parts_of``.
        k: index of the frame.
        view: whose ``solid`` bodies are solid, all others see-through; None: all are.
    """
    bodies, zero = [], cast.playback.zero
    for part in parts:
        mesh = part.mesh
        if part.body != GROUND:
            mesh = mesh.seen_from(_placement(cast, part.body, k) @ np.linalg.inv(zero[part.body]))
        solid = view is None or view.solid is None or part.body in view.solid
        bodies.append(Body(mesh, part.colour, part.opacity if solid else GHOSTLY * part.opacity))
    return bodies


def _paths(cast: Cast, frames: int) -> list[Body]:
    """Return the paths of all hands over the first so many frames."""
    agents, found = cast.solution.agents, []
    for _, agent, _, grasp in grasps_of(agents):
        along = path_mesh(cast.playback.forces[grasp.name].point[:frames])
        if along is not None:
            found.append(Body(along, colour_of(agents, agent), shadow=False))
    return found


def _arrows(cast: Cast, k: int) -> list[Body]:
    """Return the forces of all hands on the object at a frame."""
    agents, forces, found = cast.solution.agents, cast.playback.forces, []
    scale = metres_per_newton(force.force for force in forces.values())
    for _, agent, _, grasp in grasps_of(agents):
        arrow = arrow_mesh(forces[grasp.name].point[k], scale * forces[grasp.name].force[k])
        if arrow is not None:
            found.append(Body(arrow, colour_of(agents, agent), on_top=True))
    return found


def _placement(cast: Cast, body: str, k: int) -> Array:
    track, placement = cast.playback.bodies[body], np.eye(4)
    placement[:3, :3] = Rotation.from_quat(track.quaternion[k]).as_matrix()
    placement[:3, 3] = track.position[k]
    return placement


def _moments(solution: Solution, time: float | Sequence[float] | None) -> Array:
    last = float(solution.time[-1])
    moments = np.atleast_1d(np.asarray([0.0, last / 2, last] if time is None else time, dtype=np.float64))
    for moment in moments.tolist():
        if not 0.0 <= moment <= last * (1.0 + 1e-9):
            raise InputError("time", moment, f"must be within the lift, from 0 to {last:g} s")
    if moments.ndim != 1 or not len(moments):
        raise InputError("time", str(time), "must be one time or several [s]")
    return moments


def _view(cast: Cast, name: str) -> View:
    views = {view.name: view for view in views_of([cast])}
    if name not in views:
        raise InputError("view", name, f"must be one of {', '.join(views)}{did_you_mean(nearest(name, views))}")
    return views[name]
