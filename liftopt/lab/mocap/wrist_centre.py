"""The third point of a hand with two markers: the wrist's centre, which the forearm's markers show.

Marker sets of the upper limb put two markers on the knuckles and none else on the hand (Wu et al. 2005, J Biomech
38:981-992, need no more than that and the wrist).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liftopt.lab.mocap.marker_map import Labels, MarkerMap
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.rigid import FEWEST

WRIST = "wrist centre"


def needs_wrist(mapping: MarkerMap) -> bool:
    """Return whether the hand has one marker less than a pose takes."""
    return len(mapping.by_segment()["hand"]) == FEWEST - 1


def with_wrist(mapping: MarkerMap) -> dict[str, Labels]:
    """Return the labels of every segment, with the wrist's centre where the hand needs it."""
    groups = mapping.by_segment()
    return groups | {"hand": (*groups["hand"], WRIST)} if needs_wrist(mapping) else groups


def with_wrist_centre(recording: Recording, mapping: MarkerMap) -> Recording:
    """Return the recording with the centre of the wrist as one more marker if the hand needs it."""
    if not needs_wrist(mapping):
        return recording
    sides = [
        recording.points[:, [recording.index(label) for label in mapping.landmark(name)]].mean(axis=1)
        for name in ("wrist_radial", "wrist_ulnar")
    ]
    centre = np.mean(sides, axis=0)[:, None]
    return replace(
        recording,
        labels=(*recording.labels, WRIST),
        points=np.concatenate([recording.points, centre], axis=1),
        notes=(*recording.notes, "the hand has two markers; the wrist's centre is its third point"),
    )
