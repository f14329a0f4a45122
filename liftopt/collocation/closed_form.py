"""Knot functions whose derivatives are known in closed form, of whatever makes them on CasADi symbols."""

from __future__ import annotations

from typing import Any, Protocol

from liftopt.collocation.dynamics import KnotFunctions


class ClosedForm(Protocol):
    """Symbols of a knot, ``y``, ``p`` and ``m`` as of ``KnotFunctions``, and what they make.

    Attributes:
        squared: number of the leading outputs that may enter an objective squared.
    """

    y: Any
    p: Any
    m: Any
    squared: int

    def value(self) -> Any:
        """Return the outputs."""

    def gradient(self) -> Any:
        """Return the slopes of the weighted sum of the outputs."""

    def jacobian(self) -> Any:
        """Return the slopes of the outputs."""

    def curvature(self) -> Any:
        """Return the upper triangle of the second derivatives of the weighted sum of the outputs."""


def closed_form_functions(knot: ClosedForm) -> KnotFunctions:
    """Return the functions of a knot."""
    import casadi as ca

    y, p, m, slopes = knot.y, knot.p, knot.m, knot.jacobian()
    leading, d = ca.SX.sym("slopes", slopes.sparsity()), ca.SX.sym("d", knot.squared)
    rows = leading[: knot.squared, :]
    squares = ca.mtimes(rows.T, ca.repmat(d, 1, y.shape[0]) * rows)
    return KnotFunctions(
        value=ca.Function("value", [y, p], ca.cse([ca.densify(knot.value())])),
        gradient=ca.Function("gradient", [y, p, m], ca.cse([ca.densify(knot.gradient())])),
        jacobian=ca.Function("jacobian", [y, p], ca.cse([slopes])),
        curvature=ca.Function("curvature", [y, p, m], ca.cse([knot.curvature()])),
        squares=ca.Function("squares", [leading, d], [ca.triu(squares)]),
    )
