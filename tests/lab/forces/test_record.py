"""Recording, from a simulated device on a pseudo-terminal to the file: buttons, losses, a crash, a full disk."""

from __future__ import annotations

import errno
import http.client
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.lab.forces.calibration import Calibration, Curve, save_calibration
from liftopt.lab.forces.force_file import read_forces, write_forces
from liftopt.lab.forces.record_log import RecordLog
from liftopt.lab.forces.record_server import RecordServer
from liftopt.lab.forces.record_session import PRELOAD_READINGS, RecordSession
from liftopt.lab.forces.serial_device import SerialDevice
from liftopt.lab.forces.voltage_divider import Divider

THREE = ("finger1", "finger2", "thumb1")
CALIBRATION = Calibration(divider=Divider(), curves={"all": Curve(voltage=(0.0, 1.0, 4.0), force=(0.0, 2.0, 8.0))})
PATIENCE = 20.0  # s


def ask(url: str, path: str, method: str = "GET", **headers: str) -> tuple[int, Any]:
    host = url.removeprefix("http://").rstrip("/")
    connection = http.client.HTTPConnection(host, timeout=PATIENCE)
    connection.request(method, path, headers={"Host": host} | headers)
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    is_json = answer.getheader("Content-Type") == "application/json"
    return answer.status, json.loads(body) if is_json else body.decode()


def wait(url: str, until: Callable[[Any], bool]) -> Any:
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        live = ask(url, "/live?after=0")[1]
        if until(live):
            return live
        time.sleep(0.02)
    raise AssertionError(live)


@contextmanager
def served(arduino: Any, path: Path, calibration: Calibration | None = CALIBRATION) -> Iterator[str]:
    """Record in this process; yield the page's address."""
    device = SerialDevice(str(arduino.port), len(THREE), 5.0)
    log = RecordLog(path, THREE, "V", "simulated", datetime.now().astimezone())
    session, stop = RecordSession(device, log, THREE, "V", calibration), threading.Event()
    with RecordServer(session) as server:
        threads = [threading.Thread(target=session.run, args=(stop,)), threading.Thread(target=server.serve_forever)]
        for thread in threads:
            thread.start()
        try:
            yield server.url
        finally:
            stop.set()
            server.shutdown()
            for thread in threads:
                thread.join()
            log.close()


def test_every_line_is_written_and_the_buttons_decide_what_is_marked(arduino: Any, tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    with served(arduino, path) as url:
        arduino.send("half\n3,3,3\n")
        assert wait(url, lambda live: live["samples"])["rows"] == 1
        assert ask(url, "/preload", "POST") == (200, {"refusal": ""})
        status, answer = ask(url, "/start", "POST")
        assert (status, answer["refusal"]) == (409, "preload 1 is being recorded: stop it first")
        arduino.send("0.1,0.2,0.0\n" * PRELOAD_READINGS + "4,4,4\n")
        live = wait(url, lambda live: len(live["samples"]) == PRELOAD_READINGS + 2)
        assert (live["mark"], live["rows"], live["marked"]) == ("", PRELOAD_READINGS + 2, PRELOAD_READINGS)
        np.testing.assert_allclose(live["preload"], [0.2, 0.4, 0.0])
        assert ask(url, "/start", "POST")[0] == 200
        arduino.send("1.1,1.2,0.5\nwhat?\n1.1,1.2,5.0\n")
        live = wait(url, lambda live: live["rows"] == PRELOAD_READINGS + 4)
        sample, last = live["samples"][-2:]
        np.testing.assert_allclose(sample["force"], [2.0, 2.0, 1.0])
        assert sample["hand"] == pytest.approx(3.0)
        assert (sample["flags"], last["flags"]) == (["", "", ""], ["", "", "saturated/beyond"])
        assert live["garbage"] == 1
        assert ask(url, "/stop", "POST")[0] == 200
        assert ask(url, "/stop", "POST") == (409, {"refusal": "nothing is being recorded"})
        assert ask(url, "/live?after=12")[1]["samples"][0]["number"] == 13
    (trial,) = read_forces(path, CALIBRATION)
    np.testing.assert_allclose(trial.force[0], [2.0, 2.0, 1.0], atol=1e-9)
    np.testing.assert_allclose(trial.hand_force[0], 3.0, atol=1e-9)
    assert any("2 rows without a mark, outside preload and trials, are left aside" in note for note in trial.notes)
    text = path.read_text()
    assert "this line may have begun before the connection did: 'half'" in text
    assert re.search(r"^\d+\.\d{4},,3,3,3$", text, flags=re.MULTILINE)
    assert "not understood: 'what?'" in text
    assert re.search(r"^# time 0 is 20\d\d-\d\d-\d\dT[\d:.]+[+-]\d\d:\d\d$", text, flags=re.MULTILINE)


def test_a_lost_connection_leaves_a_gap_and_nothing_else(arduino: Any, tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    with served(arduino, path, calibration=None) as url:
        ask(url, "/start", "POST")
        arduino.send("\n1,1,1\n")
        wait(url, lambda live: live["rows"] == 1)
        arduino.unplug()
        assert wait(url, lambda live: not live["connected"])["losses"] == 1
        arduino.plug_in()
        live = wait(url, lambda live: live["connected"])
        assert live["mark"] == "trial 1"
        assert "force" not in live["samples"][0]
        arduino.send("\n2,2,2\n")
        wait(url, lambda live: live["rows"] == 2)
    (trial,) = read_forces(path, CALIBRATION)
    np.testing.assert_allclose(trial.force[:, 0], [2.0, 4.0])
    assert re.search(
        r"^# \d+\.\d+ s: connection lost: .+\n# \d+\.\d+ s: connected again$", path.read_text(), re.MULTILINE
    )


def test_lines_that_arrive_together_keep_their_order_in_time(arduino: Any, tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    with served(arduino, path) as url:
        ask(url, "/start", "POST")
        arduino.send("\n" + "".join(f"{k / 10},0,0\n" for k in range(40)))
        wait(url, lambda live: live["rows"] == 40)
    (trial,) = read_forces(path, CALIBRATION)
    assert np.all(np.diff(trial.time) > 0.0)
    write_forces((trial,), tmp_path / "forces.csv")
    np.testing.assert_allclose(read_forces(tmp_path / "forces.csv")[0].time, trial.time)
    np.testing.assert_allclose(trial.force[:, 0], 0.2 * np.arange(40))


def test_other_sites_can_neither_press_nor_look(arduino: Any, tmp_path: Path) -> None:
    with served(arduino, tmp_path / "r.csv") as url:
        assert ask(url, "/start", "POST", Origin="http://elsewhere.example")[0] == 403
        assert ask(url, "/start", "POST", Host="elsewhere.example")[0] == 403
        assert ask(url, "/live?after=0", Host="elsewhere.example")[0] == 400
        assert ask(url, "/live?after=x")[0] == 400
        assert ask(url, "/erase", "POST")[0] == 404
        assert ask(url, "/nothing")[0] == 404
        assert ask(url, "/start", "POST", Origin=url.rstrip("/"))[0] == 200
        status, page = ask(url, "/")
        assert status == 200
        assert "http://" not in page
        assert "https://" not in page


def test_a_full_disk_loses_nothing_once_there_is_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, write, room = tmp_path / "r.csv", os.write, 5
    log = RecordLog(path, THREE, "V", "simulated", datetime.now().astimezone())

    def full(file: int, data: bytes) -> int:
        nonlocal room
        if room == 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written = write(file, data[:room])
        room -= written
        return written

    monkeypatch.setattr(os, "write", full)
    for k in range(3):
        log.row(k, "trial 1", (1.0, k, 0.0))
    assert log.problem == "No space left on device"
    assert path.read_bytes().endswith(b"\n0.000")  # five bytes of the first row
    monkeypatch.setattr(os, "write", write)
    log.row(3.0, "trial 1", (1.0, 3.0, 0.0))
    assert log.problem == ""
    log.close()
    assert read_forces(path, CALIBRATION)[0].force[:, 1].tolist() == [0.0, 2.0, 4.0, 6.0]


def test_every_line_is_on_the_disk_before_the_next(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    log, path, fsync = RecordLog(tmp_path / "r.csv", THREE, "V", "sim", datetime.now().astimezone()), tmp_path, os.fsync
    synchronised: list[bytes] = []

    def spy(file: int) -> None:
        fsync(file)
        synchronised.append((path / "r.csv").read_bytes())

    monkeypatch.setattr(os, "fsync", spy)
    for k in range(3):
        log.row(k, "trial 1", (k, 0.0, 0.0))
    log.remark(3.0, "two\nlines")
    assert [text.splitlines()[-1] for text in synchronised] == [
        b"0.0000,trial 1,0,0,0",
        b"1.0000,trial 1,1,0,0",
        b"2.0000,trial 1,2,0,0",
        b"# 3.000 s: two lines",
    ]
    log.close()


def test_lines_that_never_found_room_are_said_at_the_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    log = RecordLog(tmp_path / "r.csv", THREE, "V", "simulated", datetime.now().astimezone())

    def broken(file: int) -> None:
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    def full(file: int, data: bytes) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", broken)
        log.row(0.0, "trial 1", (1.0, 1.0, 1.0))
    assert log.problem == "Input/output error"
    monkeypatch.setattr(os, "write", full)
    log.row(1.0, "trial 1", (1.0, 1.0, 1.0))
    with pytest.raises(InputError, match="the last 1 lines are lost"):
        log.close()


@contextmanager
def command(arduino: Any, *words: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Run the command; yield it and the page's address."""
    names = ",".join(THREE)
    line = [sys.executable, "-m", "liftopt", "record", "--port", str(arduino.port), "--channels", names, "--no-browser"]
    with subprocess.Popen([*line, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as running:
        try:
            assert running.stdout is not None
            first = running.stdout.readline()
            found = re.search(r"http://\S+", first)
            assert found is not None, first + running.stdout.read()
            yield running, found[0]
        finally:
            running.kill()


def test_what_was_read_before_the_process_is_killed_is_in_the_file(
    arduino: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, calibration = tmp_path / "new" / "r.csv", tmp_path / "cal.toml"
    save_calibration(CALIBRATION, calibration)
    with command(arduino, "--out", str(path), "--calibration", str(calibration)) as (running, url):
        assert ask(url, "/start", "POST")[0] == 200
        arduino.send("\n" + "".join(f"{k / 10},1,0.5\n" for k in range(20)))
        assert wait(url, lambda live: live["rows"] == 20)["calibrated"]
        running.send_signal(signal.SIGKILL)
        assert running.wait(PATIENCE) == -signal.SIGKILL
    (trial,) = read_forces(path, CALIBRATION)
    np.testing.assert_allclose(trial.hand_force, 0.2 * np.arange(20) + 2.0 - 1.0, atol=1e-9)
    before = path.read_bytes()
    assert main(["record", "--port", str(arduino.port), "--out", str(path), "--no-browser"]) == 2
    assert "exists already" in capsys.readouterr().err
    assert path.read_bytes() == before


def test_ctrl_c_ends_it_and_says_what_was_recorded(arduino: Any, tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    with command(arduino, "--out", str(path), "--unit", "counts") as (running, url):
        ask(url, "/start", "POST")
        arduino.send("\n0,512,1023\n")
        wait(url, lambda live: live["rows"] == 1)
        running.send_signal(signal.SIGINT)
        assert running.stdout is not None
        said = running.stdout.read()
        assert running.wait(PATIENCE) == 0
    assert "1 readings (1 of them marked); trials: 1, preloads: 0, lines not understood: 0, connections lost: 0" in said
    assert "\n0" not in said
    assert "WARNING" not in said
    assert "finger2 [counts]" in path.read_text()
    assert path.read_text().endswith("trial 1 ends\n")
    assert read_forces(path, CALIBRATION)[0].flags[0, 2] != 0


@pytest.mark.parametrize("line", ["0.{:02d},0.2,0.1", "{1},0.{0:02d},0.2,0.1", "0.{:02d},0.2,0.1,"])
def test_nothing_is_lost_where_nobody_marks_a_trial(line: str, arduino: Any, tmp_path: Path) -> None:
    """Values alone, with millis before them and with a comma behind; the oracle is what the device printed."""
    path, count = tmp_path / "r.csv", 30
    with command(arduino, "--out", str(path)) as (running, url):
        arduino.send("cut off\n" + "".join(line.format(k, 50 * k) + "\r\n" for k in range(count)))
        wait(url, lambda live: live["rows"] == count)
        running.send_signal(signal.SIGINT)
        assert running.stdout is not None
        said = running.stdout.read()
        assert running.wait(PATIENCE) == 0
    assert "30 readings (0 of them marked); trials: 0, preloads: 0, lines not understood: 0" in said
    assert "WARNING: NO TRIAL WAS MARKED" in said
    (trial,) = read_forces(path, CALIBRATION)
    np.testing.assert_allclose(trial.force[:, 0], 2.0 * 0.01 * np.arange(count), atol=1e-12)
    np.testing.assert_allclose(trial.force[:, 1:], np.tile([0.4, 0.2], (count, 1)), atol=1e-12)
    assert trial.notes[0] == "no trial is marked: all 30 rows of the recording are taken as one"


def test_a_recording_of_which_nothing_was_understood_says_so(arduino: Any, tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    with command(arduino, "--out", str(path)) as (running, url):
        arduino.send("cut off\n1,2\n3,4,5,6,7\n")
        wait(url, lambda live: live["garbage"] == 2)
        running.send_signal(signal.SIGINT)
        assert running.stdout is not None
        assert "WARNING: NO READING WAS UNDERSTOOD; a line must hold 3 numbers" in running.stdout.read()
    assert "not understood: '1,2'" in path.read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--channels", "finger1,finger1"), "two channels have the same name"),
        (("--channels", "toe"), "must start with finger"),
        (("--channels", "finger1,"), "a name is a letter"),
        (("--baud", "0"), "--baud = 0"),
        (("--supply", "0"), "divider.supply = 0"),
        (("--calibration", "nowhere.toml"), "nowhere.toml: no such file"),
        (("--port", "nowhere"), "nowhere"),
    ],
)
def test_what_cannot_be_recorded_is_said_in_a_line_and_leaves_no_file(
    words: tuple[str, ...], said: str, arduino: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "r.csv"
    assert main(["record", "--port", str(arduino.port), "--out", str(out), "--no-browser", *words]) == 2
    complaint = capsys.readouterr().err
    assert said in complaint
    assert complaint.count("\n") == 1
    assert not out.exists()
