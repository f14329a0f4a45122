"""Does every robot lift with a person? Each that is known by name, or those of a list, from a scenario file.

``python scripts/check_robots.py --out checked`` writes a scenario for each robot that is known by name as ``liftopt
robots NAME --scenario`` does, solves it, and prints the outcome, how long it took, with and without what had to be
compiled, the margins and what was found. ``--show`` also writes the page that plays the lift, exports the robot's
motion, and puts the lift to MuJoCo. Names choose some robots. ``--list FILE`` reads other robots: a TOML file with a
table ``[[robot]]`` for each, its ``name``, ``maker``, ``source`` and ``[robot.entries]``, which are entries of
``[agents.robot]``; relative paths of models count from ``--descriptions DIR``. ``--table FILE`` writes the rows as
CSV. The exit status is 1 where a robot neither lifts nor is refused with a reason.
"""

from __future__ import annotations

import argparse
import csv
import io
import sys
import time
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import tomli_w

import liftopt as lo
from liftopt.commands.cli import main as liftopt_command
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_agents import chosen_of
from liftopt.search.first_scenario import first_scenario
from liftopt.solution.finding import Finding

HELD_BACK = ("warning", "caution")
SHOWN = {"view": "--html", "export": "--out", "crosscheck": ""}


@dataclass(frozen=True)
class Asked:
    """A robot that is to lift: its name, whose it is, where its description is from, and its entries."""

    name: str
    maker: str
    source: str
    entries: Mapping[str, Any]


@dataclass
class Row:
    """What came of one robot; figures that there are none of are empty.

    Attributes:
        name, maker, source: of it.
        joints: that move.
        outcome: ``solved``, or why not.
        box_kg, from_m, to_m: what is lifted, and between which heights.
        compiled_s, first_s, again_s: what was compiled, the first solve without that, and a second one [s].
        objective: of the lift.
        torque_percent, torque_joint: largest share of a torque limit, and whose.
        speed_percent: largest share of a speed limit.
        apart_mm: nearest distance of person and robot.
        data: what is warned of in the robot's data.
        told: warnings and cautions on the lift, by code.
        shown: which further commands did what they should.
    """

    name: str
    maker: str
    source: str
    joints: int | str = ""
    outcome: str = ""
    box_kg: float | str = ""
    from_m: float | str = ""
    to_m: float | str = ""
    compiled_s: float | str = ""
    first_s: float | str = ""
    again_s: float | str = ""
    objective: float | str = ""
    torque_percent: float | str = ""
    torque_joint: str = ""
    speed_percent: float | str = ""
    apart_mm: float | str = ""
    data: str = ""
    told: str = ""
    shown: str = ""

    def line(self) -> str:
        """Return the row as it is printed."""
        return " | ".join(str(value) for value in asdict(self).values())


@dataclass
class Compiling:
    """Takes progress lines, and adds up how long what is said to compile lasted."""

    seconds: float = 0.0
    since: float | None = field(default=None)

    def __call__(self, line: str) -> None:
        """Take a line: what was going on has ended."""
        self.end()
        if line.startswith("compiling"):
            self.since = time.perf_counter()

    def end(self) -> None:
        """Nothing goes on any more."""
        if self.since is not None:
            self.seconds += time.perf_counter() - self.since
            self.since = None


def known() -> Iterator[Asked]:
    """Give the robots that are known by name and installed."""
    for robot in known_robots().values():
        if robot.is_installed:
            source = "liftopt" if robot.own_urdf else "example-robot-data"
            yield Asked(robot.name, robot.maker, source, {"model": robot.name})


def listed(file: Path, descriptions: Path) -> Iterator[Asked]:
    """Give the robots of a list."""
    for table in tomllib.loads(file.read_text(encoding="utf-8"))["robot"]:
        entries = dict(table["entries"])
        entries["model"] = str((descriptions / entries["model"]).absolute())
        yield Asked(table["name"], table["maker"], table["source"], entries)


def lifted(asked: Asked, out: Path, *, show: bool) -> Row:
    """Return what comes of a robot."""
    row, progress = Row(asked.name, asked.maker, asked.source), Compiling()
    try:
        found = chosen_of(Robot(**asked.entries), "robot").examination()
        row.joints = len(found.chain.links)
        row.data = ", ".join(dict.fromkeys(one.code for one in found.findings if one.severity == "warned"))
        if found.refused:
            reasons = dict.fromkeys(one.code for one in found.refused)
            row.outcome = f"refused: {', '.join(reasons)}"
            return row
        path = out / f"{asked.name}.toml"
        tables = first_scenario(asked.entries, asked.name, progress)
        path.write_text(tomli_w.dumps(tables), encoding="utf-8")
        scenario = lo.load_scenario(path)
        row.box_kg = scenario.object.mass
        row.from_m, row.to_m = (end.height for end in (scenario.task.start, scenario.task.end))
        started = time.perf_counter()
        solution = lo.solve(scenario, progress=progress)
        progress.end()
        row.first_s = round(time.perf_counter() - started, 1)
        row.compiled_s = round(progress.seconds, 1)
        started = time.perf_counter()
        lo.solve(scenario)
        row.again_s = round(time.perf_counter() - started, 1)
    except lo.LiftoptError as error:
        row.outcome = " ".join(str(error).split())
        return row
    row.outcome = solution.status
    if solution.status == "solved":
        _measured(row, solution)
        folder = solution.save(out / asked.name)
        row.shown = ", ".join(_shown(folder)) if show else ""
    return row


def _measured(row: Row, solution: lo.Solution) -> None:
    row.objective = float(f"{solution.objective:.6g}")
    of_robot = [one for one in solution.assessment.findings if one.agent == "robot"]
    torque, speed = (_largest(of_robot, f"robot.{what}") for what in ("torque", "speed"))
    if torque is not None:
        row.torque_percent, row.torque_joint = torque
    if speed is not None:
        row.speed_percent = speed[0]
    apart = [one.value for one in solution.assessment.findings if one.code == "clearance.person_robot"]
    row.apart_mm = round(1e3 * float(apart[0])) if apart and apart[0] is not None else ""
    told = [one for one in solution.assessment.findings if one.severity in HELD_BACK]
    row.told = ", ".join(dict.fromkeys(one.code for one in told if not one.code.startswith("verdict")))


def _largest(findings: list[Finding], code: str) -> tuple[float, str] | None:
    shares = [
        (round(100.0 * one.value / one.limit, 1), str(one.joint).removeprefix("robot_"))
        for one in findings
        if one.code == code and one.value is not None and one.limit
    ]
    return max(shares, default=None)


def _shown(folder: Path) -> Iterator[str]:
    """Give the commands that did what they should with a result."""
    for command, option in SHOWN.items():
        target = folder / ("lift.html" if command == "view" else command)
        words = [command, str(folder), *((option, str(target)) if option else ())]
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            status = liftopt_command(words)
        yield command if status == 0 else f"no {command}"


def main() -> int:
    """Check the robots that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="some of the robots (default: all)")
    parser.add_argument("--list", type=Path, metavar="FILE", help="TOML file of robots that are not known by name")
    parser.add_argument("--descriptions", type=Path, default=Path(), metavar="DIR", help="where their files are")
    parser.add_argument("--out", type=Path, default=Path("checked_robots"), metavar="DIR", help="for the results")
    parser.add_argument("--table", type=Path, metavar="FILE", help="CSV file of the rows")
    parser.add_argument("--show", action="store_true", help="also play, export, and put to MuJoCo")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    all_asked = listed(args.list, args.descriptions) if args.list else known()
    rows = []
    for asked in all_asked:
        if not args.names or asked.name in args.names:
            rows.append(lifted(asked, args.out, show=args.show))
            print(rows[-1].line(), flush=True)
    if args.table:
        with args.table.open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, [entry.name for entry in fields(Row)], lineterminator="\n")
            writer.writeheader()
            writer.writerows(asdict(row) for row in rows)
    solved = sum(row.outcome == "solved" for row in rows)
    print(f"{solved} of {len(rows)} robots of {len({row.maker for row in rows})} makers lift")
    return int(any(not row.outcome or "no stand" in row.outcome for row in rows))


if __name__ == "__main__":
    sys.exit(main())
