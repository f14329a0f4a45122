"""From knot kernels to the functions an NLP solver calls: objective, constraints, and their exact derivatives.

Every agent and the object is a ``Part`` whose knot variables are linear in the unknowns, ``y = S x``. The kernels map
them to outputs c; all outputs stacked are C, and

    f = sum_parts sum_k w_k (c_weight . c_k**2 + y_weight . y_k**2)
    g = G C(x) + A x.

So the multipliers of the kernels are ``G^T lambda`` plus those of the squares, and every nonzero of the Jacobian and
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
from liftopt.collocation.scatter import Pattern, hessian_pattern, jacobian_pattern
from liftopt.types import Array


@dataclass(frozen=True)
class Part:
    """One agent or the object in the NLP.

    Attributes:
        kernel: its functions at a knot.
        select: (K n_y, n_x) map from the unknowns to its knot variables, knot by knot.
    """

    kernel: Kernel
    select: sp.csc_matrix


@dataclass(frozen=True)
class PartParameters:
    """Values that may change between solves of one NLP.

    Attributes:
        kernel: (n_p,) the period T, then the model's entries.
        c_weight: (n_squared,) weights of the squared leading outputs in the objective.
        y_weight: (n_y,) weights of the squared knot variables in the objective.
    """

    kernel: Array
    c_weight: Array
    y_weight: Array


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
    return np.concatenate([np.concatenate([q.kernel, q.c_weight, q.y_weight]) for q in parameters])


def assemble(parts: Sequence[Part], weights: Array, combine: sp.csc_matrix, linear: sp.csc_matrix) -> Nlp:
    """Assemble the NLP of the module's docstring.

    Args:
        parts: agents and object.
        weights: (K,) quadrature weights w_k.
        combine: G, (n_g, sum of K n_c).
        linear: A, (n_g, n_x).
    """
    sizes = [[part.kernel.n_p, part.kernel.n_squared, part.kernel.n_y] for part in parts]
    x, p = ca.MX.sym("x", linear.shape[1]), ca.MX.sym("p", int(np.sum(sizes)))
    sigma, lam = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", linear.shape[0])
    given = ca.vertsplit(p, np.cumsum([0, *np.ravel(sizes)]).tolist())
    pieces = [_Piece(part, x, given[3 * i : 3 * i + 3], weights) for i, part in enumerate(parts)]

    f: Any = sum(piece.objective() for piece in pieces)
    g = ca.mtimes(constant(combine), ca.vertcat(*(ca.vec(piece.c) for piece in pieces)))
    g = ca.densify(g + ca.mtimes(constant(linear), x))  # a row may have no entry
    gradient: Any = sum(piece.gradient() for piece in pieces)
    slopes = jacobian_pattern(
        [part.kernel.jacobian.sparsity_out(0) for part in parts], [p.select for p in parts], weights, combine, linear
    )
    jacobian = _fill(slopes, [piece.slopes() for piece in pieces])
    pulls = ca.vertsplit(ca.mtimes(constant(combine).T, lam), np.cumsum([0, *(s.c.numel() for s in pieces)]).tolist())
    triangles = [[part.kernel.curvature.sparsity_out(0), part.kernel.squares.sparsity_out(0)] for part in parts]
    curvatures = hessian_pattern(triangles, [part.select for part in parts], weights)
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
        self.kernel, self.knots, self.w = part.kernel, len(weights), ca.DM(weights).T
        p_kernel, self.c_weight, self.y_weight = given
        self.select = constant(part.select)
        self.y = ca.reshape(ca.mtimes(self.select, x), self.kernel.n_y, self.knots)
        self.p = ca.repmat(p_kernel, 1, self.knots)
        self.c = self.kernel.value.map(self.knots)(self.y, self.p)

    def objective(self) -> Any:
        """Return this part's share of f."""
        squares = ca.mtimes(self.y_weight.T, self.y**2)
        if self.kernel.n_squared:
            squares += ca.mtimes(self.c_weight.T, self.c[: self.kernel.n_squared, :] ** 2)
        return ca.mtimes(squares, self.w.T)

    def pull(self) -> Any:
        """Return the derivative (n_c, K) of f by the outputs."""
        n, rest = self.kernel.n_squared, self.kernel.n_c - self.kernel.n_squared
        squared = 2 * ca.mtimes(self.c_weight, self.w) * self.c[:n, :] if n else ca.MX(0, self.knots)
        return ca.vertcat(squared, ca.DM.zeros(rest, self.knots))

    def gradient(self) -> Any:
        """Return this part's share of the gradient of f (n_x,)."""
        by_y = 2 * ca.mtimes(self.y_weight, self.w) * self.y
        if self.kernel.n_squared:
            by_y += self.kernel.gradient.map(self.knots)(self.y, self.p, self.pull())
        return ca.mtimes(self.select.T, ca.vec(by_y))

    def slopes(self) -> Any:
        """Return the nonzeros of the Jacobian of the outputs, knot by knot."""
        return ca.densify(self.kernel.jacobian.map(self.knots)(self.y, self.p).nz[:])

    def curvatures(self, sigma: Any, m: Any) -> Any:
        """Return the nonzeros by y of the curvatures, then of the squares, then the diagonal of the squared y."""
        multipliers = ca.reshape(m, self.kernel.n_c, self.knots) + sigma * self.pull()
        curved = self.kernel.curvature.map(self.knots)(self.y, self.p, multipliers)
        nonzeros = [ca.densify(curved.nz[:])]
        if self.kernel.n_squared:
            weights = 2 * sigma * ca.mtimes(self.c_weight, self.w)
            slopes = self.kernel.jacobian.map(self.knots)(self.y, self.p)
            nonzeros.append(ca.densify(self.kernel.squares.map(self.knots)(slopes, weights).nz[:]))
        return ca.vertcat(*nonzeros, 2 * sigma * self.y_weight)


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
