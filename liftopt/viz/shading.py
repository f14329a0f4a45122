"""Light and shadow on what a camera sees: bodies on a floor under a soft sky and one sun."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter

from liftopt.multibody.trajectory import cross
from liftopt.types import Array
from liftopt.viz.camera import Camera, straight
from liftopt.viz.raster import NOTHING, Fragments, rasterize
from liftopt.viz.scene_mesh import Mesh
from liftopt.viz.scene_part import Colour

Image = npt.NDArray[np.uint8]
SUN = np.array([-0.75, -1.2, -0.55])  # where it stands as the camera sees it: to the left, up, behind the camera
SKY, BOUNCE, DIRECT, FILL = 0.46, 0.20, 0.62, 0.16  # strengths of light from above, below, the sun and across from it
FLOOR, HORIZON, ZENITH = np.array([0.87, 0.88, 0.89]), np.array([0.955, 0.965, 0.975]), np.array([0.86, 0.90, 0.95])
HAZE = (5.0, 16.0)  # the floor fades into the horizon between these distances from the middle of what is seen [m]
FINER = 2  # pixels a side that are made into one
SHADOW_PIXELS, SOFT, BIAS = (
    1024,
    (-2, 0, 2),
    0.012,
)  # of the sun's view: its size, softness [pixels], and what is no shadow [m]
CELL, LIFTED, DARK = 0.01, 0.10, 0.62  # under what is near the floor: cell [m], height at which it fades [m], how dark


@dataclass(frozen=True)
class Body:
    """One mesh where it is in the world.

    Attributes:
        mesh: its vertices in world coordinates [m].
        colour: red, green, blue in [0, 1].
        opacity: below 1 it is see-through.
        on_top: of all that hides it.
        shadow: whether it casts one; what is see-through or on top casts none.
    """

    mesh: Mesh
    colour: Colour
    opacity: float = 1.0
    on_top: bool = False
    shadow: bool = True


def render(bodies: Sequence[Body], camera: Camera, size: tuple[int, int]) -> Image:
    """Return a picture (H, W, 3) of that width and height of bodies on the floor z = 0."""
    fine, lens = (FINER * size[0], FINER * size[1]), camera.larger(FINER)
    solid = [body for body in bodies if body.opacity >= 1.0 and not body.on_top]
    light = _Light.of([body for body in solid if body.shadow], SUN @ camera.axes)
    colour, ahead = (np.repeat(np.repeat(one, FINER, 0), FINER, 1) for one in _backdrop(camera, size, light))
    for layer in (solid, [body for body in bodies if body.opacity < 1.0 and not body.on_top]):
        for group in _by_opacity(layer):
            colour, ahead = _drawn(group, lens, fine, light, colour, ahead)
    for group in _by_opacity([body for body in bodies if body.on_top]):
        colour, _ = _drawn(group, lens, fine, None, colour, np.full_like(ahead, np.inf))
    height, width = size[1], size[0]
    coarse = colour.reshape(height, FINER, width, FINER, 3).mean(axis=(1, 3))
    return np.asarray(np.round(255.0 * np.clip(coarse, 0.0, 1.0)), dtype=np.uint8)


def _by_opacity(bodies: Sequence[Body]) -> list[list[Body]]:
    return [[body for body in bodies if body.opacity == value] for value in sorted({b.opacity for b in bodies})[::-1]]


@dataclass(frozen=True)
class _Soup:
    """All triangles of some bodies: corners and their normals (m, 3, 3), and a colour each (m, 3)."""

    corners: Array
    normals: Array
    colours: Array

    @staticmethod
    def of(bodies: Sequence[Body]) -> _Soup:
        corners, normals, colours = [np.zeros((0, 3, 3))], [np.zeros((0, 3, 3))], [np.zeros((0, 3))]
        for body in bodies:
            triangles = body.mesh.triangles
            corners.append(body.mesh.vertices[triangles])
            normals.append(_normals(body.mesh)[triangles])
            colours.append(np.tile(np.array(body.colour), (len(triangles), 1)))
        return _Soup(np.concatenate(corners), np.concatenate(normals), np.concatenate(colours))


@dataclass(frozen=True)
class _Light:
    """The sun's camera and how far it sees at each pixel; how dark the floor is, by cells from a corner."""

    sun: Camera
    reach: Array
    corner: Array
    dark: Array

    @staticmethod
    def of(bodies: Sequence[Body], toward: Array) -> _Light:
        corners = np.concatenate([np.zeros((0, 3, 3)), *(body.mesh.vertices[body.mesh.triangles] for body in bodies)])
        points = corners.reshape(-1, 3) if len(corners) else np.zeros((1, 3))
        low, high = points.min(axis=0) - 0.1, points.max(axis=0) + 0.1
        size = (SHADOW_PIXELS, SHADOW_PIXELS)
        sun = straight(toward, low, high, size)
        reach = rasterize(sun.project(corners), size).depth
        cells = tuple(np.maximum(np.ceil((high - low)[:2] / CELL), 1).astype(int).tolist())
        # Upwards from the floor: x and y as they are, the depth is the height.
        seen = (corners - [low[0], low[1], 0.0]) / [CELL, CELL, 1.0]
        height = rasterize(seen, (cells[0], cells[1]), both_sides=True).depth
        dark = gaussian_filter(np.exp(-np.maximum(height, 0.0) / LIFTED * 2.0), 2.2, mode="constant")
        return _Light(sun, reach, low[:2], dark)

    def lit(self, points: Array) -> Array:
        """Return how much of the sun reaches ``points`` (..., 3), 0 to 1."""
        seen = self.sun.project(points)
        column, row = (np.clip(seen[..., i].astype(int), 0, SHADOW_PIXELS - 1) for i in (0, 1))
        free = np.zeros(points.shape[:-1])
        for dx, dy in product(SOFT, SOFT):
            at = np.clip(row + dy, 0, SHADOW_PIXELS - 1) * SHADOW_PIXELS + np.clip(column + dx, 0, SHADOW_PIXELS - 1)
            free += seen[..., 2] < self.reach.take(at) + BIAS
        return free / len(SOFT) ** 2

    def under(self, points: Array) -> Array:
        """Return how much of the sky reaches ``points`` (..., 3) of the floor under what is near it, 0 to 1."""
        cell = np.floor((points[..., :2] - self.corner) / CELL).astype(int)
        rows, columns = self.dark.shape
        inside = (cell >= 0).all(axis=-1) & (cell[..., 0] < columns) & (cell[..., 1] < rows)
        row, column = np.clip(cell[..., 1], 0, rows - 1), np.clip(cell[..., 0], 0, columns - 1)
        return 1.0 - DARK * np.where(inside, self.dark[row, column], 0.0)


def _backdrop(camera: Camera, size: tuple[int, int], light: _Light) -> tuple[Array, Array]:
    """Return colour (H, W, 3) and distance ahead (H, W) of floor and sky."""
    start, look = camera.rays(size)
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = -start[..., 2] / look[..., 2]
    floor = np.isfinite(ahead) & (ahead > 0.0) & (look[..., 2] < -1e-6)
    ahead = np.where(floor, ahead, np.inf)
    climb = np.clip(look[..., 2:] / np.linalg.norm(look, axis=-1, keepdims=True) / 0.5, 0.0, 1.0)
    colour = HORIZON + climb * (ZENITH - HORIZON)
    points = start[floor] + ahead[floor][:, None] * look[floor]
    middle = light.corner + CELL * np.array(light.dark.shape[::-1]) / 2.0
    away = np.linalg.norm(points[:, :2] - middle, axis=1)
    haze = np.clip((away - HAZE[0]) / (HAZE[1] - HAZE[0]), 0.0, 1.0)[:, None]
    shade = ((SKY + 0.14) * light.under(points) + (0.40) * (0.35 + 0.65 * light.lit(points)))[:, None]
    colour[floor] = haze * HORIZON + (1.0 - haze) * FLOOR * shade
    return colour, ahead


def _drawn(
    bodies: Sequence[Body], camera: Camera, size: tuple[int, int], light: _Light | None, colour: Array, ahead: Array
) -> tuple[Array, Array]:
    """Return colour and distance ahead with bodies of one opacity drawn over them where they are nearer."""
    soup = _Soup.of(bodies)
    fragments = rasterize(camera.project(soup.corners), size)
    distance = -1.0 / np.minimum(fragments.depth, -1e-9) if camera.perspective else fragments.depth
    seen = (fragments.triangle != NOTHING) & (distance < ahead)
    if not seen.any():
        return colour, ahead
    sun = SUN @ camera.axes / np.linalg.norm(SUN)
    start, look = camera.rays(size)
    points = start[seen] + distance[seen][:, None] * look[seen]
    shaded = _shaded(soup, fragments, seen, points, look[seen], sun, light)
    opacity = bodies[0].opacity
    colour, ahead = colour.copy(), ahead.copy()
    colour[seen] = opacity * shaded + (1.0 - opacity) * colour[seen]
    if opacity >= 1.0:
        ahead[seen] = distance[seen]
    return colour, ahead


def _shaded(
    soup: _Soup, fragments: Fragments, seen: npt.NDArray[np.bool_], points: Array, look: Array, sun: Array,
    light: _Light | None,
) -> Array:  # fmt: skip
    """Return the colours (P, 3) of what is seen at ``points`` (P, 3)."""
    triangle, weights = fragments.triangle[seen], fragments.weights[seen]
    normal = np.einsum("pi,pij->pj", weights, soup.normals[triangle])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
    facing = np.clip(normal @ sun, 0.0, 1.0)
    free = np.ones(len(points)) if light is None else light.lit(points + 0.006 * normal)
    up = 0.5 + 0.5 * normal[:, 2]
    across = np.clip(normal @ (sun * [-1.0, -1.0, 0.3]), 0.0, 1.0)
    near_floor = 1.0 if light is None else 1.0 - 0.35 * np.exp(-np.maximum(points[:, 2], 0.0) / 0.06)
    strength = (SKY * up + BOUNCE * (1.0 - up)) * near_floor + DIRECT * facing * free + FILL * across
    eye = -look / np.linalg.norm(look, axis=1, keepdims=True)
    half = sun + eye
    half /= np.maximum(np.linalg.norm(half, axis=1, keepdims=True), 1e-9)
    gloss = 0.10 * free * np.clip(np.einsum("pi,pi->p", normal, half), 0.0, 1.0) ** 24
    rim = 0.10 * (1.0 - np.clip(np.einsum("pi,pi->p", normal, eye), 0.0, 1.0)) ** 3
    return np.asarray(soup.colours[triangle] * strength[:, None] * 1.08 + (gloss + rim)[:, None])


def _normals(mesh: Mesh) -> Array:
    """Return unit normals (n, 3) at the vertices, by the areas around them."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    flat = cross(b - a, c - a)
    normals = np.zeros_like(mesh.vertices)
    for i in range(3):
        np.add.at(normals, mesh.triangles[:, i], flat)
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12))
