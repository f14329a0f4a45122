"""Mapping files: what they accept, and what they say of what they do not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from liftopt.errors import InputError
from liftopt.lab.mocap.map_file import load_marker_map, mapped_markers, shipped_maps
from liftopt.lab.mocap.recording import Recording


def test_shipped_mappings_load() -> None:
    assert "box_lift" in shipped_maps()
    found = load_marker_map("box_lift")
    segments = found.by_segment()
    assert segments["pelvis"] == ("ASISr", "ASISl", "PSISr", "PSISl")
    assert segments["scapula"][-1] == "ACRO_tip"
    assert len(found.mapped()) == 44


def test_a_mapping_file(truth: Any, tmp_path: Path) -> None:
    path = tmp_path / "map.toml"
    path.write_text(tomli_w.dumps(truth.mapping_dict))
    assert load_marker_map(path) == truth.mapping


@pytest.mark.parametrize(
    ("section", "key", "value", "match"),
    [
        (None, "up", "up", "up = 'up': must be"),
        (None, "units", "ell", "units = 'ell'"),
        (None, "schema", 2, "schema = 2"),
        (None, "unit", "mm", "unit = 'mm': unknown key; did you mean units"),
        ("landmarks", "c7", None, "landmarks.c7: is missing"),
        ("landmarks", "c7", 7, "landmarks.c7 = 7: must be a marker's label"),
        ("landmarks", "c7", [], "landmarks.c7 = "),
        (
            "segments",
            "forearm",
            ["FORE1", "ARM1"],
            "segments.forearm = 'ARM1': the marker already belongs to upper_arm",
        ),
        ("segments", "tail", ["X"], "segments.tail.*unknown key"),
        ("subject", "mass", -1.0, "subject.mass = -1.0"),
    ],
)
def test_a_wrong_mapping_is_refused_by_key(
    truth: Any, tmp_path: Path, section: str | None, key: str, value: Any, match: str
) -> None:
    data = {name: dict(entry) if isinstance(entry, dict) else entry for name, entry in truth.mapping_dict.items()}
    target = data[section] if section else data
    if value is None:
        del target[key]
    else:
        target[key] = value
    path = tmp_path / "map.toml"
    path.write_text(tomli_w.dumps(data))
    with pytest.raises(InputError, match=match):
        load_marker_map(path)


def test_files_that_are_no_mapping(tmp_path: Path) -> None:
    path = tmp_path / "map.toml"
    for content, match in (
        (b"a = [", "not valid TOML"),
        (b"", "is empty"),
        (b"\0\1", "binary"),
        (b"a = '\xff'", "not valid"),
    ):
        path.write_bytes(content)
        with pytest.raises(InputError, match=match):
            load_marker_map(path)
    with pytest.raises(
        InputError, match=r"no such file, nor a shipped mapping \(.*box_lift.*\); did you mean box_lift"
    ):
        load_marker_map("box_lft")
    with pytest.raises(InputError, match="no such file"):
        load_marker_map("no_such_map")


def test_labels_with_a_prefix_and_labels_that_are_not_unique(truth: Any) -> None:
    recording = truth.recording
    prefixed = Recording("f", 100.0, recording.time, tuple(f"Ann:{x}" for x in recording.labels), recording.points)
    found, unused = mapped_markers(prefixed, truth.mapping)
    assert (found.labels, unused) == (truth.mapping.mapped(), ())
    twice = (*prefixed.labels, "Bob:STER", "*12")
    points = np.concatenate([recording.points, recording.points[:, :2]], axis=1)
    with pytest.raises(InputError, match=r"f = 'STER': .*channels 5 \(Ann:STER\), 25 \(Bob:STER\)"):
        mapped_markers(Recording("f", 100.0, recording.time, twice, points), truth.mapping)
    named = Recording("f", 100.0, recording.time, (*prefixed.labels, "Bob:OTHER", "*12"), points)
    assert mapped_markers(named, truth.mapping)[1] == ("Bob:OTHER", "*12")
