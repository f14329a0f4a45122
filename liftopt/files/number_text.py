"""Numbers as people write them: with a unit, a decimal comma, in quotes, in centimetres."""

from __future__ import annotations

import re

NUMBER = re.compile(r"\s*([+-]?\d*[.,]?\d+(?:[eE][+-]?\d+)?)\s*([^\W\d]*|°|%)\s*")
# How much of the scenario's unit one of another is, by the scenario's unit.
OTHERS = {
    "m": {"cm": 1e-2, "mm": 1e-3, "ft": 0.3048, "in": 0.0254, "inch": 0.0254},
    "kg": {"g": 1e-3, "lb": 0.45359237, "lbs": 0.45359237},
    "s": {"ms": 1e-3, "sec": 1.0, "seconds": 1.0, "min": 60.0},
    "deg": {"°": 1.0, "degrees": 1.0, "rad": 57.29577951308232},
    "": {"%": 1e-2},
}


def number_meant(value: object, unit: str, low: float, high: float) -> str:
    """Return the end of a message that says how to write what was meant; empty where that is not clear.

    Args:
        value: that was refused.
        unit: of the entry.
        low: the least that is allowed.
        high: the most that is allowed.
    """
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        centimetres = value / 100 if unit == "m" and abs(value) < 1e6 else float("nan")
        return f"; in m it is {centimetres:g}, if cm were meant" if low <= centimetres <= high else ""
    if not isinstance(value, str) or len(value) > 40 or (found := NUMBER.fullmatch(value)) is None:
        return ""
    digits, given = found.groups()
    scale = 1.0 if given.lower() in ("", unit.lower()) else OTHERS.get(unit, {}).get(given.lower())
    if scale is None:
        return ""
    meant = float(f"{float(digits.replace(',', '.')) * scale:.9g}")
    quotes = " without quotes" if f"{meant:.9g}" == value.strip() else ""
    return f"; write {meant:.9g}{quotes}" if low <= meant <= high else ""
