"""From knot kernels to the functions an NLP solver calls: objective, constraints, and their exact derivatives.

Every agent and the object is a ``Part`` whose knot variables are linear in the unknowns, ``y = S x``. The kernels map
them to outputs c; all outputs stacked are C, and

    f = sum_parts sum_k w_k (c_weight . c_k**2 + y_weight . y_k**2 + range(y_k))
    g = G C(x) + A x,

where c_weight is that of the side of zero on which each output is, and range a polynomial of each leading knot variable
(``objective.Weights``).

The multipliers of the kernels are ``G^T lambda`` plus those of the squares, and every nonzero of the Jacobian and
of the Hessian is a fixed linear combination of what the kernels return: one sparse product scatters it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import scipy.sparse as sp

from liftopt.collocation.codegen.kernels import Kernel
from liftopt.collocation.objective import RANGE_ROWS, Weights
from liftopt.collocation.scatter import Pattern, hessian_pattern, jacobian_pattern
from liftopt.types import Array


@dataclass(frozen=True)
class Part:
    """One agent or the object in the NLP.

    Attributes:
        kernel: its functions at a knot.
        select: (K n_y, n_x) map from the unknowns to its knot variables, knot by knot.
        n_range: number of leading knot variables whose range counts in the objective.
    """

    kernel: Kernel
    select: sp.csc_matrix
    n_range: int = 0

    @property
    def sizes(self) -> tuple[int, ...]:
        """Numbers of its parameters in the NLP's vector, in the order of ``pack``."""
        kernel = self.kernel
        return kernel.n_p, kernel.n_squared, kernel.n_squared, kernel.n_y, RANGE_ROWS * self.n_range

    @property
    def triangles(self) -> tuple[Any, Any, Any]:
        """Sparsities by knot variables of the curvature, of the squares of outputs and of what ranges cost."""
        kernel, leading = self.kernel, list(range(self.n_range))
        diagonal = ca.Sparsity.triplet(kernel.n_y, kernel.n_y, leading, leading)
        return kernel.curvature.sparsity_out(0), kernel.squares.sparsity_out(0), diagonal


@dataclass(frozen=True)
class PartParameters:
    """Values that may change between solves of one NLP.

    Attributes:
        kernel: (n_p,) the period T, then the model's entries.
        weights: in the objective.
    """

    kernel: Array
    weights: Weights

    @property
    def pieces(self) -> tuple[Array, ...]:
        """In the order of ``Part.sizes``."""
        weights = self.weights
        return self.kernel, weights.above, weights.below, weights.variable, weights.range.ravel()


@dataclass(frozen=True)
class Nlp:
    """An assembled NLP in the form CasADi's ``nlpsol`` takes, x (n_x,), parameters p, constraints g (n_g,).

    Attributes:
        x, p, f, g: the symbols and expressions.
        grad_f: (x, p) -> (f, gradient).
        jac_g: (x, p) -> (g, Jacobian).
        hess_lag: (x, p, lam_f, lam_g) -> upper triangle of the Hessian of the Lagrangian.
    """

    x: Any
    p: Any
    f: Any
    g: Any
    grad_f: Any
    jac_g: Any
    hess_lag: Any


def pack(parameters: Sequence[PartParameters]) -> Array:
    """Return the NLP's parameter vector."""
    return np.concatenate([piece for q in parameters for piece in q.pieces])


def assemble(parts: Sequence[Part], weights: Array, combine: sp.csc_matrix, linear: sp.csc_matrix) -> Nlp:
    """Assemble the NLP of the module's docstring.

    Args:
        parts: agents and object.
        weights: (K,) quadrature weights w_k.
        combine: G, (n_g, sum of K n_c).
        linear: A, (n_g, n_x).
    """
    sizes = np.array([part.sizes for part in parts])
    x, p = ca.MX.sym("x", linear.shape[1]), ca.MX.sym("p", int(np.sum(sizes)))
    sigma, lam = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", linear.shape[0])
    given = ca.vertsplit(p, np.cumsum([0, *np.ravel(sizes)]).tolist())
    each = sizes.shape[1]
    pieces = [_Piece(part, x, given[each * i : each * (i + 1)], weights) for i, part in enumerate(parts)]

    f: Any = sum(piece.objective() for piece in pieces)
    g = ca.mtimes(constant(combine), ca.vertcat(*(ca.vec(piece.c) for piece in pieces)))
    g = ca.densify(g + ca.mtimes(constant(linear), x))  # a row may have no entry
    gradient: Any = sum(piece.gradient() for piece in pieces)
    slopes = jacobian_pattern(
        [part.kernel.jacobian.sparsity_out(0) for part in parts], [p.select for p in parts], weights, combine, linear
    )
    jacobian = _fill(slopes, [piece.slopes() for piece in pieces])
    pulls = ca.vertsplit(ca.mtimes(constant(combine).T, lam), np.cumsum([0, *(s.c.numel() for s in pieces)]).tolist())
    curvatures = hessian_pattern([part.triangles for part in parts], [part.select for part in parts], weights)
    hessian = _fill(curvatures, [piece.curvatures(sigma, m) for piece, m in zip(pieces, pulls, strict=True)])
    return Nlp(
        x, p, f, g,
        grad_f=ca.Function("nlp_grad_f", [x, p], [f, gradient], ["x", "p"], ["f", "grad_f_x"]),
        jac_g=ca.Function("nlp_jac_g", [x, p], [g, jacobian], ["x", "p"], ["g", "jac_g_x"]),
        hess_lag=ca.Function("nlp_hess_l", [x, p, sigma, lam], [hessian],
                             ["x", "p", "lam_f", "lam_g"], ["triu_hess_gamma_x_x"]),
    )  # fmt: skip


class _Piece:
    """What one part adds to the NLP, as expressions of x."""

    def __init__(self, part: Part, x: Any, given: Sequence[Any], weights: Array) -> None:
        self.kernel, self.knots, self.w, self.n_range = part.kernel, len(weights), ca.DM(weights).T, part.n_range
        p_kernel, above, below, self.y_weight, ranges = given
        self.select = constant(part.select)
        self.y = ca.reshape(ca.mtimes(self.select, x), self.kernel.n_y, self.knots)
        self.p = ca.repmat(p_kernel, 1, self.knots)
        self.c = self.kernel.value.map(self.knots)(self.y, self.p)
        self.c_weight = self._by_side(self.c[: self.kernel.n_squared, :], above, below)
        self.ranges = ca.vertsplit(ranges, self.n_range) if self.n_range else []

    def objective(self) -> Any:
        """Return this part's share of f."""
        squares = ca.mtimes(self.y_weight.T, self.y**2)
        if n := self.kernel.n_squared:
            squares += ca.sum1(self.c_weight * self.c[:n, :] ** 2)
        if self.n_range:
            away, square, fourth = self._away()
            squares += ca.sum1((square + fourth * away**2) * away**2)
        return ca.mtimes(squares, self.w.T)

    def pull(self) -> Any:
        """Return the derivative (n_c, K) of f by the outputs."""
        n, rest = self.kernel.n_squared, self.kernel.n_c - self.kernel.n_squared
        squared = 2 * self._weighted(self.c_weight) * self.c[:n, :] if n else ca.MX(0, self.knots)
        return ca.vertcat(squared, ca.DM.zeros(rest, self.knots))

    def gradient(self) -> Any:
        """Return this part's share of the gradient of f (n_x,)."""
        by_y = 2 * ca.mtimes(self.y_weight, self.w) * self.y
        if self.kernel.n_squared:
            by_y += self.kernel.gradient.map(self.knots)(self.y, self.p, self.pull())
        if n := self.n_range:
            away, square, fourth = self._away()
            by_range = self._weighted((2 * square + 4 * fourth * away**2) * away)
            by_y = ca.vertcat(by_y[:n, :] + by_range, by_y[n:, :])
        return ca.mtimes(self.select.T, ca.vec(by_y))

    def slopes(self) -> Any:
        """Return the nonzeros of the Jacobian of the outputs, knot by knot."""
        return ca.densify(self.kernel.jacobian.map(self.knots)(self.y, self.p).nz[:])

    def curvatures(self, sigma: Any, m: Any) -> Any:
        """Return the nonzeros by y of ``Part.triangles``, then the diagonal of the squared y."""
        multipliers = ca.reshape(m, self.kernel.n_c, self.knots) + sigma * self.pull()
        curved = self.kernel.curvature.map(self.knots)(self.y, self.p, multipliers)
        nonzeros = [ca.densify(curved.nz[:])]
        if self.kernel.n_squared:
            weights = 2 * sigma * self._weighted(self.c_weight)
            slopes = self.kernel.jacobian.map(self.knots)(self.y, self.p)
            nonzeros.append(ca.densify(self.kernel.squares.map(self.knots)(slopes, weights).nz[:]))
        if self.n_range:
            away, square, fourth = self._away()
            nonzeros.append(ca.vec(sigma * self._weighted(2 * square + 12 * fourth * away**2)))
        return ca.vertcat(*nonzeros, 2 * sigma * self.y_weight)

    def _away(self) -> tuple[Any, Any, Any]:
        """Return how far leading knot variables are from neutral, and their factors of squares and fourth powers."""
        neutral, *factors = self.ranges
        away = self.y[: self.n_range, :] - ca.repmat(neutral, 1, self.knots)
        square, fourth = (self._by_side(away, factors[i + 1], factors[i]) for i in (0, 2))
        return away, square, fourth

    def _by_side(self, values: Any, above: Any, below: Any) -> Any:
        """Return the weights (n, K) of values (n, K): ``above`` (n,) where they are above zero, else ``below``."""
        return ca.if_else(values > 0, ca.repmat(above, 1, self.knots), ca.repmat(below, 1, self.knots))

    def _weighted(self, values: Any) -> Any:
        """Return values (n, K) times the quadrature weights of their knots."""
        return values * ca.repmat(self.w, values.size1(), 1)


def constant(matrix: sp.csc_matrix) -> Any:
    """Return a SciPy matrix as a CasADi constant, with its sparsity and no stored zeros."""
    matrix = sp.csc_matrix(matrix)
    matrix.sum_duplicates()
    matrix.sort_indices()
    matrix.eliminate_zeros()
    return ca.DM(to_sparsity(matrix), matrix.data)


def _fill(pattern: Pattern, values: Sequence[Any]) -> Any:
    """Return the sparse matrix whose nonzeros are ``scatter @ values + offset``."""
    nonzeros = ca.mtimes(constant(pattern.scatter), ca.vertcat(*values)) + ca.DM(pattern.offset)
    return ca.MX(to_sparsity(pattern.shape), ca.densify(nonzeros))


def to_sparsity(matrix: sp.csc_matrix) -> Any:
    """Return the sparsity of a SciPy matrix, whose data have no meaning."""
    rows, columns = matrix.shape
    return ca.Sparsity(rows, columns, matrix.indptr.tolist(), matrix.indices.tolist())
