"""Results of earlier versions, whose scenario and models stand in files beside solution.nc: they open, or say why not.

Made of a result of today by taking out what it holds more; the oracle is that result.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from liftopt.commands.cli import main
from liftopt.errors import InputError
from liftopt.storage.reader import load_result
from liftopt.storage.solved_scenario import scenario_or_solved
from liftopt.storage.writer import save


@pytest.fixture
def older(folder: Path, as_of_old: Callable[[Path], None]) -> Path:
    """A result of an earlier version."""
    as_of_old(folder)
    return folder


@pytest.mark.parametrize("name", ["", "solution.nc", "scenario.toml"])
def test_an_older_result_opens(kept: Any, older: Path, name: str) -> None:
    read = load_result(older / name)
    assert read.urdfs == kept.solution.urdfs
    assert read.scenario == kept.solution.scenario == scenario_or_solved(older / name)
    assert read.assessment == kept.solution.assessment
    for one, other in zip(read.agents, kept.solution.agents, strict=True):
        np.testing.assert_array_equal(one.tau, other.tau)


def test_saving_it_again_makes_one_of_today(kept: Any, older: Path) -> None:
    save(load_result(older), older)
    assert (older / "solution.nc").read_bytes() == (kept.folder / "solution.nc").read_bytes()


SPOILT: dict[str, tuple[Callable[[Path], object], str]] = {
    "no scenario": (
        lambda folder: (folder / "scenario.toml").unlink(),
        "scenario.toml: no such file; a result of an earlier",
    ),
    "another scenario": (
        lambda folder: (folder / "scenario.toml").write_text("schema = 1\n"),
        "duration: is missing",
    ),
    "no models": (lambda folder: shutil.rmtree(folder / "models"), "models/human_arm.urdf: cannot be read"),
    "a model of bytes": (
        lambda folder: (folder / "models" / "table.urdf").write_bytes(b"\xff"),
        "table.urdf: is a model that cannot",
    ),
    "no URDF": (
        lambda folder: (folder / "models" / "table.urdf").write_text("<html/>"),
        "the model of table cannot be read",
    ),
    "another model": (
        lambda folder: shutil.copy(folder / "models" / "table.urdf", folder / "models" / "sawyer.urdf"),
        "the model of robot is not that of the result's scenario",
    ),
    "half written": (lambda folder: (folder / ".older-result").mkdir(), "the one before it is in "),
}


@pytest.mark.parametrize("case", SPOILT)
def test_one_that_is_not_whole_is_one_clear_line(case: str, older: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spoil, told = SPOILT[case]
    spoil(older)
    with pytest.raises(InputError):
        load_result(older)
    assert main(["view", str(older), "--html", str(older / "page.html")]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert told in err
