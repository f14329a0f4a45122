"""Are lifts of the whole person found, or truly told to be impossible? Sampled scenarios, each solved and explained.

``python scripts/check_whole_person.py --count 200`` draws women and men, boxes of 1 to 20 kg from 0.05 to 1.7 m, lifted
and lowered, with one hand or two, alone and with a Sawyer, and prints what came of each and how long the search took.
A lift passes where it is solved and verified and nothing overlaps by more than 1 mm as coal sees it, or where bodies,
limits or torques are named that are in the way; ``--doubt`` searches such a lift again, four times as wide from other
seeds, and it fails if that finds one. The exit status is 1 where one fails.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from check_clearance import DEEPEST, deepest, solve
from check_natural import BODY_MASS_INDEX, row
from scipy.stats import qmc

from liftopt.commands.terminal import progress_line
from liftopt.errors import LiftoptError
from liftopt.scenario.model import Scenario, scenario_from_dict
from liftopt.search.candidate import Candidate

# Of the unit cube that is sampled: stature, mass of the box, its edges, duration, both heights, how far ahead.
SIZES = ("stature", "mass", "depth", "width", "height", "duration", "low", "high", "ahead")
LOWEST, HIGHEST = 0.05, 1.7  # of a box's underside, and of hands [m]
UNDER = 0.1  # room for hands under a box, which hold it there [m]
HEAD = 0.95  # hands go no higher than this share of the stature
KNEE = 0.6  # below this height a box stands farther ahead: legs bend ahead and do not spread [m]
DOUBT = 4  # times as many tries
CLEARANCE = {"on": 0.0, "off": "off"}


@dataclass(frozen=True)
class Row:
    """What came of one scenario.

    Attributes:
        what: the scenario in a few words.
        solved: whether it is solved and verified.
        depth: the deepest overlap that coal sees [m]; 0 where nothing is looked at.
        objective: of the lift.
        seconds: processor time of the search [s].
        reason: what is in the way; empty where nothing is known.
        doubted: whether a wider search found a lift after all.
    """

    what: str
    solved: bool
    depth: float
    objective: float
    seconds: float
    reason: str
    doubted: bool = False

    @property
    def passed(self) -> bool:
        """Whether it is solved and clear, or explained and nothing says otherwise."""
        return self.depth >= -DEEPEST if self.solved else bool(self.reason) and not self.doubted


def scenarios(count: int, seed: int) -> Iterator[tuple[str, Scenario]]:
    """Yield scenarios, each with a few words on it; the kinds take turns, the numbers are a Latin hypercube's."""
    unit = qmc.LatinHypercube(len(SIZES), seed=np.random.default_rng(seed)).random(count)
    for n, point in enumerate(unit):
        yield _scenario(n, dict(zip(SIZES, point.tolist(), strict=True)))


def _scenario(n: int, at: dict[str, float]) -> tuple[str, Scenario]:
    woman, robot, lowered, free = n % 2 == 0, n // 2 % 2 == 0, n // 4 % 3 == 2, n // 3 % 2 == 0
    hands = (("right", "left"), ("right", "left"), ("right",), ("right", "left"), ("left",))[n % 5]
    stature = _between(1.5, 1.8, at["stature"]) if woman else _between(1.6, 1.95, at["stature"])
    box: dict[str, Any] = {
        "name": "box",
        "mass": _between(1.0, 20.0 if len(hands) == 2 else 10.0, at["mass"]),
        "depth": _between(0.2, 0.4, at["depth"]),
        "width": _between(0.25, 0.6, at["width"]),
        "height": _between(0.12, 0.4, at["height"]),
    }
    hold = ("edge", "side", "handle", "bottom")[n // 5 % 4] if len(hands) == 2 else "edge"
    if len(hands) == 1 and not robot:  # as one carries a case
        hold, narrow = "handle on top", {"depth": box["width"], "width": round(box["depth"] / 2.0, 3)}
        grasp = {"place": "handle", "position": [0.0, 0.0, box["height"] / 2.0]}
        box |= narrow | {"grasps": {"human": grasp}}
    elif hold != "edge":
        box["grasps"] = {f"human_{hand}": hold for hand in hands}
    up, ahead = _in_hand(hold, box)
    heights = _heights(hold, box, stature, at)
    start, end = sorted(heights, reverse=lowered)
    # The robot holds the bottom edge; heights are midway between both.
    start, end = (round(low + (up / 2.0 if robot else up), 3) for low in (start, end))
    face = stature * _between(0.2, 0.25, at["ahead"]) + 0.15 * (min(heights) < KNEE)
    distance: Any = "free" if free else round(face + ahead, 3)
    agents: dict[str, Any] = {
        "human": {
            "kind": "person", "body": "whole", "hands": list(hands), "sex": "female" if woman else "male",
            "stature": stature, "mass": round(BODY_MASS_INDEX * stature**2, 1),
        }
    }  # fmt: skip
    if robot:
        middle = (start + end) / 2.0
        agents["robot"] = {
            "kind": "robot",
            "model": "sawyer",
            "base_height": round(min(max(middle - 0.3, 0.2), 0.9), 2),
        }
    tables = {
        "schema": 2, "name": f"sample_{n}", "duration": _between(1.5, 4.0, at["duration"]), "agents": agents,
        "object": box,
        "task": {
            "standing_distance": round(face + box["depth"] + 0.9, 2),
            "start": {"height": start, "human_distance": distance},
            "end": {"height": end, "human_distance": distance},
        },
    }  # fmt: skip
    who = f"{'woman' if woman else 'man'} of {stature:.2f} m{' and Sawyer' if robot else ''}"
    size = "x".join(f"{100 * box[edge]:.0f}" for edge in ("depth", "width", "height"))
    holds = f"{' and '.join(hands)} at the {hold}"
    place = "free" if free else f"{distance:.2f} m ahead"
    what = f"{who}, {box['mass']:.1f} kg, {size} cm, {holds}, {start:.2f} to {end:.2f} m, {place}"
    return what, scenario_from_dict(tables)


def _heights(hold: str, box: dict[str, Any], stature: float, at: dict[str, float]) -> tuple[float, float]:
    """Return how high the underside of the box is at its lower and at its higher place [m]."""
    least = UNDER if hold in ("edge", "bottom") else LOWEST
    most = min(HIGHEST, HEAD * stature) - _in_hand(hold, box)[0]
    low = _between(least, min(1.2, most - 0.2), at["low"] ** 2)  # more of them low
    return low, _between(low + 0.2, most, at["high"])


def _in_hand(hold: str, box: dict[str, Any]) -> tuple[float, float]:
    """Return how high above the underside and how far behind the near face the hands hold [m]."""
    height, depth = box["height"], box["depth"]
    up = {"side": height / 2.0, "handle": height - min(0.05, height / 4.0), "handle on top": height}.get(hold, 0.0)
    behind = {"edge": 0.0, "bottom": min(0.1, depth / 4.0)}.get(hold, depth / 2.0)
    return up, behind


def _between(low: float, high: float, share: float) -> float:
    return round(low + (high - low) * share, 3)


def examine(what: str, scenario: Scenario, doubt: bool) -> Row:
    """Solve a scenario and hold what comes of it against the goals."""
    try:
        best, reasons, seconds = solve(scenario)
    except LiftoptError as error:
        return Row(what, False, 0.0, np.nan, 0.0, f"refused: {error}")
    depth = _depth(best) if best.solved else 0.0
    found = False
    if doubt and not best.solved:
        options = scenario.solver
        wider = {"solver.tries": min(DOUBT * options.tries, 512), "solver.seed": options.seed + 1}
        found = solve(scenario.replace(wider))[0].solved
    reason = "; ".join(reason.message for reason in reasons)
    return Row(what, best.solved, depth, best.result.objective, seconds, reason, found)


def _depth(best: Candidate) -> float:
    return 0.0 if best.scenario.limits.clearance is None else min(deepest(best)[0], 0.0)


def summary(rows: list[Row]) -> str:
    """Return what came of all, in a few lines."""
    seconds, solved = np.array([each.seconds for each in rows]), [each for each in rows if each.solved]
    causes = Counter(_cause(each.reason) for each in rows if not each.solved)
    told = ", ".join(f"{cause} {count}" for cause, count in causes.most_common()) or "none"
    deepest_of_all = 1e3 * min((each.depth for each in solved), default=0.0)
    return (
        f"\n{len(rows)} lifts: {len(solved)} solved, deepest {deepest_of_all:.2f} mm; {len(rows) - len(solved)} not "
        f"({told}); {sum(not each.passed for each in rows)} fail.\nProcessor time of a search: median "
        f"{np.median(seconds):.1f} s, 95 % below {np.quantile(seconds, 0.95):.1f} s, most {seconds.max():.1f} s."
    )


def _cause(reason: str) -> str:
    """Return a word on what is in the way."""
    words = ("refused", "weak", "come", "torque", "turn", "soles", "reach", "moment", "force", "slip", "tip", "lean")
    return next((word for word in words if word in reason), "other" if reason else "not explained")


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="scenarios")
    parser.add_argument("--seed", type=int, default=17, help="of the sample")
    parser.add_argument("--only", type=int, nargs="*", help="numbers of those to solve; all by default")
    parser.add_argument("--clearance", choices=tuple(CLEARANCE), default="on", help="whether bodies must keep apart")
    parser.add_argument("--doubt", action="store_true", help="search again, wider, where nothing was found")
    args = parser.parse_args()
    # The work that a search does is limited; a time limit would cut it short on a busy machine.
    changes: dict[str, Any] = {"solver.time_limit": 600.0, "limits.clearance": CLEARANCE[args.clearance]}
    print(row("#", "lift", "objective", "processor time [s]", "deepest [mm]", "what is in the way"))
    print(row(*["---"] * 6), flush=True)
    rows = []
    with progress_line() as tell:
        for n, (what, scenario) in enumerate(scenarios(args.count, args.seed)):
            if args.only and n not in args.only:
                continue
            tell(f"{n + 1} of {args.count}: {what}")
            found = examine(what, scenario.replace(changes), args.doubt)
            rows.append(found)
            mark = "" if found.passed else "**fails** " + "a wider search finds a lift; " * found.doubted
            objective = f"{found.objective:.1f}" if found.solved else "none"
            depth = f"{1e3 * found.depth:.1f}" if found.solved else ""
            print(row(n, what, objective, f"{found.seconds:.1f}", depth, mark + found.reason), flush=True)
    print(summary(rows))
    return 0 if all(each.passed for each in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
