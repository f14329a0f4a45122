"""What a misspelt name may have meant: the nearest of those there are."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence

LIKE = 0.7  # ratio of difflib from which two words are taken for each other
MOST = 3  # names that a message offers


def nearest(word: str, known: Iterable[str], most: int = 1) -> list[str]:
    """Return the known words that a word may have meant, best first; case and ``-`` for ``_`` do not count."""
    plain = {_plain(name): name for name in known}
    return [plain[name] for name in difflib.get_close_matches(_plain(word), plain, n=most, cutoff=LIKE)]


def did_you_mean(names: Sequence[str]) -> str:
    """Return the end of a message that offers names, ``"; did you mean a, b or c?"``; empty if there are none."""
    if not names:
        return ""
    return "; did you mean " + " or ".join(filter(None, (", ".join(names[:-1]), names[-1]))) + "?"


def _plain(word: str) -> str:
    return word.lower().replace("-", "_")
