"""What a solved lift depends on: what happens to effort, joints and load share as the scenario changes a little.

Each parameter is changed up and down and the lift is solved again, from its optimum: everybody re-plans. Slopes are
central differences. Their step is the change that a reader thinks in, if half of it gives the same slopes and up and
down do as much; else it is halved until that is so. What limits say at the optimum itself is no such measure: at a
knot one becomes active or ceases to be within a millimetre of nearly any change, and next to nothing comes of it.

The optimum's own derivative (``collocation.parametric``) tells how far the motion should move. A lift solved again
that lies elsewhere is another optimum, and no slope joins the two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from liftopt.collocation.motion import motion_at, objective_terms, objective_weights
from liftopt.collocation.parametric import Optimum, Tangent
from liftopt.collocation.problem import Problem
from liftopt.control.replanning import Replanner
from liftopt.errors import InputError, LiftoptError
from liftopt.files.entries import FREE
from liftopt.multibody.trajectory import limit_share
from liftopt.scenario.model import Scenario
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.carried_planes import with_planes_of
from liftopt.solution.checks import FINER
from liftopt.solution.grasp_loads import shares
from liftopt.studies.parameters import Parameter, changed, parameters_of
from liftopt.types import Progress

# Of central differences of the problem itself, times the value: their error is its square.
STEP = 1e-4
SMALLEST = 0.1  # what counts as the value of a parameter that is smaller
HALVINGS = 4  # of the change that a reader thinks in
# Slopes of a step and of half of it agree to this share, what up and down do to the other; what is less than NOTHING,
# as a share of the figure now or of the whole, is none at all.
AGREEMENT, SYMMETRIC, NOTHING = 0.10, 0.25, 0.002
SHARP = 1e-8  # KKT error to which the optimum is polished before it is differentiated
# Planes have settled where the objective changes by a smaller share; so many solves are tried.
SETTLED, SETTLING = 1e-6, 16
# Another motion: further from the optimum by this [rad, m] than so many times what the tangent says.
ELSEWHERE, FURTHER = 0.1, 3.0


@dataclass(frozen=True)
class Sensitivity:
    """What one parameter does.

    Attributes:
        parameter: which.
        value: of the scenario, in its unit; the first where several keys move together.
        change: for which the slopes hold, up and down; at most the parameter's.
        slopes: of each of ``SensitivityStudy.figures`` by the parameter, in the figure's unit over the parameter's.
        envelope: derivative of the objective by the envelope theorem, found without solving again.
        doubt: why the slopes are not to be relied on even for ``change``, in words; empty if they are.
        beyond: why they do not hold for the parameter's whole change, in words; empty if they do.
    """

    parameter: Parameter
    value: float
    change: float
    slopes: dict[str, float]
    envelope: float
    doubt: str = ""
    beyond: str = ""

    @property
    def is_reliable(self) -> bool:
        """Whether half the change does half as much, and down the opposite of up."""
        return not self.doubt


@dataclass(frozen=True)
class SensitivityStudy:
    """What a lift depends on.

    Attributes:
        candidate: the lift.
        figures: their values: ``"objective"``, ``"effort <agent>"`` (``effort_in`` its scenario),
            ``"share <agent>"``, the mean part of the vertical grasp force, ``"peak <joint>"`` [Nm], the size of a
            joint's largest torque, and ``"used <joint>"``, its largest share of the limit in its direction; both
            between knots too.
        busiest: joint of each agent that uses most of its limit.
        sensitivities: one a parameter.
        left_out: parameter and why, of those that the scenario does not let change.
    """

    candidate: Candidate
    figures: dict[str, float]
    busiest: tuple[str, ...]
    sensitivities: tuple[Sensitivity, ...]
    left_out: tuple[tuple[Parameter, str], ...]


def sensitivity(scenario: Scenario, progress: Progress | None = None) -> SensitivityStudy:
    """Return what a lift depends on: it is solved, and solved again with each parameter a little up and down.

    Args:
        scenario: what to lift.
        progress: called with one line at a time about what is going on.

    Raises:
        InputError: a value of the scenario cannot be used.
        LiftoptError: the scenario has no verified solution, or kernels cannot be had.
    """
    cache = SolverCache()
    replanner = Replanner(progress, cache)
    solution = replanner.solve(scenario)
    candidate = replanner.latest
    if candidate is None:
        raise LiftoptError(f"no verified solution to differentiate: {solution.status}")
    return study(_settled(replanner, candidate), cache, progress=progress)


def _settled(replanner: Replanner, candidate: Candidate) -> Candidate:
    """Return the optimum that a candidate leads to when it is solved again and again, sharply.

    Planes that keep bodies apart follow the motion with every solve, and the motion follows them; without planes one
    solve does.
    """
    tolerance = min(SHARP, candidate.scenario.solver.tolerance)
    sharp, cost = candidate.scenario.replace({"solver.tolerance": tolerance}), np.inf
    for _ in range(SETTLING):
        replanner.latest = candidate
        again = replanner.replan(sharp)
        if again is None or not again.solved:
            break
        before, cost, candidate = cost, figures(again)["objective"], again
        if again.problem.planes is None or abs(before - cost) <= SETTLED * abs(cost):
            break
    return candidate


def study(
    candidate: Candidate,
    cache: SolverCache,
    parameters: Sequence[Parameter] | None = None,
    progress: Progress | None = None,
) -> SensitivityStudy:
    """Return what a lift depends on.

    Args:
        candidate: solved, to a tolerance far below what a change does.
        cache: that it comes from.
        parameters: to look at; None: ``parameters_of`` its scenario.
        progress: called with one line at a time about what is going on.

    Raises:
        SolverError: kernels cannot be had.
    """
    chosen = parameters_of(candidate.scenario) if parameters is None else parameters
    return _Differences(candidate, cache).study(chosen, progress or (lambda line: None))


def bearers(study: SensitivityStudy) -> tuple[str, ...]:
    """Return the names of those whose part of the load is told: of the people, or of everybody where there are none."""
    agents = study.candidate.problem.team.agents
    return tuple(agent.name for agent in agents if agent.kind == "person") or tuple(agent.name for agent in agents)


def figures(candidate: Candidate) -> dict[str, float]:
    """Return ``SensitivityStudy.figures`` of a lift."""
    problem, spline, x = candidate.problem, candidate.spline, candidate.result.x
    motion = motion_at(problem, spline, x, spline.phase)
    terms, weights = objective_terms(problem, motion), objective_weights(problem)
    found = {"objective": sum(weights[name] * value for name, value in terms.items())}
    for agent, share in zip(motion.agents, shares(motion.agents), strict=True):
        found[f"effort {agent.name}"] = terms[agent.name]
        found[f"share {agent.name}"] = float(np.nanmean(share))
    fine = np.linspace(0.0, 1.0, FINER * spline.intervals + 1)
    for agent in motion_at(problem, spline, x, fine).agents:
        names = agent.moving_joints
        torques, used = np.abs(agent.tau[:, agent.moving]).max(axis=0), limit_share(agent).max(axis=0)
        found |= {f"peak {name}": float(torque) for name, torque in zip(names, torques, strict=True)}
        found |= {f"used {name}": float(share) for name, share in zip(names, used, strict=True)}
    return found


@dataclass(frozen=True)
class _Sides:
    """Figures of the lift with a parameter changed down and up."""

    low: dict[str, float]
    high: dict[str, float]


class _Differences:
    """Central differences around one lift."""

    def __init__(self, candidate: Candidate, cache: SolverCache) -> None:
        self.candidate, self.cache, self.replanner = candidate, cache, Replanner(cache=cache)
        self.optimum = Optimum(candidate.problem, candidate.result.x, candidate.result.multipliers)
        self.now = figures(candidate)
        joints = [agent.moving_joints for agent in candidate.problem.team.agents]
        self.busiest = tuple(max(names, key=lambda name: self.now[f"used {name}"]) for names in joints)
        # Judged: what the table tells. Of these the first change relative to what they are, the others as they are.
        self.relative = [name for name in self.now if name.startswith(("objective", "effort"))]
        carried = [name for name in self.now if name.startswith("share")]
        self.told = [*self.relative, *carried, *(f"used {name}" for name in self.busiest)]

    def study(self, parameters: Sequence[Parameter], progress: Progress) -> SensitivityStudy:
        """Return what the lift depends on."""
        found, left_out = [], []
        for parameter in parameters:
            progress(f"sensitivity to {parameter.name}")
            value = self.candidate.scenario.value(parameter.keys[0])
            if not isinstance(value, float):
                left_out.append((parameter, f"{parameter.keys[0]} is {FREE}"))
                continue
            try:
                found.append(self._sensitivity(parameter, value))
            except InputError as error:
                left_out.append((parameter, str(error)))
        return SensitivityStudy(self.candidate, self.now, self.busiest, tuple(found), tuple(left_out))

    def _sensitivity(self, parameter: Parameter, value: float) -> Sensitivity:
        tangent = self._tangent(parameter, value)
        steps = [parameter.change / 2**i for i in range(HALVINGS + 2)]
        tried: list[tuple[float, _Sides]] = []
        first = refused = ""
        for step in steps:
            try:
                sides: _Sides | str = self._sides(parameter, step, tangent)
            except InputError as error:
                sides = refused = str(error)
            if isinstance(sides, str):  # nothing to compare: it is tried nearer
                first, tried = first or sides, []
                continue
            if tried:
                doubt = self._doubt(*tried[-1], sides, tangent)
                if not doubt:
                    return self._found(parameter, value, tangent, *tried[-1], beyond=first)
                first = first or doubt
            tried.append((step, sides))
        if not tried:
            raise InputError(parameter.keys[0], value, refused or first)
        return self._found(parameter, value, tangent, *tried[0], doubt=first)

    def _found(
        self, parameter: Parameter, value: float, tangent: Tangent, step: float, sides: _Sides, **remarks: str
    ) -> Sensitivity:
        slopes = {name: (sides.high[name] - sides.low[name]) / (2 * step) for name in self.now}
        return Sensitivity(parameter, value, step, slopes, tangent.objective, **remarks)

    def _tangent(self, parameter: Parameter, value: float) -> Tangent:
        step = STEP * max(abs(value), SMALLEST)
        before, after = (self._problem(changed(self.candidate.scenario, parameter, change)) for change in (-step, step))
        return self.optimum.tangent(before, after, step)

    def _problem(self, scenario: Scenario) -> Problem:
        """Return a changed problem, whose bodies are kept apart by the same planes."""
        problem = self.cache.problem(scenario, self.candidate.spline)
        return with_planes_of(self.cache, self.candidate, scenario, problem)

    def _sides(self, parameter: Parameter, step: float, tangent: Tangent) -> _Sides | str:
        """Return the figures of the lift solved again on both sides, or why they cannot be had."""
        found, control = [], self.candidate.problem.layout.control
        for change in (-step, step):
            self.replanner.latest = self.candidate
            candidate = self.replanner.replan(changed(self.candidate.scenario, parameter, change))
            moved = 0.0 if candidate is None else np.abs(candidate.result.x - self.candidate.result.x)[control].max()
            if moved > ELSEWHERE + FURTHER * step * np.abs(tangent.x[control]).max():
                return f"with {change:+g} {parameter.unit} the motion jumps to another optimum"
            if candidate is None or not candidate.solved:
                return f"with {change:+g} {parameter.unit} no verified lift is found from this one"
            found.append(figures(candidate))
        return _Sides(*found)

    def _doubt(self, step: float, sides: _Sides, halves: _Sides, tangent: Tangent) -> str:
        """Return why what a step does is not proportional to it, in words; empty if it is."""
        worst, excess = "", 1.0
        for name in self.told:
            now = self.now[name]
            up, down = sides.high[name] - now, sides.low[name] - now
            whole, half = (up - down) / 2, halves.high[name] - halves.low[name]
            least = NOTHING * (abs(now) if name in self.relative else 1.0)
            bend = abs(up + down) / 2 / max(SYMMETRIC * abs(whole), least)
            differs = abs(whole - half) / max(AGREEMENT * abs(whole), least)
            if max(bend, differs) > excess:
                excess = max(bend, differs)
                scale = 100.0 / (abs(now) if name in self.relative else 1.0)
                unit = "%" if name in self.relative else "points of percent"
                if bend >= differs:
                    worst = f"{name} {scale * up:+.2f} {unit} upwards, {scale * down:+.2f} downwards"
                else:
                    worst = f"{name} {scale * whole:+.2f} {unit} by all of it, {scale * half:+.2f} by twice half of it"
        if worst and tangent.reach < step:
            worst += f"; {tangent.limit} reaches or leaves its limit"
        return worst
