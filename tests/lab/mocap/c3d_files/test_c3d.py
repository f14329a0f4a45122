"""C3D files: written by ezc3d, by py-c3d and by hand, and broken ones. The oracle is what was put in."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.errors import InputError
from liftopt.lab.mocap.c3d import read_c3d
from liftopt.lab.mocap.recording import in_metres

pytest.importorskip("ezc3d", reason="ezc3d is not installed (it is in the extra 'test')")

FRAMES, LABELS = 20, ("A", "B", "*1", "D", "D")


@pytest.fixture(scope="module")
def points() -> Any:
    return np.random.default_rng(0).uniform(-900.0, 900.0, (FRAMES, len(LABELS), 3))


@pytest.fixture(scope="module")
def written(points: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a file of ezc3d with analog channels, a force plate, an occluded point, one at the origin and twins."""
    import ezc3d

    file = ezc3d.c3d()
    values = np.ones((4, len(LABELS), FRAMES))
    values[:3] = points.transpose(2, 1, 0)
    values[:3, 4] = values[:3, 3]
    values[:3, 0, 7] = 0.0
    residuals = np.zeros((1, len(LABELS), FRAMES))
    residuals[0, 1, 3] = -1.0
    file["data"]["points"], file["data"]["meta_points"]["residuals"] = values, residuals
    point, analog = file["parameters"]["POINT"], file["parameters"]["ANALOG"]
    point["RATE"]["value"], point["LABELS"]["value"], point["UNITS"]["value"] = [100.0], list(LABELS), ["mm"]
    analog["RATE"]["value"], analog["LABELS"]["value"] = [1000.0], ["Fx", "Fy", "Fz", "Mx", "My", "Mz"]
    analog["UNITS"]["value"] = ["N", "N", "N", "Nmm", "Nmm", "Nmm"]
    channels = np.zeros((1, 6, FRAMES * 10))
    channels[0, 0], channels[0, 2] = 30.0, -700.0
    file["data"]["analogs"] = channels

    def plate(name: str, value: Any) -> None:
        file.add_parameter("FORCE_PLATFORM", name, value)
        entry = file["parameters"]["FORCE_PLATFORM"][name]
        entry["type"], entry["value"] = 2, np.array(value, dtype=int)

    plate("USED", [1])
    plate("TYPE", [2])
    plate("ZERO", [1, 0])
    plate("CHANNEL", [[k] for k in range(1, 7)])
    corners = np.array([[500.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 400.0, 0.0], [500.0, 400.0, 0.0]]).T
    file.add_parameter("FORCE_PLATFORM", "CORNERS", corners[:, :, None])
    file.add_parameter("FORCE_PLATFORM", "ORIGIN", np.array([[0.0, 0.0, -40.0]]).T)
    path = tmp_path_factory.mktemp("c3d") / "trial.c3d"
    file.write(str(path))
    return path


def test_a_file_of_ezc3d(written: Path, points: Any) -> None:
    before = hashlib.sha256(written.read_bytes()).hexdigest()
    found = read_c3d(written)
    assert hashlib.sha256(written.read_bytes()).hexdigest() == before
    assert found.labels == ("A", "B", "*1", "D")  # of the twins, whose data are the same, one is left
    assert (found.rate, found.units) == (100.0, "mm")
    np.testing.assert_allclose(found.time, np.arange(FRAMES) / 100.0)
    expected = points[:, :4].copy()
    expected[3, 1] = np.nan
    expected[7, 0] = np.nan
    np.testing.assert_allclose(found.points, expected, rtol=1e-6)
    assert any("1 points at the origin" in note for note in found.notes)
    assert any("channel 5 has the label of channel 4, with the same data" in note for note in found.notes)
    assert found.analog is not None
    assert (found.analog.rate, found.analog.values.shape) == (1000.0, (FRAMES * 10, 6))
    (plate,) = found.plates
    # Corners in this order turn the plate's Z down, so that what presses on it comes out upwards.
    np.testing.assert_allclose(plate.force[0], [30.0, 0.0, 700.0], atol=1e-4)
    np.testing.assert_allclose(plate.moment[0], [0.0, -1.2, 0.0], atol=1e-6)
    np.testing.assert_allclose(plate.corners[2], [0.0, 0.4, 0.0], atol=1e-6)


def test_a_file_of_py_c3d(points: Any, tmp_path: Path) -> None:
    """Written by another library; py-c3d pads labels with blanks and marks what was not seen by a residual of -1."""
    c3d = pytest.importorskip("c3d", reason="py-c3d is not installed (it is in the extra 'test')")
    writer = c3d.Writer(point_rate=120.0, analog_rate=0.0, point_scale=-1.0)
    frames = []
    for k in range(FRAMES):
        frame = np.zeros((4, 5))
        frame[:, :3] = points[k, :4]
        frame[2, 3] = -1.0 if k == 5 else 0.0
        frames.append((frame, np.array([[]])))
    writer.add_frames(frames)
    writer.set_point_labels(["Ann:A", "Ann:B", "C", "D"])
    path = tmp_path / "other.c3d"
    with path.open("wb") as file, pytest.warns(UserWarning, match="ANALOG"):
        writer.write(file)
    found = read_c3d(path)
    assert (found.labels, found.rate, found.units) == (("Ann:A", "Ann:B", "C", "D"), 120.0, "mm")
    assert np.isnan(found.points[5, 2]).all()
    np.testing.assert_allclose(np.delete(found.points, 5, axis=0), np.delete(points[:, :4], 5, axis=0), rtol=1e-6)
    assert found.index("B") == 1
    metres = in_metres(found, None, "Z")
    np.testing.assert_allclose(metres.points[0], points[0, :4] / 1000.0, rtol=1e-6)


def test_a_file_cut_short_is_read_as_far_as_it_goes(written: Path, points: Any, tmp_path: Path) -> None:
    content = written.read_bytes()
    path = tmp_path / "cut.c3d"
    path.write_bytes(content[: -len(content) // 4])
    found = read_c3d(path)
    count = len(found.time)
    assert 0 < count < FRAMES
    assert any(f"header says {FRAMES} frames, the file holds {count}" in note for note in found.notes)
    np.testing.assert_allclose(found.points[:, 2], points[:count, 2], rtol=1e-6)


@pytest.mark.parametrize(
    ("content", "match"),
    [
        (b"", "is empty"),
        (b"\x02\x50", "cut short within its header: 2 of 512"),
        (b"Coordinates\nversion=1\n" * 40, "not a C3D file"),
        (bytes(4096), "not a C3D file"),
        (b"\x02\x50" + bytes(range(256)) * 8, "block of 512 bytes where its frames should start: not in the file"),
    ],
    ids=["empty", "two bytes", "text", "zeros", "noise"],
)
def test_what_is_no_c3d_file(content: bytes, match: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.c3d"
    path.write_bytes(content)
    with pytest.raises(InputError, match=match) as error:
        read_c3d(path)
    assert error.value.key == str(path)
    assert "\n" not in str(error.value)


def test_damaged_files_give_a_recording_or_one_clear_error(written: Path, tmp_path: Path) -> None:
    """Random bytes in header and parameters: nothing else may come of them."""
    content, rng = written.read_bytes(), np.random.default_rng(3)
    path = tmp_path / "damaged.c3d"
    for trial in range(400):
        damaged = bytearray(content)
        for place in rng.integers(0, 2500, 20):
            damaged[place] = int(rng.integers(0, 256))
        damaged[1] = 0x50
        path.write_bytes(bytes(damaged[: len(damaged) if trial % 2 else int(rng.integers(600, len(damaged)))]))
        try:
            assert read_c3d(path).points.ndim == 3
        except InputError as error:
            assert str(path) in str(error)
            assert len(str(error).split("\n")) == 1


def test_paths_that_are_no_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_c3d(tmp_path / "none.c3d")
    with pytest.raises(InputError, match="is not a file"):
        read_c3d(tmp_path)
