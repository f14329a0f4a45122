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
TIED = {"velocity": 2, "acceleration": 3}  # control points that are equal at each end
SPACES = [RestToRestSpline(n, rest) for n in SIZES for rest in TIED]


def full_spline(space: RestToRestSpline, free: np.ndarray) -> BSpline:
    """Return SciPy's clamped cubic spline with the first and the last control points equal, two or three."""
    knots = np.concatenate([np.zeros(3), np.arange(space.intervals + 1) / space.intervals, np.ones(3)])
    more = TIED[space.rest] - 1
    return BSpline(knots, np.concatenate([free[:1]] * more + [free] + [free[-1:]] * more), 3)


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_basis_is_scipys_spline_of_the_tied_control_points(space: RestToRestSpline, rng: np.random.Generator) -> None:
    n, free = space.intervals, rng.normal(size=(space.n_free, 3))
    spline = full_spline(space, free)
    for order in range(3):
        expected = spline(FINE) if order == 0 else spline.derivative(order)(FINE)
        np.testing.assert_allclose(space.basis(FINE, order) @ free, expected, atol=1e-11 * n**order)


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_partition_of_unity_and_sign(space: RestToRestSpline) -> None:
    """Closed form: a B-spline basis is non-negative and sums to one; its derivatives sum to zero."""
    values = space.basis(FINE)
    np.testing.assert_allclose(values.sum(axis=1), 1.0, atol=1e-14)
    assert values.min() >= 0.0
    for order in (1, 2):
        np.testing.assert_allclose(space.basis(FINE, order).sum(axis=1), 0.0, atol=1e-10)


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_derivatives_by_finite_differences(space: RestToRestSpline) -> None:
    n, inside, h = space.intervals, np.linspace(0.03, 0.97, 53), 1e-5
    first = (space.basis(inside + h) - space.basis(inside - h)) / (2 * h)
    second = (space.basis(inside + h, 1) - space.basis(inside - h, 1)) / (2 * h)
    np.testing.assert_allclose(space.basis(inside, 1), first, atol=1e-6)
    np.testing.assert_allclose(space.basis(inside, 2), second, atol=n**3 * 3 * h)


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_rest_at_both_ends(space: RestToRestSpline) -> None:
    """Eq. 19: zero velocity, and acceleration if asked, at both ends, which are the first and last control points."""
    ends = np.array([0.0, 1.0])
    assert not space.basis(ends, 1).any()
    still = bool(np.abs(space.basis(ends, 2)).max() < 1e-9)
    assert still is (space.rest == "acceleration")
    np.testing.assert_allclose(space.basis(ends), np.eye(space.n_free)[[0, -1]], atol=1e-14)


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_acceleration_is_linear_between_knots_and_continuous(space: RestToRestSpline, rng: np.random.Generator) -> None:
    """Linear interpolation of the knots' accelerations, and SciPy's C2 cubic through the knots, give the motion."""
    free = rng.normal(size=space.n_free)
    at_knots = space.basis(space.phase, 2) @ free
    np.testing.assert_allclose(space.basis(FINE, 2) @ free, np.interp(FINE, space.phase, at_knots), atol=1e-9)
    through = CubicSpline(space.phase, space.basis(space.phase) @ free, bc_type="clamped")
    np.testing.assert_allclose(space.basis(FINE) @ free, through(FINE), atol=1e-12)


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_sizes_knots_quadrature(space: RestToRestSpline) -> None:
    """Closed forms: uniform knots; the trapezoid rule is exact for a linear function."""
    n = space.intervals
    np.testing.assert_allclose(np.diff(space.phase), 1.0 / n, atol=1e-15)
    assert (space.n_knots, space.n_free) == (n + 1, n + 5 - 2 * TIED[space.rest])
    assert space.phase[0] == 0.0 and space.phase[-1] == 1.0
    np.testing.assert_allclose([space.quadrature.sum(), space.quadrature @ space.phase], [1.0, 0.5], atol=1e-15)
    assert space.basis(space.phase).shape == (n + 1, space.n_free)


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_greville_abscissae(space: RestToRestSpline) -> None:
    """Closed form: ends at 0 and 1, increasing, and inner ones at the peak of their uniform basis function."""
    assert space.greville[0] == 0.0 and space.greville[-1] == 1.0
    assert (np.diff(space.greville) > 0).all()
    inner = slice(2, -2)
    peaks = FINE[space.basis(FINE).argmax(axis=0)]
    np.testing.assert_allclose(space.greville[inner], peaks[inner], atol=1e-3)


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_closure_is_square_and_well_conditioned(space: RestToRestSpline) -> None:
    """As many closure knots as free control points; all ends included; the collocation matrix is regular."""
    n, knots = space.intervals, space.closure_knots
    left_out = {1, n - 1} if space.rest == "acceleration" else set()
    assert len(knots) == space.n_free and set(knots.tolist()) == set(range(n + 1)) - left_out
    assert np.linalg.cond(space.basis(space.phase[knots])) < 10.0


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_slope_is_scipys_derivative_control_points(space: RestToRestSpline, rng: np.random.Generator) -> None:
    free, tied = rng.normal(size=space.n_free), TIED[space.rest] - 1
    expected = full_spline(space, free).derivative().c[tied : space.intervals + 2 - tied]
    np.testing.assert_allclose(space.slope @ free, expected, rtol=1e-12, atol=1e-12)


@given(
    space=st.builds(RestToRestSpline, st.integers(6, 24), st.sampled_from(list(TIED))),
    data=st.data(),
)
def test_slope_hull_bounds_the_speed(space: RestToRestSpline, data: st.DataObject) -> None:
    """Property of B-splines: between any two phases the derivative stays in the hull of its control points and 0."""
    n, free = space.intervals, data.draw(arrays(np.float64, space.n_free, elements=st.floats(-10.0, 10.0, width=32)))
    hull, speed = space.slope @ free, space.basis(FINE, 1) @ free
    slack = 1e-11 * n * max(1.0, float(np.abs(free).max()))
    assert speed.max() <= max(hull.max(), 0.0) + slack
    assert speed.min() >= min(hull.min(), 0.0) - slack


@given(space=st.builds(RestToRestSpline, st.integers(6, 24), st.sampled_from(list(TIED))), data=st.data())
def test_motion_stays_in_the_hull_of_its_control_points(space: RestToRestSpline, data: st.DataObject) -> None:
    """Property of B-splines, on which limits at all times rest."""
    free = data.draw(arrays(np.float64, space.n_free, elements=st.floats(-10.0, 10.0, width=32)))
    motion = space.basis(FINE) @ free
    assert free.min() - 1e-12 <= motion.min() and motion.max() <= free.max() + 1e-12


def test_mesh_states_the_space() -> None:
    space = RestToRestSpline(9)
    mesh = space.mesh()
    for order, values in enumerate(mesh.basis):
        np.testing.assert_array_equal(values, space.basis(space.phase, order))
    np.testing.assert_array_equal(mesh.control_phase, space.greville)
    np.testing.assert_array_equal(mesh.slope, space.slope)
    assert len(mesh.slope_phase) == len(mesh.slope)
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
