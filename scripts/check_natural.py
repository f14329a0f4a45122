"""Is a predicted lift one that people make? Measures, comparison to recorded lifts, and what each weight does.

``python scripts/check_natural.py goals`` solves 40 varied lifts and holds each against the goals of ``docs/natural.md``;
``recorded`` compares ten lifts with curves of recorded ones by wrist height, ``weights`` takes every weight a third
and three times as large, ``cost`` times a cold solve beside the paper's preset. All print tables in Markdown.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from liftopt.ergonomics.motion import motion_of
from liftopt.errors import LiftoptError
from liftopt.lab.comparison.by_height import HeightCurves, read_height_curves, rmse_by_height
from liftopt.multibody.trajectory import limit_share
from liftopt.scenario.model import load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.solve import solve
from liftopt.solution.grasp_loads import squeeze
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution

RECORDED = Path(__file__).parents[2] / "shared" / "data" / "recorded_lifts" / "ammr_by_height.csv"
NATURAL = "objective.preset=natural"
ENOUGH, LIFTS, SEED = 36, 40, 16
BODY_MASS_INDEX = 23.5  # kg/m^2, so that a tall person is no thin one
# What is said in one word, in words as the columns have them.
TEN = {
    "table5": ("table5",),
    "table5_near": ("table5_near",),
    "table5_free": ("table5_free",),
    "10 kg": ("table5", "object.mass=10"),
    "from 0.7 m": ("table5", "task.start.height=0.7"),
    "to 1.6 m": ("table5", "task.end.height=1.6"),
    "woman of 1.6 m": ("table5", "human.sex=female", "human.stature=1.6", "human.mass=60"),
    "man of 1.9 m": ("table5", "human.stature=1.9", "human.mass=85"),
    "1 s": ("table5", "duration=1"),
    "4 s": ("table5", "duration=4"),
}
FIVE = {name: TEN[name] for name in ("table5", "table5_near", "table5_free", "10 kg", "1 s")}
SHOWN = {  # quantity of the recordings -> heading, largest mean of the RMSE [deg]
    "elbow_flex_3d": ("elbow", 13.0),
    "wrist_flex": ("wrist", 10.0),
    "wrist_dev": ("wrist deviation", np.inf),
    "twist": ("twist", 10.0),
    "shoulder_elev_3d": ("humeral elevation", 12.0),
    "shoulder_abd": ("abduction", np.inf),
}


@dataclass(frozen=True)
class Goal:
    """A measure of a lift with the largest value that a natural one has."""

    name: str
    unit: str
    value: Callable[[Solution], float]
    most: Callable[[Solution], float]


def goals() -> tuple[Goal, ...]:
    """Return the goals of a natural lift, all for lifts on the finer grid."""

    def wrist(lift: Solution) -> float:
        return float(motion_of(lift, lift.persons[0]).wrist_bend.max())

    def twist(lift: Solution) -> float:
        return float(np.abs(motion_of(lift, lift.persons[0]).twist).max())

    def aside(lift: Solution) -> float:
        return float(motion_of(lift, lift.persons[0]).abduction.max())

    return (
        Goal("wrist", "deg", wrist, lambda lift: 40.0),
        Goal("twist", "deg", twist, lambda lift: 25.0),
        Goal("path", "", lambda lift: motion_of(lift, lift.persons[0]).path_over_chord, lambda lift: 1.2),
        Goal("peaks", "", lambda lift: motion_of(lift, lift.persons[0]).speed_peaks, lambda lift: 1.0),
        Goal("squeeze", "N", lambda lift: float(np.abs(squeeze(lift.agents)).max()), most_squeeze),
        Goal("tilt", "deg", tilt, lambda lift: 5.0),
        Goal("arm aside", "deg", aside, lambda lift: 70.0),
    )


def most_squeeze(lift: Solution) -> float:
    """Return the largest internal force [N] that a natural lift has: 10 N and a quarter of the object's weight."""
    return 10.0 + 0.25 * 9.81 * lift.scenario.object.mass


def tilt(lift: Solution) -> float:
    """Return the largest angle [deg] of the object's upward axis from the vertical."""
    roll, pitch = lift.object.pose[:, 3], lift.object.pose[:, 4]
    return float(np.degrees(np.arccos(np.cos(roll) * np.cos(pitch))).max())


def varied() -> list[tuple[str, tuple[str, ...]]]:
    """Return the 40 lifts: a name and the arguments of ``load_scenario``; the standing distance fits the person."""
    unit = qmc.Sobol(6, rng=np.random.default_rng(SEED)).random(64)[:LIFTS]
    found = []
    for i, (mass, low, high, stature, duration, at) in enumerate(unit):
        start = 0.7 + 0.5 * low
        end = start + 0.2 + high * (1.4 - start)  # at least 0.2 m up, at most to 1.6 m
        tall = 1.5 + 0.45 * stature
        distance = tall * (0.22 + 0.04 * at)  # 0.40 m at 1.75 m lies inside
        overrides = [
            f"object.mass={2.0 + 8.0 * mass:.2f}",
            f"task.start.height={start:.3f}",
            f"task.end.height={end:.3f}",
            f"human.sex={'female' if i % 2 else 'male'}",
            f"human.stature={tall:.3f}",
            f"human.mass={BODY_MASS_INDEX * tall**2:.1f}",
            f"duration={1.0 + 3.0 * duration:.2f}",
            f"task.standing_distance={distance + 1.3:.3f}",
        ]
        for end_of_lift in ("start", "end") if i % 4 < 2 else ():
            overrides.append(f"task.{end_of_lift}.human_distance={distance:.3f}")
        words = f"{2 + 8 * mass:.1f} kg, {start:.2f} to {end:.2f} m, {'woman' if i % 2 else 'man'} {tall:.2f} m, "
        found.append((words + f"{1 + 3 * duration:.1f} s", ("table5_free", *overrides)))
    return found


def solved(arguments: tuple[str, ...], overrides: list[str], cache: SolverCache) -> Solution | None:
    """Return a lift on the finer grid, None where there is none."""
    base, *own = arguments
    try:
        solution = solve(load_scenario(base, [*own, "solver.workers=1", *overrides]), cache=cache)
    except LiftoptError as error:
        print(f"{arguments}: {error}", file=sys.stderr)
        return None
    return between_knots(solution) if solution.solved else None


def goals_table(lifts: list[tuple[str, tuple[str, ...]]], overrides: list[str], cache: SolverCache) -> Iterator[str]:
    """Yield what each lift reaches of the goals, the failed ones in bold."""
    measured, missed, natural = goals(), dict.fromkeys((goal.name for goal in goals()), 0), 0
    yield "| lift | " + " | ".join(f"{goal.name} {f'[{goal.unit}]' if goal.unit else ''}".strip() for goal in measured) + " |"
    yield "|---" * (len(measured) + 1) + "|"
    for name, arguments in lifts:
        lift = solved(arguments, overrides, cache)
        if lift is None:
            yield f"| {name} | not solved" + " |" * len(measured)
            continue
        cells, good = [], True
        for goal in measured:
            value, kept = goal.value(lift), goal.value(lift) <= goal.most(lift)
            good, missed[goal.name] = good and kept, missed[goal.name] + (not kept)
            text = f"{value:.2f}" if goal.name == "path" else f"{value:.0f}"
            cells.append(text if kept else f"**{text}**")
        natural += good
        yield f"| {name} | " + " | ".join(cells) + " |"
    yield ""
    yield f"{natural} of {len(lifts)} natural in all measures. Missed: {missed}."


def recorded_table(curves: HeightCurves, overrides: list[str], cache: SolverCache) -> Iterator[str]:
    """Yield how far each of ten lifts is from the recorded curves, and the means."""
    yield "| lift | " + " | ".join(heading for heading, _ in SHOWN.values()) + " |"
    yield "|---" * (len(SHOWN) + 1) + "|"
    rows = []
    for name, arguments in TEN.items():
        lift = solved(arguments, overrides, cache)
        if lift is None:
            yield f"| {name} | not solved" + " |" * len(SHOWN)
            continue
        off = rmse_by_height(motion_of(lift, lift.persons[0]), curves)
        rows.append([off[quantity] for quantity in SHOWN])
        yield f"| {name} | " + " | ".join(f"{value:.0f}" for value in rows[-1]) + " |"
    yield "| mean | " + " | ".join(f"**{value:.1f}**" for value in np.mean(rows, axis=0)) + " |"
    yield "| goal | " + " | ".join(f"{most:g}" if np.isfinite(most) else "" for _, most in SHOWN.values()) + " |"


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("goals", "ten", "recorded", "weights", "cost"))
    parser.add_argument("--set", action="append", default=[], dest="overrides", metavar="KEY=VALUE")
    args = parser.parse_args()
    overrides, cache, began = [NATURAL, *args.overrides], SolverCache(), time.monotonic()
    tables = {
        "goals": lambda: goals_table(varied(), overrides, cache),
        "ten": lambda: goals_table(list(TEN.items()), overrides, cache),
        "recorded": lambda: recorded_table(read_height_curves(RECORDED), overrides, cache),
    }
    for line in tables[args.what]():
        print(line, flush=True)
    print(f"{time.monotonic() - began:.0f} s", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
