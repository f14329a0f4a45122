"""Labels at the points of a curve that cover neither each other nor the curve."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox

from liftopt.types import Array

Point = tuple[float, float]
NEAR, FAR, RINGS = 7.0, 14.0, 4  # distances of a label from its point that are tried [pt], and how many
ROUND = 12  # directions that are tried, up and to the right first
ROOM, EDGE = 1.5, 8.0  # around a label, and to the edge of the axes [px]: drawn finer, text is a little wider


def label_points(
    axes: Axes, points: Sequence[Point], texts: Sequence[str], curve: Sequence[Point], **font: Any
) -> list[Annotation]:
    """Write texts beside points, each where it is free; one that finds no place is left out.

    Args:
        axes: with all that is drawn, scales and legend; the limits are final then.
        points: in data coordinates; the first are served first.
        texts: one a point.
        curve: corners of what is drawn through, in data coordinates.
        font: keywords of the text.
    """
    axes.set(xlim=axes.get_xlim(), ylim=axes.get_ylim())  # asked for, automatic limits are worked out
    canvas: Any = FigureCanvasAgg(cast(Figure, axes.figure))
    renderer = canvas.get_renderer()
    line, marks = (axes.transData.transform(np.array(each, float).reshape(-1, 2)) for each in (curve, points))
    legend = axes.get_legend()
    taken = [] if legend is None else [legend.get_window_extent(renderer)]
    taken += [Bbox.from_extents(x - 5, y - 5, x + 5, y + 5) for x, y in np.vstack([marks, line])]
    frame, placed = axes.get_window_extent(renderer).padded(-EDGE), []
    for point, text in zip(points, texts, strict=True):
        note = axes.annotate(text, point, xytext=(0.0, 0.0), textcoords="offset points", **font)
        for place in _places():
            _put(note, place)
            box = note.get_window_extent(renderer).padded(ROOM)
            if not _within(box, frame) or any(box.overlaps(other) for other in taken) or _crosses(line, box):
                continue
            taken.append(box)
            placed.append(note)
            break
        else:
            note.remove()
    return placed


def _places() -> list[Point]:
    """Return offsets [pt] in the order in which they are tried."""
    turns = sorted(range(ROUND), key=lambda i: min((i - 1.5) % ROUND, (1.5 - i) % ROUND))
    return [
        (distance * np.cos(2 * np.pi * i / ROUND), distance * np.sin(2 * np.pi * i / ROUND))
        for distance in np.linspace(NEAR, FAR, RINGS)
        for i in turns
    ]


def _put(note: Annotation, place: Point) -> None:
    x, y = place
    small = 0.3 * np.hypot(x, y)
    note.xyann = place
    note.set_horizontalalignment("left" if x > small else "right" if x < -small else "center")
    note.set_verticalalignment("bottom" if y > small else "top" if y < -small else "center")


def _within(box: Bbox, frame: Bbox) -> bool:
    return bool(frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1)


def _crosses(line: Array, box: Bbox) -> bool:
    """Return whether a polyline (K, 2) passes through a box; both in pixels."""
    for start, end in pairwise(line):
        low, high = 0.0, 1.0
        for value, step, least, most in zip(start, end - start, box.min, box.max, strict=True):
            if step == 0.0:
                low, high = (low, high) if least <= value <= most else (1.0, 0.0)
                continue
            enters, leaves = sorted(((least - value) / step, (most - value) / step))
            low, high = max(low, enters), min(high, leaves)
        if low <= high:
            return True
    return False
