"""Write requirements/lock.txt: the versions that pip chooses today for liftopt with the extras of contributors.

pip resolves what pyproject.toml asks for as in a fresh environment, and installs and builds nothing. Run it with the
Python that the versions are for, and run the tests with them before you commit the file.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
EXTRAS = ("test", "docs")
HEAD = """\
# Versions that the tests passed with, on Python {python_version} and {platform_machine} {platform_system}. \
Not what liftopt needs: pyproject.toml has that.
# pip install -c requirements/lock.txt ".[{extras}]"
# Written by scripts/lock.py.
"""


def wanted(project: dict[str, Any]) -> list[str]:
    """Return what liftopt and its extras ask for."""
    table = project["project"]
    return [*table["dependencies"], *(entry for extra in EXTRAS for entry in table["optional-dependencies"][extra])]


def resolved(requirements: list[str]) -> dict[str, Any]:
    """Return pip's report on what it would install into an empty environment."""
    command = [sys.executable, "-m", "pip", "install", "--dry-run", "--ignore-installed", "-q", "--report", "-"]
    run = subprocess.run([*command, *requirements], stdout=subprocess.PIPE, text=True, check=False)
    if run.returncode:
        raise SystemExit(f"pip failed with exit status {run.returncode}")
    report: dict[str, Any] = json.loads(run.stdout)
    return report


def locked(report: dict[str, Any]) -> str:
    """Return the file: a name and a version a line, without the places that pip took them from."""
    pins = {item["metadata"]["name"]: item["metadata"]["version"] for item in report["install"]}
    lines = [f"{name}=={pins[name]}\n" for name in sorted(pins, key=str.lower)]
    return HEAD.format(**report["environment"], extras=",".join(EXTRAS)) + "".join(lines)


def main() -> int:
    """Write the file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", nargs="?", type=Path, default=ROOT / "requirements" / "lock.txt")
    out: Path = parser.parse_args().out
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    out.write_text(locked(resolved(wanted(project))), encoding="utf-8")
    print(out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
