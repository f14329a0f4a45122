"""What a misspelt name may have meant: the nearest of those there are."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence

LIKE = 0.7  # ratio of difflib from which two words are taken for each other
MOST = 3  # names that a message offers
# Words of the field for what the scenario calls otherwise.
SECTIONS = {
    **dict.fromkeys(("person", "people", "subject", "man", "woman", "worker"), "human"),
    **dict.fromkeys(("object", "box", "load", "payload", "desk"), "table"),
    **dict.fromkeys(("arm", "sawyer"), "robot"),
    "gripper": "tool",
    "weights": "objective",
}
ENTRIES = {"weight": "mass", "gender": "sex", "time": "duration", "seconds": "duration", "n": "intervals"}
WHOLE = {"human.height": "human.stature", "human.size": "human.stature", "table.length": "table.depth"}


def nearest(word: str, known: Iterable[str], most: int = 1) -> list[str]:
    """Return the known words that a word may have meant, best first; case and ``-`` for ``_`` do not count."""
    plain = {_plain(name): name for name in known}
    return [plain[name] for name in difflib.get_close_matches(_plain(word), plain, n=most, cutoff=LIKE)]


def nearest_keys(key: str, known: Sequence[str]) -> list[str]:
    """Return the known dotted keys that a key may have meant, best first: misspelt, without or in another section."""
    *outer, last = re.split(r"[./:\s]+", _plain(key))
    outer, last = [SECTIONS.get(part, part) for part in outer], ENTRIES.get(last, last)
    wanted = ".".join([*outer, last])
    wanted = WHOLE.get(wanted, wanted)
    if wanted in known:
        return [wanted]
    last = wanted.rpartition(".")[2]
    lasts = {name.rpartition(".")[2] for name in known}
    for name in [last] if last in lasts else [SECTIONS.get(last, ""), *nearest(last, sorted(lasts))]:
        found = [other for other in known if other.rpartition(".")[2] == name]
        if outer:
            section = nearest(outer[0], sorted({other.partition(".")[0] for other in known}))
            found = [other for other in found if other.partition(".")[0] in section] or found
        if found:
            found.sort(key=lambda other: -difflib.SequenceMatcher(None, wanted, other).ratio())
            return found[:MOST]
    return nearest(wanted, known)


def did_you_mean(names: Sequence[str]) -> str:
    """Return the end of a message that offers names, ``"; did you mean a, b or c?"``; empty if there are none."""
    if not names:
        return ""
    return "; did you mean " + " or ".join(filter(None, (", ".join(names[:-1]), names[-1]))) + "?"


def _plain(word: str) -> str:
    return word.lower().replace("-", "_")
