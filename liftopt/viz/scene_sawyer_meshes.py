"""Sawyer in the manufacturer's own meshes, from a ``sawyer_description`` folder that the user has."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.dh import translation
from liftopt.multibody.robots.sawyer_description import HEAD_IN_FIRST_LINK, JOINTS, described_frames
from liftopt.multibody.solids import placement_of
from liftopt.types import Array
from liftopt.viz.scene_mesh import Mesh
from liftopt.viz.scene_part import GROUND, Colour, Part

DESCRIPTION = "urdf/sawyer_base.urdf.xacro"
RED: Colour = (0.55, 0.07, 0.08)
DARK: Colour = (0.16, 0.16, 0.17)
SHARP = 0.6  # [rad]: edges sharper than this stay edges
# The joint that moves each link of the description, None for what stands still; what is not here is not drawn.
MOVED_BY: dict[str, str | None] = {"pedestal": None, "right_arm_base_link": None, "head": "Q1"} | {
    f"right_l{i}": f"Q{i + 1}" for i in range(len(JOINTS))
}


@dataclass(frozen=True)
class _Visual:
    link: str
    placement: Array
    file: Path


def sawyer_mesh_parts(folder: str | Path, name: str, world_base: Array) -> list[Part]:
    """Return the robot of that name with all joints at zero, from the STL files beside those its description names.

    Args:
        folder: a ``sawyer_description`` with ``urdf/`` and ``meshes/``.
        name: that its joints begin with.
        world_base: (4, 4) T_world_base of the manufacturer's base frame.

    Raises:
        InputError: the folder is none, or a mesh cannot be read; it says which and why.
    """
    frames = dict(
        zip((f"right_l{i}" for i in range(len(JOINTS))), described_frames(np.zeros(len(JOINTS))), strict=True)
    )
    frames["head"] = frames["right_l0"] @ translation(*HEAD_IN_FIRST_LINK)
    parts = []
    for visual in _visuals(Path(folder)):
        placement = world_base @ frames.get(visual.link, np.eye(4)) @ visual.placement
        colour = DARK if visual.link == "pedestal" else RED
        joint = MOVED_BY[visual.link]
        body = GROUND if joint is None else f"{name}_{joint}"
        parts.append(Part(body, visual.link, colour, _load(visual.file).seen_from(placement)))
    return parts


def _visuals(folder: Path) -> list[_Visual]:
    source = folder / DESCRIPTION
    try:
        tree = ElementTree.parse(source)
    except (OSError, ElementTree.ParseError) as error:
        raise InputError("--sawyer", str(folder), f"is no sawyer_description: {DESCRIPTION}: {error}") from None
    visuals = []
    for link in tree.getroot().iter("link"):
        name, visual = str(link.get("name")), link.find("visual")
        mesh = None if visual is None else visual.find("geometry/mesh")
        if name not in MOVED_BY or visual is None or mesh is None:
            continue
        inside = str(mesh.get("filename")).split("sawyer_description/", 1)[-1]
        visuals.append(_Visual(name, placement_of(visual.find("origin")), (folder / inside).with_suffix(".STL")))
    missing = sorted(set(MOVED_BY) - {visual.link for visual in visuals})
    if missing:
        raise InputError("--sawyer", str(folder), f"{DESCRIPTION} has no mesh for {', '.join(missing)}")
    return visuals


def _load(file: Path) -> Mesh:
    import trimesh

    if not file.is_file():
        raise InputError("--sawyer", NO_VALUE, f"there is no mesh {file}")
    try:
        loaded = trimesh.load_mesh(file)
        if not len(loaded.faces):
            raise ValueError("it has no triangles")
        smooth = trimesh.graph.smooth_shade(loaded, angle=SHARP)
        return Mesh(np.asarray(smooth.vertices, float), np.asarray(smooth.faces, np.int64))
    except Exception as error:  # trimesh's readers raise whatever a broken file makes them raise
        raise InputError("--sawyer", NO_VALUE, f"{file} cannot be read as STL: {error}") from None
