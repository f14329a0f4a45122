"""Result files, out and in: what is read is what was written, and nothing broken is ever left or taken in."""

from __future__ import annotations

import dataclasses
import errno
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray as xr

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.storage import result_folder
from liftopt.storage.dataset import to_xarray
from liftopt.storage.reader import load_result
from liftopt.storage.solved_scenario import scenario_or_solved
from liftopt.storage.writer import save

CHEAP = ("solver.intervals=10", "solver.starts=1")
FILES = 5  # solution.nc, scenario.toml and three models


def _contents(folder: Path) -> dict[str, bytes]:
    return {f.relative_to(folder).as_posix(): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file()}


def _same(one: Any, other: Any, where: str = "solution") -> None:
    """Compare two trees of frozen dataclasses bit by bit."""
    assert type(one) is type(other), where
    if dataclasses.is_dataclass(one):
        for field in dataclasses.fields(one):
            _same(getattr(one, field.name), getattr(other, field.name), f"{where}.{field.name}")
    elif isinstance(one, tuple):
        assert len(one) == len(other), where
        for i, pair in enumerate(zip(one, other, strict=True)):
            _same(*pair, f"{where}[{i}]")
    elif isinstance(one, np.ndarray):
        np.testing.assert_array_equal(one, other, err_msg=where)
    else:
        assert one == other, where


def test_what_is_read_is_what_was_written(kept: Any) -> None:
    _same(load_result(kept.folder), kept.solution)
    _same(load_result(kept.folder / "solution.nc"), kept.solution)
    _same(load_result(str(kept.folder)), kept.solution)


def test_folder_holds_the_contracts_files_and_nothing_else(kept: Any) -> None:
    models = [f"models/{name}.urdf" for name in ("human_arm", "sawyer", "table")]
    assert sorted(_contents(kept.folder)) == sorted([*models, "scenario.toml", "solution.nc"])


def test_an_unsolved_result_is_read_back_as_unsolved(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--set", "limits.max_grasp_force=5", "--set", "solver.starts=1", "--set", "solver.intervals=10"]
    assert main(["solve", "--out", str(tmp_path / "r"), *arguments]) == 3
    solution = load_result(tmp_path / "r")
    assert not solution.solved
    assert solution.status in capsys.readouterr().err
    assert not solution.verification.passed


def test_saving_again_replaces_the_older_result(kept: Any, solved: Callable[..., Any], folder: Path) -> None:
    newer = solved("table5_near", *CHEAP)
    save(newer.solution, folder)
    assert load_result(folder).scenario.name == "table5_near"
    assert _contents(folder).keys() == _contents(kept.folder).keys()


INTERRUPTED = [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()]


@pytest.mark.parametrize("error", INTERRUPTED, ids=type)
def test_failure_before_the_one_rename_leaves_the_older_result_whole(
    error: BaseException, folder: Path, solved: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    newer, before = solved("table5_near", *CHEAP).solution, _contents(folder)

    def failing(source: Path, target: Path) -> None:
        assert target.name == "solution.nc"  # the first file to be moved, and the only one that counts
        raise error

    monkeypatch.setattr(os, "replace", failing)
    for expected in (before, {}):
        with pytest.raises(InputError if isinstance(error, OSError) else KeyboardInterrupt):
            save(newer, folder)
        assert _contents(folder) == expected
        shutil.rmtree(folder)


@pytest.mark.parametrize("at", range(1, FILES))
@pytest.mark.parametrize("error", INTERRUPTED, ids=type)
def test_failure_after_the_one_rename_leaves_the_newer_result_whole(
    at: int, error: BaseException, folder: Path, solved: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    newer, calls, replace = solved("table5_near", *CHEAP), [], os.replace

    def failing(source: Path, target: Path) -> None:
        calls.append(target)
        if len(calls) == at + 1:
            raise error
        replace(source, target)

    monkeypatch.setattr(os, "replace", failing)
    with pytest.raises(InputError if isinstance(error, OSError) else KeyboardInterrupt) as caught:
        save(newer.solution, folder)
    if isinstance(error, OSError):
        left = calls[-1].relative_to(folder)
        assert str(caught.value).endswith(f"No space left on device (solution.nc is written, {left} beside it is not)")
    _same(load_result(folder), newer.solution)
    assert scenario_or_solved(folder) == newer.solution.scenario
    assert not [path for path in folder.iterdir() if path.name.startswith(".")]


def test_full_disk_while_writing_leaves_the_older_result_whole(
    folder: Path, solved: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    before = _contents(folder)

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(result_folder, "_write", full)
    with pytest.raises(InputError, match=r"--out = .*: cannot be written: No space left on device"):
        save(solved("table5_near", *CHEAP).solution, folder)
    assert _contents(folder) == before


def test_a_file_where_the_folder_should_be_is_exit_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "taken").write_text("precious")
    assert main(["solve", "--out", str(tmp_path / "taken")]) == 2
    assert main(["solve", "--out", str(tmp_path / "taken" / "below")]) == 2
    assert capsys.readouterr().err.count("cannot be written") == 2
    assert (tmp_path / "taken").read_text() == "precious"


def _edit(change: Callable[[h5py.File], None]) -> Callable[[Path], None]:
    def apply(folder: Path) -> None:
        with h5py.File(folder / "solution.nc", "r+") as file:
            change(file)

    return apply


def _without(name: str) -> Callable[[Path], None]:
    return _edit(lambda file: file.__delitem__(name))


def _without_attribute(name: str) -> Callable[[Path], None]:
    return _edit(lambda file: file.attrs.__delitem__(name))


def _with_attribute(name: str, value: object) -> Callable[[Path], None]:
    return _edit(lambda file: file.attrs.__setitem__(name, value))


def _one_joint_less(folder: Path) -> None:
    data = xr.load_dataset(folder / "solution.nc", engine="h5netcdf").isel(robot_joint=slice(-1))
    data.to_netcdf(folder / "solution.nc", engine="h5netcdf")


def _truncated(folder: Path) -> None:
    file = folder / "solution.nc"
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])


def _other_netcdf(folder: Path) -> None:
    with h5netcdf.File(folder / "solution.nc", "w") as file:
        file.dimensions["x"] = 3
        file.create_variable("temperature", ("x",), data=np.zeros(3))


def _spoiled(name: str, value: float) -> Callable[[Path], None]:
    """Let the last value of a variable be another."""
    return _edit(lambda file: file[name].__setitem__(tuple(size - 1 for size in file[name].shape), value))


def _text(name: str, change: Callable[[str], str]) -> Callable[[Path], None]:
    """Change a text attribute."""
    return _edit(lambda file: file.attrs.__setitem__(name, change(str(file.attrs[name]))))


READ, WHOLE = "solution.nc: cannot be read as NetCDF-4", "solution.nc: is no whole result of liftopt"
BROKEN: dict[str, tuple[Callable[[Path], object], str]] = {
    "gone": (lambda folder: (folder / "solution.nc").unlink(), "result: is no result: there is no file solution.nc"),
    "empty": (lambda folder: (folder / "solution.nc").write_bytes(b""), READ),
    "garbage": (lambda folder: (folder / "solution.nc").write_bytes(bytes(range(256)) * 99), READ),
    "text": (lambda folder: (folder / "solution.nc").write_text("no result"), READ),
    "truncated": (_truncated, READ),
    "no time": (_without("time"), WHOLE),
    "other NetCDF": (_other_netcdf, WHOLE),
    "no torques": (_without("human_tau"), WHOLE),
    "one joint less": (_one_joint_less, ", 9), expected ("),
    "no record": (_without_attribute("record"), WHOLE),
    "no objective": (_without_attribute("objective"), WHOLE),
    "record is no JSON": (_with_attribute("record", "{"), WHOLE),
    "record is empty": (_with_attribute("record", "{}"), WHOLE),
    "record is a list": (_with_attribute("record", "[]"), WHOLE),
    "objective is text": (_with_attribute("objective", "low"), WHOLE),
    "a torque is NaN": (_spoiled("robot_tau", np.nan), "robot_tau holds values that are not finite"),
    "a force is infinite": (_spoiled("grasp_force", -np.inf), "grasp_force holds values that are not finite"),
    "time is NaN": (_spoiled("time", np.nan), "time holds values that are not finite"),
    "time turns back": (_spoiled("time", 0.0), "time does not increase"),
    "a model is gone": (_without_attribute("urdf_table"), "the model of table cannot be read"),
    "a model is empty": (_text("urdf_table", lambda text: ""), "the model of table cannot be read"),
    "a model is a number": (_with_attribute("urdf_table", 7), "the model of table cannot be read"),
    "a model is cut": (_text("urdf_robot", lambda text: text[:2000]), "the model of robot cannot be read"),
    "a model of fewer joints": (
        _text("urdf_human", lambda text: text.replace('type="revolute"', 'type="fixed"')),
        "it has no joint human_Q1 (3 joints, not 13)",
    ),
    "another scenario": (_text("scenario", lambda text: "schema = 1\n"), "duration: is missing"),
    "a scenario that is none": (_text("scenario", lambda text: "schema"), "holds a scenario that cannot be read"),
    "a scenario that is a number": (_with_attribute("scenario", 7), "holds a scenario that cannot be read"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_result_is_one_input_error_that_names_the_file(case: str, folder: Path) -> None:
    spoil, words = BROKEN[case]
    spoil(folder)
    with pytest.raises(InputError) as caught:
        load_result(folder)
    message = str(caught.value)
    assert words in message
    assert "\n" not in message
    assert str(folder / "solution.nc") in message or case == "gone"


def test_nothing_reads_back_what_stands_beside_the_result(kept: Any, folder: Path) -> None:
    (folder / "scenario.toml").write_text("schema = 1\n")
    (folder / "models" / "sawyer.urdf").write_text("no model")
    (folder / "models" / "table.urdf").unlink()
    _same(load_result(folder), kept.solution)
    assert scenario_or_solved(folder) == kept.solution.scenario
    shutil.rmtree(folder / "models")
    (folder / "scenario.toml").unlink()
    moved = folder.rename(folder.parent / "moved") / "solution.nc"
    _same(load_result(moved), kept.solution)
    assert scenario_or_solved(moved) == kept.solution.scenario


def test_the_file_is_the_dataset_and_the_dataset_is_the_file(kept: Any) -> None:
    file = xr.load_dataset(kept.folder / "solution.nc", engine="h5netcdf")
    xr.testing.assert_identical(to_xarray(kept.solution), file)
    assert all({"units", "long_name"} <= set(file[name].attrs) for name in file.variables)


def test_the_same_answer_makes_the_same_bytes(kept: Any, tmp_path: Path) -> None:
    save(kept.solution, tmp_path / "again")
    assert _contents(tmp_path / "again") == _contents(kept.folder)


@pytest.mark.parametrize("path", ["nowhere", "nowhere/solution.nc", "nowhere.nc", "."])
def test_a_path_without_a_result_is_an_input_error(path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"is no result: there is no file "):
        load_result(path)


def test_versions_are_json_that_any_reader_takes(kept: Any) -> None:
    """JSON proper knows no NaN and no Infinity."""
    with h5netcdf.File(kept.folder / "solution.nc", "r") as file:
        versions = json.loads(file.attrs["versions"], parse_constant=pytest.fail)
    assert all(isinstance(version, str) for version in versions.values())
