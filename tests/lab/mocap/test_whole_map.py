"""Mappings of full-body marker sets: what they accept, and what they say of what they do not."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import pytest
import tomli_w
from whole_markers import MAPPING

from liftopt.errors import InputError
from liftopt.lab.mocap.map_file import load_marker_map
from liftopt.lab.mocap.whole_map import WholeMap


@pytest.mark.parametrize(("name", "count"), [("plug_in_gait", 34), ("biomech_57", 44), ("pose2sim", 16)])
def test_shipped_full_body_sets_load_with_both_sides_alike(name: str, count: int) -> None:
    found = load_marker_map(name)
    assert isinstance(found, WholeMap)
    assert len(found.mapped()) == count
    mirrored = {
        label.replace("R", "L", 1) for label in found.landmark("hip", "right") + found.landmark("asis", "right")
    }
    assert mirrored == set(found.landmark("hip", "left") + found.landmark("asis", "left"))


def test_a_mapping_file(tmp_path: Any) -> None:
    path = tmp_path / "map.toml"
    path.write_text(tomli_w.dumps(MAPPING))
    found = load_marker_map(path)
    assert found == WholeMap.checked(MAPPING)
    segments = found.by_segment()
    assert segments["pelvis"] == ("RASI", "RPSI", "LASI", "LPSI")
    assert segments["right upper arm"] == ("RELB", "RELM", "RUPA")
    shank = next(group for group in found.shape_groups() if group.name == "right shank")
    assert shank.labels == ("RKNE", "RKNM", "RANK", "RANM", "RTIB")
    assert shank.judged == ("RANK", "RANM", "RTIB")


@pytest.mark.parametrize(
    ("place", "value", "match"),
    [
        (("body",), "both", "body = 'both': must be"),
        (
            ("landmarks", "right", "knee_lateral"),
            None,
            "right.knee_lateral: the knee takes knee or knee_lateral",
        ),
        (("landmarks", "left", "wrist_ulnar"), None, "landmarks.left.wrist_ulnar: is needed beside wrist_radial"),
        (("landmarks", "c7"), None, "landmarks.c7: the trunk takes all of"),
        (("landmarks", "right", "elbow_lateral"), 7, "landmarks.right.elbow_lateral = 7: must be a marker's label"),
        (("landmarks", "right", "tail"), "X", "landmarks.right.tail.*unknown key"),
        (("landmarks", "left"), None, "landmarks.left: is missing"),
        (("segments", "right", "shank"), ["RUPA"], "RUPA'.*already belongs to right upper arm"),
    ],
)
def test_a_wrong_mapping_is_refused_by_key(tmp_path: Any, place: tuple[str, ...], value: Any, match: str) -> None:
    data = deepcopy(MAPPING)
    target = data
    for key in place[:-1]:
        target = target[key]
    if value is None:
        del target[place[-1]]
    else:
        target[place[-1]] = value
    path = tmp_path / "map.toml"
    path.write_text(tomli_w.dumps(data))
    with pytest.raises(InputError, match=match):
        load_marker_map(path)
