"""How an optimum moves with its problem: the first-order conditions differentiated by a parameter.

At an optimum (x, lambda) of a problem that depends on a parameter p the conditions

    grad_x L(x, lambda, p) = 0,    g_i(x, p) - b_i(p) = 0 of the active rows,    x_j - b_j(p) = 0 of the active bounds

hold in p, so their total derivative vanishes: the KKT matrix times (dx/dp, dlambda/dp) is minus their partial
derivative by p (Fiacco 1983, Introduction to Sensitivity and Stability Analysis in Nonlinear Programming, chapter 3).
The active set is not picked: what an interior point holds at the optimum is kept, ``multiplier x slack`` of every
inequality, whose derivative adds ``-slack / |multiplier|`` on the diagonal: next to nothing for an active row, and so
much for an inactive one that its multiplier stays nought (Pirnay, Lopez-Negrete and Biegler 2012, Optimal sensitivity
based on IPOPT). Where both are small the active set is about to change; ``Tangent.reach`` says how near.

Partial derivatives by p are central differences of whole problems, built anew on both sides of p, so that a parameter
may enter anywhere: in models, limits, scales of rows, poses or time.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from liftopt.collocation.kkt import FirstOrder, first_order
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.result import Multipliers
from liftopt.collocation.task import OBJECT_COORDINATES
from liftopt.types import Array

LOOSE = 1e12  # slack over multiplier where there is no multiplier at all
LEAST_LOOSE = 1e-9  # of all rows where some depend on others


@dataclass(frozen=True)
class Tangent:
    """Derivatives of an optimum by one parameter p.

    Attributes:
        x: (n_x,) dx/dp.
        multipliers: dlambda/dp.
        objective: dJ/dp by the envelope theorem: the partial derivative of the Lagrangian.
        reach: change of p, up or down, at which a limit that is not active would become so or one that is would not,
            as far as the tangent tells; beyond it slopes change.
        limit: which one, in words; empty if there is none.
    """

    x: Array
    multipliers: Multipliers
    objective: float
    reach: float
    limit: str


@dataclass(frozen=True, eq=False)
class Optimum:
    """A problem's optimum and the KKT matrix there.

    Attributes:
        problem: what was solved.
        x, multipliers: the optimum.
    """

    problem: Problem
    x: Array
    multipliers: Multipliers

    def tangent(self, before: Problem, after: Problem, step: float) -> Tangent:
        """Return how the optimum moves with a parameter.

        Args:
            before: the problem at p - step.
            after: the problem at p + step, of the same structure.
            step: of the central difference, in the unit of p.
        """
        below, above = (first_order(problem, self.x, self.multipliers) for problem in (before, after))
        bound = (self._bounds(after) - self._bounds(before)) / (2 * step)
        gradient, g = (above.gradient - below.gradient) / (2 * step), (above.g - below.g) / (2 * step)
        n_g = len(g)
        # A problem's bounds move as its rows do.
        rows = np.concatenate([g, np.zeros(len(self.x))]) - bound
        dx, dlam = np.split(self._factors.solve(-np.concatenate([gradient, rows])), [len(self.x)])
        slope = (above.objective - below.objective) / (2 * step) + float(self._lam @ rows)
        moved = np.concatenate([g + self._jacobian @ dx, dx]) - bound
        return Tangent(dx, Multipliers(dlam[n_g:], dlam[:n_g]), slope, *self._reach(moved, dlam))

    @cached_property
    def _lam(self) -> Array:
        return np.concatenate([self.multipliers.g, self.multipliers.x])

    @cached_property
    def _first_order(self) -> FirstOrder:
        return first_order(self.problem, self.x, self.multipliers)

    def _limits(self, problem: Problem) -> tuple[Array, Array]:
        """Return lower and upper bounds of all rows, then of all unknowns."""
        lower, upper = problem.bounds()
        constraints = problem.constraints
        return np.concatenate([constraints.lower, lower]), np.concatenate([constraints.upper, upper])

    def _bounds(self, problem: Problem) -> Array:
        """Return the bound that each row and unknown is held to by its multiplier; 0 where there is none."""
        lower, upper = self._limits(problem)
        bound = np.where(self._lam < 0, lower, upper)
        return np.where(np.isfinite(bound), bound, 0.0)

    @cached_property
    def _slack(self) -> Array:
        """Distance to that bound; 0 of an equality, infinite where there is no bound."""
        lower, upper = self._limits(self.problem)
        values = np.concatenate([self._first_order.g, self.x])
        slack = np.maximum(np.where(self._lam < 0, values - lower, upper - values), 0.0)
        return np.where(upper > lower, slack, 0.0)

    @cached_property
    def _jacobian(self) -> sp.csc_matrix:
        return _matrix(self.problem.nlp.jac_g(self.x, self.problem.parameters)[1])

    @cached_property
    def _factors(self) -> Any:
        from scipy.sparse.linalg import splu

        nlp, n = self.problem.nlp, len(self.x)
        upper = _matrix(nlp.hess_lag(self.x, self.problem.parameters, 1.0, self.multipliers.g))
        hessian = upper + sp.triu(upper, 1).T
        slope = sp.vstack([self._jacobian, sp.identity(n)])
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(self._slack > 0, self._slack / np.abs(self._lam), 0.0)
        loose = np.minimum(ratio, LOOSE)
        try:
            return splu(_kkt_matrix(hessian, slope, loose))
        except RuntimeError:  # rows that say the same, as the grasps of two hands on one body may
            return splu(_kkt_matrix(hessian, slope, np.maximum(loose, LEAST_LOOSE)))

    def _reach(self, moved: Array, dlam: Array) -> tuple[float, str]:
        """Return the change at which the first limit changes sides, from the rates of values off bounds, and which."""
        active = np.abs(self._lam) > self._slack
        lower, upper = self._limits(self.problem)
        values, rates = np.where(active, self._lam, self._slack), np.where(active, dlam, moved)
        inequality = np.flatnonzero((upper > lower) & np.isfinite(values) & (rates != 0))
        if not len(inequality):
            return np.inf, ""
        changes = np.abs(values[inequality] / rates[inequality])
        first = int(np.argmin(changes))
        return float(changes[first]), self._name(int(inequality[first]))

    def _name(self, row: int) -> str:
        """Return what a row, or an unknown counted after all rows, is."""
        for block in self.problem.constraints.blocks:
            if block.rows.start <= row < block.rows.stop:
                label = block.labels[(row - block.rows.start) % len(block.labels)]
                who = "" if label.startswith(block.who) else f"{block.who} "
                return f"{block.name.replace('_', ' ')} of {who}{label}"
        layout, team = self.problem.layout, self.problem.team
        _, column = np.nonzero(layout.control == row - len(self.multipliers.g))
        names = [joint for agent in team.agents for joint in agent.moving_joints]
        names += [f"{team.object.name} {c}" for c in OBJECT_COORDINATES]
        return f"position of {names[column[0]]}" if len(column) else "a component of a grasp force"


def _kkt_matrix(hessian: sp.spmatrix, slope: sp.spmatrix, loose: Array) -> sp.csc_matrix:
    return sp.csc_matrix(sp.bmat([[hessian, slope.T], [slope, -sp.diags(loose)]]))


def _matrix(found: Any) -> sp.csc_matrix:
    """Return a CasADi matrix as SciPy's."""
    sparsity = found.sparsity()
    data = (np.array(found.nonzeros()), np.array(sparsity.row()), np.array(sparsity.colind()))
    return sp.csc_matrix(data, shape=found.shape)
