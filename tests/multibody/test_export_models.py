"""What is committed under models/ is what scripts/export_models.py writes. Oracle: byte comparison."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pinocchio as pin
import pytest

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "scripts" / "export_models.py"
NAMES = (
    "human_arm.urdf",
    "human_arm_numbers.md",
    "whole_body.urdf",
    "whole_body_numbers.md",
    "sawyer.urdf",
    "table.urdf",
)


def _run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, str(SCRIPT), *arguments], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    folder = tmp_path_factory.mktemp("models")
    assert _run("--out", str(folder)).returncode == 0
    return folder


@pytest.mark.parametrize("name", NAMES)
def test_committed_models_are_what_the_script_writes(exported, name):
    assert (ROOT / "models" / name).read_bytes() == (exported / name).read_bytes()


def test_check_tells_a_changed_file(exported):
    assert _run("--out", str(exported), "--check").returncode == 0
    path = exported / "table.urdf"
    original = path.read_text()
    path.write_text(original.replace("0.45", "0.46"))
    failed = _run("--out", str(exported), "--check")
    path.write_text(original)
    assert failed.returncode == 1
    assert "table.urdf" in failed.stderr


def test_committed_models_load_from_file():
    """Oracle: Pinocchio's URDF parser; degrees of freedom of Tables 2 and 3, of the whole person and of a free body."""
    assert pin.buildModelFromUrdf(str(ROOT / "models" / "whole_body.urdf")).nv == 20
    assert pin.buildModelFromUrdf(str(ROOT / "models" / "human_arm.urdf")).nv == 13
    assert pin.buildModelFromUrdf(str(ROOT / "models" / "sawyer.urdf")).nv == 10
    assert pin.buildModelFromUrdf(str(ROOT / "models" / "table.urdf"), pin.JointModelFreeFlyer()).nv == 6
