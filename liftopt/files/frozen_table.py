"""A table of a scenario whose names are the user's: a mapping that cannot be changed and has a hash."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, TypeVar, get_args

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from liftopt.files.suggestions import did_you_mean, nearest

T = TypeVar("T")


class FrozenTable(Mapping[str, T]):
    """Values by name, in the order of the file."""

    def __init__(self, values: Mapping[str, T] | None = None) -> None:
        """Keep a copy of ``values``."""
        self._values = dict(values or {})

    def __getitem__(self, name: str) -> T:
        """Return the value of that name; raises ``KeyError`` with the names that there are."""
        if name not in self._values:
            offer = did_you_mean(nearest(str(name), self._values))
            raise KeyError(f"no {name!r}; there are {', '.join(self._values)}{offer}")
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self._values)

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._values)

    def __eq__(self, other: object) -> bool:
        """Whether they are the same values in the same order."""
        return isinstance(other, FrozenTable) and list(self.items()) == list(other.items())

    def __hash__(self) -> int:
        """Return a hash of names and values."""
        return hash(tuple(self.items()))

    def __repr__(self) -> str:
        """Return the table as a mapping is written."""
        return f"{type(self).__name__}({self._values!r})"

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return how pydantic checks it: as a dictionary of its values."""
        values = handler.generate_schema(dict[str, (get_args(source) or (Any,))[0]])  # type: ignore[misc]
        given = core_schema.no_info_before_validator_function(_as_dict, values)
        return core_schema.no_info_after_validator_function(
            cls, given, serialization=core_schema.plain_serializer_function_ser_schema(dict)
        )


def _as_dict(values: object) -> object:
    return dict(values) if isinstance(values, Mapping) else values
