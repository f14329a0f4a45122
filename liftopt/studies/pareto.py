"""The Pareto front of two efforts, a person's against a robot's: what the one gains where the other works more.

Every point is an optimum of the scenario with other weights of the two efforts, their sum kept; whoever else lifts
keeps the weight that the scenario gives. The search starts anew at both ends and in the middle of the range. It follows
each of these optima through all weights by warm solves. Then it goes over the whole range in both directions as long as
a neighbour's motion leads to something better. Acceleration and force have weights of their own, and there are local
optima: so another point may be better in both efforts. Such points are dropped.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from liftopt.assessment.who import Who, who_in
from liftopt.collocation.motion import objective_terms
from liftopt.control.replanning import Replanner
from liftopt.errors import InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.scenario.model import Scenario
from liftopt.scenario.placement import lead, partner
from liftopt.scenario.presets import defaults_at
from liftopt.search.candidate import Candidate
from liftopt.solution.grasp_loads import shares
from liftopt.types import Progress

DECADES = 4.0  # that the ratio of the weights runs over, about that of the preset
# Where a warm solve across a step in weights fails, it is tried in two halves, this often.
HALVINGS = 2
ROUNDS = 3  # over the whole range and back, at most
BETTER = 1e-6  # relative gain of the objective that counts
FEWEST, MOST = 2, 200


@dataclass(frozen=True)
class Point:
    """One compromise.

    Attributes:
        weights: of the first's and the second's effort.
        efforts: the first's and the second's effort, measured as ``effort_in`` their scenario.
        share: mean part of the vertical grasp force that the first carries.
        candidate: the lift, verified.
    """

    weights: tuple[float, float]
    efforts: tuple[float, float]
    share: float
    candidate: Candidate


@dataclass(frozen=True)
class Front:
    """What can be had.

    Attributes:
        scenario: whose.
        between: names of the two whose efforts are traded: a person and a robot, where there are both.
        points: that no other point beats in both efforts, the first's effort rising.
        dominated: those that one does.
        missing: weights of the two for which no verified solution was found.
    """

    scenario: Scenario
    between: tuple[str, str]
    points: tuple[Point, ...]
    dominated: tuple[Point, ...]
    missing: tuple[tuple[float, float], ...]


def pareto_front(
    scenario: Scenario,
    count: int = 11,
    progress: Progress | None = None,
    between: Sequence[str] | None = None,
) -> Front:
    """Return the front of a scenario from ``count`` ratios of the weights, evenly spaced in their logarithm.

    The ratios run from a hundred times that of the preset, 1 : 1 for the paper's, to a hundredth of it.

    Args:
        scenario: whose.
        count: of ratios.
        progress: called with one line at a time about what is going on.
        between: names of the two whose efforts are traded; None takes the first person and the first robot, or the
            second who lifts.

    Raises:
        InputError: ``count`` is out of range, nobody has a name, or the scenario weighs neither effort.
        SolverError: the solver cannot run at all.
    """
    if not FEWEST <= count <= MOST:
        raise InputError("--points", count, f"must be a whole number from {FEWEST} to {MOST}")
    one, other = pair = _pair(scenario, between)
    total = scenario.agents[one].weight + scenario.agents[other].weight
    if total == 0:
        raise InputError(f"{one}.weight", 0.0, f"one of {one}.weight and {other}.weight must be above 0")
    middle = _usual(scenario, one) - _usual(scenario, other)
    logs = np.linspace(middle + DECADES / 2, middle - DECADES / 2, count).tolist()  # of one over the other
    walk = _Walk(scenario, pair, total, logs, Replanner(progress), progress or (lambda line: None))
    candidates = walk.best()
    points = [_point(candidate, pair) for candidate in candidates if candidate is not None and candidate.solved]
    missing = [weights_at(total, log) for log, p in zip(logs, candidates, strict=True) if p is None or not p.solved]
    dominated = [point for point in points if any(_beats(other, point) for other in points)]
    kept = sorted((point for point in points if point not in dominated), key=lambda point: point.efforts)
    return Front(scenario, pair, tuple(kept), tuple(dominated), tuple(missing))


def weights_at(total: float, log: float) -> tuple[float, float]:
    """Return the weights of the two whose ratio has this logarithm to base 10."""
    one = total / (1 + 10**-log)
    return one, total - one


def _usual(scenario: Scenario, name: str) -> float:
    """Return the logarithm to base 10 of the weight that an agent has by the preset."""
    weights: dict[str, float] = defaults_at(f"{scenario.agents[name].kind}.weight")
    return math.log10(weights[scenario.objective.preset])


def _pair(scenario: Scenario, between: Sequence[str] | None) -> tuple[str, str]:
    """Return the names of the two whose efforts are traded."""
    names = list(scenario.agents)
    if between is None:
        other = partner(scenario)
        if other is None:
            raise InputError("agents", ", ".join(names), "must be two or more: a front trades two efforts")
        return lead(scenario), other
    for name in between:
        if name not in names:
            allowed = f"must be the name of one who lifts: {', '.join(names)}"
            raise InputError("--between", name, allowed + did_you_mean(nearest(name, names)))
    one, other = between
    if one == other:
        raise InputError("--between", f"{one} {other}", "must be two who lift")
    return one, other


class _Walk:
    """The best lift so far for every ratio, and the ways between them."""

    def __init__(
        self,
        scenario: Scenario,
        pair: tuple[str, str],
        total: float,
        logs: Sequence[float],
        replanner: Replanner,
        progress: Progress,
    ) -> None:
        self.scenario, self.pair, self.total, self.logs = scenario, pair, total, logs
        self.replanner, self.progress = replanner, progress
        self.candidates: list[Candidate | None] = [None] * len(logs)

    def best(self) -> list[Candidate | None]:
        """Return the best lift found for each ratio."""
        last = len(self.logs) - 1
        for i in sorted({0, last // 2, last}):
            if (found := self._search(i)) is not None:
                self._keep(i, found)
                for path in (range(i, last), range(i, 0, -1)):
                    self._follow(found, path, 1 if path.step > 0 else -1)
        for _ in range(ROUNDS):
            if not (self._polish(range(last), 1) + self._polish(range(last, 0, -1), -1)):
                break
        return self.candidates

    def _search(self, i: int) -> Candidate | None:
        """Return the best of several starts at one ratio."""
        self.progress(f"searching at weights {ratio_text(weights_at(self.total, self.logs[i]))}")
        self.replanner.latest = None
        self.replanner.solve(self._scenario(self.logs[i]), cold=True)
        found, options = self.replanner.latest, self.scenario.solver
        if found is None or found.spline.intervals == options.intervals:
            return found
        # It took a finer mesh, and objectives compare on one mesh only: all begin again there.
        self.scenario = self.scenario.replace({"solver.intervals": found.spline.intervals, "refine.on": False})
        self.candidates = [None] * len(self.candidates)
        return self._search(i)

    def _follow(self, candidate: Candidate, path: range, step: int) -> None:
        """Take one optimum along through the weights, whatever else is known there."""
        for i in path:
            there = self._warm(candidate, self.logs[i], self.logs[i + step])
            if there is None:
                return
            self._keep(i + step, there)
            candidate = there

    def _polish(self, path: range, step: int) -> int:
        """Start every solve from its best neighbour; return how many it made better."""
        gained = 0
        for i in path:
            candidate = self.candidates[i]
            there = None if candidate is None else self._warm(candidate, self.logs[i], self.logs[i + step])
            gained += there is not None and self._keep(i + step, there)
        return gained

    def _warm(self, candidate: Candidate, log: float, onto: float, halvings: int = HALVINGS) -> Candidate | None:
        self.progress(f"following an optimum to weights {ratio_text(weights_at(self.total, onto))}")
        self.replanner.latest = candidate
        there = self.replanner.replan(self._scenario(onto))
        if there is not None or halvings == 0:
            return there
        middle = (log + onto) / 2
        between = self._warm(candidate, log, middle, halvings - 1)
        return None if between is None else self._warm(between, middle, onto, halvings - 1)

    def _keep(self, i: int, candidate: Candidate) -> bool:
        known = self.candidates[i]
        if known is not None and candidate.result.objective > (1 - BETTER) * known.result.objective:
            return False
        if not candidate.solved:
            return False
        self.candidates[i] = candidate
        return True

    def _scenario(self, log: float) -> Scenario:
        weights = zip(self.pair, weights_at(self.total, log), strict=True)
        return self.scenario.replace({f"{name}.weight": weight for name, weight in weights})


def _point(candidate: Candidate, pair: tuple[str, str]) -> Point:
    motion = candidate.at(candidate.spline.phase * candidate.problem.task.duration)
    terms, agents = objective_terms(candidate.problem, motion), candidate.scenario.agents
    one, other = pair
    row = [agent.name for agent in motion.agents].index(one)
    share = float(np.nanmean(shares(motion.agents)[row]))
    return Point((agents[one].weight, agents[other].weight), (terms[one], terms[other]), share, candidate)


def _beats(one: Point, other: Point) -> bool:
    """Whether a point is better than another in one effort and no worse in the other."""
    no_worse = all(a <= b for a, b in zip(one.efforts, other.efforts, strict=True))
    return no_worse and not all(map(math.isclose, one.efforts, other.efforts))


def ratio_text(weights: tuple[float, float]) -> str:
    """Return the ratio of two weights, not both 0, as everybody tells it: ``"1 : 100"``, ``"2.51 : 1"``."""
    one, other = weights
    if not one or not other:
        return "1 : 0" if one else "0 : 1"
    ratio = float(f"{max(one, other) / min(one, other):.3g}")
    return f"{ratio:g} : 1" if one >= other else f"1 : {ratio:g}"


def who_of(front: Front, name: str) -> Who:
    """Return how one of the front's scenario is told."""
    return who_in(front.scenario.agents, name)
