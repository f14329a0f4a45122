"""What stands around the lift: floor, light and background."""

from __future__ import annotations

from liftopt.multibody.dh import translation
from liftopt.viz.scene_commands import Command, place, set_object
from liftopt.viz.scene_mesh import block

FLOOR = (0.70, 0.72, 0.74)
FLOOR_SIZE, FLOOR_THICKNESS = 20.0, 0.02  # [m]
SUN = (-1.2, -3.0, 5.0)  # [m]: shines from there to the origin


def stage_commands() -> list[Command]:
    """Return the commands that lay the floor, set the light and hide what the viewer shows of itself."""
    floor = block((0.0, 0.0, -FLOOR_THICKNESS / 2.0 - 0.001), (FLOOR_SIZE, FLOOR_SIZE, FLOOR_THICKNESS), edge=0.001)
    settings: list[tuple[str, str, object]] = [
        ("/Background", "top_color", [0.90, 0.93, 0.96]),
        ("/Background", "bottom_color", [0.66, 0.71, 0.77]),
        ("/Axes", "visible", False),
        ("/Lights/FillLight/<object>", "position", list(SUN)),
        ("/Lights/FillLight/<object>", "intensity", 0.55),
        ("/Lights/FillLight/<object>", "castShadow", True),
        ("/Lights/PointLightNegativeX/<object>", "intensity", 0.22),
        ("/Lights/PointLightPositiveX/<object>", "intensity", 0.22),
        ("/Lights/AmbientLight/<object>", "intensity", 0.50),
    ]
    return [
        set_object("/floor", floor, FLOOR),
        place("/Grid", translation(0.0, 0.0, 0.001)),
        *({"type": "set_property", "path": path, "property": key, "value": value} for path, key, value in settings),
    ]
