"""The varied scenarios that the benchmark holds, and the objective that each had before the work on speed.

``scenarios.json`` keeps them with their starts, so that they stay what they are whatever SciPy draws and however
postures are searched. ``python -m benchmarks.scenarios`` in ``scripts/`` makes it anew, with the liftopt installed
there: its objectives are then the reference.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import qmc

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.spline import RestToRestSpline
from liftopt.scenario.build import agents_of, object_of, task_of
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.search.initial_guess import posture_starts
from liftopt.search.solve import solve

BASE = "table5_paper"
FILE = Path(__file__).with_name("scenarios.json")
COUNT, WITH_REFERENCE, SEED, STARTS = 60, 40, 2026, 8
# Table 5 lies inside. The clearance is from the robot's grasp to its base: beyond 1.05 m the arm hardly reaches.
RANGES = {
    "human.stature": (1.55, 1.92),
    "human.mass": (50.0, 100.0),
    "object.mass": (0.5, 5.0),
    "object.depth": (0.35, 0.55),
    "object.width": (0.2, 0.5),
    "task.start.height": (0.75, 1.0),
    "task.end.height": (1.15, 1.45),
    "task.start.human_distance": (0.35, 0.45),
    "duration": (1.4, 3.0),
    "clearance": (0.75, 1.05),
}
PATIENT = "solver.time_limit=3600"  # so that no search is cut short where a machine is slow or busy
REST = "task.rest=acceleration"  # as all lifts were when the objectives were kept
DECIMALS = 6  # of a start: what it takes to begin at the same place
MADE = (
    f"Drawn from a Latin hypercube (scipy.stats.qmc, seed {SEED}) over the ranges of scenarios.py, the first {COUNT} "
    f"that can be lifted. objective: of the best of {STARTS} starts with IPOPT, tolerance 1e-6, verified, for the "
    f"first {WITH_REFERENCE}. ends: the best posture pair of posture_starts with seed 0. Both by the liftopt of commit "
)


@dataclass(frozen=True)
class Ends:
    """Postures at both ends to start from: coordinates (23,) [rad, m] and grasp forces (6,) [N]."""

    first: tuple[float, ...]
    last: tuple[float, ...]
    first_force: tuple[float, ...]
    last_force: tuple[float, ...]


@dataclass(frozen=True)
class Varied:
    """One varied scenario.

    Attributes:
        overrides: what differs from ``table5_paper``, as ``load_scenario`` takes it.
        objective: of the best of eight starts before the work on speed; None for those without.
        ends: where a single solve starts.
    """

    overrides: tuple[str, ...]
    objective: float | None
    ends: Ends

    def scenario(self, *more: str) -> Scenario:
        """Return the scenario, with some more entries changed."""
        return load_scenario(BASE, [*self.overrides, *more])


def table5_paper() -> Varied:
    """Return the lift of the paper, which the others vary."""
    return _read(json.loads(FILE.read_text(encoding="utf-8"))[BASE])


def varied_scenarios() -> tuple[Varied, ...]:
    """Return the varied ones, those with a reference objective first."""
    return tuple(_read(entry) for entry in json.loads(FILE.read_text(encoding="utf-8"))["scenarios"])


def draw(count: int) -> list[tuple[str, ...]]:
    """Return overrides from a Latin hypercube over the ranges; the sexes take turns."""
    lower, upper = np.transpose(list(RANGES.values()))
    points = qmc.scale(qmc.LatinHypercube(len(RANGES), seed=SEED).random(count), lower, upper)
    drawn = []
    for i, point in enumerate(points):
        values = dict(zip(RANGES, np.round(point, 3).tolist(), strict=True))
        depth, ahead = values["object.depth"], values["task.start.human_distance"]
        values["task.end.human_distance"] = ahead
        values["task.standing_distance"] = round(ahead + depth + values.pop("clearance"), 3)
        drawn.append((f"human.sex={('male', 'female')[i % 2]}", *(f"{key}={value}" for key, value in values.items())))
    return drawn


def search_ends(scenario: Scenario) -> Ends:
    """Return the best posture pair that is found for a scenario."""
    team = Team.of(agents_of(scenario), object_of(scenario))
    problem = Problem(team, task_of(scenario), RestToRestSpline(20).mesh())
    start = posture_starts(problem, 1, 0, Deadline.after(60.0))[0]
    control, force = (np.round(values, DECIMALS) for values in problem.unpack(start.x))
    return Ends(*(tuple(values.tolist()) for values in (control[0], control[-1], force[0], force[-1])))


def remake(commit: str) -> None:
    """Solve what is drawn, keep the first that can be lifted, and write the file."""
    kept: list[dict[str, Any]] = []
    for overrides in draw(COUNT + COUNT // 3):
        if len(kept) == COUNT:
            break
        more = (f"solver.starts={STARTS}", "solver.name=ipopt", PATIENT, REST)
        solution = solve(load_scenario(BASE, [*overrides, *more]))
        print(f"{len(kept)} kept: {solution.objective:.6f} {solution.status}", flush=True)
        if solution.solved:
            reference = solution.objective if len(kept) < WITH_REFERENCE else None
            kept.append(_entry(overrides, reference))
    made = {"made": MADE + commit, BASE: _entry((), None), "scenarios": kept}
    keep(made)


def keep(made: dict[str, Any]) -> None:
    """Write the file, a line for a scenario."""
    lines = ",\n".join(json.dumps(entry) for entry in made["scenarios"])
    head = f'{{"made": {json.dumps(made["made"])},\n{json.dumps(BASE)}: {json.dumps(made[BASE])},\n'
    FILE.write_text(f'{head}"scenarios": [\n{lines}\n]}}\n', encoding="utf-8")


def _entry(overrides: tuple[str, ...], objective: float | None) -> dict[str, Any]:
    ends = search_ends(load_scenario(BASE, overrides))
    return {"overrides": overrides, "objective": objective, "ends": asdict(ends)}


def _read(entry: dict[str, Any]) -> Varied:
    ends = Ends(**{name: tuple(values) for name, values in entry["ends"].items()})
    return Varied(tuple(entry["overrides"]), entry["objective"], ends)


if __name__ == "__main__":
    import sys

    remake(sys.argv[1])
