"""A checked section of a TOML file: a frozen pydantic model whose refusals are one line that names the key."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic.fields import FieldInfo

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.entries import allowed_in, extra_of, kinds_of, meant_by
from liftopt.files.frozen_table import FrozenTable
from liftopt.files.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from typing import Self

    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)

Place = tuple[int | str, ...]


class _Telling(ModelMetaclass):
    """Lets a model that is made in Python refuse in our words; within another model pydantic goes on as usual."""

    def __call__(cls, /, *args: Any, **values: Any) -> Any:
        try:
            return super().__call__(*args, **values)
        except ValidationError as error:
            raise cls.refusal(error, values) from None  # type: ignore[attr-defined]


class Section(BaseModel, metaclass=_Telling):
    """A frozen group of entries; every value is checked on construction.

    Raises:
        InputError: an entry is missing, unknown, of the wrong type or out of its range; the message names its key.
    """

    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, strict=True, extra="forbid")

    def plain(self) -> dict[str, Any]:
        """Return the entries as TOML and JSON write them; what is left out by default stays out."""
        result = {}
        for name, field in type(self).model_fields.items():
            value = _plain(getattr(self, name))
            if value is None:
                value = extra_of(field).get("word")
            if value is not None:
                result[field.alias or name] = value
        return result

    def changed(self, **values: Any) -> Self:
        """Return the section with some entries changed, checked anew."""
        fields = type(self).model_fields.items()
        return type(self)(**{field.alias or name: getattr(self, name) for name, field in fields} | values)

    @classmethod
    def checked(cls, tables: Any, prefix: str = "") -> Self:
        """Return the section of a file's tables; ``prefix``, with its dot, begins the keys of messages."""
        try:
            return cls.model_validate(tables)
        except ValidationError as error:
            raise cls.refusal(error, tables, prefix) from None

    @classmethod
    def refusal(cls, error: ValidationError, values: Any, prefix: str = "") -> InputError:
        """Return our error for pydantic's about ``values``: unknown keys come first, others may follow from them."""
        fault = first_fault(error)
        return refusal_at(cls, fault["loc"], fault["type"], fault["input"], prefix)


def first_fault(error: ValidationError) -> Any:
    """Return the fault to tell of: an unknown key, from which others may follow, or the first in the order of keys."""
    faults = error.errors(include_url=False, include_context=False)
    return next((fault for fault in faults if fault["type"] == "extra_forbidden"), faults[0])


def keys_of(of: type[BaseModel]) -> dict[str, FieldInfo]:
    """Return the fields of a section by their keys in a file."""
    return {field.alias or name: field for name, field in of.model_fields.items()}


def refusal_at(of: type[BaseModel], place: Place, kind: str, value: object, prefix: str = "") -> InputError:
    """Return the error of one fault that pydantic found in a section.

    Args:
        of: the section.
        place: keys and indices that lead to the fault.
        kind: pydantic's name of the fault.
        value: that was refused.
        prefix: of the keys, with its dot.
    """
    keys = [str(key) for key in place if isinstance(key, str)]
    key = prefix + ".".join(map(shown_key, keys))
    if kind == "extra_forbidden":
        inside = section_at(of, keys[:-1])
        known = list(keys_of(inside)) if inside else []
        offer = did_you_mean(nearest(keys[-1], known)) or "; known here: " + ", ".join(known)
        return InputError(key, value, "unknown key" + offer)
    # Below a table of the user's names the field that holds it is all there is to tell.
    field = next(filter(None, (field_at(of, keys[:depth]) for depth in range(len(keys), 0, -1))))
    if kind == "missing" and isinstance(place[-1], str):  # else a list is too short
        return InputError(key, NO_VALUE, f"is missing; must be {allowed(field)} ({about(field)})")
    return InputError(key, value, f"must be {allowed(field)} ({about(field)}){meant_by(field, value)}")


def sections_in(field: FieldInfo) -> tuple[type[BaseModel], ...]:
    """Return the sections of which a field holds one; none if it holds a value."""
    return tuple(kind for kind in kinds_of(field) if isinstance(kind, type) and issubclass(kind, BaseModel))


def section_of(field: FieldInfo) -> type[BaseModel] | None:
    """Return the section that a field holds, None if it holds a value or one of several sections."""
    kinds = sections_in(field)
    return kinds[0] if len(kinds) == 1 else None


def section_at(of: type[BaseModel], keys: Sequence[str]) -> type[BaseModel] | None:
    """Return the section that keys lead to, None if there is none; a table of sections has them by the user's names."""
    inside: type[BaseModel] | None = of
    named: type[BaseModel] | None = None
    for key in keys:
        if named is not None:
            inside, named = named, None
            continue
        if inside is None or key not in keys_of(inside):
            return None
        field = keys_of(inside)[key]
        inside, named = section_of(field), _named_sections(field)
    return inside


def _named_sections(field: FieldInfo) -> type[BaseModel] | None:
    """Return the section of which a field holds a table, None if it holds something else."""
    found = [kind for table in kinds_of(field) if get_origin(table) is FrozenTable for kind in get_args(table)]
    return found[0] if len(found) == 1 and isinstance(found[0], type) and issubclass(found[0], BaseModel) else None


def field_at(of: type[BaseModel], keys: Sequence[str]) -> FieldInfo | None:
    """Return the field that keys lead to, None if there is none."""
    inside = section_at(of, keys[:-1])
    return None if inside is None else keys_of(inside).get(keys[-1])


def allowed(field: FieldInfo) -> str:
    """Return what a field accepts, in words that follow "must be"."""
    inside = section_of(field)
    return allowed_in(field) if inside is None else "a section with the keys " + ", ".join(keys_of(inside))


def about(field: FieldInfo) -> str:
    """Return what a field is, in a few words: its description, or the first line of its section's docstring."""
    inside = section_of(field)
    return field.description or ((inside.__doc__ or "").partition("\n")[0].rstrip(".") if inside else "")


def shown_key(key: str) -> str:
    """Return a key as a message shows it: an odd one in quotes, a long one cut."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]{1,60}", key) else f"{key[:60]!r}"


def _plain(value: Any) -> Any:
    if isinstance(value, Section):
        return value.plain()
    if isinstance(value, Mapping):
        return {name: _plain(inner) for name, inner in value.items()} or None
    return [_plain(inner) for inner in value] or None if isinstance(value, tuple) else value
