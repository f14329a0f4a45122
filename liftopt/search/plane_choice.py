"""Planes between solids along a motion: which pairs get rows, on which side, and which of their points."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt

from liftopt.collocation.separating_planes import WORLD, Body, SeparatingPlanes, Separation
from liftopt.multibody.solid_pairs import SolidPair
from liftopt.search.solid_distances import SolidDistances, gaps
from liftopt.search.team_solids import TeamSolids
from liftopt.types import Array

# A pair has rows at the times at which it is nearer than this, if it is too near at some time [m].
NEAR = 0.15
# Corners of a hull that lie so much farther along the normal than its nearest one get no row of their own [m]: in the
# next round they may, if the body turns. Both ends of a capsule do.
FARTHER = 0.03
# The 26 directions to the faces, edges and corners of a cube.
DIRECTIONS = np.array([d for d in product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1, keepdims=True)
# Where two solids overlap the direction that separates them is chosen for all times together: depth along it costs its
# square in this unit [m], and a change of direction from one knot to the next 1 - cosine of the angle.
DEPTH = 0.1
# Cosine of the angle between normals from one knot to the next above which they count as one direction.
TURN = 0.85
# From one knot to the next normals do not turn round: that costs so much where the cosine is smaller than this.
FLIP, THROUGH = -0.1, 1e4
# What it costs at a knot to pass on the other side of what stands around than the object: so much, times 1 - cosine.
BESIDE = 2.0
# And for who holds the object, on another side of it than where arms, legs and trunk belong.
OFF_SIDE = 20.0
# Depth costs so much more at the ends where the task places the object, and it can hardly yield.
FIXED = 100.0
SAME_SIDE = 0.5  # cosine of the angle between directions that are on one side
# The object may rest on what stands at an end, this deep [m], and leaves it with this acceleration at least [m/s^2].
TOUCHING, LEAVING = 1e-3, 0.2
# There the task holds it, and a row that just touches would leave the solver no interior: it is this far off [m].
AT_REST = 1e-4
# Rows of two bodies are made this many at a time, so that the next planes seldom need another structure.
ROOM = 4


@dataclass(frozen=True)
class PlaneOptions:
    """What planes ask for.

    Attributes:
        distance: least distance of solids [m].
        margin: of that, what is more than the scenario asks for [m].
        time: (K,) of the knots [s]; None: nothing is known of it.
        crossing: pairs by number that overlap at or between knots, for which a side is chosen.
        avoided: of these, pairs whose first choice of a side led nowhere: another one is taken.
    """

    distance: float
    margin: float = 0.0
    time: Array | None = None
    crossing: frozenset[int] = frozenset()
    avoided: frozenset[int] = frozenset()

    def of(self, pair: SolidPair) -> float:
        """Return the least distance of a pair [m]: parts of one body may touch, but for the margin."""
        return self.margin if pair.within_body else self.distance


@dataclass(frozen=True)
class _Row:
    normal: Array
    one: Array
    other: Array
    distance: float
    name: str
    slack: float


def choose_planes(
    solids: TeamSolids,
    found: SolidDistances,
    pairs: npt.NDArray[np.int64],
    options: PlaneOptions,
    like: SeparatingPlanes | None = None,
) -> SeparatingPlanes:
    """Return planes that keep pairs apart, chosen by the distances at the knots of a motion.

    Args:
        solids: of the team.
        found: distances at the knots, known below ``NEAR``.
        pairs: numbers of the pairs that get rows.
        options: what the planes ask for.
        like: planes whose structure is kept where it is large enough.
    """
    knots = len(found.distance)
    rows: dict[tuple[Body, Body], list[list[_Row]]] = defaultdict(lambda: [[] for _ in range(knots)])
    beside: dict[int, Array] = {}  # on which side of what stands around the object passes
    order = sorted(pairs.tolist(), key=lambda p: solids.bodies[solids.ends[p, 0]].part != len(solids.team.agents))
    for p in order:
        one, other = solids.ends[p]
        if solids.bodies[one].part == solids.bodies[other].part == WORLD:
            continue  # both stand: no motion keeps them apart
        normals = _normals(solids, found, p, options, beside.get(int(other)))
        if p in options.crossing and solids.bodies[one].part == len(solids.team.agents):
            beside[int(other)] = normals
        between = rows[solids.bodies[one], solids.bodies[other]]
        near, wanted = found.distance[:, p] < NEAR, _wanted(solids, found, p, options)
        for k in np.flatnonzero(near):
            between[k] += _rows(solids, found, p, int(k), normals[k], float(wanted[k]))
        turns = np.einsum("ka,ka->k", normals[1:], normals[:-1]) < TURN
        for k in np.flatnonzero(turns & near[1:] & near[:-1]):
            at, normal, gap = _shared(solids, found, p, int(k), normals)
            # A motion that is apart stays feasible.
            distance = float(wanted[at]) if p in options.crossing else min(gap, float(wanted[at]))
            if distance > 0.0:
                between[at] += _rows(solids, found, p, at, normal, distance)
    known = {(s.one, s.other): s.rows for s in like.separations} if like else {}
    # What is known and no longer near asks for nothing.
    bodies = sorted({*known, *(key for key, at in rows.items() if any(at))})
    made = tuple(_separation(*key, rows[key], known.get(key, 0)) for key in bodies)
    used = {body.part for key in bodies for body in key}
    return SeparatingPlanes(tuple(part for part in solids.parts if part.part in used), made)


def _separation(one: Body, other: Body, rows: list[list[_Row]], least: int) -> Separation:
    most = max([least, *(len(at) for at in rows)])
    m = -(-most // ROOM) * ROOM
    shape = (len(rows), m)
    normal, first, second = (np.zeros((*shape, 3)) for _ in range(3))
    distance, names = np.zeros(shape), [[""] * m for _ in rows]
    for k, at in enumerate(rows):
        for j, row in enumerate(at):
            normal[k, j], first[k, j], second[k, j] = row.normal, row.one, row.other
            distance[k, j], names[k][j] = row.distance, row.name
    return Separation(one, other, normal, first, second, distance, tuple(map(tuple, names)))


def _rows(solids: TeamSolids, found: SolidDistances, p: int, k: int, normal: Array, distance: float) -> list[_Row]:
    """Return the rows of a pair at a knot: each near point of the one against each near point of the other."""
    s, t = solids.ends[p]
    ones, others = _support(solids, found, s, k, normal), _support(solids, found, t, k, -normal)
    least = distance + solids.radius[s] + solids.radius[t]
    name = solids.pairs[p].told
    rows = []
    for i in ones:
        for j in others:
            value = float(normal @ (found.points[k, s, i] - found.points[k, t, j]))
            rows.append(_Row(normal, solids.points[s, i], solids.points[t, j], float(least), name, value - least))
    return rows


def _shared(solids: TeamSolids, found: SolidDistances, p: int, k: int, normals: Array) -> tuple[int, Array, float]:
    """Return at which of knots k and k + 1 the other's normal is to hold too, that normal, and the gap along it now.

    What a plane separates at two knots it separates between them, where bodies move about straight; so none passes
    through another from one knot to the next.
    """
    one = np.array([p])
    later = float(gaps(solids, found.points[[k + 1]], normals[None, [k]], one)[0, 0])
    earlier = float(gaps(solids, found.points[[k]], normals[None, [k + 1]], one)[0, 0])
    return (k + 1, normals[k], later) if later >= earlier else (k, normals[k + 1], earlier)


def _support(solids: TeamSolids, found: SolidDistances, s: int, k: int, normal: Array) -> list[int]:
    """Return the corners of a hull that lie nearest against the normal; of what stands, one is always the nearest."""
    count = len(solids.solids[s].points)
    along = found.points[k, s, :count] @ normal
    if solids.bodies[s].part == WORLD:
        return [int(along.argmin())]
    reach = np.inf if solids.solids[s].kind == "capsule" else FARTHER
    return [int(i) for i in np.flatnonzero(along <= along.min() + reach)]


def _normals(
    solids: TeamSolids, found: SolidDistances, p: int, options: PlaneOptions, beside: Array | None = None
) -> Array:
    """Return a unit normal (K, 3) of a pair at every knot; those who hold the object pass ``beside`` as it does."""
    distance, exact = found.distance[:, p], found.normal[:, p]
    asked = options.of(solids.pairs[p])
    other = solids.ends[p, 1]
    if solids.flat[other]:
        return np.tile([0.0, 0.0, 1.0], (len(distance), 1))
    if p not in options.crossing:
        return exact
    apart = (distance > 0.0) & np.isfinite(distance)
    directions = _directions(solids, found, p)
    count = directions.shape[1]
    along = [gaps(solids, found.points, directions[:, d, None], np.array([p])) for d in range(count)]
    gap = np.concatenate(along, axis=1)
    # Where solids are apart the direction between their nearest points is a candidate too, and the best.
    directions = np.concatenate([directions, np.where(apart[:, None], exact, directions[:, 0])[:, None]], axis=1)
    gap = np.concatenate([gap, np.where(apart, distance, -np.inf)[:, None]], axis=1)
    cost = (np.minimum(gap - asked, 0.0) / DEPTH) ** 2 * (20.0 / max(1, len(distance) - 1))
    if _is_placed(solids, p):
        cost[[0, -1]] *= FIXED
    cost = np.minimum(cost, 1e6)
    if beside is not None:
        cost += BESIDE * (1.0 - np.einsum("kda,ka->kd", directions, beside))
    if p in solids.sides:
        cost += _off_side(solids, found, p, directions)
    first = _cheapest(cost, directions)
    if p in options.avoided:
        chosen = directions[np.arange(len(first)), first]
        # What lies between the directions of both ends is the side on which it passed; else it is where it overlapped.
        between = (chosen @ chosen[[0, -1]].T < SAME_SIDE).all(axis=1)
        passed = chosen[between] if between.any() else chosen[distance < asked]
        alike = (np.einsum("kda,ca->kdc", directions, passed) > SAME_SIDE).any(axis=2)
        first = _cheapest(cost + THROUGH * alike, directions)
    return directions[np.arange(len(first)), first]


def _off_side(solids: TeamSolids, found: SolidDistances, p: int, directions: Array) -> Array:
    """Return what each direction (K, D) costs for being off the side of the object where its holder's part belongs."""
    side = solids.sides[p]
    box = solids.ends[p, 0 if side.object_is_first else 1]
    normals = np.einsum("kab,sb->ksa", found.placements[:, box, :3, :3], side.normals)
    return np.asarray(OFF_SIDE * (1.0 - np.einsum("kda,ksa->kds", directions, normals).max(axis=2)))


def _is_placed(solids: TeamSolids, p: int) -> bool:
    """Whether a pair is the object and something that stands, which hardly move against each other at the ends."""
    return {solids.bodies[s].part for s in solids.ends[p]} == {WORLD, len(solids.team.agents)}


def _wanted(solids: TeamSolids, found: SolidDistances, p: int, options: PlaneOptions) -> Array:
    """Return the distance (K,) that a pair is to keep [m].

    What the object rests on at an end it leaves little by little; the margin counts from there on.
    """
    wanted = np.full(len(found.distance), options.of(solids.pairs[p]))
    if options.time is not None and _is_placed(solids, p):
        since = options.time - options.time[0], options.time[-1] - options.time
        for end, passed in zip((0, -1), since, strict=True):
            rest = found.distance[end, p]
            if rest >= options.distance - options.margin - TOUCHING:
                wanted = np.minimum(wanted, rest + LEAVING / 2 * passed**2)
                wanted[end] -= AT_REST
    return wanted


def _directions(solids: TeamSolids, found: SolidDistances, p: int) -> Array:
    """Return the 26 directions (K, 26, 3) in the axes of the pair's box, or in the world's where there is none."""
    boxes = [s for s in solids.ends[p] if solids.solids[s].kind == "box"]
    if not boxes:
        return np.tile(DIRECTIONS, (len(found.distance), 1, 1))
    s = boxes[-1]
    axes = found.placements[:, s, :3, :3] @ solids.solids[s].T_joint_solid[:3, :3]
    return np.asarray(np.einsum("kab,db->kda", axes, DIRECTIONS))


def _cheapest(cost: Array, directions: Array) -> npt.NDArray[np.int64]:
    """Return the choice at every knot whose costs, with those of changing direction, are least in all.

    Where it changes, one of both directions has to serve at both knots: else one body would pass through the other.
    """
    total, back = cost[0], []
    for k in range(1, len(cost)):
        cosine = directions[k - 1] @ directions[k].T
        both = np.minimum(cost[k - 1][None, :], cost[k][:, None])  # the later at k - 1, the earlier at k
        change = 1.0 - cosine + np.where(cosine < TURN, both, 0.0) + np.where(cosine < FLIP, THROUGH, 0.0)
        through = total[:, None] + change
        back.append(through.argmin(axis=0))
        total = through.min(axis=0) + cost[k]
    path = [int(total.argmin())]
    for choice in reversed(back):
        path.append(int(choice[path[-1]]))
    return np.array(path[::-1])
