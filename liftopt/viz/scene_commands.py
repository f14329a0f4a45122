"""Commands of the meshcat viewer as plain data: an object, a placement, an animation clip."""

from __future__ import annotations

from typing import Any

import numpy as np

from liftopt.types import Array
from liftopt.viz.scene_mesh import Mesh
from liftopt.viz.scene_part import Colour

Command = dict[str, Any]
DECIMALS = 4  # of a drawn length: 0.1 mm


def clip(path: str, time: Array, values: dict[str, Array]) -> Command:
    """Return a node's animation: rows of ``values`` (K, 3 or 4) by property at ``time`` (K,) [s]."""
    tracks = [
        {
            "name": f".{name}",
            "type": "quaternion" if name == "quaternion" else "vector3",
            "times": np.round(time, 5).tolist(),
            "values": (np.round(rows, 6 if name == "quaternion" else DECIMALS + 1) + 0.0).ravel().tolist(),
        }
        for name, rows in values.items()
    ]
    return {"path": path, "clip": {"fps": 1, "name": "lift", "tracks": tracks}}


def set_object(
    path: str, mesh: Mesh, colour: Colour, opacity: float = 1.0, on_top: bool = False, colours: Array | None = None
) -> Command:
    """Return the command that draws a mesh, in three.js' own format.

    Args:
        path: of its node.
        mesh: what is drawn.
        colour: of all of it.
        opacity: below 1 it is see-through, and gives way where it lies in the face of something solid.
        on_top: of all that hides it.
        colours: (n, 4) red, green, blue and opacity of each vertex, which ``colour`` and ``opacity`` give way to.
    """
    red, green, blue = (round(255 * value) for value in colour)
    vertices = np.round(mesh.vertices, DECIMALS) + 0.0
    geometry: dict[str, Any] = {
        "uuid": f"geometry{path}",
        "type": "BufferGeometry",
        "data": {
            "attributes": {"position": {"itemSize": 3, "type": "Float32Array", "array": vertices.ravel().tolist()}},
            "index": {
                "type": "Uint16Array" if len(vertices) <= 65536 else "Uint32Array",
                "array": mesh.triangles.ravel().tolist(),
            },
        },
    }
    see_through = opacity < 1.0 or colours is not None
    # Lit at the vertices: with smooth figures as good as by the pixel, and twice as fast without a graphics card.
    material = {
        "uuid": f"material{path}",
        "type": "MeshLambertMaterial",
        "color": (red << 16) + (green << 8) + blue,
        "transparent": see_through,
        "opacity": opacity,
        "depthWrite": not see_through,
        "depthTest": not on_top,
    }
    if opacity < 1.0:
        material |= {"polygonOffset": True, "polygonOffsetFactor": 2, "polygonOffsetUnits": 2}
    if colours is not None:
        values = np.round(colours, DECIMALS).ravel().tolist()
        geometry["data"]["attributes"]["color"] = {"itemSize": 4, "type": "Float32Array", "array": values}
        material |= {"vertexColors": True, "color": 0xFFFFFF}
    item: Command = {"uuid": f"mesh{path}", "type": "Mesh", "geometry": geometry["uuid"], "material": material["uuid"]}
    if on_top:
        item["renderOrder"] = 10
    scene = {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [geometry],
        "materials": [material],
        "object": item,
    }
    return {"type": "set_object", "path": path, "object": scene}


def place(path: str, transform: Array) -> Command:
    """Return the command that puts a node at ``transform`` (4, 4) in its parent."""
    return {"type": "set_transform", "path": path, "matrix": transform.T.ravel().tolist()}
