"""Show that a change left the answers as they were, bit by bit: twelve lifts by the paper's objective, solved twice.

``python scripts/check_same_answers.py record FOLDER`` solves them with the installed liftopt, by its command line;
``compare BEFORE AFTER`` puts two such folders beside each other and prints a table in Markdown. The exit status is 1
where a status, an exit status, a number or an array differs in one bit. Seconds and versions are left out.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import h5netcdf
import numpy as np

# Of schema 1, so that versions before and after read them alike: the paper's objective, and nothing kept apart.
SCENARIOS = Path(__file__).parents[1] / "tests" / "scenario" / "schema1"
# As shipped, both grasps, both solvers, finer meshes, and lifts that cannot be or that only a wider search finds.
LIFTS = {
    "table5": ("table5",),
    "near": ("table5_near",),
    "free": ("table5_free",),
    "wrench": ("table5", "--set", "human.grasp=wrench", "--set", "robot.grasp=wrench"),
    "flat hand": ("table5_near", "--set", "human.contact=flat", "--set", "robot.grasp=wrench", "--set", "table.mass=5"),
    "acceleration": ("table5_near", "--set", "task.rest=acceleration", "--set", "solver.seed=3"),
    "refined": ("table5_near", "--set", "refine.on=true", "--set", "refine.objective_error=0.002"),
    "40 intervals": ("table5", "--set", "solver.intervals=40", "--set", "human.stature=1.6"),
    "ipopt": ("table5_near", "--set", "solver.name=ipopt", "--set", "solver.starts=1", "--set", "solver.tries=0"),
    "too fast": ("table5", "--set", "duration=0.2"),
    "too heavy": ("table5_near", "--set", "table.mass=45"),
    "too far": ("table5", "--set", "task.standing_distance=2.9"),
}
# Beside other work the limit of time must not end what work ends on an idle machine.
SET = ("--set", "solver.time_limit=600")
FOLLOWED = ("status", "objective", "iterations", "max_violation", "kkt_error")


def record(folder: Path) -> None:
    """Solve all lifts into a folder."""
    for name, (scenario, *arguments) in LIFTS.items():
        out = folder / name.replace(" ", "_")
        command = [sys.executable, "-m", "liftopt", "solve", str(SCENARIOS / f"{scenario}.toml"), *arguments, *SET]
        run = subprocess.run(
            [*command, "--out", str(out)], capture_output=True, check=False, env=os.environ | {"OMP_NUM_THREADS": "1"}
        )
        (out / "exit_status").write_text(str(run.returncode), encoding="utf-8")
        print(f"{name}: exit status {run.returncode}", flush=True)


def _contents(folder: Path) -> dict[str, bytes]:
    """Return what must not differ, by name."""
    found = {"exit status": (folder / "exit_status").read_bytes()}
    path = next(iter([*folder.glob("solution.nc"), *folder.glob("unsolved/solution.nc")]))
    with h5netcdf.File(path, "r") as file:
        for name in FOLLOWED:
            found[name] = np.asarray(file.attrs[name]).tobytes() if name != "status" else str(file.attrs[name]).encode()
        for name, variable in file.variables.items():
            values = np.asarray(variable[...])
            found[name] = str(values.tolist()).encode() if values.dtype == object else values.tobytes()
    return found


def differences(before: Path, after: Path) -> Iterator[tuple[str, int, list[str]]]:
    """Yield for each lift its name, how many numbers and arrays were compared, and which differ."""
    for name in LIFTS:
        old, new = (_contents(folder / name.replace(" ", "_")) for folder in (before, after))
        yield name, len(old), sorted(key for key in {*old, *new} if old.get(key) != new.get(key))


def main() -> int:
    """Record or compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("record").add_argument("folder", type=Path)
    two = commands.add_parser("compare")
    two.add_argument("before", type=Path)
    two.add_argument("after", type=Path)
    args = parser.parse_args()
    if args.command == "record":
        record(args.folder)
        return 0
    print("| lift | compared | differ |\n|---|---|---|")
    same = True
    for name, count, differ in differences(args.before, args.after):
        same &= not differ
        print(f"| {name} | {count} | {', '.join(differ) or 'none'} |")
    return int(not same)


if __name__ == "__main__":
    sys.exit(main())
