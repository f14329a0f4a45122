"""Is a predicted lift one that people make? Goals, comparison with recorded lifts, and what each weight does.

``python scripts/check_natural.py goals`` solves 40 varied lifts with the preset natural and holds each against the
goals in ``docs/concepts/natural.md``; ``recorded`` compares ten lifts with the angles of recorded ones by wrist height;
``weights`` takes every weight a third and three times as large; ``cost`` sets a cold solve from one given start beside
the paper's preset. All print tables in Markdown.
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

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.ergonomics.motion import motion_of
from liftopt.errors import LiftoptError
from liftopt.lab.comparison.by_height import read_height_curves, rmse_by_height
from liftopt.multibody.trajectory import limit_share
from liftopt.scenario.build import agents_of, motions_of, object_of, task_of
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.initial_guess import posture_starts
from liftopt.search.solve import solve
from liftopt.solution.grasp_loads import squeeze
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution

RECORDED = Path(__file__).parents[2] / "shared" / "data" / "recorded_lifts" / "ammr_by_height.csv"
LIFTS, SEED = 40, 16
BODY_MASS_INDEX = 23.5  # kg/m^2, so that a tall person is no thin one
Lifts = dict[str, tuple[str, ...]]  # name -> shipped scenario and what differs
TEN: Lifts = {
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
SHOWN = {  # quantity of the recordings -> heading, largest mean of the root mean square differences [deg]
    "elbow_flex_3d": ("elbow", 13.0),
    "wrist_flex": ("wrist", 10.0),
    "wrist_dev": ("wrist deviation", np.inf),
    "twist": ("twist", 10.0),
    "shoulder_elev_3d": ("humeral elevation", 12.0),
    "shoulder_abd": ("abduction", np.inf),
}
WEIGHTS = (
    "human.weight", "robot.weight", "objective.acceleration_weight", "objective.force_weight",
    "objective.range_weight", "objective.tilt_weight",
)  # fmt: skip


@dataclass(frozen=True)
class Measure:
    """One number of a lift.

    Attributes:
        value: the number.
        most: the largest that a natural lift has.
        text: the number as a table shows it.
    """

    value: float
    most: float
    text: str


def measures(lift: Solution) -> dict[str, Measure]:
    """Return the measures of a lift, given on the finer grid, in the order of the tables' columns."""
    person = lift.persons[0]
    motion, tilt = motion_of(lift, person), np.cos(lift.object.pose[:, 3]) * np.cos(lift.object.pose[:, 4])
    numbers = {
        "wrist [deg]": (motion.wrist_bend.max(), 40.0, "g"),
        "twist [deg]": (np.abs(motion.twist).max(), 25.0, "g"),
        "path": (motion.path_over_chord, 1.2, ".2f"),
        "peaks": (motion.speed_peaks, 1.0, "g"),
        "squeeze [N]": (np.abs(squeeze(lift.agents)).max(), 10.0 + 0.25 * 9.81 * lift.scenario.object.mass, "g"),
        "tilt [deg]": (np.degrees(np.arccos(np.clip(tilt, -1.0, 1.0))).max(), 5.0, ".1f"),
        "arm aside [deg]": (motion.abduction.max(), 70.0, "g"),
        "elbow [deg]": (motion.elbow.mean(), np.inf, "g"),
        "person's share": (np.abs(limit_share(person)).max(), np.inf, ".2f"),
        "robot's share": (np.abs(limit_share(lift.robots[0])).max(), np.inf, ".2f"),
    }
    return {
        name: Measure(float(value), most, f"{round(float(value)) if form == 'g' else float(value):{form}}")
        for name, (value, most, form) in numbers.items()
    }


def varied() -> Lifts:
    """Return 40 lifts of a Sobol sample; where both stand fits the person, and half fix where the object is."""
    unit = qmc.Sobol(6, rng=np.random.default_rng(SEED)).random(64)[:LIFTS]
    found = {}
    for i, (mass, low, rise, tall, slow, at) in enumerate(unit):
        sex, stature, duration = ("male", "female")[i % 2], 1.5 + 0.45 * tall, 1.0 + 3.0 * slow
        start = 0.7 + 0.5 * low
        end = start + 0.2 + rise * (1.4 - start)  # at least 0.2 m up, at most to 1.6 m
        ahead = stature * (0.22 + 0.04 * at)  # 0.40 m at 1.75 m lies inside
        overrides = [
            f"object.mass={2.0 + 8.0 * mass:.2f}", f"task.start.height={start:.3f}", f"task.end.height={end:.3f}",
            f"human.sex={sex}", f"human.stature={stature:.3f}", f"human.mass={BODY_MASS_INDEX * stature**2:.1f}",
            f"duration={duration:.2f}", f"task.standing_distance={ahead + 1.3:.3f}",
        ]  # fmt: skip
        fixed = ("start", "end") if i % 4 < 2 else ()
        overrides += [f"task.{place}.human_distance={ahead:.3f}" for place in fixed]
        who = f"{'woman' if sex == 'female' else 'man'} of {stature:.2f} m"
        name = f"{2.0 + 8.0 * mass:.1f} kg, {start:.2f} to {end:.2f} m, {who}, {duration:.1f} s"
        found[name] = ("table5_free", *overrides)
    return found


def solved(arguments: tuple[str, ...], overrides: list[str], cache: SolverCache) -> Solution | None:
    """Return a lift on the finer grid, None where there is none."""
    shipped, *own = arguments
    try:
        solution = solve(load_scenario(shipped, ["objective.preset=natural", *own, *overrides]), cache=cache)
    except LiftoptError as error:
        print(f"{arguments}: {error}", file=sys.stderr)
        return None
    return between_knots(solution) if solution.solved else None


def row(*cells: object) -> str:
    """Return one line of a table."""
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def goals(overrides: list[str], cache: SolverCache, lifts: Lifts) -> Iterator[str]:
    """Yield what each lift reaches of the goals, what misses one in bold."""
    missed: dict[str, int] = {}
    natural, head = 0, False
    for name, arguments in lifts.items():
        lift = solved(arguments, overrides, cache)
        if lift is None:
            yield row(name, "not solved")
            continue
        found = {key: each for key, each in measures(lift).items() if np.isfinite(each.most)}
        if not head:
            yield row("lift", *found)
            yield row(*["---"] * (len(found) + 1))
            head = True
        beyond = [key for key, each in found.items() if each.value > each.most]
        missed |= {key: missed.get(key, 0) + 1 for key in beyond}
        natural += not beyond
        yield row(name, *(f"**{each.text}**" if key in beyond else each.text for key, each in found.items()))
    yield f"\n{natural} of {len(lifts)} reach all goals. Missed: {missed or 'none'}."


def recorded(overrides: list[str], cache: SolverCache, file: Path) -> Iterator[str]:
    """Yield how far each of ten lifts is from the recorded angles, and the means."""
    curves, rows = read_height_curves(file), []
    yield row("lift", *(heading for heading, _ in SHOWN.values()))
    yield row(*["---"] * (len(SHOWN) + 1))
    for name, arguments in TEN.items():
        lift = solved(arguments, overrides, cache)
        if lift is None:
            yield row(name, "not solved")
            continue
        off = rmse_by_height(motion_of(lift, lift.persons[0]), curves)
        rows.append([off[quantity] for quantity in SHOWN])
        yield row(name, *(f"{value:.0f}" for value in rows[-1]))
    yield row("mean", *(f"**{value:.1f}**" for value in np.mean(rows, axis=0)))
    yield row("goal", *(f"{most:g}" if np.isfinite(most) else "" for _, most in SHOWN.values()))


def weights(overrides: list[str], cache: SolverCache) -> Iterator[str]:
    """Yield the means over five lifts with every weight as it is, and a third and three times as large."""
    plain = load_scenario("table5", ["objective.preset=natural"])
    cases = [("as it is", "")] + [
        (f"{key} {words}", f"{key}={plain.value(key) * factor!r}")
        for key in WEIGHTS
        for words, factor in (("/ 3", 1 / 3), ("x 3", 3.0))
    ]
    for i, (name, change) in enumerate(cases):
        lifts = [solved(each, [*overrides, *([change] if change else [])], cache) for each in FIVE.values()]
        found = [measures(lift) for lift in lifts if lift is not None]
        if not i:
            yield row("weight", *found[0], "solved")
            yield row(*["---"] * (len(found[0]) + 2))
        means = {key: float(np.mean([each[key].value for each in found])) for key in found[0]}
        shown = (f"{v:.2f}" if k in ("path",) or "share" in k else f"{v:.1f}" for k, v in means.items())
        yield row(name, *shown, f"{len(found)} of {len(lifts)}")


def cost(overrides: list[str], cache: SolverCache, repeat: int = 5) -> Iterator[str]:
    """Yield iterations and the fastest time of a cold solve from the best blend of postures, by preset."""
    yield row("lift", "natural: iterations", "[ms]", "paper: iterations", "[ms]", "ratio of the times")
    yield row(*["---"] * 6)
    ratios = []
    for name, (shipped, *own) in TEN.items():
        found = [
            cold(load_scenario(shipped, [f"objective.preset={preset}", *own, *overrides]), cache, repeat)
            for preset in ("natural", "paper")
        ]
        ratios.append(found[0][1] / found[1][1])
        yield row(name, *(text for n, ms in found for text in (n, f"{ms:.0f}")), f"{ratios[-1]:.2f}")
    yield row("geometric mean", "", "", "", "", f"**{np.exp(np.log(ratios).mean()):.2f}**")


def cold(scenario: Scenario, cache: SolverCache, repeat: int) -> tuple[int, float]:
    """Return iterations and the fastest time [ms] of solves from the most promising pair of postures."""
    mesh = motions_of(scenario).mesh()
    problem = Problem(Team.of(agents_of(scenario), object_of(scenario), print), task_of(scenario), mesh)
    start, solver = posture_starts(problem, 1, 0, NEVER)[0], cache.solver(problem, scenario, "banded")
    results = [solver.solve(start.x, deadline=NEVER) for _ in range(repeat)]
    return results[0].iterations, 1e3 * min(result.seconds for result in results)


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("goals", "recorded", "weights", "cost"))
    parser.add_argument("--curves", type=Path, default=RECORDED, help="angles of recorded lifts by wrist height")
    parser.add_argument("--set", action="append", default=[], dest="overrides", metavar="KEY=VALUE")
    args = parser.parse_args()
    cache, began = SolverCache(), time.monotonic()
    tables: dict[str, Callable[[], Iterator[str]]] = {
        "goals": lambda: goals(args.overrides, cache, varied()),
        "recorded": lambda: recorded(args.overrides, cache, args.curves),
        "weights": lambda: weights(args.overrides, cache),
        "cost": lambda: cost(args.overrides, cache),
    }
    for line in tables[args.what]():
        print(line, flush=True)
    print(f"{time.monotonic() - began:.0f} s", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
