"""Joints and frames of the exported URDFs, from the models of the default lift."""

from __future__ import annotations

from drawings.stage import bodies, default_lift
from liftopt.scenario.urdf_files import urdf_files
from tables import table


def urdf_names() -> str:
    """Return one line a file: its joints and its frames that no joint moves by itself."""
    rows = []
    for name, file in urdf_files(default_lift().scenario).items():
        body = bodies()[name]
        joints = [joint for joint in list(body.model.names)[1:] if joint != "root_joint"]
        frames = [frame.name for frame in body.model.frames if "grasp" in frame.name and "fixed" not in frame.name]
        rows.append((f"`{file}`", ", ".join(f"`{joint}`" for joint in joints) or "none: a free body",
                     ", ".join(f"`{frame}`" for frame in frames)))  # fmt: skip
    return table(("file", "joints", "grasp frames"), rows)
