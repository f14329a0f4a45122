"""Joints and frames of the exported URDFs, from the models of the default lift."""

from __future__ import annotations

from drawings.stage import bodies, default_lift
from tables import table


def urdf_names() -> str:
    """Return one line a file: its joints and its frames that no joint moves by itself."""
    rows = []
    for file, body in zip(default_lift().urdfs, bodies().values(), strict=True):
        joints = [name for name in list(body.model.names)[1:] if name != "root_joint"]
        frames = [frame.name for frame in body.model.frames if "grasp" in frame.name and "fixed" not in frame.name]
        rows.append((f"`{file}`", ", ".join(f"`{name}`" for name in joints) or "none: a free body",
                     ", ".join(f"`{name}`" for name in frames)))  # fmt: skip
    return table(("file", "joints", "grasp frames"), rows)
