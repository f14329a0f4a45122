"""What would make a lift possible: the smallest change of one value of the scenario, found by solving with it.

Each change is enlarged until a lift is found, and then bisected towards the scenario as it was, each solve from the
last that worked. What is reported was solved and verified with that very value: there is a lift; that there is none
with less is not proven.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Multipliers, Solver, SolverResult
from liftopt.collocation.transfer import transfer
from liftopt.errors import InputError, SolverError
from liftopt.scenario.model import Scenario
from liftopt.search.candidate import Candidate
from liftopt.search.feasibility_screen import too_fast
from liftopt.search.initial_guess import InitialGuess, posture_starts
from liftopt.search.postures import PostureSolver
from liftopt.solution.infeasibility_report import Obstacle, SuggestedChange

if TYPE_CHECKING:
    from liftopt.search.solve import Search

Array = npt.NDArray[np.float64]
STARTS = 2  # of each changed scenario
ITERATIONS = 150  # of each start
ENOUGH = 4  # remedies
# Work for all remedies, and what a search for postures counts as: in iterations of the solver on so many intervals, by
# the time they take.
WORK, POSTURES, INTERVALS = 3000.0, 70.0, 20
HOLDS = 4.0  # likewise, whether the object can be held at both ends of a motion that is known
# Of seeds, for postures. With three rounds of them and as much work in all, two of eight remedies were not found.
ROUNDS = 1
LEAST_MOVE = 0.05  # [m], tried first where nothing says how far to move
GROWTH = 1.6  # of a change that does not help yet
QUICK = "banded"
FINEST = 160  # intervals of a remedy's mesh


@dataclass(frozen=True)
class Adjustable:
    """Values of a scenario that may be changed together.

    Attributes:
        keys: dotted keys; all move by the same amount.
        step: resolution of the change.
        usual: a change as large as this ranks as 1; of the value itself if ``relative``.
        less, more: what a change is called; may hold {change} and {value}, and {was}.
        against: constraints it may help with.
        most: largest change tried, in steps.
        relative: ``usual`` is a share of the value.
    """

    keys: tuple[str, ...]
    step: float
    usual: float
    less: str
    more: str
    against: frozenset[str]
    most: int = 64
    relative: bool = False


_REACH, _MOTION = frozenset({"closure", "keep_in"}), frozenset({"closure", "keep_in", "torque", "velocity"})
_STRENGTH = frozenset({"torque", "grasp_force"})
_POSTURE = _REACH | {"torque"}


def levers(scenario: Scenario) -> list[Adjustable]:
    """Return what may be changed in a scenario, the simplest first."""
    found = [
        Adjustable(("duration",), 0.01, 0.25, "", "at least {value:.2f} s",
              frozenset({"velocity", "torque", "grasp_force", "closure"}), 600, relative=True),
        Adjustable(("object.mass",), 0.1, 0.25, "object at most {value:.1f} kg", "", _STRENGTH, 512, relative=True),
        Adjustable(("limits.max_grasp_force",), 1.0, 0.1, "", "grasp force of up to {value:.0f} N",
              frozenset({"grasp_force"}), 512, relative=True),
        Adjustable(("task.standing_distance",), 0.01, 0.1, "robot base {change:.2f} m nearer",
              "robot base {change:.2f} m farther away", _MOTION, 256),
    ]  # fmt: skip
    for keys, where in _ends(scenario, "height"):
        lower, higher = where + " at most {value:.2f} m", where + " at least {value:.2f} m"
        found.append(Adjustable(keys, 0.01, 0.1, lower, higher, _MOTION))
    for keys, where in _ends(scenario, "human_distance"):
        found.append(Adjustable(keys, 0.01, 0.1, where + " {change:.2f} m nearer to the person",
                           where + " {change:.2f} m farther from the person", _POSTURE))  # fmt: skip
    for name, agent in scenario.agents.items():
        if agent.kind == "robot":
            found.append(
                Adjustable((f"{name}.base_height",), 0.01, 0.1, f"{name} base {{change:.2f}} m lower",
                      f"{name} base {{change:.2f}} m higher", _POSTURE)
            )  # fmt: skip
    found.append(
        Adjustable(("object.depth",), 0.01, 0.1, "object at most {value:.2f} m deep",
              "object at least {value:.2f} m deep", _POSTURE)
    )  # fmt: skip
    return found


def _ends(scenario: Scenario, name: str) -> Iterator[tuple[tuple[str, ...], str]]:
    given = [end for end in ("start", "end") if getattr(getattr(scenario.task, end), name) is not None]
    what = "height" if name == "height" else "object"
    for end in given:
        yield (f"task.{end}.{name}",), f"{end} height" if name == "height" else f"object at the {end}"
    if len(given) == 2 and name != "height":
        yield tuple(f"task.{end}.{name}" for end in given), f"{what} at both ends"


class SuggestedChanges:
    """Looks for changes of one scenario, for which no solution was found."""

    def __init__(self, search: Search, near: Iterable[Array], work: float = WORK) -> None:
        """Get ready.

        Args:
            search: the search that found nothing; past its deadline no more is tried.
            near: unknowns to start from besides postures.
            work: after which no more is tried, see ``WORK``.
        """
        self.search, self.near, self.left = search, list(near), work

    def against(self, obstacles: Sequence[Obstacle]) -> tuple[SuggestedChange, ...]:
        """Return verified remedies, the smallest change first."""
        found: list[SuggestedChange] = []
        hints = [(lever, _hint(self.search.scenario, lever, obstacles)) for lever in levers(self.search.scenario)]
        helpful = [(lever, hint) for lever, hint in hints if hint]
        for i, (lever, hint) in enumerate(helpful):
            if not self._goes_on(0.0) or len(found) == ENOUGH:
                break
            what = " and ".join(lever.keys)
            self.search.progress(f"looking for the smallest change that helps: {what} ({i + 1} of {len(helpful)})")
            change = self._smallest(lever, hint, self.left - 2 * self.left / (len(helpful) - i + 1))
            if change:
                found.append(change)
        return tuple(sorted(found, key=lambda change: change.size))

    def _goes_on(self, rest: float) -> bool:
        """Whether more work is left than ``rest``, and time."""
        return self.left > rest and time.monotonic() < self.search.deadline

    def _smallest(self, lever: Adjustable, hint: int, rest: float) -> SuggestedChange | None:
        """Return the smallest change of a lever that leads to a verified lift; ``hint`` steps are tried first.

        ``rest`` of the work is left to others.
        """
        signs = [sign for sign, words in ((-1, lever.less), (1, lever.more)) if words]
        candidate, steps, fails, sign = None, min(hint, lever.most), 0, 0
        while candidate is None and fails < lever.most and self._goes_on(rest):
            for sign in signs:
                candidate = self._candidate(lever, sign * steps, None)
                if candidate:
                    break
            else:
                fails, steps = steps, min(int(GROWTH * steps) + 1, lever.most)
        if candidate is None:
            return None
        helps = steps
        while helps - fails > 1 and self._goes_on(rest):
            middle = (helps + fails) // 2
            nearer = self._candidate(lever, sign * middle, candidate)
            candidate, helps, fails = (nearer, middle, fails) if nearer else (candidate, helps, middle)
        return self._remedy(lever, sign, candidate) if self._holds(candidate) else None

    def _remedy(self, lever: Adjustable, sign: int, candidate: Candidate) -> SuggestedChange:
        was, values = (tuple(s.value(key) for key in lever.keys) for s in (self.search.scenario, candidate.scenario))
        change = abs(values[0] - was[0])
        words = (lever.less if sign < 0 else lever.more).format(change=change, value=values[0])
        if "{value" in (lever.less or lever.more):
            words += f", not {was[0]:g}"
        size = change / (lever.usual * (was[0] if lever.relative else 1.0))
        return SuggestedChange(lever.keys, values, words, round(size, 6))

    def _holds(self, candidate: Candidate) -> bool:
        """Whether the plan is verified, on finer meshes if it takes them."""
        while candidate.refinable and 2 * candidate.spline.intervals <= FINEST:
            finer = candidate.spline.on(2 * candidate.spline.intervals)
            problem = self.search.cache.problem(candidate.scenario, finer)
            start = transfer(candidate.problem, candidate.spline, candidate.result.x, problem, finer)
            candidate = Candidate(
                candidate.scenario, problem, finer, candidate.start, self._solve(problem, candidate.scenario, start)
            )
        return candidate.solved

    def _solve(self, problem: Problem, scenario: Scenario, x: Array, warm: Multipliers | None = None) -> SolverResult:
        """Solve from ``x`` (n_x,), and count it as work."""
        solver = self._solver(problem, scenario)
        result = solver.solve(x, deadline=self.search.deadline, warm=warm, problem=problem, most=ITERATIONS)
        self.left -= result.iterations * (len(problem.mesh.phase) - 1) / INTERVALS
        return result

    def _solver(self, problem: Problem, scenario: Scenario) -> Solver:
        try:
            return self.search.cache.solver(problem, scenario, QUICK)
        except SolverError:
            return self.search.cache.solver(problem, scenario, scenario.solver.name)

    def _candidate(self, lever: Adjustable, steps: int, near: Candidate | None) -> Candidate | None:
        """Return a plan of the changed scenario that converged, from a plan of a near one if there is one, or None."""
        scenario = _changed(self.search.scenario, lever, steps)
        if scenario is None:
            return None
        cache, spline = self.search.cache, self.search.spline
        try:
            problem = cache.problem(scenario, spline)
        except InputError:  # the change leaves what a model can be
            return None
        if too_fast(problem):
            return None

        def solved(start: InitialGuess, warm: Candidate | None = None) -> Candidate | None:
            result = self._solve(problem, scenario, start.x, warm.result.multipliers if warm else None)
            candidate = Candidate(scenario, problem, spline, start.name, result)
            return candidate if candidate.result.converged and (candidate.solved or candidate.refinable) else None

        postures = cache.postures(problem, scenario)
        if near and near.problem.same_structure(problem):
            held = self._held(postures, problem, near)
            return solved(InitialGuess("near", near.result.x), near) if held else None
        deadline, seed = self.search.deadline, scenario.solver.seed
        starts = posture_starts(problem, STARTS, seed, deadline, postures=postures, rounds=ROUNDS)
        self.left -= POSTURES
        if starts:
            lower, upper = problem.bounds()
            starts += [InitialGuess("near", np.clip(x, lower, upper)) for x in self.near if x.shape == lower.shape]
        return next(filter(None, map(solved, starts)), None)

    def _held(self, postures: PostureSolver, problem: Problem, near: Candidate) -> bool:
        """Whether the object can be held still at both ends, much as the motion of a plan does.

        A motion need not: it may begin to fall. But a solve of the changed scenario asks for it first.
        """
        self.left -= HOLDS
        control, task = near.problem.unpack(near.result.x)[0], problem.task
        ends = ((task.start, control[0]), (task.end, control[-1]))
        return all(postures.solve(pose, seed, self.search.deadline) is not None for pose, seed in ends)


def _hint(scenario: Scenario, lever: Adjustable, obstacles: Sequence[Obstacle]) -> int:
    """Return how many steps of a lever the obstacles seem to ask for; 0 if it cannot help against them."""
    most, was = 0.0, scenario.value(lever.keys[0])
    for obstacle in obstacles:
        if obstacle.constraint not in lever.against:
            continue
        if obstacle.static and obstacle.time is not None and _elsewhere(lever, obstacle.time):
            return 0
        if obstacle.static and lever.keys == ("duration",):
            continue
        if not lever.relative:
            change = obstacle.amount if obstacle.unit == "m" else 0.0
        elif lever.keys == ("object.mass",):
            change = was * obstacle.share / (1.0 + obstacle.share)
        else:
            change = was * obstacle.share
        most = max(most, change, lever.step if lever.relative else LEAST_MOVE)
    return int(np.ceil(most / lever.step - 1e-9))


def _elsewhere(lever: Adjustable, when: float) -> bool:
    """Whether a lever moves only the end of the lift that an obstacle is not at."""
    return all(key.startswith("task.end." if when == 0.0 else "task.start.") for key in lever.keys)


def _changed(scenario: Scenario, lever: Adjustable, steps: int) -> Scenario | None:
    """Return the scenario with its values on the lever's grid, or None if it would be none."""
    grid = {key: round(round(scenario.value(key) / lever.step + steps) * lever.step, 6) for key in lever.keys}
    try:
        return scenario.replace(grid)
    except InputError:
        return None
