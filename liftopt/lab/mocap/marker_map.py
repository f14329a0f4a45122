"""Which marker stands where on trunk and right arm: a laboratory's marker labels by landmark and segment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from liftopt.errors import InputError
from liftopt.files.entries import entry, number
from liftopt.files.section import Section
from liftopt.lab.mocap.length_units import METRES
from liftopt.lab.mocap.recording import TO_Z_UP

Labels = tuple[str, ...]
if TYPE_CHECKING:
    Axis: TypeAlias = str
    Unit: TypeAlias = str
else:
    Axis, Unit = Literal[tuple(TO_Z_UP)], Literal[(*METRES, "")]


def _listed(value: object) -> object:
    """Return one label or several as a tuple of different ones; raises ValueError for anything else."""
    labels = (value,) if isinstance(value, str) else value
    if not isinstance(labels, (list, tuple)) or not all(isinstance(x, str) and x.strip() for x in labels):
        raise ValueError("no labels")
    if len(set(labels)) < len(labels):
        raise ValueError("the same label twice")
    return tuple(labels)


def _some(labels: Labels) -> Labels:
    if not labels:
        raise ValueError("no label")
    return labels


Listed = BeforeValidator(_listed)
Landmark = Annotated[Labels, Listed, AfterValidator(_some)]
Cluster = Annotated[Labels, Listed]


def _landmark(about: str) -> Any:
    return entry(about, "a marker's label or a list of them")


def _cluster(about: str) -> Any:
    return entry(about, "a list of 0 labels or more")


class Landmarks(Section):
    """Points of the skeleton that a finger finds; where several labels are given, their mean is meant."""

    asis_right: Annotated[Landmark, _landmark("right front spine of the pelvis")]
    asis_left: Annotated[Landmark, _landmark("left front spine of the pelvis")]
    psis_right: Annotated[Landmark, _landmark("right rear spine of the pelvis")]
    psis_left: Annotated[Landmark, _landmark("left rear spine of the pelvis")]
    suprasternale: Annotated[Landmark, _landmark("notch above the breastbone")]
    xiphoid: Annotated[Landmark, _landmark("lower end of the breastbone")]
    c7: Annotated[Landmark, _landmark("spine at the base of the neck, C7 or T1")]
    t8: Annotated[Landmark, _landmark("spine behind the lower end of the breastbone, T8 to T10")]
    acromion_right: Annotated[Landmark, _landmark("tip of the right shoulder")]
    elbow_lateral: Annotated[Landmark, _landmark("outer epicondyle of the right elbow")]
    elbow_medial: Annotated[Landmark, _landmark("inner epicondyle of the right elbow")]
    wrist_radial: Annotated[Landmark, _landmark("radial styloid, thumb side of the right wrist")]
    wrist_ulnar: Annotated[Landmark, _landmark("ulnar styloid, little finger side of the right wrist")]
    knuckle_index: Annotated[Landmark, _landmark("knuckle of the right index finger")]
    knuckle_little: Annotated[Landmark, _landmark("knuckle of the right little finger")]


class Segments(Section):
    """Markers that move with each segment, besides its landmarks."""

    pelvis: Annotated[Cluster, _cluster("pelvis")] = ()
    trunk: Annotated[Cluster, _cluster("rib cage")] = ()
    scapula: Annotated[Cluster, _cluster("right shoulder blade; it only places the shoulder's centre")] = ()
    upper_arm: Annotated[Cluster, _cluster("right upper arm")] = ()
    forearm: Annotated[Cluster, _cluster("right forearm")] = ()
    hand: Annotated[Cluster, _cluster("right hand without fingers")] = ()
    object: Annotated[Cluster, _cluster("what is lifted")] = ()


class Person(Section):
    """What markers do not tell of the person; the stature is estimated from segments if it is 0."""

    sex: Annotated[Literal["male", "female", ""], entry("whose segment data to use")] = ""
    mass: Annotated[float, number("body mass; 0 where it is given elsewhere", "kg", 0.0, 200.0)] = 0.0
    stature: Annotated[float, number("height of the person; 0 to estimate it", "m", 0.0, 2.2)] = 0.0


# Which segment a landmark belongs to.
HOME: dict[str, str] = {
    "asis_right": "pelvis", "asis_left": "pelvis", "psis_right": "pelvis", "psis_left": "pelvis",
    "suprasternale": "trunk", "xiphoid": "trunk", "c7": "trunk", "t8": "trunk",
    "elbow_lateral": "upper_arm", "elbow_medial": "upper_arm",
    "wrist_radial": "forearm", "wrist_ulnar": "forearm",
    "knuckle_index": "hand", "knuckle_little": "hand",
}  # fmt: skip
TRACKED = ("trunk", "upper_arm", "forearm", "hand")


def each_label_once(segments: Mapping[str, Sequence[str]]) -> dict[str, Labels]:
    """Return the labels of every segment that has any, each once.

    One marker may stand for two landmarks of its segment (the sacrum for both rear spines).
    """
    return {name: tuple(dict.fromkeys(labels)) for name, labels in segments.items() if labels}


def refuse_shared_markers(segments: Mapping[str, Labels]) -> None:
    """Raise InputError if a marker stands on two segments."""
    where: dict[str, str] = {}
    for segment, labels in segments.items():
        for label in labels:
            if label in where:
                raise InputError(f"segments.{segment}", label, f"the marker already belongs to {where[label]}")
            where[label] = segment


class MarkerMap(Section):
    """The mapping of one marker set.

    Raises:
        InputError: a key is missing, unknown or wrong, or a marker stands on two segments.
    """

    version: Annotated[Literal[1], Field(alias="schema", description="version of the mapping format")]
    body: Annotated[Literal["arm"], entry("what the markers show of the person")] = "arm"
    up: Annotated[Axis, entry("axis of the recording that points up")]
    units: Annotated[Unit, entry("unit of length of the file, whatever the file states")] = ""
    landmarks: Landmarks
    segments: Segments = Segments()
    subject: Person = Person()

    @model_validator(mode="after")
    def _each_marker_once(self) -> MarkerMap:
        refuse_shared_markers(self.by_segment())
        return self

    def landmark(self, name: str) -> Labels:
        """Return the labels of a landmark."""
        labels: Labels = getattr(self.landmarks, name)
        return labels

    def by_segment(self) -> dict[str, Labels]:
        """Return the labels of every segment that has any, landmarks first; the acromion is on the shoulder blade."""
        result: dict[str, list[str]] = {}
        for name, segment in HOME.items():
            result.setdefault(segment, []).extend(self.landmark(name))
        for name in Segments.model_fields:
            result.setdefault(name, []).extend(getattr(self.segments, name))
        if result["scapula"]:
            result["scapula"].extend(self.landmark("acromion_right"))
        return each_label_once(result)

    def mapped(self) -> Labels:
        """Return all labels used, each once."""
        labels = [label for group in self.by_segment().values() for label in group]
        return tuple(dict.fromkeys([*labels, *self.landmark("acromion_right")]))

    def landmark_of(self, label: str) -> str:
        """Return which landmark a marker is; empty if it is none."""
        return next((name for name, labels in self.landmarks if label in labels), "")

    def without(self, gone: Set[str]) -> MarkerMap:
        """Return the mapping without some markers of the segments."""
        kept = {name: tuple(x for x in getattr(self.segments, name) if x not in gone) for name in Segments.model_fields}
        return self.changed(segments=Segments(**kept))
