"""Which marker stands where: a TOML file that maps a laboratory's marker labels to segments and landmarks."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.lab.mocap.length_units import METRES
from liftopt.lab.mocap.recording import TO_Z_UP, Recording
from liftopt.lab.mocap.text_file import read_text
from liftopt.scenario.schema import Choice, Kind, Number, entries, section

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

SHIPPED = Path(__file__).parent / "maps"
Labels = tuple[str, ...]


@dataclass(frozen=True)
class MarkerLabels(Kind):
    """Labels of markers: one or several."""

    fewest: int

    @property
    def allowed(self) -> str:  # noqa: D102
        return "a marker's label or a list of them" if self.fewest == 1 else f"a list of {self.fewest} labels or more"

    def accept(self, key: str, value: Any) -> Labels:  # noqa: D102
        labels = (value,) if isinstance(value, str) else value
        if not isinstance(labels, (list, tuple)) or not all(isinstance(x, str) and x.strip() for x in labels):
            raise self.refuse(key, value)
        if len(set(labels)) < max(len(labels), self.fewest):
            raise self.refuse(key, value)
        return tuple(labels)


@dataclass(frozen=True, kw_only=True)
class Landmarks:
    """Points of the skeleton that a finger finds; where several labels are given, their mean is meant."""

    asis_right: Annotated[Labels, MarkerLabels("right front spine of the pelvis", 1)]
    asis_left: Annotated[Labels, MarkerLabels("left front spine of the pelvis", 1)]
    psis_right: Annotated[Labels, MarkerLabels("right rear spine of the pelvis", 1)]
    psis_left: Annotated[Labels, MarkerLabels("left rear spine of the pelvis", 1)]
    suprasternale: Annotated[Labels, MarkerLabels("notch above the breastbone", 1)]
    xiphoid: Annotated[Labels, MarkerLabels("lower end of the breastbone", 1)]
    c7: Annotated[Labels, MarkerLabels("spine at the base of the neck, C7 or T1", 1)]
    t8: Annotated[Labels, MarkerLabels("spine behind the lower end of the breastbone, T8 to T10", 1)]
    acromion_right: Annotated[Labels, MarkerLabels("tip of the right shoulder", 1)]
    elbow_lateral: Annotated[Labels, MarkerLabels("outer epicondyle of the right elbow", 1)]
    elbow_medial: Annotated[Labels, MarkerLabels("inner epicondyle of the right elbow", 1)]
    wrist_radial: Annotated[Labels, MarkerLabels("radial styloid, thumb side of the right wrist", 1)]
    wrist_ulnar: Annotated[Labels, MarkerLabels("ulnar styloid, little finger side of the right wrist", 1)]
    knuckle_index: Annotated[Labels, MarkerLabels("knuckle of the right index finger", 1)]
    knuckle_little: Annotated[Labels, MarkerLabels("knuckle of the right little finger", 1)]


@dataclass(frozen=True, kw_only=True)
class Segments:
    """Markers that move with each segment, besides its landmarks."""

    pelvis: Annotated[Labels, MarkerLabels("pelvis", 0)] = ()
    trunk: Annotated[Labels, MarkerLabels("rib cage", 0)] = ()
    scapula: Annotated[Labels, MarkerLabels("right shoulder blade; it only places the shoulder's centre", 0)] = ()
    upper_arm: Annotated[Labels, MarkerLabels("right upper arm", 0)] = ()
    forearm: Annotated[Labels, MarkerLabels("right forearm", 0)] = ()
    hand: Annotated[Labels, MarkerLabels("right hand without fingers", 0)] = ()
    object: Annotated[Labels, MarkerLabels("what is lifted", 0)] = ()


@dataclass(frozen=True, kw_only=True)
class Person:
    """What markers do not tell of the person; the stature is estimated from segments if it is 0."""

    sex: Annotated[str, Choice("whose segment data to use", ("male", "female", ""))] = ""
    mass: Annotated[float, Number("body mass; 0 where it is given elsewhere", "kg", 0.0, 200.0)] = 0.0
    stature: Annotated[float, Number("height of the person; 0 to estimate it", "m", 0.0, 2.2)] = 0.0


# Which segment a landmark belongs to.
HOME: dict[str, str] = {
    "asis_right": "pelvis", "asis_left": "pelvis", "psis_right": "pelvis", "psis_left": "pelvis",
    "suprasternale": "trunk", "xiphoid": "trunk", "c7": "trunk", "t8": "trunk",
    "elbow_lateral": "upper_arm", "elbow_medial": "upper_arm",
    "wrist_radial": "forearm", "wrist_ulnar": "forearm",
    "knuckle_index": "hand", "knuckle_little": "hand",
}  # fmt: skip
TRACKED = ("trunk", "upper_arm", "forearm", "hand")


@dataclass(frozen=True, kw_only=True)
class MarkerMap:
    """The mapping of one marker set.

    Raises:
        InputError: a key is missing, unknown or wrong, or a marker stands on two segments.
    """

    schema: Annotated[int, Choice("version of the mapping format", (1,))]
    up: Annotated[str, Choice("axis of the recording that points up", tuple(TO_Z_UP))]
    units: Annotated[str, Choice("unit of length of the file, whatever the file states", (*METRES, ""))] = ""
    landmarks: Landmarks
    segments: Segments = field(default_factory=Segments)
    subject: Person = field(default_factory=Person)

    def __post_init__(self) -> None:
        where: dict[str, str] = {}
        for segment, labels in self.by_segment().items():
            for label in labels:
                if label in where:
                    raise InputError(f"segments.{segment}", label, f"the marker already belongs to {where[label]}")
                where[label] = segment

    def landmark(self, name: str) -> Labels:
        """Return the labels of a landmark."""
        labels: Labels = getattr(self.landmarks, name)
        return labels

    def by_segment(self) -> dict[str, Labels]:
        """Return the labels of every segment that has any, landmarks first; the acromion is on the shoulder blade."""
        result: dict[str, list[str]] = {}
        for name, segment in HOME.items():
            result.setdefault(segment, []).extend(self.landmark(name))
        for entry in entries(Segments):
            result.setdefault(entry.name, []).extend(getattr(self.segments, entry.name))
        if result["scapula"]:
            result["scapula"].extend(self.landmark("acromion_right"))
        # One marker may stand for two landmarks of its segment (the sacrum for both rear spines).
        return {name: tuple(dict.fromkeys(labels)) for name, labels in result.items() if labels}

    def mapped(self) -> Labels:
        """Return all labels used, each once."""
        labels = [label for group in self.by_segment().values() for label in group]
        return tuple(dict.fromkeys([*labels, *self.landmark("acromion_right")]))


def shipped_maps() -> tuple[str, ...]:
    """Return the names of the mappings that come with liftopt."""
    return tuple(sorted(path.stem for path in SHIPPED.glob("*.toml")))


def load_marker_map(source: str | Path) -> MarkerMap:
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
    result: MarkerMap = section(MarkerMap).accept("", data)
    return result


def mapped_markers(recording: Recording, mapping: MarkerMap) -> tuple[Recording, Labels]:
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
