"""Planes chosen along a motion: coal's distances and Pinocchio's kinematics are the oracles."""

from __future__ import annotations

from types import ModuleType

import numpy as np
import pytest

from liftopt.collocation.problem import Problem
from liftopt.collocation.separating_planes import WORLD
from liftopt.multibody.solids import placed_box
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.make_clear import MARGIN, planes_along
from liftopt.search.plane_choice import NEAR, PlaneOptions, choose_planes
from liftopt.search.session import Session
from liftopt.search.solid_distances import solid_distances
from liftopt.search.team_solids import TeamSolids

BOX = {"object.depth": 0.3, "object.width": 0.3, "object.height": 0.3, "solver.intervals": 8}


@pytest.fixture(scope="module")
def session() -> Session:
    return Session(load_scenario("table5").replace(BOX), SolverCache())


@pytest.fixture(scope="module")
def problem(session: Session) -> Problem:
    return session.problem(session.spline)


@pytest.fixture(scope="module")
def solids(problem: Problem) -> TeamSolids:
    shelf = placed_box("shelf", (0.3, 0.4, 0.03), (0.6, 0.5, 1.3), 0.3)
    return TeamSolids.of(problem.team, (shelf,))


def wandering(problem: Problem, rng: np.random.Generator) -> np.ndarray:
    """Return a motion about the comfortable postures, with the object before the person."""
    postures = np.concatenate([*(agent.posture for agent in problem.team.agents), [0.5, 0.1, 1.0, 0.0, 0.0, 0.0]])
    control = postures + 0.3 * rng.normal(size=problem.layout.control.shape)
    return problem.pack(control, np.zeros(problem.layout.force.shape))


def test_distances_are_coals(
    problem: Problem, solids: TeamSolids, rng: np.random.Generator, coal_distance: ModuleType
) -> None:
    """Every pair that is near has coal's signed distance; every other one is at least as far as was asked."""
    x = wandering(problem, rng)
    coordinates = problem.mesh.basis[0] @ problem.unpack(x)[0]
    found = solid_distances(solids, problem, coordinates, 0.1)
    for p, pair in enumerate(solids.pairs):
        s, t = solids.ends[p]
        for k in (0, 4, 8):
            exact = coal_distance.distance(pair.one, found.placements[k, s], pair.other, found.placements[k, t])
            if np.isfinite(found.distance[k, p]):
                assert found.distance[k, p] == pytest.approx(exact, abs=1e-6)
            else:
                assert exact >= 0.1 - 1e-6


def test_rows_that_hold_prove_a_distance(problem: Problem, solids: TeamSolids, rng: np.random.Generator) -> None:
    """On motions that planes were not chosen for: where all corners have rows and all hold, coal agrees."""
    proven = 0
    for _ in range(6):
        x = wandering(problem, rng)
        knots = solid_distances(solids, problem, problem.mesh.basis[0] @ problem.unpack(x)[0], NEAR)
        least = knots.distance.min(axis=0)
        apart = np.flatnonzero((least > 0.01) & (least < 0.1))
        planes = choose_planes(solids, knots, apart, PlaneOptions(0.005))
        control = problem.unpack(x)[0] + 0.02 * rng.normal(size=problem.layout.control.shape)
        later = solid_distances(solids, problem, problem.mesh.basis[0] @ control, np.inf, apart)
        for p in apart:
            ends = solids.ends[p]
            bodies = tuple(solids.bodies[s] for s in ends)
            separation = next(s for s in planes.separations if (s.one, s.other) == bodies)
            for k in range(len(problem.mesh.phase)):
                own = np.array([name == solids.pairs[p].told for name in separation.names[k]])
                one, other = (
                    point[k, own] @ later.placements[k, s, :3, :3].T + later.placements[k, s, :3, 3]
                    for point, s in zip((separation.point_one, separation.point_other), ends, strict=True)
                )
                gap = np.einsum("ja,ja->j", separation.normal[k, own], one - other) - separation.distance[k, own]
                moving = [s for s in ends if solids.bodies[s].part != WORLD]
                every = np.prod([len(solids.solids[s].points) for s in moving])
                if len(gap) >= every and gap.min() >= 0.0:
                    proven += 1
                    assert later.distance[k, p] >= 0.005 - 1e-6
    assert proven > 50


def test_a_motion_that_is_apart_keeps_its_own_planes(
    problem: Problem, solids: TeamSolids, rng: np.random.Generator
) -> None:
    """With the normals between the nearest points the motion that they were chosen for satisfies every row."""
    x = wandering(problem, rng)
    knots = solid_distances(solids, problem, problem.mesh.basis[0] @ problem.unpack(x)[0], NEAR)
    apart = np.flatnonzero((knots.distance.min(axis=0) > 0.02) & (knots.distance.min(axis=0) < NEAR))
    assert len(apart) > 5
    other = problem.apart(planes_along(solids, problem, x, apart, 0.02, 0.0))
    g = other.nlp.jac_g(x, other.parameters)[0].full().ravel()
    first = next(block.rows.start for block in other.constraints.blocks if block.name == "clearance")
    assert (g - other.constraints.lower)[first:].min() >= -1e-6


def test_an_overlap_is_not_passed_through(problem: Problem, solids: TeamSolids) -> None:
    """The object rises through the shelf: planes go around it, and from one to the next no normal turns round."""
    control = np.tile(
        np.concatenate([*(agent.posture for agent in problem.team.agents), [0.6, 0.5, 0.0, 0.0, 0.0, 0.0]]),
        (problem.layout.control.shape[0], 1),
    )
    control[:, -4] = np.linspace(0.6, 1.5, len(control))
    x = problem.pack(control, np.zeros(problem.layout.force.shape))
    knots = solid_distances(solids, problem, problem.mesh.basis[0] @ problem.unpack(x)[0], NEAR)
    crossed = [p for p, pair in enumerate(solids.pairs) if pair.told == "table and shelf"]
    planes = choose_planes(solids, knots, np.array(crossed), PlaneOptions(MARGIN, crossing=frozenset(crossed)))
    (separation,) = planes.separations
    assert WORLD in (separation.one.part, separation.other.part)
    near = separation.active[:, 0]
    normal = separation.normal[near, 0]
    assert normal[0, 2] == pytest.approx(-1.0) and normal[-1, 2] == pytest.approx(1.0)
    assert (np.einsum("ka,ka->k", normal[1:], normal[:-1]) > -0.11).all()
    assert (np.abs(normal[:, 2]) < 0.9).any()


def test_without_clearance_there_are_no_planes() -> None:
    scenario: Scenario = load_scenario("table5").replace({**BOX, "limits.clearance": "off"})
    session = Session(scenario, SolverCache())
    problem = session.problem(session.spline)
    assert session.clearer(problem) is None and problem.planes is None and not problem.poses


def test_what_rests_where_the_task_has_it_is_inside_its_row(problem: Problem) -> None:
    """The object rises from a block that it rests on: an interior point needs room there too, and less than 1 mm."""
    (ahead, _, low), (_, _, high) = problem.task.start[:3], problem.task.end[:3]
    control = np.tile(
        np.concatenate([*(agent.posture for agent in problem.team.agents), [ahead, 0.0, low, 0.0, 0.0, 0.0]]),
        (problem.layout.control.shape[0], 1),
    )
    control[:, -4] = low + (high - low) * np.linspace(0.0, 1.0, len(control)) ** 2
    top = low - BOX["object.height"] / 2
    block = placed_box("block", (0.3, 0.3, top), (ahead, 0.0, top / 2), 0.0)
    solids = TeamSolids.of(problem.team, (block,))
    x = problem.pack(control, np.zeros(problem.layout.force.shape))
    pairs = np.array([p for p, pair in enumerate(solids.pairs) if pair.told == "table and block"])
    planes = planes_along(solids, problem, x, pairs, 0.0)
    apart = problem.apart(planes)
    first = next(rows.rows.start for rows in apart.constraints.blocks if rows.name == "clearance")
    slack = (apart.nlp.jac_g(x, apart.parameters)[0].full().ravel() - apart.constraints.lower)[first:]
    assert 0.0 < slack.min() < 1e-3
