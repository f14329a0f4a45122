"""The mapping of a full-body marker set: landmarks of the midline and of both sides, and what moves with them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.entries import entry
from liftopt.files.section import Section
from liftopt.lab.mocap.marker_map import Axis, Cluster, Labels, Person, Unit, each_label_once, refuse_shared_markers
from liftopt.lab.mocap.outliers import ShapeGroup

SIDES = ("right", "left")
TRAVEL = 0.1  # m that an acromion may come nearer to a marker of the trunk, or go away from it


def _labels(about: str) -> Any:
    return entry(about, "a marker's label or a list of them")


class Side(Section):
    """Points of one half of the skeleton; where several labels are given, their mean is meant.

    Shoulder to ankle are joint centres, as video gives them: with them the points around that joint may be left out.
    """

    asis: Annotated[Cluster, _labels("front spine of the pelvis")] = ()
    psis: Annotated[Cluster, _labels("rear spine of the pelvis, or the sacrum for both sides")] = ()
    hip: Annotated[Cluster, _labels("centre of the hip")] = ()
    knee_lateral: Annotated[Cluster, _labels("outer epicondyle of the knee")] = ()
    knee_medial: Annotated[Cluster, _labels("inner epicondyle of the knee")] = ()
    knee: Annotated[Cluster, _labels("centre of the knee")] = ()
    ankle_lateral: Annotated[Cluster, _labels("outer malleolus")] = ()
    ankle_medial: Annotated[Cluster, _labels("inner malleolus")] = ()
    ankle: Annotated[Cluster, _labels("centre of the ankle")] = ()
    heel: Annotated[Cluster, _labels("heel")] = ()
    toe: Annotated[Cluster, _labels("head of the second metatarsal, or the big toe")] = ()
    acromion: Annotated[Cluster, _labels("tip of the shoulder")] = ()
    shoulder: Annotated[Cluster, _labels("centre of the shoulder")] = ()
    elbow_lateral: Annotated[Cluster, _labels("outer epicondyle of the elbow")] = ()
    elbow_medial: Annotated[Cluster, _labels("inner epicondyle of the elbow")] = ()
    elbow: Annotated[Cluster, _labels("centre of the elbow")] = ()
    wrist_radial: Annotated[Cluster, _labels("thumb side of the wrist")] = ()
    wrist_ulnar: Annotated[Cluster, _labels("little finger side of the wrist")] = ()
    wrist: Annotated[Cluster, _labels("centre of the wrist")] = ()
    knuckle_index: Annotated[Cluster, _labels("knuckle of the index finger")] = ()
    knuckle_middle: Annotated[Cluster, _labels("knuckle of the middle finger")] = ()
    knuckle_little: Annotated[Cluster, _labels("knuckle of the little finger")] = ()


class WholeLandmarks(Section):
    """Points of the skeleton that a finger finds, or that video shows."""

    suprasternale: Annotated[Cluster, _labels("notch above the breastbone")] = ()
    xiphoid: Annotated[Cluster, _labels("lower end of the breastbone")] = ()
    c7: Annotated[Cluster, _labels("spine at the base of the neck, C7 or T1")] = ()
    t8: Annotated[Cluster, _labels("spine behind the lower end of the breastbone, T8 to T10")] = ()
    right: Side
    left: Side


class SideClusters(Section):
    """Markers that move with the segments of one side, besides its landmarks."""

    upper_arm: Annotated[Cluster, _labels("upper arm")] = ()
    forearm: Annotated[Cluster, _labels("forearm")] = ()
    hand: Annotated[Cluster, _labels("hand without fingers")] = ()
    thigh: Annotated[Cluster, _labels("thigh")] = ()
    shank: Annotated[Cluster, _labels("shank")] = ()
    foot: Annotated[Cluster, _labels("foot")] = ()


class WholeClusters(Section):
    """Markers that move with each segment, besides its landmarks; those that a recording lacks are left out."""

    pelvis: Annotated[Cluster, _labels("pelvis")] = ()
    trunk: Annotated[Cluster, _labels("rib cage")] = ()
    object: Annotated[Cluster, _labels("what is lifted")] = ()
    right: SideClusters = SideClusters()
    left: SideClusters = SideClusters()


PELVIS, TRUNK = ("asis", "psis"), ("suprasternale", "xiphoid", "c7", "t8")
# Which segment of a side a landmark moves with; joint centres move with none.
HOME: dict[str, tuple[str, ...]] = {
    "upper_arm": ("elbow_lateral", "elbow_medial"),
    "forearm": ("wrist_radial", "wrist_ulnar"),
    "hand": ("knuckle_index", "knuckle_middle", "knuckle_little"),
    "thigh": ("knee_lateral", "knee_medial"),
    "shank": ("ankle_lateral", "ankle_medial"),
    "foot": ("heel", "toe"),
}
# Landmarks of the neighbour that keep their distances to a segment's markers, being near the joint between them.
BORDER = {"forearm": "upper_arm", "shank": "thigh", "foot": "shank"}
CENTRES = ("hip", "knee", "ankle", "shoulder", "elbow", "wrist")
# What shows a joint of a side: any one of these.
NEEDED: dict[str, tuple[str, ...]] = {
    "shoulder": ("shoulder", "acromion"),
    "elbow": ("elbow", "elbow_lateral"),
    "wrist": ("wrist", "wrist_radial"),
    "hip": ("hip", "asis"),
    "knee": ("knee", "knee_lateral"),
    "ankle": ("ankle", "ankle_lateral"),
}
# Of what one is given, the other must be too.
TOGETHER = {"wrist_radial": "wrist_ulnar", "asis": "psis"}


class WholeMap(Section):
    """The mapping of one full-body marker set.

    Raises:
        InputError: a key is unknown or wrong, landmarks do not suffice, or a marker stands on two segments.
    """

    version: Annotated[Literal[1], Field(alias="schema", description="version of the mapping format")]
    body: Annotated[Literal["whole"], entry("what the markers show of the person")]
    up: Annotated[Axis, entry("axis of the recording that points up")]
    units: Annotated[Unit, entry("unit of length of the file, whatever the file states")] = ""
    landmarks: WholeLandmarks
    segments: WholeClusters = WholeClusters()
    subject: Person = Person()

    @model_validator(mode="after")
    def _suffices(self) -> WholeMap:
        for side in SIDES:
            of_side: Side = getattr(self.landmarks, side)
            for joint, ways in NEEDED.items():
                if not any(getattr(of_side, way) for way in ways):
                    choice = " or ".join(ways)
                    raise InputError(f"landmarks.{side}.{ways[-1]}", NO_VALUE, f"the {joint} takes {choice}")
            for one, other in TOGETHER.items():
                if getattr(of_side, one) and not getattr(of_side, other):
                    raise InputError(f"landmarks.{side}.{other}", NO_VALUE, f"is needed beside {one}")
        given = [name for name in TRUNK if getattr(self.landmarks, name)]
        if given and len(given) < len(TRUNK):
            missing = next(name for name in TRUNK if name not in given)
            raise InputError(f"landmarks.{missing}", NO_VALUE, f"the trunk takes all of {', '.join(TRUNK)}, or none")
        if bool(self.landmarks.right.asis) != bool(self.landmarks.left.asis):
            raise InputError(
                "landmarks.left.asis", NO_VALUE, "the pelvis takes both sides, or the centres of both hips"
            )
        return self

    @model_validator(mode="after")
    def _each_marker_once(self) -> WholeMap:
        refuse_shared_markers(self.by_segment())
        return self

    def landmark(self, name: str, side: str = "") -> Labels:
        """Return the labels of a landmark, of the midline or of a side; none where it has none."""
        labels: Labels = getattr(getattr(self.landmarks, side) if side else self.landmarks, name)
        return labels

    def by_segment(self) -> dict[str, Labels]:
        """Return the labels of every segment that has any, landmarks first."""
        result: dict[str, list[str]] = {
            "pelvis": [label for side in SIDES for name in PELVIS for label in self.landmark(name, side)],
            "trunk": [label for name in TRUNK for label in self.landmark(name)],
            "object": [],
        }
        for name, labels in result.items():
            labels += getattr(self.segments, name)
        for side in SIDES:
            for name, home in HOME.items():
                own = [label for landmark in home for label in self.landmark(landmark, side)]
                result[f"{side} {name.replace('_', ' ')}"] = own + list(getattr(getattr(self.segments, side), name))
        return each_label_once(result)

    def alone(self) -> Iterator[tuple[str, Labels]]:
        """Give the landmarks that move with no segment, by name: acromia and joint centres."""
        for side in SIDES:
            for name in ("acromion", *CENTRES):
                if labels := self.landmark(name, side):
                    yield f"{side} {name}", labels

    def mapped(self) -> Labels:
        """Return all labels used, each once."""
        groups = [*self.by_segment().values(), *(labels for _, labels in self.alone())]
        return tuple(dict.fromkeys(label for labels in groups for label in labels))

    def shape_groups(self) -> list[ShapeGroup]:
        """Return the markers that keep their distances, by which outliers are found."""
        segments, groups = self.by_segment(), []
        for name, labels in segments.items():
            side, _, part = name.partition(" ")
            near = HOME.get(BORDER.get(part.replace(" ", "_"), ""), ())
            border = [label for landmark in near for label in self.landmark(landmark, side)]
            groups.append(ShapeGroup(name, (*border, *labels), labels))
        for name, labels in self.alone():
            beside = segments.get("trunk", ()) if name.endswith("acromion") else ()
            groups.append(ShapeGroup(name, (*beside, *labels), labels, TRAVEL))
        return groups

    def without(self, gone: set[str]) -> WholeMap:
        """Return the mapping without some markers of the clusters."""

        def kept(cluster: Labels) -> list[str]:
            return [label for label in cluster if label not in gone]

        def of_side(side: str) -> dict[str, list[str]]:
            clusters: SideClusters = getattr(self.segments, side)
            return {name: kept(getattr(clusters, name)) for name in SideClusters.model_fields}

        middle = {name: kept(getattr(self.segments, name)) for name in ("pelvis", "trunk", "object")}
        clusters = WholeClusters.checked(middle | {side: of_side(side) for side in SIDES}, "segments.")
        return self.changed(segments=clusters)

    def landmark_of(self, label: str) -> str:
        """Return which landmark a marker is, ``"right.asis"``; empty if it is none."""
        for name in TRUNK:
            if label in self.landmark(name):
                return name
        for side in SIDES:
            for name in Side.model_fields:
                if label in self.landmark(name, side):
                    return f"{side}.{name}"
        return ""
