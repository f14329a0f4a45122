"""TRC, MOT, STO and CSV files: as OpenSim writes them, as other tools mangle them, and broken ones."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from liftopt.errors import InputError
from liftopt.lab.forces.force_file import write_forces
from liftopt.lab.forces.force_record import ForceRecord
from liftopt.lab.mocap.hand_force import HandForce, read_hand_force
from liftopt.lab.mocap.motion_table import read_motion_table
from liftopt.lab.mocap.trc import read_trc

# As OpenSim writes it: names padded over three columns, an empty line before the data, a marker not seen left empty.
TRC = (
    "PathFileType\t4\t(X/Y/Z)\ttrial.trc\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n"
    "100\t100\t3\t2\tmm\t100\t1\t3\n"
    "Frame#\tTime\tSTER\t\t\tXIPH\t\t\n"
    "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n"
    "\n"
    "1\t0.00\t1.5\t2\t3\t4\t5\t6\n"
    "2\t0.01\t1.6\t2\t3\t\t\t\n"
    "3\t0.02\t1.7\t2\t3\t4\t5\t-6e0\n"
)
MOT = (
    "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\n\nUnits are S.I.\nendheader\n"
    "time\telbow\twrist\n0\t10\t1\n0.1\t20\t2\n"
)


def _read_force(path: Path) -> HandForce:
    return read_hand_force(path, "Z")


@pytest.fixture
def write(tmp_path: Path) -> Any:
    def _write(text: str | bytes, name: str = "file.trc") -> Path:
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return _write


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_a_trc_file_as_opensim_writes_it(write: Any, ending: str) -> None:
    found = read_trc(write(TRC.replace("\n", ending)))
    assert (found.labels, found.rate, found.units, found.notes) == (("STER", "XIPH"), 100.0, "mm", ())
    np.testing.assert_allclose(found.time, [0.0, 0.01, 0.02])
    np.testing.assert_allclose(found.points[:, 0, 0], [1.5, 1.6, 1.7])
    assert np.isnan(found.points[1, 1]).all()
    assert found.points[2, 1, 2] == -6.0


def test_a_trc_file_with_commas_and_wrong_counts(write: Any) -> None:
    text = TRC.replace("\t", ",").replace("100,100,3,2,mm", "60,60,652,51,mm")
    found = read_trc(write(text))
    assert found.points.shape == (3, 2, 3)
    assert found.rate == 100.0  # that of the time stamps
    assert found.notes == (
        "the header says NumFrames 652, the file holds 3",
        "the header says NumMarkers 51, the file holds 2",
        "the header says 60 Hz, the time stamps 100 Hz",
    )


def test_time_stamps_of_few_digits(write: Any) -> None:
    """60 Hz to the millisecond: the stamps alone would say 58.8 Hz."""
    rows = "".join(f"{k + 1}\t{k / 60.0:.3f}\t1\t2\t3\t4\t5\t6\n" for k in range(200))
    for stated in ("60", "120"):
        found = read_trc(write(TRC[: TRC.index("1\t0.00")].replace("\n100\t", f"\n{stated}\t") + rows))
        assert (found.rate, len(found.time)) == (60.0, 200)


def test_missing_frames_become_frames_without_markers(write: Any) -> None:
    found = read_trc(write(TRC + "7\t0.06\t1\t1\t1\t1\t1\t1\n"))
    assert len(found.time) == 7
    assert np.isnan(found.points[3:6]).all()
    assert any("3 frames are missing" in note for note in found.notes)


def test_a_row_without_the_tabs_of_markers_that_were_not_seen(write: Any) -> None:
    """Editors cut tabs at the end of a line."""
    whole, trimmed = read_trc(write(TRC)), read_trc(write(TRC.replace("\t\t\t\n3\t", "\n3\t")))
    np.testing.assert_array_equal(trimmed.points, whole.points)
    assert trimmed.notes == ("lines end before the last column, the first is line 8: markers there were not seen",)


def test_a_trc_file_in_milliseconds_is_refused(write: Any) -> None:
    text = TRC.replace("\t0.00\t", "\t0\t").replace("\t0.01\t", "\t10\t").replace("\t0.02\t", "\t20\t")
    with pytest.raises(InputError, match="Time must hold seconds; at 100 Hz these are ms"):
        read_trc(write(text))


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("PathFileType", "Path", "line 1 = .*starts with PathFileType"),
        ("Frame#", "Frames", "no line that starts with Frame#"),
        ("1.6", "1.6.2", "line 8 = '1.6.2': the column STER X must hold numbers"),
        ("1.6\t2\t3", "1.6\t2\t3\t9\t9\t9\t9\t9", "line 8 = '10 fields'.*names 8 columns"),
        ("0.02", "0.01", "line 9 = 0.01: the time must be a number that increases"),
        ("0.02", "0.0243", "line 9 = 0.0243: the time is not on the grid"),
        ("0.02", "1e9", "line 9 = 1000000000.0: the time leaps"),
        ("STER\t\t\tXIPH\t\t", "", "line 4.*must name markers"),
    ],
)
def test_a_broken_trc_file_is_refused_by_line(write: Any, old: str, new: str, match: str) -> None:
    with pytest.raises(InputError, match=match):
        read_trc(write(TRC.replace(old, new)))


@pytest.mark.parametrize(("content", "match"), [(b"", "is empty"), (b"  \n\n", "is empty"), (bytes(300), "binary")])
def test_empty_and_binary_files(write: Any, content: bytes, match: str) -> None:
    for read in (read_trc, read_motion_table, _read_force):
        with pytest.raises(InputError, match=match):
            read(write(content))
        with pytest.raises(InputError, match="no such file"):
            read(Path("no-such-file"))


def test_a_last_line_cut_off_is_left_out(write: Any) -> None:
    cut = TRC[: TRC.rindex("\t4\t5\t-6e0")]
    found = read_trc(write(cut))
    assert len(found.time) == 2
    assert any("line 9 ends after 5 of 8 fields" in note for note in found.notes)
    table = read_motion_table(write(MOT + "0.2\t3", "a.mot"))
    assert len(table.time) == 2


@pytest.mark.parametrize("separator", ["\t", ",", "   "])
def test_a_motion_table(write: Any, separator: str) -> None:
    text = MOT.replace("\t", separator)
    if separator == ",":  # a spreadsheet pads the header with empty fields
        text = "\n".join(line + ("" if "time" in line or line[:1].isdigit() else ",,") for line in text.split("\n"))
    found = read_motion_table(write(text, "a.mot"))
    assert (found.title, found.in_degrees, found.names, found.notes) == ("Coordinates", True, ("elbow", "wrist"), ())
    np.testing.assert_allclose(found.column("elbow"), [10.0, 20.0])
    with pytest.raises(InputError, match="'knee': no such column"):
        found.column("knee")


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("endheader", "end", "no line endheader"),
        ("time\t", "frame\t", "line 9 = 'frame': the first column must be time"),
        ("wrist", "elbow", "line 9 = 'elbow': the name stands over two columns"),
        ("0.1\t", "0\t", "line 11 = 0.0: the time must be a number that increases"),
        ("20", "NaNa", "line 11 = 'NaNa': the column elbow must hold numbers"),
        ("0\t10\t1\n0.1\t20\t2\n", "", "holds no rows"),
    ],
)
def test_a_broken_motion_table_is_refused_by_line(write: Any, old: str, new: str, match: str) -> None:
    with pytest.raises(InputError, match=match):
        read_motion_table(write(MOT.replace(old, new), "a.mot"))


def test_forces_of_the_sensors_point_up(tmp_path: Path) -> None:
    """What ``liftopt forces`` writes, taken for a recording with Y up."""
    path = tmp_path / "forces.csv"
    force = np.array([[3.0, 1.0], [5.0, 0.5]])
    channels, flags = ("finger1", "thumb1"), np.zeros((2, 2), dtype=np.uint8)
    record = ForceRecord("s", 1, channels, np.array([0.0, 0.3]), force, flags, np.zeros(2), ())
    write_forces((record,), path)
    series = read_hand_force(path, "Y")
    np.testing.assert_allclose(series.time, [0.0, 0.3])
    np.testing.assert_allclose(series.force, [[0.0, 2.0, 0.0], [0.0, 4.5, 0.0]], atol=1e-12)


def test_hand_force_series(write: Any) -> None:
    series = _read_force(write("time,fx,fy,fz,state\n0,0,0,10,on\n0.5,2,0,20,off\n", "f.csv"))
    force, outside = series.at(np.array([-0.1, 0.25, 0.5, 0.6]))
    np.testing.assert_allclose(force, [[0, 0, 0], [1, 0, 15], [2, 0, 20], [0, 0, 0]])
    assert outside == 2
    sto = _read_force(
        write(
            MOT.replace("elbow\twrist", "fx\tfy\tfz").replace("\t1\n", "\t1\t5\n").replace("\t2\n", "\t2\t6\n"), "f.sto"
        )
    )
    np.testing.assert_allclose(sto.force, [[10, 1, 5], [20, 2, 6]])
    for text, match in (
        ("time,fx,fy\n0,1,2\n", "line 1 = .*no column fz"),
        (",,,\n", "nothing but separators"),
        ("time,fx,fy,fz\n0,1,,3\n", "missing in row 1"),
        ("time,fx,fy,fz\n1,1,1,3\n0.5,1,1,1\n", "= 0.5: the time must increase; row 2"),
    ):
        with pytest.raises(InputError, match=match):
            _read_force(write(text, "f.csv"))


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_mangled_text_files_give_a_table_or_one_clear_error(tmp_path: Path, data: st.DataObject) -> None:
    """Cut anywhere, and any characters put in anywhere: never another exception than InputError."""
    text, read, name = data.draw(
        st.sampled_from([(TRC, read_trc, "a.trc"), (MOT, read_motion_table, "a.mot"), (MOT, _read_force, "a.csv")])
    )
    cut = data.draw(st.integers(0, len(text)))
    place = data.draw(st.integers(0, cut))
    junk = data.draw(st.one_of(st.binary(max_size=6), st.sampled_from([b"\t", b"nan", b"inf", b"1e308", b"\n", b","])))
    path = tmp_path / name
    path.write_bytes(text.encode()[:place] + junk + text.encode()[place:cut])
    try:
        read(path)
    except InputError as error:
        assert str(path) in str(error)
        assert len(str(error).split("\n")) == 1
