"""What outlives a lift: models, kernels and solvers, used again by the next lift as far as they fit it."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import partial
from operator import is_not
from typing import Any, TypeVar

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.banded import Banded, BandedOptions
from liftopt.collocation.solvers.banded_nlp import kernels_for_simd
from liftopt.collocation.solvers.ipopt import Ipopt, IpoptOptions
from liftopt.collocation.solvers.result import Solver
from liftopt.collocation.spline import Mesh, RestToRestSpline
from liftopt.scenario.build import agent_key, agent_of, object_key, object_of, obstacles_of, task_of
from liftopt.scenario.model import Scenario
from liftopt.search.postures import PostureSolver
from liftopt.search.team_solids import TeamSolids
from liftopt.types import Progress

T = TypeVar("T")
BANDED, IPOPT = "banded", "ipopt"  # solvers by name
# Factor on the objective inside IPOPT: with a larger one it takes more iterations (docs/tuning.md).
LIFT_SCALING = 0.03


class SolverCache:
    """Builds what a lift needs, or hands out what it built before; for one thread.

    A new subject, tool, object, task or duration keeps kernels and solvers; another number of intervals or another
    scale of a constraint (the limits on torque and grasp force are shares of it) makes new ones.
    """

    def __init__(self) -> None:
        """Start with nothing."""
        self._models: dict[str, tuple[Hashable, Any]] = {}
        self._team: Team | None = None
        self._solids: tuple[Hashable, TeamSolids] | None = None
        self._postures: PostureSolver | None = None
        self._meshes: dict[RestToRestSpline, Mesh] = {}
        self._problems: dict[RestToRestSpline, tuple[Scenario, Problem]] = {}
        self._solvers: dict[tuple[str, int, float, float, int, bool], Solver] = {}

    def problem(self, scenario: Scenario, spline: RestToRestSpline, progress: Progress | None = None) -> Problem:
        """Return the lift of a scenario on a mesh; ``progress`` is called when kernels must be compiled first."""
        agents = tuple(
            self._kept(name, agent_key(scenario, name), partial(agent_of, scenario, name)) for name in scenario.agents
        )
        lifted = self._kept("the object", object_key(scenario), partial(object_of, scenario))
        team, models = self._team, (*agents, lifted)
        known = (*team.agents, team.object) if team else ()
        if team is None or len(known) != len(models) or any(map(is_not, models, known)):
            team = self._team = Team.of(agents, lifted, progress, like=team)
        if spline not in self._meshes:
            self._meshes[spline] = spline.mesh()
        kept = self._problems.get(spline)
        if kept is None or kept[0] != scenario or kept[1].team is not team:
            kept = scenario, Problem(team, task_of(scenario), self._meshes[spline])
            self._problems[spline] = kept
        return kept[1]

    def solver(
        self,
        problem: Problem,
        scenario: Scenario,
        name: str,
        progress: Progress | None = None,
        worker: int = 0,
        rough: float = 0.0,
    ) -> Solver:
        """Return the solver ``name`` for a problem; each ``worker`` has one of its own, ``rough`` as ``BandedOptions``.

        Raises:
            SolverError: it cannot be set up.
        """
        tolerance = scenario.solver.tolerance
        # Free problems and those with planes take turns, on one mesh.
        key = (name, worker, tolerance, rough, len(problem.mesh.phase), problem.planes is not None)
        kept = self._solvers.get(key)
        if kept is None or not kept.takes(problem):
            made: Solver
            if name == BANDED:
                made = Banded(problem, BandedOptions(tolerance=tolerance, rough=rough), progress)
            else:
                options = IpoptOptions(tolerance=tolerance, objective_scaling=LIFT_SCALING)
                made = Ipopt(problem, options, kernels_for_simd(problem, progress))
            kept = self._solvers[key] = made
        return kept

    def solids(self, scenario: Scenario, team: Team, progress: Progress | None = None) -> TeamSolids:
        """Return the solids of a team and of the scenario's obstacles; ``progress`` is called when kernels compile."""
        kept, obstacles = self._solids, scenario.obstacles
        if kept is None or kept[0] != obstacles or kept[1].team is not team:
            like = kept[1] if kept else None
            kept = self._solids = obstacles, TeamSolids.of(team, obstacles_of(scenario), progress, like)
        return kept[1]

    def postures(self, problem: Problem, scenario: Scenario, progress: Progress | None = None) -> PostureSolver:
        """Return the solver of static postures for a lift; ``progress`` is called when kernels must be compiled."""
        workers = scenario.solver.workers
        self._postures = PostureSolver(problem.team, problem.task, progress, like=self._postures, workers=workers)
        return self._postures

    def _kept(self, name: str, key: Hashable, make: Callable[[], T]) -> T:
        if name not in self._models or self._models[name][0] != key:
            self._models[name] = (key, make())
        model: T = self._models[name][1]
        return model
