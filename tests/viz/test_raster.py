"""Pictures without a browser, from the inside: pixels against rays that meet triangles, cameras against their rays."""

from __future__ import annotations

import numpy as np
import pytest

from liftopt.viz.camera import Camera, in_perspective, straight
from liftopt.viz.raster import NOTHING, rasterize
from liftopt.viz.scene_mesh import ball, block
from liftopt.viz.shading import Body, render

LOW, HIGH = np.array([-0.4, -0.3, 0.1]), np.array([0.5, 0.4, 1.6])
SIDES = ((0.0, -1.0, 0.0), (0.5, -1.0, 0.4), (-1.0, 0.2, 0.1), (0.0, -0.001, 1.0), (0.0, 0.0, 1.0))
SIZE = (64, 48)


@pytest.fixture(params=[straight, in_perspective], ids=["straight", "perspective"])
def make(request: pytest.FixtureRequest) -> object:
    return request.param


def _triangles() -> np.ndarray:
    random = np.random.default_rng(5)
    middle = random.uniform(LOW, HIGH, (40, 3))
    return np.asarray(middle[:, None] + random.uniform(-0.25, 0.25, (40, 3, 3)))


def _met(start: np.ndarray, look: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return how far along a ray each triangle is met (Moeller and Trumbore, 1997), infinite where it is not."""
    a, e, f = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    p = np.cross(look, f)
    determinant = np.einsum("mi,mi->m", e, p)
    t = start - a
    u = np.einsum("mi,mi->m", t, p) / determinant
    q = np.cross(t, e)
    v = q @ look / determinant
    along = np.einsum("mi,mi->m", f, q) / determinant
    return np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (along > 0), along, np.inf)


@pytest.mark.parametrize("side", SIDES)
def test_each_pixel_shows_the_triangle_that_its_ray_meets_first(make: object, side: tuple[float, float, float]) -> None:
    camera: Camera = make(side, LOW, HIGH, SIZE)  # type: ignore[operator]
    triangles = _triangles()
    seen = rasterize(camera.project(triangles), SIZE, both_sides=True)
    start, look = camera.rays(SIZE)
    shown = 0
    for row in range(SIZE[1]):
        for column in range(SIZE[0]):
            along = _met(start[row, column], look[row, column], triangles)
            found = seen.triangle[row, column]
            if found == NOTHING:
                assert not np.isfinite(along).any()
                continue
            shown += 1
            assert along[found] == pytest.approx(along.min(), abs=1e-9)
            point = seen.weights[row, column] @ triangles[found]
            if not camera.perspective:  # with it, weights are those on the screen
                np.testing.assert_allclose(point, start[row, column] + along[found] * look[row, column], atol=1e-9)
    assert shown > 100


@pytest.mark.parametrize("side", SIDES)
def test_a_camera_has_the_box_in_view_and_as_large_as_that_goes(make: object, side: tuple[float, float, float]) -> None:
    camera: Camera = make(side, LOW, HIGH, SIZE)  # type: ignore[operator]
    corners = np.array([[(LOW, HIGH)[(i >> k) & 1][k] for k in range(3)] for i in range(8)])
    at = camera.project(corners)[:, :2]
    assert np.all((at > -1e-3) & (at < np.array(SIZE) + 1e-3))
    touched = np.minimum(at, np.array(SIZE) - at).min(axis=0)
    assert touched.min() < 0.5  # one pair of edges is touched
    up = camera.project(np.array([[0.0, 0.0, 0.5], [0.0, 0.0, 0.6]]))
    if abs(side[2]) < 0.9:
        assert up[1, 1] < up[0, 1]  # what is higher is higher on the picture


def test_only_what_turns_its_front_to_the_camera_is_seen() -> None:
    camera = straight((0.0, -1.0, 0.0), LOW, HIGH, SIZE)
    mesh = block((0.0, 0.0, 0.8), (0.4, 0.4, 0.4))
    corners = mesh.vertices[mesh.triangles]
    seen = rasterize(camera.project(corners), SIZE)
    inside_out = rasterize(camera.project(corners[:, ::-1]), SIZE)
    assert seen.depth[np.isfinite(seen.depth)].mean() < inside_out.depth[np.isfinite(inside_out.depth)].mean() - 0.3
    np.testing.assert_array_equal(seen.triangle == NOTHING, inside_out.triangle == NOTHING)


def test_a_ball_is_as_large_as_it_is_and_casts_a_shadow_on_the_floor() -> None:
    camera = straight((0.0, -1.0, 0.6), np.array([-1.0, -1.0, 0.0]), np.array([1.0, 1.0, 1.0]), (200, 150))
    red = Body(ball((0.0, 0.0, 0.6), (0.3, 0.3, 0.3)), (0.9, 0.05, 0.05))
    bare, image = render([], camera, (200, 150)).astype(int), render([red], camera, (200, 150)).astype(int)
    assert image.shape == (150, 200, 3)
    ball_seen = image[..., 0] > 1.5 * image[..., 1]
    assert ball_seen.sum() == pytest.approx(np.pi * (0.3 * camera.scale) ** 2, rel=0.06)
    darker = (bare - image).mean(axis=2) > 15
    assert np.count_nonzero(darker & ~ball_seen) > 300
    np.testing.assert_array_equal(image, render([red], camera, (200, 150)).astype(int))


def test_what_is_see_through_or_on_top_lets_others_be_seen() -> None:
    camera = straight((0.0, -1.0, 0.0), np.array([-1.0, -1.0, 0.0]), np.array([1.0, 1.0, 1.0]), (100, 60))
    behind = Body(ball((0.0, 0.5, 0.5), (0.2, 0.2, 0.2)), (0.9, 0.0, 0.0))
    wall = block((0.0, -0.5, 0.5), (1.0, 0.1, 0.9))
    middle = (30, 50)
    hidden, through, over = (
        render(bodies, camera, (100, 60))[middle].astype(float)
        for bodies in (
            [behind, Body(wall, (0.0, 0.0, 0.9))],
            [behind, Body(wall, (0.0, 0.0, 0.9), opacity=0.5)],
            [Body(behind.mesh, behind.colour, on_top=True), Body(wall, (0.0, 0.0, 0.9))],
        )
    )
    assert hidden[0] < 60 < hidden[2]
    assert min(through[0], through[2]) > 60
    assert over[2] < 60 < over[0]
