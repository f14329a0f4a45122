"""Entries of a checked section: pydantic's fields with a unit and a meaning, and what is allowed in words.

What a field accepts stands in its annotation and metadata and nowhere else: checking, messages, help and the JSON
schema for editors follow from it.
"""

from __future__ import annotations

from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le
from pydantic import BeforeValidator, Field
from pydantic.fields import FieldInfo

from liftopt.files.number_text import number_meant
from liftopt.files.suggestions import did_you_mean, nearest

TRUTH = {"true": "true", "yes": "true", "on": "true", "1": "true"} | {
    "false": "false", "no": "false", "off": "false", "0": "false",
}  # fmt: skip
# Words that stand in a file for a number; None in Python.
FREE = "free"  # left to the solver
OFF = "off"  # not asked for


def number(about: str, unit: str, low: float, high: float, *, open_low: bool = False) -> Any:
    """Return the field of a finite number from ``low`` to ``high``; ``open_low`` excludes ``low`` itself."""
    extra: Any = {"unit": unit}
    if open_low:
        return Field(description=about, gt=low, le=high, allow_inf_nan=False, json_schema_extra=extra)
    return Field(description=about, ge=low, le=high, allow_inf_nan=False, json_schema_extra=extra)


def free_number(about: str, unit: str, low: float, high: float, word: str = FREE) -> Any:
    """Return the field of a number for which a word may stand in a file, and None in Python."""
    extra: Any = {"unit": unit, "word": word}
    return Field(description=about, ge=low, le=high, allow_inf_nan=False, json_schema_extra=extra)


def whole(about: str, low: int, high: int) -> Any:
    """Return the field of a whole number from ``low`` to ``high``."""
    return Field(description=about, ge=low, le=high)


def entry(about: str, allowed: str | None = None) -> Any:
    """Return the field of another type; ``allowed`` follows "must be" where the type does not say it."""
    return Field(description=about) if allowed is None else Field(
        description=about, json_schema_extra={"allowed": allowed}
    )  # fmt: skip


def _freed(value: object) -> object:
    return None if value == FREE else value


def _off(value: object) -> object:
    return None if value == OFF else value


OrFree, OrOff = BeforeValidator(_freed), BeforeValidator(_off)  # beside ``free_number``


def extra_of(field: FieldInfo) -> dict[str, Any]:
    """Return unit, word and the like of a field."""
    return field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}


def kinds_of(field: FieldInfo) -> tuple[Any, ...]:
    """Return the types that a field accepts, None left out."""
    return tuple(kind for kind in _flat(field.annotation) if kind is not NoneType)


def range_of(field: FieldInfo) -> tuple[float, float, bool]:
    """Return the least, the largest, and whether the least itself is excluded; infinite where there is no end."""
    low, high, is_open = float("-inf"), float("inf"), False
    for mark in field.metadata:
        if isinstance(mark, Ge):
            low = mark.ge  # type: ignore[assignment]
        elif isinstance(mark, Gt):
            low, is_open = mark.gt, True  # type: ignore[assignment]
        elif isinstance(mark, Le):
            high = mark.le  # type: ignore[assignment]
    return low, high, is_open


def allowed_in(field: FieldInfo) -> str:
    """Return what a field that is no section accepts, in words that follow "must be"."""
    extra, kinds = extra_of(field), kinds_of(field)
    if "allowed" in extra:
        return str(extra["allowed"])
    choices = choices_of(field)
    if choices:
        return " or ".join(f'"{value}"' if isinstance(value, str) else str(value) for value in choices)
    if kinds == (bool,):
        return "true or false"
    low, high, is_open = range_of(field)
    if kinds == (int,):
        return f"a whole number from {low} to {high}"
    span = f"above {low:g} and at most" if is_open else f"from {low:g} to"
    text = f"a number {span} {high:g} {extra.get('unit', '')}".rstrip()
    return f'{text}, or "{extra["word"]}"' if "word" in extra else text


def choices_of(field: FieldInfo) -> tuple[object, ...]:
    """Return the values of a field that accepts a few only; none if it accepts others."""
    kinds = kinds_of(field)
    return get_args(kinds[0]) if len(kinds) == 1 and get_origin(kinds[0]) is Literal else ()


def meant_by(field: FieldInfo, value: object) -> str:
    """Return the end of a message that says how to write what a refused value may have meant; empty if nothing."""
    if choices := choices_of(field):
        words = [choice for choice in choices if isinstance(choice, str)]
        return did_you_mean(nearest(value, words)) if isinstance(value, str) else ""
    extra, kinds = extra_of(field), kinds_of(field)
    low, high, _ = range_of(field)
    if kinds == (bool,):
        word = str(value).lower() if isinstance(value, (str, int)) else ""
        return f"; write {TRUTH[word]}" if word in TRUTH else ""
    if kinds == (int,):
        if isinstance(value, float) and value.is_integer() and low <= value <= high:
            return f"; write {value:.0f}"
        offer = number_meant(value, "", low, high) if isinstance(value, str) else ""
        return "" if "." in offer else offer
    if kinds != (float,):
        return ""
    if "word" in extra and isinstance(value, str) and value.lower() == extra["word"]:
        return f"; write {extra['word']}"
    return number_meant(value, str(extra.get("unit", "")), low, high)


def _flat(annotation: Any) -> list[Any]:
    """Return the members of a union, or the one type; annotations are peeled off."""
    while hasattr(annotation, "__metadata__"):
        annotation = annotation.__origin__
    if get_origin(annotation) in (Union, UnionType):
        return [kind for member in get_args(annotation) for kind in _flat(member)]
    return [annotation]
