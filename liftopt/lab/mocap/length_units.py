"""Units of length as exporters spell them, and what they are in metres."""

from __future__ import annotations

# The names a mapping may use, and their length [m].
METRES = {
    "m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001, "um": 1e-6, "in": 0.0254, "ft": 0.3048,
    "meters": 1.0, "metres": 1.0, "millimeters": 0.001,
}  # fmt: skip
SHORTEST_CUT = 4  # letters of a name that was cut off: C3D writers may store no more
SYMBOLS = {"µm": 1e-6, "μm": 1e-6, '"': 0.0254, "'": 0.3048, "mtr": 1.0, "mtrs": 1.0, "ins": 0.0254}
WORDS = {
    "meters": 1.0, "metres": 1.0, "decimeters": 0.1, "decimetres": 0.1, "centimeters": 0.01, "centimetres": 0.01,
    "millimeters": 0.001, "millimetres": 0.001, "micrometers": 1e-6, "micrometres": 1e-6, "microns": 1e-6,
    "inches": 0.0254, "foot": 0.3048, "feet": 0.3048,
}  # fmt: skip


def metres_of(unit: str) -> float | None:
    """Return the length of a unit [m] in any usual spelling, cut off or not; None if it is not known."""
    name = unit.strip().strip("[]().").strip().lower()
    if name in METRES:
        return METRES[name]
    if name in SYMBOLS:
        return SYMBOLS[name]
    found = {scale for word, scale in WORDS.items() if len(name) >= SHORTEST_CUT and word.startswith(name)}
    return found.pop() if len(found) == 1 else None
