"""Force plates and whole files against ezc3d, which reads them by itself; and a push on a plate in closed form."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.lab.mocap.c3d import read_c3d

CORNERS = np.array([[500.0, 20.0, 3.0], [0.0, 0.0, 0.0], [-16.0, 400.0, 0.0], [484.0, 420.0, 3.0]])


def _with_plate(file: Any, kind: int, channels: int, origin: list[float], **more: Any) -> None:
    rng = np.random.default_rng(kind)
    file.analog = np.round(rng.uniform(50.0, 900.0, (len(file.analog), channels)), 1)
    for name, value in (("USED", channels), ("OFFSET", [0] * channels), ("SCALE", [0.5] * channels)):
        file.parameters["ANALOG"][name] = value
    for name in ("LABELS", "UNITS"):
        file.parameters["ANALOG"][name] = ["N"] * channels
    file.parameters["FORCE_PLATFORM"] = {
        "USED": 1,
        "TYPE": [kind],
        "ZERO": [0, 0],
        "CHANNEL": np.arange(1, channels + 1)[:, None],
        "CORNERS": CORNERS.T[:, :, None],
        "ORIGIN": np.array(origin)[:, None],
        **more,
    }


@pytest.mark.parametrize(
    ("kind", "channels", "origin"),
    [
        (1, 6, [0.0, 0.0, -20.0]),
        (2, 6, [1.5, -2.0, -40.0]),
        (2, 6, [1.5, -2.0, 40.0]),
        (3, 8, [120.0, 200.0, -50.0]),
        (4, 6, [0.0, 0.0, -35.0]),
    ],
)
def test_plates_of_all_types_against_ezc3d(
    kind: int, channels: int, origin: list[float], c3d_file: Any, tmp_path: Path
) -> None:
    ezc3d = pytest.importorskip("ezc3d", reason="ezc3d is not installed (it is in the extra 'test')")
    more = {"CAL_MATRIX": np.random.default_rng(0).uniform(-2.0, 2.0, (6, 6, 1))} if kind == 4 else {}
    _with_plate(c3d_file, kind, channels, origin, **more)
    path = c3d_file.write(tmp_path / "a.c3d")
    (found,) = read_c3d(path).plates
    (theirs,) = ezc3d.c3d(str(path), extract_forceplat_data=True)["data"]["platform"]
    assert found.rate == 400.0
    np.testing.assert_allclose(found.force, theirs["force"].T, rtol=1e-6, atol=1e-4)
    np.testing.assert_allclose(found.corners, theirs["corners"].T / 1000.0, rtol=1e-6)
    np.testing.assert_allclose(found.centre_of_pressure, theirs["center_of_pressure"].T / 1000.0, rtol=1e-5, atol=1e-6)
    if kind != 1:  # of that type ezc3d 1.7 gives the moment with the other sign
        np.testing.assert_allclose(found.moment, theirs["moment"].T / 1000.0, rtol=1e-5, atol=1e-4)


def test_a_push_is_where_it_is(c3d_file: Any, tmp_path: Path) -> None:
    """80 N down, 0.1 m and -0.05 m from the middle of a plate whose transducer lies 40 mm below its surface."""
    _with_plate(c3d_file, 2, 6, [0.0, 0.0, -40.0])
    c3d_file.parameters["FORCE_PLATFORM"]["CORNERS"] = np.array(
        [[250.0, -200.0, 0.0], [-250.0, -200.0, 0.0], [-250.0, 200.0, 0.0], [250.0, 200.0, 0.0]]
    ).T[:, :, None]
    force, axes = np.array([6.0, -4.0, -80.0]), np.diag([1.0, -1.0, -1.0])  # the plate's Z points down
    place = np.array([100.0, -50.0, 40.0])  # seen from the transducer
    c3d_file.analog[:] = np.concatenate([axes @ force, axes @ np.cross(place, force)])
    (found,) = read_c3d(c3d_file.write(tmp_path / "a.c3d")).plates
    np.testing.assert_allclose(found.force[0], force)
    np.testing.assert_allclose(found.centre_of_pressure[0], [0.1, -0.05, 0.0], atol=1e-7)
    np.testing.assert_allclose(found.moment[0], np.cross([0.1, -0.05, 0.0], force), atol=1e-6)


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("TYPE", [5], "type 5 of plate 1 is not among 1, 2, 3, 4"),
        ("TYPE", [4], "CAL_MATRIX is missing or incomplete for plate 1"),
        ("CHANNEL", [[1], [2], [3], [4], [5], [60]], "CHANNEL does not name 6 of the 6 channels for plate 1"),
        ("CORNERS", [[0.0], [0.0], [0.0]], "CORNERS is missing or incomplete"),
        ("CORNERS", np.zeros((3, 4, 1)), "the corners of plate 1 are no rectangle"),
        ("USED", 2, "TYPE is missing or incomplete for plate 2"),
    ],
)
def test_plates_that_cannot_be_read_are_noted_and_the_markers_kept(
    name: str, value: Any, reason: str, c3d_file: Any, plain_points: Any, tmp_path: Path
) -> None:
    _with_plate(c3d_file, 2, 6, [0.0, 0.0, -40.0])
    c3d_file.parameters["FORCE_PLATFORM"][name] = value
    found = read_c3d(c3d_file.write(tmp_path / "a.c3d"))
    np.testing.assert_allclose(found.points, plain_points(), rtol=1e-6)
    assert found.plates == ()
    assert any("force plates are stated but could not be read" in note and reason in note for note in found.notes)


def test_a_real_file_against_ezc3d(box_lift: Path) -> None:
    ezc3d = pytest.importorskip("ezc3d", reason="ezc3d is not installed (it is in the extra 'test')")
    path = box_lift / "markers_analogs.c3d"
    found, theirs = read_c3d(path), ezc3d.c3d(str(path))
    assert found.notes == ()
    points = theirs["data"]["points"][:3].transpose(2, 1, 0)
    seen = theirs["data"]["meta_points"]["residuals"][0].T >= 0.0
    index = [theirs["parameters"]["POINT"]["LABELS"]["value"].index(label) for label in found.labels]
    known = np.isfinite(found.points).all(axis=2)
    zeros = np.all(points[:, index] == 0.0, axis=2)
    np.testing.assert_array_equal(known, seen[:, index] & np.isfinite(points[:, index]).all(axis=2) & ~zeros)
    np.testing.assert_allclose(found.points[known], points[:, index][known], rtol=1e-6)
    assert found.analog is not None
    np.testing.assert_allclose(found.analog.values, theirs["data"]["analogs"][0].T, rtol=1e-6, atol=1e-9)
