"""The list of external forces that ``rnea`` takes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, overload


class StdVec_Force(list[Any]):
    """One ``Force`` for each joint, the universe first, each in its joint's local frame."""

    @overload
    def __init__(self, other: Iterable[Any] = ..., /) -> None: ...

    @overload
    def __init__(self, size: int, value: Any, /) -> None: ...

    def __init__(self, other: Any = (), value: Any = None, /) -> None:
        """Copy the forces of ``other``, or hold ``other`` copies of ``value``; without arguments, be empty."""
        super().__init__(other if value is None else (value.copy() for _ in range(other)))

    def tolist(self) -> list[Any]:
        """Return the forces in a plain list."""
        return list(self)
