"""Text recordings as other tools write them; the oracle is the same data in the plain format."""

from __future__ import annotations

import codecs
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.lab.forces.calibration import Calibration, Curve
from liftopt.lab.forces.calibration_series import read_series
from liftopt.lab.forces.force_file import read_forces
from liftopt.lab.forces.voltage_divider import Divider
from liftopt.lab.mocap.hand_force import read_hand_force
from liftopt.lab.mocap.motion_table import read_motion_table
from liftopt.lab.mocap.trc import read_trc

MARKERS, FRAMES = ("RASI", "STER", "C7", "MC2"), 20
AXES = "\t\t" + "\t".join(f"{axis}{k + 1}" for k in range(len(MARKERS)) for axis in "XYZ")
HEAD = (
    "PathFileType\t4\t(X/Y/Z)\ttrial.trc\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n"
    f"100.00\t100.00\t{FRAMES}\t{len(MARKERS)}\tmm\t100.00\t1\t{FRAMES}\n"
    "Frame#\tTime\t" + "\t\t\t".join(MARKERS) + "\t\t\n" + AXES + "\n\n"
)
PLACES = np.round(np.random.default_rng(2).uniform(-900.0, 900.0, (FRAMES, len(MARKERS), 3)), 2)
ROWS = [
    "\t".join([str(k + 1), f"{k / 100:.4f}", *(f"{value:.2f}" for value in frame.ravel())])
    for k, frame in enumerate(PLACES)
]
TRC = HEAD + "\n".join(ROWS) + "\n"
CALIBRATION = Calibration(divider=Divider(), curves={"all": Curve(voltage=(0.0, 1.0, 4.0), force=(0.0, 2.0, 8.0))})
LOG = "time [s],finger1 [V],thumb1 [V]\n" + "".join(f"{0.05 * k:.3f},{0.3 + 0.01 * k:.4f},0.2\n" for k in range(30))
SERIES = "voltage [V],weight [g]\n0.0,0\n0.099,50.5\n0.159,100\n0.253,200\n"
MOT = "Coordinates\nversion=1\ninDegrees=yes\nendheader\ntime\telbow\twrist\n0.0\t10.5\t1.25\n0.1\t20.5\t-2.25\n"
FORCE = "time,fx,fy,fz\n0.0,0.5,-1.5,10.25\n0.1,2.5,0.0,20.75\n"


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    def _write(content: str | bytes, name: str = "file.trc") -> Path:
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return _write


def _with_commas(text: str) -> str:
    return text.replace(",", ";").replace(".", ",")


def _unnamed(text: str) -> str:
    """From the eighth frame on, an unnamed marker behind the others."""
    lines = text.splitlines()
    return "\n".join(line + ("\t1.0\t2.0\t3.0" if k >= 14 else "") for k, line in enumerate(lines)) + "\n"


@pytest.mark.parametrize(
    ("content", "note"),
    [
        (TRC.replace("PathFileType\t4\t(X/Y/Z)\ttrial.trc", "PathFileType  4\t(X/Y/Z) trial"), ""),
        (TRC.replace("PathFileType\t4\t(X/Y/Z)\ttrial.trc", "PathFileType 4 (X/Y/Z) C:\\data, 3\\trial.trc"), ""),
        (TRC.replace("PathFileType\t4\t(X/Y/Z)\t", "PathFileType\t\t4\t\t(X/Y/Z)\t\tD:\\EVaRT\\"), ""),
        ("\n" + TRC, ""),
        (TRC.replace("\n", "\r\n"), ""),
        (TRC.replace("\n", " \t\n"), ""),
        (TRC.replace("\t", "\t\t"), ""),
        (HEAD + "\n".join(ROWS).replace("\t", "\t\t"), ""),
        (TRC.replace("\t\t\t", "\t"), ""),
        (TRC.replace("STER\t\t\t", "STER\t\t").replace("RASI\t\t\t", "RASI\t\t").replace("C7\t\t\t", "C7\t\t"), ""),
        (TRC.replace("DataRate\tCameraRate", "DataRate\t\tCameraRate"), ""),
        (TRC.replace(AXES, AXES + "\tX5\tY5\tZ5"), ""),
        (_unnamed(TRC), "3 columns behind the 14 that have a name are left out, from line 15 on"),
        (TRC.replace(".", ","), ""),
        (codecs.BOM_UTF16_LE + TRC.encode("utf-16-le"), ""),
        (codecs.BOM_UTF16_BE + TRC.encode("utf-16-be"), ""),
        (TRC.encode("utf-16-le"), ""),
        (codecs.BOM_UTF8 + TRC.encode(), ""),
        (TRC.replace("trial.trc", "Müller.trc").encode("latin-1"), ""),
        (TRC.encode() + bytes(700), "it ends in 700 NUL bytes, as a power cut leaves them: left out"),
        (TRC.encode() + ROWS[3][:30].encode() + bytes(700), "left out, with line 27, which they cut"),
        (codecs.BOM_UTF16_LE + TRC.encode("utf-16-le") + bytes(64), "it ends in 64 NUL bytes"),
        (TRC + "\x1a", ""),
    ],
)
def test_trc_files_of_other_tools(content: str | bytes, note: str, write: Callable[..., Path]) -> None:
    found = read_trc(write(content))
    assert (found.labels, found.rate, found.units) == (MARKERS, 100.0, "mm")
    np.testing.assert_allclose(found.points, PLACES)
    np.testing.assert_allclose(found.time, np.arange(FRAMES) / 100.0)
    assert bool(found.notes) == bool(note)
    assert note in "".join(found.notes)


def test_a_marker_without_a_name_among_others_shifts_nothing(write: Callable[..., Path]) -> None:
    found = read_trc(write(TRC.replace("STER\t\t\tC7", "\t\t\tC7").replace("\t4\tmm", "\t3\tmm")))
    assert found.labels == ("RASI", "C7", "MC2")
    np.testing.assert_allclose(found.points, PLACES[:, [0, 2, 3]])
    assert found.notes == ("1 markers without a name, between others, are left out",)


def test_what_is_infinitely_far_away_was_not_seen(write: Callable[..., Path]) -> None:
    rows = ROWS.copy()
    rows[4] = rows[4].rsplit("\t", 3)[0] + 3 * "\t-3.697314e+28"
    rows[5] = rows[5].rsplit("\t", 3)[0] + "\t-36973140000000000000000000000\t1\t2"
    rows[6] = rows[6].rsplit("\t", 3)[0] + "\t1.#QNAN\t-1.#IND\tnan"
    found = read_trc(write(HEAD + "\n".join(rows)))
    expected = PLACES.copy()
    expected[4:7, 3] = np.nan
    np.testing.assert_allclose(found.points, expected)
    assert found.notes == ("MC2: 2 points at -3.697314e+28 taken as not seen",)


def test_every_reader_takes_decimal_commas_utf_16_and_what_a_power_cut_leaves(write: Callable[..., Path]) -> None:
    """The same numbers as from the plain file."""

    def forces(path: Path) -> Any:
        (trial,) = read_forces(path, CALIBRATION)
        return np.concatenate([trial.time, trial.force.ravel()])

    def series(path: Path) -> Any:
        (one,) = read_series(path, Divider())
        return one.single

    def hand(path: Path) -> Any:
        one = read_hand_force(path, "Z")
        return np.concatenate([one.time[:, None], one.force], axis=1)

    def motion(path: Path) -> Any:
        table = read_motion_table(path)
        return np.concatenate([table.time[:, None], table.values], axis=1)

    motion_commas = MOT.replace(".", ",")
    for read, text, commas, name in (
        (forces, LOG, _with_commas(LOG), "log.csv"),
        (series, SERIES, _with_commas(SERIES), "series.csv"),
        (hand, FORCE, _with_commas(FORCE), "force.csv"),
        (motion, MOT, motion_commas, "a.mot"),
    ):
        plain = read(write(text, name))
        blanks = motion_commas.replace("\t", "   ")
        others: list[str | bytes] = [commas, commas.replace(";", "\t"), commas.replace(";", " ; ")]
        others += [blanks] if read is motion else [commas.replace("\n", ";\n"), text.replace("\n", ",\n")]
        others += [codecs.BOM_UTF16_LE + text.encode("utf-16-le"), codecs.BOM_UTF16_BE + commas.encode("utf-16-be")]
        others += [codecs.BOM_UTF8 + text.encode(), text.encode() + bytes(512), text.replace("\n", "\r\n")]
        others += [text.encode() + b"9.0" + bytes(40)]
        for other in others:
            np.testing.assert_array_equal(read(write(other, name)), plain, err_msg=repr(other))


def test_commas_in_quotes_are_decimal(write: Callable[..., Path]) -> None:
    text = 'time [s],"finger1 [V]",thumb1 [V]\n"0,5","1,25","0,0"\n"1,0","2,5","0,0"\n'
    (trial,) = read_forces(write(text, "log.csv"), CALIBRATION)
    np.testing.assert_allclose(trial.time, [0.5, 1.0])
    np.testing.assert_allclose(trial.force[:, 0], [2.5, 5.0])


def test_what_a_power_cut_left_is_noted(write: Callable[..., Path]) -> None:
    (trial,) = read_forces(write(LOG.encode() + b"1.500,0.6" + bytes(512), "log.csv"), CALIBRATION)
    assert len(trial.time) == 30
    assert trial.notes[0].startswith("it ends in 512 NUL bytes, as a power cut leaves them: left out, with line 32")


@pytest.mark.parametrize(
    ("content", "match"),
    [
        (LOG.replace(",", ";").replace("0.4", "0,4"), "mixes decimal points and commas: further above it is '.'"),
        ("time [s],finger1 [V]\n0,000,0,30\n0,050,0,31\n", "line 2 = '4 fields'.*semicolons must separate the fields"),
        ("time [s];finger1 [V]\n0;1,234,5\n", "line 2 = '1,234,5': the column finger1 must hold numbers"),
        ("time [s];finger1 [V]\n0;1.234,5\n", "line 2 = '1.234,5': "),
        (LOG.encode() + bytes(512) + LOG.encode(), "is a binary file, or damaged from line 32 on"),
        (bytes(512), "is a binary file: it holds nothing but NULs"),
        (bytes(range(256)) * 4, "is a binary file"),
        (codecs.BOM_UTF16_LE, "holds no rows"),
        (codecs.BOM_UTF16_LE + b"\xff\xd8\xff", "holds no rows|states no unit"),
    ],
)
def test_what_may_mean_two_things_is_refused_in_a_line(
    content: str | bytes, match: str, write: Callable[..., Path]
) -> None:
    path = write(content, "log.csv")
    with pytest.raises(InputError, match=match) as error:
        read_forces(path, CALIBRATION)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("content", "match"),
    [
        (TRC.replace(ROWS[9], ROWS[9].replace(".", ",")), "line 16 = '0,0900': mixes decimal points and commas"),
        (TRC.replace(ROWS[9], ROWS[9] + "\t1.0\t2.0"), "line 16 = '16 fields': the header names 14 columns"),
        (TRC.replace("PathFileType", "Path\tFileType"), "line 1 = .*starts with PathFileType"),
        (HEAD, "holds no frames"),
        ("PathFileType\t4\nFrame#\tTime\tA\n", "has no line that starts with Frame#|holds no frames"),
        ("Frame#\tTime\tA\n1\t0\t1\t2\t3\n", "starts with PathFileType"),
    ],
)
def test_a_broken_trc_file_is_refused_in_a_line(content: str, match: str, write: Callable[..., Path]) -> None:
    path = write(content)
    with pytest.raises(InputError, match=match) as error:
        read_trc(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_the_commands_read_a_spreadsheet_of_europe(
    write: Callable[..., Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    calibration = tmp_path / "cal.toml"
    assert main(["calibrate", str(write(_with_commas(SERIES), "s.csv")), "--out", str(calibration)]) == 0
    log, plain = write(_with_commas(LOG), "comma.csv"), write(LOG, "plain.csv")
    capsys.readouterr()
    said = []
    for path in (log, plain):
        assert main(["forces", str(path), "--calibration", str(calibration)]) == 0
        said.append(capsys.readouterr().out)
    assert said[0] == said[1]


def test_rows_without_a_mark_are_one_trial_only_where_none_is_marked(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    head, rows = "# liftopt record\ntime [s],mark,finger1 [V]\n", "0,,1\n1,preload 1,0.5\n2,,2\n3,,3\n"
    (whole,) = read_forces(write(head + rows, "r.csv"), CALIBRATION)
    np.testing.assert_allclose(whole.force[:, 0], [4.0 - 1.0, 6.0 - 1.0])
    assert "no trial is marked: all 2 rows behind the preload are taken as one" in whole.notes
    (marked,) = read_forces(write(head + rows + "4,trial 1,4\n5,,0\n", "m.csv"), CALIBRATION)
    np.testing.assert_allclose(marked.force[:, 0], [8.0 - 1.0])
    assert "4 rows without a mark, outside preload and trials, are left aside" in marked.notes
    with pytest.raises(InputError, match="holds no trial"):
        read_forces(write(head + "0,,1\n1,preload 1,0.5\n", "p.csv"), CALIBRATION)
