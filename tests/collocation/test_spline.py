"""The spline space: SciPy's B-splines, closed forms and finite differences are the oracles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.interpolate import BSpline, CubicSpline

from liftopt.collocation.spline import Mesh, RestToRestSpline, interpolate_linear

FINE = np.linspace(0.0, 1.0, 1001)
SIZES = (6, 8, 20)


def full_spline(intervals: int, free: np.ndarray) -> BSpline:
    """Return SciPy's clamped cubic spline with the first and the last three control points equal."""
    knots = np.concatenate([np.zeros(3), np.arange(intervals + 1) / intervals, np.ones(3)])
    control = np.concatenate([free[:1], free[:1], free, free[-1:], free[-1:]])
    return BSpline(knots, control, 3)


@pytest.mark.parametrize("n", SIZES)
def test_basis_is_scipys_spline_of_the_tied_control_points(n: int, rng: np.random.Generator) -> None:
    space, free = RestToRestSpline(n), rng.normal(size=(n - 1, 3))
    spline = full_spline(n, free)
    for order in range(3):
        expected = spline(FINE) if order == 0 else spline.derivative(order)(FINE)
        np.testing.assert_allclose(space.basis(FINE, order) @ free, expected, atol=1e-11 * n**order)


@pytest.mark.parametrize("n", SIZES)
def test_partition_of_unity_and_sign(n: int) -> None:
    """Closed form: a B-spline basis is non-negative and sums to one; its derivatives sum to zero."""
    space = RestToRestSpline(n)
    values = space.basis(FINE)
    np.testing.assert_allclose(values.sum(axis=1), 1.0, atol=1e-14)
    assert values.min() >= 0.0
    for order in (1, 2):
        np.testing.assert_allclose(space.basis(FINE, order).sum(axis=1), 0.0, atol=1e-10)


@pytest.mark.parametrize("n", SIZES)
def test_derivatives_by_finite_differences(n: int) -> None:
    space, inside, h = RestToRestSpline(n), np.linspace(0.03, 0.97, 53), 1e-5
    first = (space.basis(inside + h) - space.basis(inside - h)) / (2 * h)
    second = (space.basis(inside + h, 1) - space.basis(inside - h, 1)) / (2 * h)
    np.testing.assert_allclose(space.basis(inside, 1), first, atol=1e-6)
    np.testing.assert_allclose(space.basis(inside, 2), second, atol=n**3 * 3 * h)


@pytest.mark.parametrize("n", SIZES)
def test_rest_at_both_ends(n: int) -> None:
    """Eq. 19: zero velocity and acceleration at both ends, and the ends are the first and last control points."""
    space, ends = RestToRestSpline(n), np.array([0.0, 1.0])
    assert not space.basis(ends, 1).any()
    np.testing.assert_allclose(space.basis(ends, 2), 0.0, atol=1e-9)
    np.testing.assert_allclose(space.basis(ends), np.eye(n - 1)[[0, -1]], atol=1e-14)


@pytest.mark.parametrize("n", SIZES)
def test_acceleration_is_linear_between_knots_and_continuous(n: int, rng: np.random.Generator) -> None:
    """Linear interpolation of the knots' accelerations, and SciPy's C2 cubic through the knots, give the motion."""
    space, free = RestToRestSpline(n), rng.normal(size=n - 1)
    at_knots = space.basis(space.phase, 2) @ free
    np.testing.assert_allclose(space.basis(FINE, 2) @ free, np.interp(FINE, space.phase, at_knots), atol=1e-9)
    through = CubicSpline(space.phase, space.basis(space.phase) @ free, bc_type="clamped")
    np.testing.assert_allclose(space.basis(FINE) @ free, through(FINE), atol=1e-12)


@pytest.mark.parametrize("n", SIZES)
def test_sizes_knots_quadrature(n: int) -> None:
    """Closed forms: uniform knots; the trapezoid rule is exact for a linear function."""
    space = RestToRestSpline(n)
    np.testing.assert_allclose(np.diff(space.phase), 1.0 / n, atol=1e-15)
    assert (space.n_knots, space.n_free) == (n + 1, n - 1)
    assert space.phase[0] == 0.0 and space.phase[-1] == 1.0
    np.testing.assert_allclose([space.quadrature.sum(), space.quadrature @ space.phase], [1.0, 0.5], atol=1e-15)
    assert space.basis(space.phase).shape == (n + 1, n - 1)


@pytest.mark.parametrize("n", SIZES)
def test_greville_abscissae(n: int) -> None:
    """Closed form: ends at 0 and 1, increasing, and inner ones at the peak of their uniform basis function."""
    space = RestToRestSpline(n)
    assert space.greville[0] == 0.0 and space.greville[-1] == 1.0
    assert (np.diff(space.greville) > 0).all()
    inner = slice(2, -2)
    peaks = FINE[space.basis(FINE).argmax(axis=0)]
    np.testing.assert_allclose(space.greville[inner], peaks[inner], atol=1e-3)


@pytest.mark.parametrize("n", SIZES)
def test_closure_is_square_and_well_conditioned(n: int) -> None:
    """As many closure knots as free control points; all ends included; the collocation matrix is regular."""
    space = RestToRestSpline(n)
    knots = space.closure_knots
    assert len(knots) == space.n_free and {0, n} <= set(knots.tolist()) and not {1, n - 1} & set(knots.tolist())
    assert np.linalg.cond(space.basis(space.phase[knots])) < 10.0


@pytest.mark.parametrize("n", SIZES)
def test_slope_is_scipys_derivative_control_points(n: int, rng: np.random.Generator) -> None:
    space, free = RestToRestSpline(n), rng.normal(size=n - 1)
    expected = full_spline(n, free).derivative().c[2 : n + 2 - 2]
    np.testing.assert_allclose(space.slope @ free, expected, rtol=1e-12, atol=1e-12)


@given(
    n=st.integers(6, 24),
    data=st.data(),
)
def test_slope_hull_bounds_the_speed(n: int, data: st.DataObject) -> None:
    """Property of B-splines: between any two phases the derivative stays in the hull of its control points and 0."""
    free = data.draw(arrays(np.float64, n - 1, elements=st.floats(-10.0, 10.0, width=32)))
    space = RestToRestSpline(n)
    hull, speed = space.slope @ free, space.basis(FINE, 1) @ free
    slack = 1e-11 * n * max(1.0, float(np.abs(free).max()))
    assert speed.max() <= max(hull.max(), 0.0) + slack
    assert speed.min() >= min(hull.min(), 0.0) - slack


@given(n=st.integers(6, 24), data=st.data())
def test_motion_stays_in_the_hull_of_its_control_points(n: int, data: st.DataObject) -> None:
    """Property of B-splines, on which limits at all times rest."""
    free = data.draw(arrays(np.float64, n - 1, elements=st.floats(-10.0, 10.0, width=32)))
    motion = RestToRestSpline(n).basis(FINE) @ free
    assert free.min() - 1e-12 <= motion.min() and motion.max() <= free.max() + 1e-12


def test_mesh_states_the_space(rng: np.random.Generator) -> None:
    space = RestToRestSpline(9)
    mesh = space.mesh()
    for order, values in enumerate(mesh.basis):
        np.testing.assert_array_equal(values, space.basis(space.phase, order))
    np.testing.assert_array_equal(mesh.control_phase, space.greville)
    np.testing.assert_array_equal(mesh.slope, space.slope)
    # What is outside a basis function's support is exactly zero: at most three functions act at a knot.
    assert max(np.count_nonzero(row) for row in mesh.basis[0]) == 3


def test_mesh_of_a_posture_does_not_move() -> None:
    mesh = Mesh.at_rest()
    value, slope, curve = mesh.basis
    assert value.shape == (1, 1) and value[0, 0] == 1.0 and not slope.any() and not curve.any()
    assert mesh.weights.sum() == 1.0 and mesh.slope.shape == (0, 1)


def test_linear_interpolation_is_numpys(rng: np.random.Generator) -> None:
    values, phase = rng.normal(size=(5, 2)), rng.uniform(size=11)
    expected = [np.interp(phase, [0.0, 0.25, 0.5, 0.75, 1.0], column) for column in values.T]
    np.testing.assert_allclose(interpolate_linear(values, phase), np.transpose(expected), atol=1e-15)
