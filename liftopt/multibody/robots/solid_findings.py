"""What stands for links in clearance whose shape nobody knows."""

from __future__ import annotations

from collections.abc import Iterator

from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.data_finding import DataFinding
from liftopt.multibody.robots.description import RobotDescription
from liftopt.multibody.robots.mesh_file import can_be_read


def solid_findings(chain: RobotChain) -> Iterator[DataFinding]:
    """Give the links that move and have neither a plain shape nor a mesh that is at hand."""
    bare = [link.joint.child for link in chain.links if not any(_has(chain.description, name) for name in link.links)]
    if bare:
        message = f"of {len(chain.links)} that move have no shape that can be read: {', '.join(bare)}; tubes along "
        message += "them stand for them in clearance and in pictures"
        yield DataFinding("solids.tubes", "assumed", "shapes", len(bare), message,
                          "give them collision meshes (stl, obj, dae) or plain shapes")  # fmt: skip


def _has(description: RobotDescription, name: str) -> bool:
    link = description.link(name)
    return any(
        shape.mesh is None or (shape.mesh.path is not None and can_be_read(shape.mesh.path))
        for shape in (*link.collisions, *link.visuals)
    )
