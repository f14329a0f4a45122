"""Where a solver stopped on a scenario: a motion at any time, its verification, and the solution it makes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from liftopt.collocation.motion import Motion, motion_at, objective_terms, objective_weights
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import STOPPED, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.scenario.build import obstacles_of
from liftopt.scenario.model import Scenario
from liftopt.solution.checks import Verification
from liftopt.solution.solution import SOLVED, Solution, StartRecord
from liftopt.solution.verify import verify
from liftopt.types import Array


@dataclass(frozen=True, eq=False)
class Candidate:
    """Where a solver stopped. It is verified when it is asked whether it is solved, and not before.

    Attributes:
        scenario: what was asked.
        problem: what was solved.
        spline: its space of motions.
        start: name of where the solver started.
        result: where it stopped.
        infeasible: why there cannot be a solution, one line; empty if nothing is known to be in the way.
        origin: on another mesh, from which it was solved; None if it was not.
    """

    scenario: Scenario
    problem: Problem
    spline: RestToRestSpline
    start: str
    result: SolverResult
    infeasible: str = ""
    origin: Candidate | None = None

    @cached_property
    def verification(self) -> Verification:
        """Every requirement, by Pinocchio in double precision."""
        scenario = self.scenario
        obstacles, clearance = obstacles_of(scenario), scenario.limits.clearance
        return verify(self.problem, self.spline, self.result, scenario.solver.tolerance, obstacles, clearance)

    @cached_property
    def outcome(self) -> str:
        """``"solved"`` as far as the solver knows, or why not, in one line."""
        if self.infeasible:
            return f"infeasible: {self.infeasible}"
        if self.result.converged:
            return SOLVED
        late, limit = self.result.status == STOPPED, self.scenario.solver.time_limit
        why = f"time limit of {limit:g} s reached" if late else f"the solver: {self.result.status}"
        return f"not converged ({why}): {self.verification.describe_failure()}"

    @property
    def solved(self) -> bool:
        """Whether the solver found an optimum and the verification agrees."""
        return self.outcome == SOLVED and self.verification.passed

    @property
    def refinable(self) -> bool:
        """Whether grasp closure between knots is all that is wrong."""
        return self.outcome == SOLVED and [c.name for c in self.verification.checks if not c.passed] == [
            "grasp closure between knots"
        ]

    @property
    def usable(self) -> bool:
        """Whether it is solved, or would be on a finer mesh."""
        return self.solved or self.refinable

    def at(self, time: Array) -> Motion:
        """Return what everybody does at ``time`` (K,) [s], by Pinocchio: q, v, a, torques, grasp forces, the object.

        Before the start and after the end it is as at that end: at rest, with the acceleration, torques and forces that
        the motion starts or ends with (none of the acceleration with ``task.rest = "acceleration"``).
        """
        phase = np.clip(np.asarray(time, dtype=float) / self.problem.task.duration, 0.0, 1.0)
        return motion_at(self.problem, self.spline, self.result.x, phase)

    def solution(
        self, starts: Sequence[StartRecord], seconds: dict[str, float], notes: tuple[str, ...] = ()
    ) -> Solution:
        """Return the solution, verified.

        Args:
            starts: all starts that were tried.
            seconds: ``setup`` and ``total`` [s].
            notes: what the user should know.
        """
        motion, team = motion_at(self.problem, self.spline, self.result.x, self.spline.phase), self.problem.team
        terms, weights = objective_terms(self.problem, motion), objective_weights(self.problem)
        urdfs = {agent.name: agent.urdf for agent in team.agents} | {team.object.name: team.object.urdf}
        return Solution(
            scenario=self.scenario,
            outcome=self.outcome,
            time=motion.time,
            agents=motion.agents,
            object=motion.object,
            urdfs=urdfs,
            objective=sum(weights[name] * value for name, value in terms.items()),
            objective_terms=terms,
            objective_weights=weights,
            iterations=self.result.iterations,
            intervals=self.spline.intervals,
            seconds={"solve": self.result.seconds, "evaluation": self.result.evaluation_seconds, **seconds},
            starts=tuple(starts),
            kept_start=self.start,
            verification=self.verification,
            notes=notes,
        )
