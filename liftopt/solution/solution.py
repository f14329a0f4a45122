"""A solved lift: trajectories, objective, verification, and how it was found."""

from __future__ import annotations

from dataclasses import dataclass, field

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.multibody.trajectory import AgentTrajectory, ObjectTrajectory
from liftopt.scenario.model import Scenario
from liftopt.solution.accuracy import Accuracy
from liftopt.solution.checks import Verification
from liftopt.solution.clearance import Clearance
from liftopt.solution.finding import Assessment
from liftopt.solution.infeasibility_report import InfeasibilityReason, SuggestedChange
from liftopt.types import Array

SOLVED = "solved"
CUT_SHORT = "cut the search short"  # by time; in notes, and in the status where there is no solution


@dataclass(frozen=True)
class StartRecord:
    """How the solver fared from one start.

    Attributes:
        name: of the start.
        status: the solver's word for how it ended.
        objective: where it stopped.
        iterations: of the solver.
        seconds: wall time in the solver [s].
    """

    name: str
    status: str
    objective: float
    iterations: int
    seconds: float


@dataclass(frozen=True)
class Solution:
    """The best motion found for a scenario. It is solved only if its own verification says so.

    Attributes:
        scenario: what was asked, all defaults filled in.
        outcome: ``"solved"`` or why there is no solution, in one line.
        time: (K,) knots [s].
        agents: trajectories at the knots, in the scenario's order.
        object: the object's trajectory at the knots.
        urdfs: text of the very models solved, by the name of the agent or the object.
        objective: weighted sum of the terms.
        objective_terms, objective_weights: unweighted integrals and their weights by name.
        iterations: of the kept start.
        intervals: N of the mesh it stands on.
        seconds: ``solve`` and ``evaluation`` of the kept start, ``setup`` and ``total`` [s].
        starts: all starts that were tried.
        kept_start: name of the one the solution comes from.
        verification: its own verification.
        notes: what the user should know (a refined mesh, a missing compiler).
        accuracy: how far it is from the lift in continuous time; None for what is no solution.
        reasons: what is in the way where there is no solution, the worst first.
        suggested_changes: changes that make a solution possible, each solved and verified; the smallest first.
        assessment: what it means for the person and the robot, and how far it can be trusted, as every output tells it.
        clearance: how far bodies keep apart between the knots too; None of what is no solution.
    """

    scenario: Scenario
    outcome: str
    time: Array
    agents: tuple[AgentTrajectory, ...]
    object: ObjectTrajectory
    urdfs: dict[str, str]
    objective: float
    objective_terms: dict[str, float]
    objective_weights: dict[str, float]
    iterations: int
    intervals: int
    seconds: dict[str, float]
    starts: tuple[StartRecord, ...]
    kept_start: str
    verification: Verification
    notes: tuple[str, ...] = ()
    accuracy: Accuracy | None = None
    reasons: tuple[InfeasibilityReason, ...] = ()
    suggested_changes: tuple[SuggestedChange, ...] = ()
    assessment: Assessment = field(default_factory=Assessment)
    clearance: Clearance | None = None

    @property
    def solved(self) -> bool:
        """Whether the solver found an optimum and the verification agrees."""
        return self.outcome == SOLVED and self.verification.passed

    @property
    def status(self) -> str:
        """``"solved"``, or why it is not, in one line."""
        if self.outcome != SOLVED or self.verification.passed:
            return self.outcome
        return f"verification failed: {self.verification.describe_failure()}"

    def __getitem__(self, name: str) -> AgentTrajectory:
        """Return the trajectory of the agent of that name.

        Raises:
            InputError: nobody has it.
        """
        for agent in self.agents:
            if agent.name == name:
                return agent
        names = [agent.name for agent in self.agents]
        raise InputError("agent", name, f"must be one of {', '.join(names)}{did_you_mean(nearest(name, names))}")

    @property
    def persons(self) -> tuple[AgentTrajectory, ...]:
        """The people who lift, in the scenario's order."""
        return tuple(agent for agent in self.agents if agent.kind == "person")

    @property
    def robots(self) -> tuple[AgentTrajectory, ...]:
        """The robots that lift, in the scenario's order."""
        return tuple(agent for agent in self.agents if agent.kind == "robot")

    @property
    def ground_reaction_force(self) -> Array:
        """(K, 3) force of the ground on the first person, world axes [N]; of anybody: ``ground_force`` of the agent.

        Raises:
            InputError: robots lift alone.
        """
        return self._first_person("ground_reaction_force").ground_force

    @property
    def ground_reaction_moment(self) -> Array:
        """(K, 3) moment of the ground on the first person at the foot origin, world axes [Nm].

        Raises:
            InputError: robots lift alone.
        """
        return self._first_person("ground_reaction_moment").ground_moment

    def _first_person(self, asked: str) -> AgentTrajectory:
        for person in self.persons:
            return person
        raise InputError(asked, NO_VALUE, "is the first person's, and this is a lift by robots alone")
