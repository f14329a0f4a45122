"""Two transcriptions of one lift on finer and finer meshes: the spline collocation of the solve, and Hermite-Simpson.

The first starts from the solution, the second from the first one's optimum, so that optima of one basin are compared,
not luck. What they have in common is the continuous problem; as h goes to 0 both objectives must go to its optimum: the
spline's at second order, from above, Hermite-Simpson's much faster. On the paper's lift

    N                     10       20       40       80      160
    spline J          870.67   835.41   822.51   818.70   817.66
    Hermite-Simpson   816.56   817.27   817.29   817.30   817.30

and extrapolated from the two finest meshes the spline's is 817.31. Zero acceleration at both ends (eq. 19) costs either
a ramp over one interval, and nothing in the limit, which both then approach at first order. Hermite-Simpson without
that demand is there on a coarse mesh already: the third witness.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from liftopt.collocation.motion import Motion, motion_at
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.solvers.result import SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.transfer import nearest
from liftopt.crosscheck.hermite_simpson import HermiteSimpson, Optimum, Points
from liftopt.crosscheck.instant import Coordinates
from liftopt.multibody.trajectory import AgentTrajectory, grasps_of
from liftopt.scenario.build import agents_of, motions_of, object_of, task_of
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.types import Array, Progress

MESHES = (10, 20, 40, 80, 160)
LIMIT_MESH = 20  # on which the limit is taken: on the paper's lift it is there to 3e-5
CLOSER = 0.6  # of the distance is left, at most, on half the step


@dataclass(frozen=True)
class MeshRow:
    """Both optima on one mesh.

    Attributes:
        intervals: N.
        spline: objective of the spline collocation, by its trapezoid rule.
        hermite_simpson: objective of the second transcription, by Simpson's rule.
        gap: largest distance of the grasp points at the middles of the second [m].
        seconds: wall time in IPOPT of the first and of the second [s].
        converged: whether IPOPT says so of both.
    """

    intervals: int
    spline: float
    hermite_simpson: float
    gap: float
    seconds: tuple[float, float]
    converged: bool

    @property
    def difference(self) -> float:
        """How much higher the spline's objective is, over the other."""
        return (self.spline - self.hermite_simpson) / self.hermite_simpson


@dataclass(frozen=True)
class MeshStudy:
    """The table of both optima.

    Attributes:
        rows: one a mesh, N doubling.
        limit: objective where the ends may accelerate, by Hermite-Simpson.
        order: at which the spline's objective converges, 1 or 2.
    """

    rows: tuple[MeshRow, ...]
    limit: float
    order: int

    @property
    def extrapolated(self) -> float:
        """The spline's objective in the limit of ever finer meshes, from the two finest (Richardson)."""
        coarse, fine = self.rows[-2:]
        return fine.spline - (coarse.spline - fine.spline) / float(2**self.order - 1)

    @property
    def approaching(self) -> bool:
        """Whether each doubling of N brings the optima together, to ``CLOSER`` of the difference before or less."""
        sizes = [abs(row.difference) for row in self.rows]
        return all(row.converged for row in self.rows) and all(
            fine <= CLOSER * coarse for coarse, fine in pairwise(sizes)
        )


def mesh_study(solution: Solution, meshes: Sequence[int] = MESHES, progress: Progress | None = None) -> MeshStudy:
    """Solve by both transcriptions on several meshes, each from the solution.

    Args:
        solution: where to start; the problem is that of its scenario.
        meshes: numbers of intervals, each twice the one before.
        progress: called with one line for each mesh.

    Raises:
        SolverError: IPOPT cannot run.
    """
    team = Team.of(agents_of(solution.scenario, solution.urdfs), object_of(solution.scenario, solution.urdfs))
    task, rows = task_of(solution.scenario), []
    still = solution.scenario.task.rest == "acceleration"
    for intervals in meshes:
        if progress:
            progress(f"two transcriptions on {intervals} intervals")
        problem, spline, found = spline_optimum(solution, team, intervals)
        motion = motion_at(problem, spline, found.x, np.linspace(0.0, 1.0, 2 * intervals + 1))
        second = HermiteSimpson(team.agents, team.object, task, intervals, still=still)
        optimum = second.solve(points_of(motion, second.at))
        rows.append(_row(found, optimum))
    limit = optimum
    if still:
        # From the finest optimum: on the way there both may have found a better basin.
        step = max(1, meshes[-1] // LIMIT_MESH)
        loose = HermiteSimpson(team.agents, team.object, task, meshes[-1] // step, still=False)
        limit = loose.solve(optimum.points.every(step))
    return MeshStudy(tuple(rows), limit.objective if limit.converged else np.nan, spline.order)


def spline_optimum(solution: Solution, team: Team, intervals: int) -> tuple[Problem, RestToRestSpline, SolverResult]:
    """Return the solve's own optimum on another mesh, started from the solution."""
    spline = motions_of(solution.scenario, intervals)
    problem = Problem(team, task_of(solution.scenario), spline.mesh())
    dense = resample(solution, max(4, 4 * intervals // solution.intervals))
    coordinates = np.hstack([*(agent.q[:, agent.moving] for agent in dense.agents), dense.object.pose])
    phase = dense.time / dense.time[-1]
    force = np.hstack([part for agent in solution.agents for part in _transmitted(agent)])
    start = nearest(problem, spline, phase, coordinates, force)
    return problem, spline, Ipopt(problem).solve(start, deadline=NEVER)


def points_of(motion: Motion, at: Coordinates) -> Points:
    """Return a motion at nodes and middles as the second transcription takes it."""

    def joints(kind: str) -> Array:
        return np.hstack([getattr(agent, kind)[:, agent.moving] for agent in motion.agents])

    lifted = motion.object
    return Points(
        at.select(joints("q"), lifted.pose),
        at.select(joints("v"), lifted.pose_velocity),
        at.select(joints("a"), lifted.pose_acceleration),
        np.hstack([agent.grasp_force.reshape(len(motion.time), -1) for agent in motion.agents]),
        np.hstack(
            [
                np.empty((len(motion.time), 0)),
                *(agent.grasp_moment[:, own] for _, agent, own, grasp in grasps_of(motion.agents) if grasp.moments),
            ]
        ),
        joints("tau"),
    )


def _transmitted(agent: AgentTrajectory) -> Iterator[Array]:
    """Give the force (K, 3) of each grasp, and its moment if it has one."""
    for own, grasp in enumerate(agent.grasps):
        yield agent.grasp_force[:, own]
        if grasp.moments:
            yield agent.grasp_moment[:, own]


def _row(found: SolverResult, optimum: Optimum) -> MeshRow:
    return MeshRow(
        optimum.intervals,
        found.objective,
        optimum.objective,
        optimum.middle_gap,
        (found.seconds, optimum.seconds),
        found.converged and optimum.converged,
    )


def render(study: MeshStudy) -> str:
    """Return the table as plain text and a verdict."""
    heads = f"{'N':>4} {'spline J':>11} {'Hermite-Simpson J':>18} {'difference':>11} {'gap [mm]':>10}"
    lines = [f"{heads} {'time [s]':>14}"]
    for row in study.rows:
        lines.append(
            f"{row.intervals:4d} {row.spline:11.3f} {row.hermite_simpson:18.3f} {row.difference:10.2%} "
            f"{1e3 * row.gap:10.4f} {row.seconds[0]:6.1f} {row.seconds[1]:7.1f}"
            + ("" if row.converged else "  not converged")
        )
    lines.append(f"In the limit J is {study.limit:.3f} by Hermite-Simpson, free to accelerate at the ends,")
    off = study.extrapolated / study.limit - 1
    lines.append(f"and {study.extrapolated:.3f} by the spline's two finest meshes, extrapolated: {off:+.3%}.")
    verdict = "The optima approach each other." if study.approaching else "The optima do NOT approach each other."
    return "\n".join([*lines, verdict])
