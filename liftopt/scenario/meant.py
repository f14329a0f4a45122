"""Which keys of a scenario a wrong one may have meant: misspelt, without its section, or in the words of the field."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping, Sequence

from liftopt.files.suggestions import MOST, nearest

# Words of the field for what a scenario calls otherwise.
KINDS = {
    **dict.fromkeys(("person", "people", "subject", "man", "woman", "worker", "human"), "person"),
    **dict.fromkeys(("arm", "sawyer", "robot"), "robot"),
}
SECTIONS = {
    **dict.fromkeys(("box", "load", "payload", "desk", "table"), "object"),
    "gripper": "tool",
    "weights": "objective",
}
ENTRIES = {"weight": "mass", "gender": "sex", "time": "duration", "seconds": "duration", "n": "intervals"}
OF_KIND = {
    "person": {"height": "stature", "size": "stature"},
    "object": {"length": "depth"},
}


def nearest_keys(key: str, known: Sequence[str], agents: Mapping[str, str]) -> list[str]:
    """Return the known dotted keys that a key may have meant, best first.

    Args:
        key: that is not known.
        known: dotted keys, agents by name.
        agents: kind by name.
    """
    *outer, last = re.split(r"[./:\s]+", key.lower().replace("-", "_"))
    if outer == ["objective"] and (weight := f"{last.removesuffix('_weight')}.weight") in known:
        return [weight]  # where it stood in schema 1
    outer, last = [_section(part, agents, known) for part in outer], ENTRIES.get(last, last)
    if outer:
        last = OF_KIND.get(agents.get(outer[0], outer[0]), {}).get(last, last)
    wanted = ".".join([*outer, last])
    if wanted in known:
        return [wanted]
    lasts = {name.rpartition(".")[2] for name in known}
    for name in [last] if last in lasts else [_section(last, agents, known), *nearest(last, sorted(lasts))]:
        found = [other for other in known if other.rpartition(".")[2] == name]
        if outer:
            section = nearest(outer[0], sorted({other.partition(".")[0] for other in known}))
            found = [other for other in found if other.partition(".")[0] in section] or found
        if found:
            found.sort(key=lambda other: -difflib.SequenceMatcher(None, wanted, other).ratio())
            return found[:MOST]
    return nearest(wanted, known)


def _section(word: str, agents: Mapping[str, str], known: Sequence[str]) -> str:
    """Return what a scenario calls a section that somebody called ``word``."""
    if any(key == word or key.startswith(f"{word}.") for key in known):
        return word
    word = next(iter(nearest(word, [*KINDS, *SECTIONS])), word)
    of_kind = [name for name, kind in agents.items() if kind == KINDS.get(word)]
    return of_kind[0] if of_kind else SECTIONS.get(word, word)
