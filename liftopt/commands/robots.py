"""``liftopt robots``: which are known by name, and what is noticed about the data of one, or of a file."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftopt.commands.exit_status import DONE, NOT_SOLVED
from liftopt.commands.terminal import captured, write
from liftopt.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from liftopt.multibody.robots.chosen_robot import ChosenRobot
    from liftopt.multibody.robots.examination import Examination
    from liftopt.multibody.robots.known_robot import KnownRobot

LISTED = ("name", "robot", "maker", "lifts", "installed")
JOINTS = ("joint", "kind", "from", "to", "speed", "effort")
HEADS = {"refused": "Refused", "warned": "Warning", "assumed": "Assumed"}


def add_robots_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "robots",
        help="robots that are known by name; what a URDF or xacro file lacks",
        description="Without ROBOT, list the robots that are known by name. With one, say what it is, what is assumed "
        "about it, and what is missing or wrong in its data, each with the fix; exit status 3 if it cannot lift.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "robot",
        nargs="?",
        metavar="ROBOT",
        help="a name from the list or of robot_descriptions, or a URDF or xacro file",
    )
    parser.add_argument("--grasp-frame", metavar="LINK", help="link that it holds with; by default one is proposed")
    parser.add_argument("--base", metavar="LINK", help="link that is bolted down (default: the root)")
    parser.add_argument(
        "--lock", action="append", default=[], metavar="JOINT=VALUE", help="hold a joint there, in rad or m; repeatable"
    )
    parser.add_argument(
        "--arg", action="append", default=[], metavar="NAME=VALUE", help="an argument of a xacro file; repeatable"
    )
    parser.add_argument(
        "--scenario",
        metavar="FILE",
        help="write a scenario to start from, with a stand that reaches (a new file)",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=robots)


def robots(args: argparse.Namespace) -> int:
    """Do what the command line says and return the exit status.

    Raises:
        InputError: there is no such robot, its file is no robot, or an option is wrong.
    """
    if args.robot is None:
        for option in ("grasp_frame", "base", "lock", "arg", "scenario"):
            if value := getattr(args, option):
                raise InputError(f"--{option.replace('_', '-')}", value, "needs a ROBOT")
        write(_list_json() if args.json else captured(_print_list))
        return DONE
    if args.scenario:
        from liftopt.files.new_file import check_new

        check_new("--scenario", Path(args.scenario))
    chosen = _chosen(args)
    known, found = chosen.known, chosen.examination()
    status = NOT_SOLVED if found.refused else DONE
    written = _written_scenario(args, chosen) if args.scenario and status == DONE else None
    if args.json:
        name = None if known is None else known.name
        told = {"known_as": name, **found.plain(), "scenario": written, "exit_status": status}
        write(json.dumps(told, indent=2, allow_nan=False) + "\n")
    else:
        write(captured(lambda console: _print(found, known, console)))
        if written is not None:
            write(f"Written to {written}; liftopt solve {written} solves it\n")
    return status


def _chosen(args: argparse.Namespace) -> ChosenRobot:
    from liftopt.multibody.robots.catalogue import known_robots
    from liftopt.multibody.robots.chosen_robot import chosen_robot

    arguments, locked = dict(_pairs("--arg", args.arg)), _locked(args)
    if args.robot in known_robots():
        for key in ("grasp_frame", "base", "arg", "lock"):
            if said := getattr(args, key):
                raise InputError(f"--{key.replace('_', '-')}", said, f"goes with a file; of {args.robot} it is known")
    return chosen_robot(
        args.robot, arguments=arguments, grasp_frame=args.grasp_frame, base_link=args.base, locked=locked
    )


def _locked(args: argparse.Namespace) -> dict[str, float]:
    return {name: _number("--lock", name, value) for name, value in _pairs("--lock", args.lock)}


def _written_scenario(args: argparse.Namespace, chosen: ChosenRobot) -> str:
    """Write a scenario of the robot as it was chosen, and return where it is."""
    import tomli_w

    from liftopt.commands.terminal import progress_line
    from liftopt.files.new_file import write_new
    from liftopt.multibody.robots.public_description import is_public
    from liftopt.search.first_scenario import first_scenario

    entries: dict[str, Any] = {"grasp_frame": args.grasp_frame, "base_link": args.base, "locked": _locked(args)}
    entries |= {"arguments": dict(_pairs("--arg", args.arg))}
    by_name = chosen.known is not None or is_public(args.robot)
    model = args.robot if by_name else str(Path(args.robot).absolute())
    robot = {"model": model} | {key: value for key, value in entries.items() if value}
    with progress_line() as progress:
        made = first_scenario(robot, Path(args.scenario).stem, progress)
    head = (
        f"# A person and {chosen.description.name} lift a box: a scenario to start from.\n"
        "# SI units; radians unless the key says otherwise.\n\n"
    )
    write_new("--scenario", Path(args.scenario), head + tomli_w.dumps(made))
    return str(args.scenario)


def _pairs(option: str, words: list[str]) -> list[tuple[str, str]]:
    pairs = []
    for word in words:
        name, equals, value = word.partition("=")
        if not name or not equals:
            raise InputError(option, word, "must be NAME=VALUE")
        pairs.append((name, value))
    return pairs


def _number(option: str, name: str, value: str) -> float:
    try:
        return float(value)
    except ValueError:
        raise InputError(f"{option} {name}", value, "must be a number of rad or m") from None


def _list_json() -> str:
    from liftopt.multibody.robots.catalogue import known_robots

    listed = [
        {
            "name": robot.name,
            "title": robot.title,
            "maker": robot.maker,
            "file": robot.file,
            "base": robot.base,
            "grasp_frame": robot.grasp_frame,
            "locked": dict(robot.locked),
            "payload_kg": robot.payload,
            "payload_source": None if robot.payload_source is None else robot.payload_source.told,
            "installed": robot.is_installed,
        }
        for robot in known_robots().values()
    ]
    return json.dumps({"robots": listed, "exit_status": DONE}, indent=2) + "\n"


def _print_list(console: Console) -> None:
    from rich.table import Table

    from liftopt.multibody.robots.catalogue import known_robots
    from liftopt.multibody.robots.xacro_text import INSTALL

    table = Table(*LISTED, box=None, header_style="bold", pad_edge=False)
    known = list(known_robots().values())
    for robot in known:
        payload = "" if robot.payload is None else f"{robot.payload:g} kg"
        table.add_row(robot.name, robot.title, robot.maker, payload, "yes" if robot.is_installed else "no")
    console.print(table)
    told = "\nliftopt robots NAME says what is known of one, liftopt robots FILE looks a URDF or xacro file through."
    if not all(robot.is_installed for robot in known):
        told += f"\nThose that are not installed come with: {INSTALL}"
    console.print(told, markup=False, highlight=False, soft_wrap=True)


def _print(found: Examination, known: KnownRobot | None, console: Console) -> None:
    from rich.table import Table

    from liftopt.multibody.robots.data_finding import alike, told_together

    def say(text: str) -> None:
        console.print(text, markup=False, highlight=False, soft_wrap=True)

    chain = found.chain
    if known is None:
        say(f"{chain.description.name}, from {chain.description.source}")
    else:
        say(f"{known.name}: {known.title}, {known.maker}" + ("" if known.path is None else f", from {known.path}"))
        if known.payload is not None and known.payload_source is not None:
            say(f"It lifts {known.payload:g} kg: {known.payload_source.told}")
    say(
        f"{len(chain.links)} joints move {chain.moving_mass:.3g} kg between the base {chain.base} and the grasp frame "
        f"{chain.grasp_frame}; the links, one after the other, reach {chain.reach:.3g} m"
    )
    table = Table(*JOINTS, box=None, header_style="bold", pad_edge=False)
    for joint, ends in zip(chain.joints, chain.ranges, strict=True):
        slides = joint.kind == "prismatic"
        numbers = (ends.lower, ends.upper, joint.velocity, joint.effort)
        units = ("m", "m", "m/s", "N") if slides else ("rad", "rad", "rad/s", "Nm")
        table.add_row(
            joint.name,
            joint.kind,
            *("none" if n is None else f"{n:.4g} {unit}" for n, unit in zip(numbers, units, strict=True)),
        )
    console.print(table)
    for group in alike(found.findings):
        say(f"{HEADS[group[0].severity]}: {told_together(group)}")
    say("It cannot lift with these data." if found.refused else "It can lift with these data.")
