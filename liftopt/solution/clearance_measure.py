"""How far bodies keep apart over a motion, measured by coal where cheap bounds cannot tell."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import coal
import numpy as np

from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.coal_shape import coal_shape
from liftopt.multibody.poses import joint_placements, object_placements
from liftopt.multibody.solid_pairs import SolidPair
from liftopt.multibody.trajectory import AgentTrajectory, ObjectTrajectory
from liftopt.solution.clearance import Clearance, KindClearance, PairClearance
from liftopt.solution.clearance_bounds import Indices, PlacedSolids, sphere_bounds, tight_bounds
from liftopt.types import Array

Agents = Sequence[tuple[Agent, AgentTrajectory]]
Lifted = tuple[LiftedObject, ObjectTrajectory]
NEAR = 0.05  # [m]


def measure_clearance(
    time: Array, agents: Agents, lifted: Lifted, pairs: Sequence[SolidPair], near: float = NEAR
) -> Clearance:
    """Return how far all pairs keep apart at K times.

    Args:
        time: (K,) [s].
        agents: every agent and its motion at these times.
        lifted: the object and its motion.
        pairs: that must keep apart; see ``solid_pairs``.
        near: of every pair that comes nearer the smallest distance is told [m].
    """
    pairs = sorted(pairs, key=lambda pair: pair.kind)
    placed, one, other = _placed(len(time), agents, lifted, pairs)
    names, first, kind_of = np.unique([pair.kind for pair in pairs], return_index=True, return_inverse=True)
    below, above = sphere_bounds(placed, one, other)
    most = np.minimum.reduceat(above, first, axis=0)  # (kinds, K)
    pair, k = np.nonzero((below <= most[kind_of]) | (below < near))
    lower = np.maximum(tight_bounds(placed, one[pair], other[pair], k), below[pair, k])
    ask = _Coal(placed, one, other)
    kinds = []
    for i, name in enumerate(names):
        distance, nearest, points = _over_time(ask, *_of_kind(kind_of[pair] == i, pair, k, lower), len(time))
        speed = _relative_speed(placed, one[nearest], other[nearest], points, time)
        kinds.append(KindClearance(str(name), distance, nearest, points, speed))
    closest = {item.pair: item for item in _closest(ask, pairs, pair, k, lower, time, near)}
    for kind in kinds:  # where nothing of it comes near
        at = int(np.argmin(kind.distance))
        leading = pairs[kind.pair[at]]
        closest.setdefault(leading, PairClearance(leading, float(kind.distance[at]), float(time[at]), kind.points[at]))
    return Clearance(time, tuple(pairs), tuple(kinds), tuple(sorted(closest.values(), key=lambda item: item.distance)))


def pairs_nearby(
    time: Array, agents: Agents, lifted: Lifted, pairs: Sequence[SolidPair], near: float = NEAR
) -> tuple[PairClearance, ...]:
    """Return how near those pairs come that come nearer than ``near`` [m]; other arguments as ``measure_clearance``."""
    placed, one, other = _placed(len(time), agents, lifted, pairs)
    below, _ = sphere_bounds(placed, one, other)
    pair, k = np.nonzero(below < near)
    lower = np.maximum(tight_bounds(placed, one[pair], other[pair], k), below[pair, k])
    return tuple(_closest(_Coal(placed, one, other), pairs, pair, k, lower, time, near))


class _Coal:
    """Distances by coal of single pairs at single times, each asked once."""

    def __init__(self, placed: PlacedSolids, one: Indices, other: Indices) -> None:
        self._placed, self._one, self._other = placed, one.tolist(), other.tolist()
        self._shapes = [coal_shape(solid) for solid in placed.solids]
        self._measures: dict[int, coal.ComputeDistance] = {}
        self._places: dict[tuple[int, int], coal.Transform3s] = {}
        self._known: dict[tuple[int, int], tuple[float, Array, Array]] = {}
        self._request, self._result = coal.DistanceRequest(), coal.DistanceResult()
        self._request.enable_signed_distance = True

    def __call__(self, pair: int, k: int) -> tuple[float, Array, Array]:
        """Return the signed distance of a pair at a time [m], and its closest points (3,) in the world."""
        known = self._known.get((pair, k))
        if known is None:
            one, other, result = self._one[pair], self._other[pair], self._result
            if pair not in self._measures:
                self._measures[pair] = coal.ComputeDistance(self._shapes[one], self._shapes[other])
            result.clear()
            apart = self._measures[pair](self._place(one, k), self._place(other, k), self._request, result)
            known = self._known[pair, k] = apart, result.getNearestPoint1(), result.getNearestPoint2()
        return known

    def _place(self, solid: int, k: int) -> coal.Transform3s:
        place = self._places.get((solid, k))
        if place is None:
            place = coal.Transform3s(self._placed.rotation[solid, k], self._placed.position[solid, k])
            self._places[solid, k] = place
        return place


def _over_time(ask: _Coal, pair: Indices, k: Indices, lower: Array, count: int) -> tuple[Array, Indices, Array]:
    """Return the smallest distance (K,) at every time, of which pair (K,), and its closest points (K, 2, 3).

    The pair of the smallest bound is asked first, until no bound is smaller.
    """
    distance, nearest = [np.inf] * count, [0] * count
    for row, at, bound in zip(pair.tolist(), k.tolist(), lower.tolist(), strict=True):
        if bound < distance[at] and (apart := ask(row, at)[0]) < distance[at]:
            distance[at], nearest[at] = apart, row
    points = [ask(row, at)[1:] for at, row in enumerate(nearest)]
    return np.array(distance), np.array(nearest), np.array(points)


def _relative_speed(placed: PlacedSolids, one: Indices, other: Indices, points: Array, time: Array) -> Array:
    """Return the relative speed (K,) of the closest points, each fixed to its solid, by central differences [m/s]."""
    k = np.arange(len(time))
    before, after = np.maximum(k - 1, 0), np.minimum(k + 1, len(time) - 1)
    velocity = []
    for solid, point in ((one, points[:, 0]), (other, points[:, 1])):
        own = np.einsum("kji,kj->ki", placed.rotation[solid, k], point - placed.position[solid, k])
        ahead, behind = (
            np.einsum("kij,kj->ki", placed.rotation[solid, at], own) + placed.position[solid, at]
            for at in (after, before)
        )
        velocity.append((ahead - behind) / (time[after] - time[before])[:, None])
    return np.asarray(np.linalg.norm(velocity[0] - velocity[1], axis=1))


def _of_kind(rows: Array, pair: Indices, k: Indices, lower: Array) -> tuple[Indices, Indices, Array]:
    order = np.flatnonzero(rows)
    order = order[np.argsort(lower[order], kind="stable")]
    return pair[order], k[order], lower[order]


def _closest(
    ask: _Coal, pairs: Sequence[SolidPair], pair: Indices, k: Indices, lower: Array, time: Array, near: float = NEAR
) -> Iterator[PairClearance]:
    """Give where each pair comes nearest that comes nearer than ``near``: its smallest bound is asked first."""
    order = np.flatnonzero(lower < near)
    if not len(order):
        return
    order = order[np.lexsort((lower[order], pair[order]))]
    rows, starts = np.unique(pair[order], return_index=True)
    for row, own in zip(rows.tolist(), np.split(order, starts[1:])[: len(rows)], strict=True):
        best, at = np.inf, 0
        for moment, bound in zip(k[own].tolist(), lower[own].tolist(), strict=True):
            if bound >= best:
                break
            if (apart := ask(row, moment)[0]) < best:
                best, at = apart, moment
        if best < near:
            yield PairClearance(pairs[row], float(best), float(time[at]), np.array(ask(row, at)[1:]))


def _placed(
    count: int, agents: Agents, lifted: Lifted, pairs: Sequence[SolidPair]
) -> tuple[PlacedSolids, Indices, Indices]:
    """Return all solids of the pairs over time, and which of them each pair has."""
    solids = {id(solid): solid for pair in pairs for solid in (pair.one, pair.other)}
    index = {key: i for i, key in enumerate(solids)}
    joints = {lifted[0].name: {1: object_placements(lifted[1].pose)}}
    for agent, motion in agents:
        own = sorted({solid.joint for solid in solids.values() if solid.owner == agent.name} - {0})
        found = joint_placements(agent.reduced(), motion.q[:, motion.moving], own)
        joints[agent.name] = {joint: found[:, n] for n, joint in enumerate(own)}
    world = np.broadcast_to(np.eye(4), (count, 4, 4))
    places = np.stack([
        joints.get(solid.owner, {}).get(solid.joint, world) @ solid.T_joint_solid for solid in solids.values()
    ])  # fmt: skip
    placed = PlacedSolids(list(solids.values()), np.ascontiguousarray(places[..., :3, :3]), places[..., :3, 3].copy())
    one, other = (np.array([index[id(getattr(pair, side))] for pair in pairs]) for side in ("one", "other"))
    return placed, one, other
