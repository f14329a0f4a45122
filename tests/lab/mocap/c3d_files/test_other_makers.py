"""C3D files as other makers write them, each complete for all that is missing; the oracle is what was put in."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.errors import InputError
from liftopt.lab.mocap.c3d import read_c3d
from liftopt.lab.mocap.recording import Recording, in_metres


def _without(group: str, *names: str) -> Callable[[Any], None]:
    return lambda file: [file.parameters[group].pop(name) for name in names] and None


def _set(group: str, name: str, value: Any) -> Callable[[Any], None]:
    return lambda file: file.parameters[group].update({name: value})


def _no_group(group: str) -> Callable[[Any], None]:
    return lambda file: file.parameters.pop(group) and None


def _header(index: int, word: int) -> Callable[[Any], None]:
    return lambda file: file.header.update({index: word})


@pytest.mark.filterwarnings("ignore:missing parameter:UserWarning")  # of py-c3d; what is missing says nothing new
@pytest.mark.parametrize("floats", [True, False])
@pytest.mark.parametrize("processor", ["Intel", "DEC", "MIPS"])
def test_numbers_of_every_processor(
    processor: str, floats: bool, c3d_file: Any, plain_points: Any, tmp_path: Path
) -> None:
    """Also against py-c3d, which reads all three by itself."""
    c3d_file.processor, c3d_file.floats = processor, floats
    path = c3d_file.write(tmp_path / "a.c3d")
    found = read_c3d(path)
    assert (found.labels, found.rate, found.units, found.notes) == (("A", "B", "C"), 100.0, "mm", ())
    np.testing.assert_allclose(found.points, plain_points(), rtol=2e-7, atol=2e-5)
    assert found.analog is not None
    assert found.analog.rate == 400.0
    np.testing.assert_allclose(found.analog.values, c3d_file.analog, rtol=1e-6)
    c3d = pytest.importorskip("c3d", reason="py-c3d is not installed (it is in the extra 'test')")
    frames = list(c3d.Reader(io.BytesIO(path.read_bytes())).read_frames())
    theirs = np.array([points[:, :3] for _, points, _ in frames])
    np.testing.assert_allclose(theirs[~c3d_file.unseen], found.points[~c3d_file.unseen], rtol=1e-6, atol=2e-5)


@pytest.mark.parametrize(
    ("change", "note"),
    [
        (_set("POINT", "FRAMES", 30.0), ""),
        (_set("POINT", "USED", 3.0), ""),
        (_set("ANALOG", "OFFSET", [0.0] * 6), ""),
        (_set("ANALOG", "OFFSET", [10.0, -20.0, 0.0, 0.0, 3.0, 0.0]), ""),
        (_without("ANALOG", "OFFSET"), "ANALOG:OFFSET is missing: taken as 0"),
        (_without("ANALOG", "RATE"), ""),
        (_without("ANALOG", "RATE", "OFFSET", "GEN_SCALE"), "ANALOG:OFFSET is missing"),
        (_without("POINT", "USED"), "POINT:USED is missing"),
        (_without("POINT", "FRAMES", "SCALE", "RATE", "DATA_START"), ""),
        (_without("POINT", "USED", "FRAMES", "SCALE", "RATE", "DATA_START"), "POINT:USED is missing"),
        (_set("POINT", "USED", 5), "POINT:USED is 5, the header says 3 points: 3 are read"),
        (_header(1, 7), "POINT:USED is 3, the header says 7 points: 3 are read"),
        (_header(2, 0), ""),
        (_header(4, 0), ""),
        (_header(8, 0), ""),
        (_header(9, 0), ""),
        (_header(4, 12), "the header says 12 frames, the file holds 30"),
    ],
)
def test_what_is_said_elsewhere_is_taken_from_there(
    change: Callable[[Any], None], note: str, c3d_file: Any, plain_points: Any, tmp_path: Path
) -> None:
    change(c3d_file)
    found = read_c3d(c3d_file.write(tmp_path / "a.c3d"))
    np.testing.assert_allclose(found.points, plain_points(), rtol=1e-6)
    assert (found.rate, found.units, found.labels) == (100.0, "mm", ("A", "B", "C"))
    assert found.analog is not None
    np.testing.assert_allclose(found.analog.values, c3d_file.analog, rtol=1e-6, atol=1e-4)
    assert bool(found.notes) == bool(note)
    assert note in "".join(found.notes)


@pytest.mark.parametrize("processor", ["Intel", "MIPS"])
def test_no_point_group_at_all(processor: str, c3d_file: Any, plain_points: Any, tmp_path: Path) -> None:
    """As PhaseSpace writes it: the markers have no names but their channels."""
    c3d_file.processor = processor
    _no_group("POINT")(c3d_file)
    found = read_c3d(c3d_file.write(tmp_path / "a.c3d"))
    np.testing.assert_allclose(found.points, plain_points(), rtol=1e-6)
    assert (found.labels, found.units, found.rate) == (("*1", "*2", "*3"), None, 100.0)
    assert any("3 markers have no label: *1, *2, *3 by their channel" in note for note in found.notes)
    with pytest.raises(InputError, match="states no unit of length; the mapping must"):
        in_metres(found, None, "Z")
    np.testing.assert_allclose(in_metres(found, "mm", "Z").points, plain_points() / 1000.0, rtol=1e-6)


def test_analog_channels_without_a_scale_are_left_aside(c3d_file: Any, plain_points: Any, tmp_path: Path) -> None:
    _without("ANALOG", "SCALE")(c3d_file)
    found = read_c3d(c3d_file.write(tmp_path / "a.c3d"))
    np.testing.assert_allclose(found.points, plain_points(), rtol=1e-6)
    assert found.analog is None
    assert any("ANALOG:SCALE is missing" in note for note in found.notes)


def test_analog_channels_behind_the_last_scale_are_left_aside(c3d_file: Any, tmp_path: Path) -> None:
    path = c3d_file.write(tmp_path / "a.c3d")
    content = path.read_bytes()
    at = content.index(b"\x05\x02SCALE")
    assert content[at + 9 : at + 12] == b"\x04\x01\x06"  # floats, one dimension of six
    path.write_bytes(content[: at + 11] + b"\x04" + content[at + 12 :])
    found = read_c3d(path)
    assert found.analog is not None
    np.testing.assert_allclose(found.analog.values, c3d_file.analog[:, :4])
    assert "ANALOG:SCALE is missing for channels 5 to 6: they are left aside" in found.notes


def test_no_analog_group_where_the_header_counts_channels(c3d_file: Any, plain_points: Any, tmp_path: Path) -> None:
    _no_group("ANALOG")(c3d_file)
    found = read_c3d(c3d_file.write(tmp_path / "a.c3d"))
    np.testing.assert_allclose(found.points, plain_points(), rtol=1e-6)


def test_two_rates_and_two_scales_are_noted(c3d_file: Any, plain_points: Any, tmp_path: Path) -> None:
    c3d_file.floats = False
    content = bytearray(c3d_file.content())
    content[12:16], content[20:24] = np.float32(0.7).tobytes(), np.float32(60.0).tobytes()
    path = tmp_path / "a.c3d"
    path.write_bytes(content)
    found = read_c3d(path)
    np.testing.assert_allclose(found.points, plain_points(), atol=1e-4)
    assert found.rate == 100.0
    assert found.notes == (
        "POINT:SCALE is 0.1, the header says 0.7: the first is taken",
        "POINT:RATE is 100 Hz, the header says 60 Hz: the first is taken",
    )


def test_where_frames_start_follows_from_the_parameters(c3d_file: Any, plain_points: Any, tmp_path: Path) -> None:
    """Neither the header nor POINT:DATA_START says it: the section of parameters counts its own blocks."""
    _header(8, 0)(c3d_file)
    _without("POINT", "DATA_START")(c3d_file)
    np.testing.assert_allclose(read_c3d(c3d_file.write(tmp_path / "a.c3d")).points, plain_points(), rtol=1e-6)


def test_offsets_without_a_sign(c3d_file: Any, tmp_path: Path) -> None:
    """16 bits around 32768, as converters of 16 bits count."""
    c3d_file.floats = False
    c3d_file.parameters["ANALOG"] |= {"OFFSET": [32768] * 6, "FORMAT": ["UNSIGNED"]}
    found = read_c3d(c3d_file.write(tmp_path / "a.c3d"))
    assert found.analog is not None
    np.testing.assert_allclose(found.analog.values, c3d_file.analog, atol=1e-9)


def test_more_frames_than_the_header_can_count(c3d_file: Any, tmp_path: Path) -> None:
    """65535 is as far as its words go: TRIAL, LONG_FRAMES and a float say the rest, and else the file's length."""
    frames = 66_000
    c3d_file.points = np.full((frames, 1, 3), 100.0)
    c3d_file.points[:, 0, 0] = np.arange(frames)
    c3d_file.unseen, c3d_file.analog = np.zeros((frames, 1), bool), np.zeros((4 * frames, 0))
    c3d_file.parameters.pop("ANALOG")
    c3d_file.parameters["POINT"] |= {"USED": 1, "LABELS": ["A"]}
    c3d_file.header[4] = 65535
    stated: list[tuple[str, dict[str, Any]]] = [
        ("POINT", {"FRAMES": float(frames)}),
        ("POINT", {"FRAMES": -1, "LONG_FRAMES": float(frames)}),
        ("TRIAL", {"ACTUAL_START_FIELD": [1, 0], "ACTUAL_END_FIELD": [frames % 65536, frames // 65536]}),
    ]
    plain = c3d_file.parameters
    for group, values in stated:
        c3d_file.parameters = {name: dict(entries) for name, entries in plain.items()}
        c3d_file.parameters["POINT"]["FRAMES"] = -1
        c3d_file.parameters.setdefault(group, {}).update(values)
        found = read_c3d(c3d_file.write(tmp_path / "a.c3d"))
        assert len(found.time) == frames
        np.testing.assert_allclose(found.points[1:, 0, 0], np.arange(1, frames))
        assert found.time[-1] == pytest.approx((frames - 1) / 100.0)


@pytest.mark.parametrize(
    ("spelling", "metres"),
    [
        ("Millimeter", 1e-3), ("millimetres", 1e-3), ("MM", 1e-3), ("mill", 1e-3), ("mete", 1.0), ("Meter", 1.0),
        ("metr", 1.0), ("M", 1.0), ("cm", 0.01), ("Centimeters", 0.01), ("cent", 0.01), ("inch", 0.0254),
        ("Inches", 0.0254), ("in", 0.0254), ("um", 1e-6), ("\xb5m", 1e-6), ("microns", 1e-6), ("[mm]", 1e-3),
        ("feet", 0.3048), ("dm", 0.1),
    ],
)  # fmt: skip
def test_units_in_any_spelling(spelling: str, metres: float, c3d_file: Any, plain_points: Any, tmp_path: Path) -> None:
    c3d_file.points *= 0.001 / metres
    c3d_file.parameters["POINT"]["UNITS"] = [spelling]
    found = in_metres(read_c3d(c3d_file.write(tmp_path / "a.c3d")), None, "Z")
    np.testing.assert_allclose(found.points, metres * plain_points(), rtol=1e-6)


@pytest.mark.parametrize("spelling", ["furlong", "m/s", "me", "rad", "V", "mil"])
def test_an_unknown_unit_is_refused_until_the_mapping_states_it(
    spelling: str, c3d_file: Any, plain_points: Any, tmp_path: Path
) -> None:
    c3d_file.parameters["POINT"]["UNITS"] = [spelling]
    found = read_c3d(c3d_file.write(tmp_path / "a.c3d"))
    with pytest.raises(InputError, match=f"'{spelling}': is a unit of length that is not known.*the mapping may state"):
        in_metres(found, None, "Z")
    metres = in_metres(found, "mm", "Z")
    np.testing.assert_allclose(metres.points, plain_points() / 1000.0, rtol=1e-6)
    assert f"the file states '{spelling}' as its unit of length; mm is taken, as the mapping says" in metres.notes


def test_a_wrong_unit_is_named_and_the_mapping_wins(c3d_file: Any, plain_points: Any, tmp_path: Path) -> None:
    """The header says mm, the numbers are metres: the whole person would be smaller than a fingernail."""
    c3d_file.points /= 1000.0
    found = read_c3d(c3d_file.write(tmp_path / "a.c3d"))
    with pytest.raises(InputError, match=r"= 'mm': cannot be the unit of .*units = \"m\" would make it") as error:
        in_metres(found, None, "Z")
    assert error.value.key == str(tmp_path / "a.c3d")
    metres = in_metres(found, "m", "Z")
    np.testing.assert_allclose(metres.points, plain_points(), rtol=1e-6)
    assert any("the file states 'mm'" in note and "m is taken" in note for note in metres.notes)
    with pytest.raises(InputError, match=r"^units = 'cm': cannot be the unit"):
        in_metres(found, "cm", "Z")


def test_what_is_infinitely_far_away_was_not_seen(c3d_file: Any, plain_points: Any, tmp_path: Path) -> None:
    """NDI Optotrak writes -3.697314e28 into every coordinate of a marker that it does not see."""
    c3d_file.points[10:14, 2] = -3.697314e28
    found = read_c3d(c3d_file.write(tmp_path / "a.c3d"))
    expected = plain_points()
    expected[10:14, 2] = np.nan
    np.testing.assert_allclose(found.points, expected, rtol=1e-6)
    assert found.notes == ("C: 4 points at -3.697314e+28 taken as not seen",)


def test_a_missing_unit_is_asked_for() -> None:
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (5, 4, 3))
    with pytest.raises(InputError, match=r"^units: trial states no unit of length; the mapping must"):
        in_metres(Recording("trial", 100.0, np.arange(5) / 100.0, tuple("ABCD"), points), None, "Z")


def test_events_are_read_with_their_side_by_time(c3d_file: Any, tmp_path: Path) -> None:
    """A time is minutes and seconds."""
    c3d_file.parameters["EVENT"] = {
        "USED": 3,
        "CONTEXTS": ["Right", "General", "Left"],
        "LABELS": ["Foot Strike", "Lift", "Foot Off"],
        "TIMES": [[0.0, 1.0, 0.0], [0.25, 2.5, 0.1]],
    }
    events = read_c3d(c3d_file.write(tmp_path / "trial.c3d")).events
    assert [name for name, _ in events] == ["Left Foot Off", "Right Foot Strike", "General Lift"]
    np.testing.assert_allclose([at for _, at in events], [0.1, 0.25, 62.5], atol=1e-5)
