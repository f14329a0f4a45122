"""Commands of the meshcat viewer as plain data: an object, a placement, an animation clip."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from liftopt.viz.scene_mesh import Mesh
from liftopt.viz.scene_part import Colour

Array = npt.NDArray[np.float64]
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


def set_object(path: str, mesh: Mesh, colour: Colour, opacity: float = 1.0, on_top: bool = False) -> Command:
    """Return the command that draws ``mesh`` at ``path``, in three.js' own format; ``on_top`` of all that hides it."""
    red, green, blue = (round(255 * value) for value in colour)
    vertices = np.round(mesh.vertices, DECIMALS) + 0.0
    geometry = {
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
    # Lit at the vertices: with smooth figures as good as by the pixel, and twice as fast without a graphics card.
    material = {
        "uuid": f"material{path}",
        "type": "MeshLambertMaterial",
        "color": (red << 16) + (green << 8) + blue,
        "transparent": opacity < 1.0,
        "opacity": opacity,
        "depthWrite": opacity >= 1.0,
        "depthTest": not on_top,
    }
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
