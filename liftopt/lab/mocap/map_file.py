"""Mappings in TOML files, a user's or shipped ones, and what of a recording they use."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.lab.mocap.marker_map import Labels, MarkerMap
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.text_file import read_text
from liftopt.lab.mocap.whole_map import WholeMap

SHIPPED = Path(__file__).parent / "maps"
AnyMap = MarkerMap | WholeMap
KINDS: dict[Any, type[AnyMap]] = {"arm": MarkerMap, "whole": WholeMap}


def shipped_maps() -> tuple[str, ...]:
    """Return the names of the mappings that come with liftopt."""
    return tuple(sorted(path.stem for path in SHIPPED.glob("*.toml")))


def load_marker_map(source: str | Path) -> AnyMap:
    """Return the mapping of a TOML file, or the shipped one of that name.

    Raises:
        InputError: the file cannot be read, is not TOML, or is no mapping; the message names the key.
    """
    shipped = shipped_maps()
    path = SHIPPED / f"{source}.toml" if source in shipped else Path(source)
    if not os.path.exists(path):  # not even where no path can be like this
        meant = did_you_mean(nearest(str(source), shipped))
        raise InputError(str(source), NO_VALUE, f"no such file, nor a shipped mapping ({', '.join(shipped)}){meant}")
    try:
        data = tomllib.loads(read_text(path, "a mapping in TOML").decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:  # UnicodeDecodeError is a ValueError too
        raise InputError(str(path), NO_VALUE, f"is not valid TOML: {error}") from None
    body = data.get("body", "arm")
    if not isinstance(body, str) or body not in KINDS:
        raise InputError("body", body, 'must be "arm" (trunk and right arm) or "whole"')
    return KINDS[body].checked(data)


def without_lacking(recording: Recording, mapping: WholeMap) -> tuple[WholeMap, list[str]]:
    """Return the mapping without markers of its clusters that a recording lacks, and what was left out."""
    lacking = [
        label
        for label in mapping.mapped()
        if not (_is_there(recording, label) or mapping.landmark_of(label) or label in mapping.segments.object)
    ]
    if not lacking:
        return mapping, []
    return mapping.without(set(lacking)), [f"the recording lacks {', '.join(lacking)} of the mapping: not needed"]


def mapped_markers(recording: Recording, mapping: AnyMap) -> tuple[Recording, Labels]:
    """Return the recording with the mapped markers only, and the labels of the others.

    Raises:
        InputError: labels are missing in the recording or are ambiguous; all missing ones are named.
    """
    missing = [label for label in mapping.mapped() if not _is_there(recording, label)]
    if missing:
        listed = ", ".join(missing)
        raise InputError("mapping", listed, f"not in {recording.source}, which has {_short(recording.labels)}")
    used = {recording.index(label) for label in mapping.mapped()}
    unused = tuple(label for i, label in enumerate(recording.labels) if i not in used)
    return recording.select(mapping.mapped()), unused


def _is_there(recording: Recording, label: str) -> bool:
    return any(name == label or name.rpartition(":")[2] == label for name in recording.labels)


def _short(labels: Iterable[str]) -> str:
    labels = list(labels)
    return ", ".join(labels[:60]) + (f" and {len(labels) - 60} more" if len(labels) > 60 else "")
