"""An optimum from one mesh to another, finer or coarser, as a start there: its motion and its multipliers.

The multiplier of a row at a time is about the multiplier of the continuous constraint times the step, so it is divided
by the width of time that its row stands for, interpolated, and multiplied by the new width. With the multipliers a
solver takes fewer iterations than from the motion alone, and seldom goes to another optimum (docs/tuning.md).
"""

from __future__ import annotations

import numpy as np

from liftopt.collocation.constraints import Block
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Multipliers
from liftopt.collocation.spline import Mesh, RestToRestSpline, interpolate_linear
from liftopt.types import Array

SAMPLES = 8  # an interval of the finer of two meshes


def transfer(problem: Problem, spline: RestToRestSpline, x: Array, other: Problem, onto: RestToRestSpline) -> Array:
    """Return the unknowns of ``other`` that move as ``x`` does; exact where the finer knots hold the coarser ones.

    Args:
        problem: what ``x`` (n_x,) belongs to.
        spline: its space of motions.
        x: a motion.
        other: the same team and task on another mesh.
        onto: its space of motions.
    """
    control, force = problem.unpack(x)
    phase = np.linspace(0.0, 1.0, SAMPLES * max(spline.intervals, onto.intervals) + 1)
    return nearest(other, onto, phase, spline.basis(phase) @ control, force)


def nearest(problem: Problem, spline: RestToRestSpline, phase: Array, coordinates: Array, force: Array) -> Array:
    """Return the unknowns (n_x,) nearest to a motion that is given by samples, in least squares and within the bounds.

    Args:
        problem: whose unknowns.
        spline: its space of motions.
        phase: (P,) of the samples.
        coordinates: (P, n) all moving joints and the object's six coordinates [rad, m].
        force: (K, 3 agents) grasp forces at uniform phases of their own, linear between them [N].
    """
    control = np.asarray(np.linalg.lstsq(spline.basis(phase), coordinates, rcond=None)[0], dtype=np.float64)
    return problem.pack(control, interpolate_linear(force, spline.phase))


def nearest_controls(problem: Problem, way: Array) -> Array:
    """Return the control points (B, n_free, n) nearest to motions that are given at the knots, within the bounds.

    Args:
        problem: whose control points.
        way: (K, B, n) all moving joints and the object's six coordinates [rad, m].
    """
    lower, upper = (bound[problem.layout.control] for bound in problem.bounds())
    control = np.einsum("ck,kbn->bcn", np.linalg.pinv(problem.mesh.basis[0]), way)
    return np.asarray(np.clip(control, lower, upper))


def transfer_multipliers(problem: Problem, multipliers: Multipliers, other: Problem) -> Multipliers:
    """Return the multipliers of one mesh on another, where they are about those of the same motion.

    Args:
        problem: what the multipliers belong to.
        multipliers: at an optimum of it.
        other: the same team and task on another mesh, or with other planes.
    """
    x, g = np.zeros(other.layout.n_x), np.zeros(other.constraints.linear.shape[0])
    known = {(block.name, block.who): block for block in problem.constraints.blocks}
    for two in other.constraints.blocks:
        if (one := known.get((two.name, two.who))) is None:  # rows between bodies that had none
            continue
        before = multipliers.g[one.rows].reshape(-1, len(one.labels))
        same = min(len(one.labels), len(two.labels))
        g[two.rows].reshape(-1, len(two.labels))[:, :same] = _spread(
            before[:, :same], _phases(problem.mesh, one), _phases(other.mesh, two)
        )
    control, force = problem.unpack(multipliers.x)
    x[other.layout.control] = _spread(control, problem.mesh.control_phase, other.mesh.control_phase)
    x[other.layout.force] = _spread(force, problem.mesh.phase, other.mesh.phase)
    return Multipliers(x, g, interpolated=True)


def _phases(mesh: Mesh, block: Block) -> Array:
    """Return when the rows of a block act."""
    if block.name == "velocity":
        return mesh.slope_phase
    return mesh.phase[mesh.closure_knots] if block.name == "grasp_closure" else mesh.phase


def _spread(values: Array, phase: Array, onto: Array) -> Array:
    """Return values (K, m) at ``phase`` (K,), each for a stretch of time, at ``onto`` (L,): the same density."""
    density = values / _widths(phase)[:, None]
    return np.stack([np.interp(onto, phase, column) for column in density.T], axis=1) * _widths(onto)[:, None]


def _widths(phase: Array) -> Array:
    return np.diff(np.concatenate([[0.0], (phase[1:] + phase[:-1]) / 2, [1.0]]))
