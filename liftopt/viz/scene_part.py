"""A part of the scene: one mesh of one colour on one moving body."""

from __future__ import annotations

from dataclasses import dataclass, replace

from liftopt.types import Array
from liftopt.viz.scene_mesh import Mesh

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Part:
    """What is drawn of one body.

    Attributes:
        body: the joint that moves it (``"human_Q8"``), or ``"ground"`` for what stands still.
        name: of the part, unique on its body.
        colour: red, green, blue in [0, 1].
        mesh: in the frame that the body has in ``Playback.zero``, which is the world for what stands still.
        opacity: below 1 it is see-through.
    """

    body: str
    name: str
    colour: Colour
    mesh: Mesh
    opacity: float = 1.0

    def placed(self, transform: Array) -> Part:
        """Return the part in frame A, given T_A_B (4, 4) of the frame B that it is in."""
        return replace(self, mesh=self.mesh.seen_from(transform))


GROUND = "ground"
