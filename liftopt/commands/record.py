"""``liftopt record``: force sensors on a serial port, live in the browser and line by line into a CSV."""

from __future__ import annotations

import argparse
import re
import threading
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftopt.commands.exit_status import DONE
from liftopt.commands.terminal import write
from liftopt.errors import InputError
from liftopt.types import Progress

if TYPE_CHECKING:
    from liftopt.lab.forces.calibration import Calibration
    from liftopt.lab.forces.record_session import RecordSession
    from liftopt.lab.forces.voltage_divider import Divider

CHANNELS = "finger1,finger2,finger3,finger4,thumb1,thumb2"  # four below the board and two above it (Fig. 5)
FASTEST = 4_000_000  # baud


def add_record_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "record",
        help="record force sensors from an Arduino, live in the browser",
        description="Read force sensors from an Arduino that prints a line per sample, one number for each channel, "
        "separated by commas; its clock (millis) may stand before them. The page has buttons to take the preload and "
        "to start and stop trials; every line, marked or not, is on the disk before the next is read. Ctrl-C ends it.",
        allow_abbrev=False,
    )
    parser.add_argument("--port", required=True, metavar="PORT", help="serial port, such as /dev/ttyACM0")
    parser.add_argument("--out", required=True, metavar="FILE", help="CSV to write; it must not exist")
    parser.add_argument("--calibration", metavar="CAL", help="of the sensors, to show forces as well as voltages")
    parser.add_argument(
        "--channels",
        default=CHANNELS,
        metavar="NAMES",
        help="in the device's order, finger... or thumb... (default: %(default)s)",
    )
    parser.add_argument(
        "--unit", choices=("V", "mV", "counts"), default="V", help="of the numbers in a line (default: %(default)s)"
    )
    parser.add_argument("--baud", type=int, default=9600, metavar="N", help="bits per second (default: %(default)s)")
    add_divider_arguments(parser)
    parser.add_argument("--no-browser", action="store_false", dest="browser", help="serve the page, open no browser")
    parser.set_defaults(run=_record)


def add_divider_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that describe the voltage dividers."""
    parser.add_argument("--supply", type=float, metavar="V", help="supply of the voltage dividers (default: 5)")
    parser.add_argument("--resistor", type=float, metavar="OHM", help="their fixed resistor (default: 10000)")
    parser.add_argument(
        "--full-scale", type=int, metavar="N", help="what the converter counts at the supply (default: 1023)"
    )


def add_unloaded_argument(parser: argparse.ArgumentParser) -> None:
    """Add the option that says where a recording without a mark has its preload."""
    parser.add_argument(
        "--unloaded",
        type=float,
        default=0.0,
        metavar="S",
        help="take the preload from the first seconds of a trial, where a CSV marks none",
    )


def unloaded_of(args: argparse.Namespace) -> float:
    """Return the seconds of that option.

    Raises:
        InputError: they are out of range.
    """
    from liftopt.multibody.bounds import checked_number

    return checked_number("--unloaded", args.unloaded, 0.0, 3600.0, "s")


def divider_of(args: argparse.Namespace, known: Divider | None = None) -> Divider:
    """Return the dividers of the command line; what is not given there is as in ``known``, or usual.

    Raises:
        InputError: a value is out of range.
    """
    from liftopt.lab.forces.voltage_divider import Divider

    names = ("supply", "resistor", "full_scale")
    given = {name: getattr(args, name) for name in names if getattr(args, name) is not None}
    return Divider.checked((known or Divider()).plain() | given, "divider.")


def calibration_of(args: argparse.Namespace) -> Calibration | None:
    """Return the calibration of the command line for its dividers, None if there is none.

    Raises:
        InputError: the file is wrong, or a value out of range.
    """
    from liftopt.lab.forces.calibration import load_calibration

    if args.calibration is None:
        return None
    calibration = load_calibration(Path(args.calibration))
    return calibration.wired(divider_of(args, calibration.divider))


def _record(args: argparse.Namespace) -> int:
    record(args, progress=lambda line: write(line + "\n"))
    return DONE


def record(args: argparse.Namespace, progress: Progress) -> None:
    """Record until Ctrl-C.

    Args:
        args: the command line.
        progress: where to tell the user about the page, and at the end what was recorded.

    Raises:
        InputError: an option or the calibration is wrong, the port cannot be opened, the file exists or cannot be
            written.
    """
    import numpy as np

    from liftopt.lab.forces.force_record import sensor_forces
    from liftopt.lab.forces.record_log import RecordLog
    from liftopt.lab.forces.record_session import RecordSession
    from liftopt.lab.forces.serial_device import SerialDevice

    channels = _channels(args.channels)
    if not 0 < args.baud <= FASTEST:
        raise InputError("--baud", args.baud, f"must be from 1 to {FASTEST}")
    calibration = calibration_of(args)
    divider = divider_of(args) if calibration is None else calibration.divider
    if calibration is not None:
        # Every channel has a curve, and what evaluates it is loaded before a reading waits for it.
        sensor_forces(channels, np.zeros((1, len(channels))), calibration)
    if Path(args.out).exists():  # said before the port is opened, which restarts an Arduino
        from liftopt.files.new_file import EXISTS

        raise InputError("--out", args.out, EXISTS)
    largest = {"V": divider.supply, "mV": 1e3 * divider.supply, "counts": float(divider.full_scale)}[args.unit]
    device = SerialDevice(args.port, len(channels), largest, args.baud)
    try:
        what = f"{args.port} at {args.baud} baud; divider: {divider.supply:g} V, {divider.resistor:g} ohm"
        log = RecordLog(Path(args.out), channels, args.unit, what, datetime.now().astimezone())
    except InputError:
        device.close()
        raise
    session = RecordSession(device, log, channels, args.unit, calibration)
    try:
        _serve(session, args.browser, progress)
    finally:
        log.close()
    progress(session.summary())


def _serve(session: RecordSession, browser: bool, progress: Progress) -> None:
    from liftopt.lab.forces.record_server import RecordServer
    from liftopt.viz.viewer_server import opened

    stop, failed = threading.Event(), []
    with RecordServer(session) as server:

        def take() -> None:
            try:
                session.run(stop)
            except BaseException as error:
                failed.append(error)
                server.shutdown()

        reader = threading.Thread(target=take, name="serial port")
        reader.start()
        try:
            with suppress(KeyboardInterrupt):
                progress(f"Recording at {server.url} (Ctrl-C ends it)")
                progress("Every line is kept. The page's buttons mark preload and trials.")
                if browser and not opened(server.url):
                    progress("No browser could be opened here: open this address in one.")
                server.serve_forever(poll_interval=0.2)
        finally:
            session.stop()
            stop.set()
            reader.join()
    if failed:
        raise failed[0]


def _channels(text: str) -> tuple[str, ...]:
    from liftopt.lab.forces.force_record import side

    names = tuple(name.strip() for name in text.split(","))
    for name in names:
        if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
            raise InputError("--channels", name, "a name is a letter, then letters, digits and _; commas between names")
        try:
            side(name)
        except InputError as error:
            raise InputError("--channels", name, error.allowed) from None
    if len({name.lower() for name in names}) < len(names):
        raise InputError("--channels", text, "two channels have the same name")
    return names
