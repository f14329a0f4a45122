"""``liftopt mocap``: a recording of markers becomes a recorded lift, and its summary."""

from __future__ import annotations

import argparse
import json
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftopt.commands.terminal import captured, printing
from liftopt.errors import NO_VALUE, InputError

if TYPE_CHECKING:
    from rich.console import Console

    from liftopt.lab.mocap.hand_force import HandForce
    from liftopt.lab.mocap.recorded_lift import RecordedLift

SHARE = 0.5  # of the load on the right hand, unless the user says another


def add_mocap_parser(commands: Any) -> None:
    """Add the command to the subparsers ``commands``."""
    parser = commands.add_parser(
        "mocap",
        help="joint angles and torques of a recorded lift, from its markers",
        description="Read the markers of a C3D or TRC file, scale the person, follow the markers with the "
        "model of trunk and right arm or of the whole person, as the mapping says, and write recorded.nc. The file "
        "read is never changed.",
        allow_abbrev=False,
    )
    parser.add_argument("recording", metavar="FILE", help="a C3D or TRC file")
    parser.add_argument(
        "--map",
        required=True,
        dest="mapping",
        metavar="MAP",
        help="a mapping in TOML, or a shipped one: box_lift (trunk and right arm); of the whole body plug_in_gait, "
        "biomech_57, or pose2sim (video)",
    )
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for recorded.nc")
    parser.add_argument("--up", metavar="AXIS", help="axis of FILE that points up (default: as the mapping has it)")
    parser.add_argument(
        "--object-markers", metavar="A,B,C", help="markers of what is lifted (default: as the mapping has it)"
    )
    parser.add_argument("--mass", type=float, metavar="KG", help="body mass of the person")
    parser.add_argument("--sex", choices=("male", "female"), help="whose segment data to use")
    parser.add_argument(
        "--stature", type=float, metavar="M", help="height of the person (default: estimated from segments)"
    )
    parser.add_argument(
        "--cutoff", type=float, metavar="HZ", default=6.0, help="of the low-pass filter (default: %(default)s)"
    )
    parser.add_argument(
        "--hand-force",
        metavar="FILE",
        help="of the right hand on the object: time, fx, fy, fz [s, N] in FILE's axes (CSV, MOT, STO), or of liftopt "
        "forces; a CSV may name units: time [ms], fx [kN]",
    )
    parser.add_argument("--hand-force-left", metavar="FILE", help="the same of the left hand of a whole person")
    parser.add_argument(
        "--hand-force-start",
        type=float,
        metavar="S",
        help="when these series start on FILE's clock (default: as they say)",
    )
    parser.add_argument(
        "--object-mass",
        type=float,
        metavar="KG",
        default=0.0,
        help="estimate the hands' forces from the object's motion",
    )
    parser.add_argument("--hand-share", type=float, metavar="0-1", help=f"of the right hand in that (default: {SHARE})")
    parser.add_argument(
        "--hand-share-left",
        type=float,
        metavar="0-1",
        help="of the left hand of a whole person (default: what the right one leaves)",
    )
    parser.add_argument(
        "--ignore",
        action="append",
        default=[],
        metavar="MARKER[:FROM-TO]",
        help="leave a marker out, all the time or from FROM to TO [s]; may be given several times",
    )
    parser.add_argument(
        "--from", dest="start", default="", metavar="S", help="use the trial from this time or C3D event on"
    )
    parser.add_argument("--to", dest="end", default="", metavar="S", help="and up to this one")
    parser.add_argument(
        "--lift", type=int, metavar="N", help="which lift of the trial counts, from 1, where there are several"
    )
    parser.add_argument("--json", action="store_true", help="print the summary as one JSON object")
    parser.set_defaults(run=printing(mocap))


def mocap(args: argparse.Namespace) -> str:
    """Do what the command line says and return what it prints.

    Raises:
        InputError: a file, the mapping or an option is wrong.
    """
    from liftopt.lab.mocap.from_markers import read_recording, recorded_lift
    from liftopt.lab.mocap.loads import Load
    from liftopt.lab.mocap.map_file import load_marker_map
    from liftopt.lab.mocap.marker_map import Person
    from liftopt.lab.mocap.recorded_file import save_recorded
    from liftopt.lab.mocap.trial_part import TrialPart, ignored_markers
    from liftopt.multibody.bounds import checked_number

    mapping = load_marker_map(args.mapping)
    given = {name: getattr(args, name) for name in ("mass", "sex", "stature") if getattr(args, name) is not None}
    share, left = args.hand_share, args.hand_share_left
    person = Person.checked(mapping.subject.plain() | given, "subject.")
    changes: dict[str, Any] = {"subject": person} | ({"up": args.up} if args.up else {})
    if args.object_markers:
        labels = [label.strip() for label in args.object_markers.split(",")]
        changes["segments"] = mapping.segments.changed(object=labels)
    mapping = mapping.changed(**changes)
    load = Load(
        measured=_measured(args, args.hand_force, mapping.up),
        mass=checked_number("--object-mass", args.object_mass, 0.0, 100.0, "kg"),
        share=checked_number("--hand-share", SHARE if share is None else share, 0.0, 1.0, "of the load"),
        left_measured=_measured(args, args.hand_force_left, mapping.up),
        left_share=None if left is None else checked_number("--hand-share-left", left, 0.0, 1.0, "of the load"),
    )
    if mapping.body == "arm" and (args.hand_force_left or left is not None):
        option = "--hand-force-left" if args.hand_force_left else "--hand-share-left"
        raise InputError(option, NO_VALUE, f"{args.mapping} maps trunk and right arm only")
    _check_together(args)
    part = TrialPart(args.start, args.end, ignored_markers(args.ignore))
    recording = read_recording(Path(args.recording))
    lift = recorded_lift(recording, mapping, load, args.cutoff, part)
    if args.lift is not None:
        lift = lift.of_lift(args.lift)
    save_recorded(lift, Path(args.out))
    return (
        json.dumps(summary_dict(lift, Path(args.out)), allow_nan=False) + "\n"
        if args.json
        else captured(lambda console: _print(lift, args.out, console))
    )


def _check_together(args: argparse.Namespace) -> None:
    """Raise ``InputError`` where an option says more of something that is not there."""
    if args.hand_force_start is not None and not (args.hand_force or args.hand_force_left):
        raise InputError("--hand-force-start", args.hand_force_start, "is when --hand-force FILE starts; give it too")
    for option, share in (("--hand-share", args.hand_share), ("--hand-share-left", args.hand_share_left)):
        if share is not None and not args.object_mass:
            raise InputError(option, share, "is a hand's share of --object-mass KG; give it too")


def _measured(args: argparse.Namespace, file: str | None, up: str) -> HandForce | None:
    from liftopt.lab.mocap.hand_force import read_hand_force
    from liftopt.multibody.bounds import checked_number

    if not file:
        return None
    series = read_hand_force(Path(file), up)
    if args.hand_force_start is None:
        return series
    start = checked_number("--hand-force-start", args.hand_force_start, -1e6, 1e6, "s")
    return replace(series, time=series.time - series.time[0] + start)


def summary_dict(lift: RecordedLift, out: Path) -> dict[str, Any]:
    """Return what the command prints with ``--json``: residuals in m, angles in rad."""
    from liftopt.lab.mocap.recorded_file import about

    known = [float(value) for value in lift.residual_rms]
    return about(lift) | {
        "out": str(out),
        "frames": len(lift.time),
        "seconds": float(lift.time[-1] - lift.time[0]),
        "residual_rms": {
            name: value if value == value else None for name, value in zip(lift.markers, known, strict=True)
        },
        "angles": {
            name: [float(lift.q[:, i].min()), float(lift.q[:, i].max())] for i, name in enumerate(lift.joint_names)
        },
        "peak_torque": {name: float(abs(lift.tau[:, i]).max()) for i, name in enumerate(lift.joint_names)},
    }


def _print(lift: RecordedLift, out: str, console: Console) -> None:
    import numpy as np
    from rich.markup import escape
    from rich.table import Table

    def progress(text: str) -> None:
        console.print(escape(text), highlight=False, soft_wrap=True)

    progress(f"{lift.source}: {len(lift.time)} frames at {lift.rate:g} Hz, low-pass at {lift.cutoff:g} Hz")
    person, lengths = lift.subject, lift.lengths
    how = "estimated" if lift.stature_estimated else "given"
    progress(f"Person: {person.stature:.3f} m ({how}), {person.mass:g} kg, {person.sex}")
    progress(
        "  "
        + ", ".join(f"L{i} {value:.3f}" for i, value in enumerate(vars(lengths).values(), start=1))
        + (" m" if lift.whole else " m (L1 by stature)")
    )
    if lift.whole:
        whole = lift.whole
        progress(
            f"  ankle {whole.ankle:.3f} (by stature), knee {whole.knee:.3f}, hip {whole.hip:.3f} m above the floor"
        )
    progress(f"Force of the {'hands' if lift.whole else 'hand'}: {lift.force_from}")
    if len(lift.lifts) > 1:
        progress(f"Lifts: {lift.lift_times()}" + ("" if lift.carried else "; choose one by --lift"))
    if lift.carried:
        progress(f"Object: away from its place from {lift.carried[0]:.2f} to {lift.carried[1]:.2f} s")
    for gap_kind, count in Counter(gap.filled for gap in lift.gaps).items():
        markers = sorted({gap.marker for gap in lift.gaps if gap.filled == gap_kind})
        what = "left open" if gap_kind == "open" else f"filled by {gap_kind}"
        progress(f"Gaps {what}: {count} ({', '.join(markers)})")
    table = Table("joint", "lowest", "highest", "peak torque", box=None, header_style="bold", pad_edge=False)
    for i, name in enumerate(lift.joint_names):
        scale, unit, effort = (1.0, "m", "N") if "GT" in name else (180.0 / np.pi, "deg", "Nm")
        low, high = scale * lift.q[:, i].min(), scale * lift.q[:, i].max()
        digits = 3 if unit == "m" else 1
        table.add_row(
            name, f"{low:.{digits}f} {unit}", f"{high:.{digits}f} {unit}", f"{abs(lift.tau[:, i]).max():.1f} {effort}"
        )
    console.print(table)
    table = Table("marker", "rms mm", "max mm", box=None, header_style="bold", pad_edge=False)
    for i, name in enumerate(lift.markers):
        table.add_row(
            escape(name), f"{1000 * lift.residual_rms[i]:.1f}", f"{1000 * np.nanmax(lift.residual[:, i]):.1f}"
        )
    console.print(table)
    progress(f"All markers: {1000 * float(np.sqrt(np.nanmean(lift.residual**2))):.1f} mm (rms)")
    for note in lift.notes:
        progress(f"Note: {note}")
    progress(f"Written to {out}")
