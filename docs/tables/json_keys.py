"""What ``liftopt solve --json`` prints, from the summary of a lift."""

from __future__ import annotations

from typing import Any

from drawings.stage import default_lift
from liftopt.solution.summary import summary_dict
from tables import table

DEEP = ("scenario",)  # described elsewhere


def json_keys() -> str:
    """Return the keys of the object, dotted, each with an example's value; of a list, those of its first entry."""
    return table(("key", "in the default lift"), [(f"`{k}`", v) for k, v in _leaves("", summary_dict(default_lift()))])


def _leaves(prefix: str, value: Any) -> list[tuple[str, str]]:
    if prefix in DEEP:
        return [(prefix, "the scenario as solved, all defaults filled in")]
    if isinstance(value, dict) and value:
        return [leaf for key, item in value.items() for leaf in _leaves(f"{prefix}.{key}" if prefix else key, item)]
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return _leaves(f"{prefix}[]", value[0])
    return [(prefix, _shown(value))]


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return f"list of {len(value)}" if value else "empty list"
    if isinstance(value, float):
        return f"{value:.4g}"
    text = "null" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
