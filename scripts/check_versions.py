"""Run the tests in fresh environments with the oldest and the newest versions that pyproject.toml allows.

Each environment is built from nothing: a virtual environment, liftopt installed from this folder with the extras, its
lower bounds pinned for `oldest`. Prints a table in Markdown; the exit status is 1 where anything failed.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
EXTRAS = ("test", "lab", "crosscheck")
BOUND = re.compile(r"^([A-Za-z0-9_.-]+)\s*(>=|==)\s*([^,;\s]+)")


def oldest(project: dict[str, Any]) -> list[str]:
    """Return every requirement at its lower bound, also of the build."""
    wanted = [*project["build-system"]["requires"], *project["project"]["dependencies"]]
    for extra in EXTRAS:
        wanted += project["project"]["optional-dependencies"][extra]
    found: dict[str, str] = {}
    for requirement in wanted:
        bound = BOUND.match(requirement)
        if bound is None:
            raise SystemExit(f"no lower bound in {requirement!r}")
        name, _, version = bound.groups()
        found.setdefault(name.lower(), version)
        if found[name.lower()] != version:
            raise SystemExit(f"two lower bounds of {name}: {found[name.lower()]} and {version}")
    return [f"{name}=={version}" for name, version in found.items()]


def checked(which: str, python: str, tests: Sequence[str]) -> tuple[bool, str]:
    """Build one environment and run the tests in it; return whether they passed, and their last line."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory(prefix="liftopt-") as folder:
        subprocess.run([python, "-m", "venv", folder], check=True)
        inside, pins = str(Path(folder) / "bin" / "python"), Path(folder) / "pins.txt"
        pins.write_text("\n".join(oldest(project)) if which == "oldest" else "", encoding="utf-8")
        # The build gets them too: by the second name from pip 25.3 on.
        pinned = os.environ | {"PIP_CONSTRAINT": str(pins), "PIP_BUILD_CONSTRAINT": str(pins)}
        subprocess.run([inside, "-m", "pip", "install", "-q", "--upgrade", "pip"], check=True)
        install = [inside, "-m", "pip", "install", "-q", f"{ROOT}[{','.join(EXTRAS)}]"]
        built = subprocess.run(install, env=pinned, capture_output=True, text=True, check=False)
        if built.returncode:
            return False, f"not installed: {(built.stderr.strip().splitlines() or ['no message'])[-1]}"
        # What is installed is tested: from here the tests would import the folder's own files.
        command = [inside, "-m", "pytest", "-p", "no:cacheprovider", *(str(ROOT / test) for test in tests)]
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        lines = run.stdout.strip().splitlines() or [run.stderr.strip() or "no output"]
        for line in lines:
            if line.startswith(("FAILED", "ERROR")):
                print(line, file=sys.stderr)
        return run.returncode == 0, lines[-1].strip("= ")


def main() -> int:
    """Check what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("which", nargs="*", choices=("oldest", "newest"), default=["oldest", "newest"])
    parser.add_argument("--python", default=sys.executable, help="that makes the environments (default: this one)")
    parser.add_argument("--tests", nargs="*", default=["tests"], metavar="PATH", help="from the repository's root")
    args = parser.parse_args()
    print("| versions | passed | last line | minutes |\n|---|---|---|---|")
    passed = True
    for which in args.which:
        began = time.monotonic()
        good, last = checked(which, args.python, args.tests)
        passed &= good
        print(f"| {which} | {'yes' if good else 'no'} | {last} | {(time.monotonic() - began) / 60:.0f} |", flush=True)
    return int(not passed)


if __name__ == "__main__":
    sys.exit(main())
