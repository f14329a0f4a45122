"""The style: the linters' verdicts, the length and names of files, and no trace of the machine it was written on."""

from __future__ import annotations

import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.long
ROOT = Path(__file__).parents[1]
LONGEST = 400
TYPED_NUMPY = (2, 3)
SOURCES = ("liftopt", "scripts", "tests", "docs")


def _files(*suffixes: str) -> list[Path]:
    return [f for folder in SOURCES for suffix in suffixes for f in sorted((ROOT / folder).rglob(f"*{suffix}"))]


@pytest.mark.parametrize(
    "command",
    [["ruff", "check", "."], ["ruff", "format", "--check", "."], ["mypy", "--strict"]],
    ids=" ".join,
)
def test_linters_have_nothing_to_say(command: list[str]) -> None:
    if importlib.util.find_spec(command[0]) is None:
        pytest.skip(f"{command[0]} is not installed (it is in the extra 'test')")
    if command[0] == "mypy" and tuple(map(int, np.__version__.split(".")[:2])) < TYPED_NUMPY:
        pytest.skip("the types of this NumPy, and of what goes with it, say less than those the code is checked with")
    run = subprocess.run([sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr


def test_no_file_is_too_long_or_a_drawer_for_everything() -> None:
    files = _files(".py", ".cpp", ".hpp", ".h")
    assert len(files) > 50
    lengths = {f.relative_to(ROOT).as_posix(): len(f.read_text(encoding="utf-8").splitlines()) for f in files}
    assert {name: n for name, n in lengths.items() if n > LONGEST} == {}
    assert {name for name in lengths if Path(name).stem in ("utils", "util", "common", "helpers", "misc")} == set()


def test_tracked_text_names_no_machine_and_no_mirror() -> None:
    git = shutil.which("git")
    if git is None or not (ROOT / ".git").exists():
        pytest.skip("not a git clone: nothing says which files are tracked")
    listed = subprocess.run([git, "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False)
    if listed.returncode != 0:
        pytest.skip(f"git will not list the files: {listed.stderr.strip()}")
    # Put together here, so that this file does not find itself.
    roots = "|".join(("home", "root", "tmp", "work", "Users", "mnt"))
    path = re.compile(rf"(?<![\w.~>)}}/-])/(?:{roots})/\w")
    host = re.compile(r"https?://[^\s/]*(?:localhost|127\.0\.0\.1|\d+\.\d+\.\d+\.\d+|pypi|artifactory|nexus|mirror)")
    found = []
    for name in filter(None, listed.stdout.split("\0")):
        try:
            text = (ROOT / name).read_text(encoding="utf-8")
        except (UnicodeDecodeError, FileNotFoundError):
            continue
        for number, line in enumerate(text.splitlines(), start=1):
            if path.search(line) or host.search(line):
                found.append(f"{name}:{number}: {line.strip()}")
    assert found == []
