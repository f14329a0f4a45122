"""Postures that bring every grasp to the object, from many seeds at once, as the hands can hold it; without forces.

Levenberg's and Marquardt's method on the grasp gaps, in its dual form: the steps have the least norm, so a posture
stays near its seed, and the systems to solve are as small as the number of gaps. Joints at a limit that a step
would cross are kept there for that step. All is done by NumPy's own loops: a library of linear algebra rounds as the
processor has it, and its threads take longer to wake than such small systems to solve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.collocation.batch import Batch
from liftopt.collocation.layout import FORCE_SIZE, OBJECT_SIZE
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.types import Array

CLOSED = 1e-6  # [m]
# A seed that is not closed by then seldom closes.
CLOSING_ITERATIONS = 20
# From one knot to the next along a path.
FOLLOWING_ITERATIONS = 2
LONGEST_STEP = 0.6  # [rad]
DAMPING, EASE, TIGHTEN, STUCK = 1e-3, 0.2, 8.0, 1e6
# Damping falls no lower: two stretched arms leave the gaps nearly dependent.
LEAST_DAMPING = 1e-9
# An iteration that gains less than this share of the squared gaps is the last.
STALLED = 1e-9


@dataclass(frozen=True)
class Reach:
    """How near the grasps come from each of B seeds.

    Attributes:
        coordinates: (B, n) joints of every agent, then the object's six coordinates.
        gaps: (B, grasps) distance left between each grasp and its point on the object [m].
        outside: (B, grasps) how far each grasp is outside its half-space [m]; 0 where there is none.
        twisted: (B, grasps) how far the cosine of each hand's angle on the object is below that of its limit; 0 where
            there is none.
    """

    coordinates: Array
    gaps: Array
    outside: Array
    twisted: Array

    @property
    def shortfall(self) -> Array:
        """(B,) the largest of what is missing [m, 1]."""
        return np.asarray(np.max([self.gaps, self.outside, self.twisted], axis=(0, 2)))


class InverseKinematics:
    """Inverse kinematics of a team, on a problem of one knot at rest."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        blocks = problem.constraints.blocks
        names = [grasp.name for grasp in problem.team.grasps]
        closure = [np.arange(b.rows.start, b.rows.stop) for b in blocks if b.name == "grasp_closure"]
        workspace = [b for name in ("workspace", "grasp_turn") for b in blocks if b.name == name]
        self._kept = [names.index(b.who) + len(names) * (b.name == "grasp_turn") for b in workspace]
        self._offset = np.array([float(b.lower[0]) for b in workspace])
        self._n_closure = FORCE_SIZE * len(closure)
        rows = np.concatenate([*closure, *(np.arange(b.rows.start, b.rows.stop) for b in workspace)])
        self._batch = Batch(problem, rows)
        self._columns = problem.layout.control[0]
        free = problem.at_pose(np.full(OBJECT_SIZE, np.nan)).bounds()
        self._anywhere = tuple(bound[self._columns] for bound in free)

    def reach(
        self,
        pose: Array,
        seeds: Array,
        deadline: Deadline,
        *,
        most: int,
        any_angle: bool = False,
        anywhere: bool = False,
    ) -> Reach:
        """Bring all grasps as near as possible.

        Args:
            pose: of the object, (6,) or one for each seed (B, 6); NaN leaves a coordinate free within the task's range.
            seeds: (B, n) coordinates to start from.
            deadline: past which it returns what it has.
            most: iterations.
            any_angle: leave out the joints' ranges of motion.
            anywhere: leave out the half-spaces and the limits on the hands' angles.
        """
        lower, upper = self._bounds(np.broadcast_to(pose, (len(seeds), OBJECT_SIZE)), any_angle)
        x = np.zeros((len(seeds), self.problem.layout.n_x))
        x[:, self._columns] = np.clip(seeds, lower, upper)
        damping, left = np.full(len(x), DAMPING), self._left(x, anywhere)
        todo = np.arange(len(x))
        for _ in range(most):
            todo = todo[(np.abs(left[todo]).max(axis=1) > CLOSED / 10) & (damping[todo] < STUCK)]
            if not len(todo) or deadline.passed:
                break
            trial = x[todo]
            here = trial[:, self._columns]
            slopes = self._batch.slopes(trial)[:, :, self._columns] * (left[todo] != 0)[:, :, None]
            step = _least_norm_step(slopes, left[todo], damping[todo], here - lower[todo], upper[todo] - here)
            trial[:, self._columns] = np.clip(here + step, lower[todo], upper[todo])
            after = self._left(trial, anywhere)
            was, now = (left[todo] ** 2).sum(axis=1), (after**2).sum(axis=1)
            better = now < was
            x[todo[better]], left[todo[better]] = trial[better], after[better]
            damping[todo] = np.where(better, np.maximum(EASE * damping[todo], LEAST_DAMPING), TIGHTEN * damping[todo])
            damping[todo[better & (was - now < STALLED * was)]] = STUCK
        gaps = np.linalg.norm(left[:, : self._n_closure].reshape(len(x), -1, FORCE_SIZE), axis=2)
        beyond = np.zeros((len(x), 2 * gaps.shape[1]))
        beyond[:, self._kept] = -self._left(x, False)[:, self._n_closure :]
        return Reach(x[:, self._columns], gaps, *np.split(beyond, 2, axis=1))

    def _left(self, x: Array, anywhere: bool) -> Array:
        """Return the vectors between grasps and by how much (negative) one-sided rows are missed; 0 where they hold."""
        left = self._batch.rows(x)
        kept = left[:, self._n_closure :]
        kept[:] = 0.0 if anywhere else np.minimum(0.0, kept - self._offset)
        return left

    def _bounds(self, pose: Array, any_angle: bool) -> tuple[Array, Array]:
        """Return lower and upper bounds (B, n) with the object at ``pose`` (B, 6), NaN where it is free."""
        lower, upper = (np.tile(bound, (len(pose), 1)) for bound in self._anywhere)
        for bound in (lower, upper):
            bound[:, -OBJECT_SIZE:] = np.where(np.isnan(pose), bound[:, -OBJECT_SIZE:], pose)
        if any_angle:
            lower[:, :-OBJECT_SIZE], upper[:, :-OBJECT_SIZE] = -np.pi, np.pi
        return lower, upper


def _solved_each(systems: Array, right: Array) -> Array:
    """Return the solutions (B, m) of positive definite ``systems`` (B, m, m), by Gaussian elimination in order."""
    matrix, x = systems.copy(), right.copy()
    size = x.shape[1]
    for k in range(size):
        factors = matrix[:, k + 1 :, k] / matrix[:, k, None, k]
        matrix[:, k + 1 :, k:] -= factors[:, :, None] * matrix[:, None, k, k:]
        x[:, k + 1 :] -= factors * x[:, k, None]
    for k in reversed(range(size)):
        x[:, k] /= matrix[:, k, k]
        x[:, :k] -= matrix[:, :k, k] * x[:, k, None]
    return x


def _least_norm_step(slopes: Array, left: Array, damping: Array, below: Array, above: Array) -> Array:
    """Return the damped step (B, n) of least norm that closes ``left``, within the room ``below`` and ``above``."""
    free, size = (below + above > 0).astype(float), left.shape[1]
    # Rows that do not count have no slopes: their equations become 0 = 0.
    off = np.where((slopes == 0).all(axis=2), 1.0, damping[:, None])
    step = np.zeros_like(below)
    for _ in range(2):
        movable = slopes * free[:, None, :]
        system = np.einsum("bij,bkj->bik", movable, slopes)
        system[:, range(size), range(size)] += off
        step = -np.einsum("bij,bi->bj", movable, _solved_each(system, left))
        crossing = (free > 0) & (((below <= 0) & (step < 0)) | ((above <= 0) & (step > 0)))
        if not crossing.any():
            break
        free[crossing] = 0.0
    longest = np.abs(step).max(axis=1, keepdims=True)
    return np.asarray(step * np.minimum(1.0, LONGEST_STEP / np.maximum(longest, CLOSED)))
