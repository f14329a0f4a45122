"""How far bodies keep apart: oracles are coal asked of every pair at every time, and MuJoCo's own distances."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from liftopt.multibody.solid_pairs import solid_pairs
from liftopt.multibody.solids import FLOOR, Solid
from liftopt.multibody.trajectory import attitude
from liftopt.scenario.build import agents_of, object_of, obstacles_of
from liftopt.solution import verify
from liftopt.solution.clearance import Clearance
from liftopt.solution.clearance_bounds import PlacedSolids, sphere_bounds, tight_bounds
from liftopt.solution.clearance_measure import NEAR
from liftopt.solution.clearance_of import clearance_of
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution
from liftopt.solution.summary import summary_dict
from liftopt.storage.reader import load_result

SHELF = [{"name": "shelf", "box": [0.5, 0.6, 0.05], "position": [0.7, -0.1, 0.95], "yaw_deg": 20.0}]


@pytest.fixture(scope="module")
def light(solved: Callable[..., Any]) -> Any:
    """Return the paper's lift on a coarse mesh, and its folder; what overlaps in it is left as it is."""
    return solved("table5_paper", "solver.intervals=10", "solver.starts=1")


@pytest.fixture(scope="module")
def beside(light: Any) -> Solution:
    """Return that lift on a finer grid, with a shelf put into it."""
    solution = light.solution
    return between_knots(Solution(**vars(solution) | {"scenario": solution.scenario.replace({"obstacles": SHELF})}))


@pytest.fixture(scope="module")
def placed(beside: Solution, coal_distance: ModuleType) -> Callable[[Solid, int], np.ndarray]:
    """Return a function: T_world_joint (4, 4) of the joint of a solid at a time, by its index."""
    agents = {agent.name: agent for agent in agents_of(beside.scenario, beside.urdfs)}

    def at(solid: Solid, k: int) -> np.ndarray:
        placement = np.eye(4)
        if solid.owner in agents:
            motion = beside[solid.owner]
            placement = coal_distance.joint_placements(agents[solid.owner], motion.q[k, motion.moving])[solid.joint]
        elif solid.owner == beside.object.name:
            pose = beside.object.pose[k]
            placement[:3, :3], placement[:3, 3] = attitude(pose[3:])[0], pose[:3]
        return placement

    return at


@pytest.fixture(scope="module")
def clearance(beside: Solution) -> Clearance:
    """Return its clearance."""
    return clearance_of(beside)


def test_the_nearest_of_every_kind_is_what_coal_finds_among_all_pairs(
    beside: Solution, clearance: Clearance, placed: Any, coal_distance: ModuleType
) -> None:
    pairs = solid_pairs(
        agents_of(beside.scenario, beside.urdfs),
        object_of(beside.scenario, beside.urdfs),
        obstacles_of(beside.scenario),
    )
    assert {pair.told for pair in pairs} == {pair.told for pair in clearance.pairs}
    for k in (0, 37, 64, 100):
        found: dict[str, list[float]] = {}
        for pair in pairs:
            apart = coal_distance.distance(pair.one, placed(pair.one, k), pair.other, placed(pair.other, k))
            found.setdefault(pair.kind, []).append(apart)
        assert {kind.kind for kind in clearance.kinds} == set(found)
        for kind in clearance.kinds:
            assert kind.distance[k] == pytest.approx(min(found[kind.kind]), abs=1e-6), kind.kind


def test_every_pair_that_comes_near_is_told_with_its_smallest_distance(
    beside: Solution, clearance: Clearance, placed: Any, coal_distance: ModuleType
) -> None:
    told = {item.pair.told: item for item in clearance.closest}
    assert [item.distance for item in clearance.closest] == sorted(item.distance for item in clearance.closest)
    assert len(told) == len(clearance.closest)
    near = 0
    for pair in clearance.pairs:
        if pair.kind not in ("person", "person-object", "person-obstacle"):
            continue
        apart = [
            coal_distance.distance(pair.one, placed(pair.one, k), pair.other, placed(pair.other, k))
            for k in range(0, len(beside.time), 4)
        ]
        if min(apart) < NEAR:
            near += 1
            item = told[pair.told]
            assert item.distance <= min(apart) + 1e-6
            k = int(np.argmin(np.abs(beside.time - item.time)))
            again = coal_distance.distance(pair.one, placed(pair.one, k), pair.other, placed(pair.other, k))
            assert again == pytest.approx(item.distance, abs=1e-6)
    assert near > 3


def test_mujoco_finds_the_same_distances_and_points(clearance: Clearance, placed: Any) -> None:
    mujoco = pytest.importorskip("mujoco")
    compared = 0
    for item in clearance.closest:
        if FLOOR in (item.pair.one, item.pair.other):
            continue
        k = int(np.argmin(np.abs(clearance.time - item.time)))
        bodies = "".join(
            f'<body><freejoint/><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>{_geom(solid)}</body>'
            for solid in (item.pair.one, item.pair.other)
        )
        model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
        data = mujoco.MjData(model)
        for i, solid in enumerate((item.pair.one, item.pair.other)):
            T_world_solid = placed(solid, k) @ solid.T_joint_solid
            quaternion = np.zeros(4)
            mujoco.mju_mat2Quat(quaternion, T_world_solid[:3, :3].flatten())
            data.qpos[7 * i : 7 * i + 7] = [*T_world_solid[:3, 3], *quaternion]
        mujoco.mj_kinematics(model, data)
        ends = np.zeros(6)
        apart = mujoco.mj_geomDistance(model, data, 0, 1, 2.0, ends)
        if item.distance > 0.0:  # how deep two overlap has more than one meaning
            assert apart == pytest.approx(item.distance, abs=1e-5), item.pair.told
            gap = np.linalg.norm(item.points[1] - item.points[0])
            assert gap == pytest.approx(item.distance, abs=1e-5)
        else:
            assert apart < 1e-6, item.pair.told
        compared += 1
    assert compared > 6


def _geom(solid: Solid) -> str:
    """Return a solid as MuJoCo's geom, which has half sizes."""
    if solid.kind == "box":
        size, kind = np.array(solid.size) / 2.0, "box"
    else:
        size, kind = np.array([solid.size[0], max(solid.size[1] / 2.0, 1e-9)]), "capsule"
    return f'<geom type="{kind}" size="{" ".join(map(str, size))}" mass="0"/>'


def test_bounds_hold_and_of_capsules_are_exact(coal_distance: ModuleType) -> None:
    rng = np.random.default_rng(5)
    solids, rotation, position = [], [], []
    for i in range(40):
        size = tuple(rng.uniform(0.02, 0.4, 3)) if i % 2 else tuple(rng.uniform(0.01, 0.3, 2))
        solids.append(Solid(f"s{i}", "", 0, np.eye(4), "box" if i % 2 else "capsule", size))
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        rotation.append([turn * np.sign(np.linalg.det(turn))])
        position.append([rng.uniform(-0.5, 0.5, 3)])
    # Parallel axes have no one nearest point.
    rotation[2], position[2] = rotation[0], [position[0][0] + rotation[0][0] @ [0.1, 0.02, 0.05]]
    solids.append(FLOOR)
    rotation.append([np.eye(3)])
    position.append([np.array([0.0, 0.0, -0.3])])
    placed = PlacedSolids(solids, np.array(rotation), np.array(position))
    one, other = np.array(np.triu_indices(len(solids), 1))
    below, above = sphere_bounds(placed, one, other)
    tight = tight_bounds(placed, one, other, np.zeros(len(one), dtype=np.int64))
    places = np.tile(np.eye(4), (len(solids), 1, 1))
    places[:, :3, :3], places[:, :3, 3] = placed.rotation[:, 0], placed.position[:, 0]
    for row, (i, j) in enumerate(zip(one, other, strict=True)):
        apart = coal_distance.distance(solids[i], places[i], solids[j], places[j])
        assert below[row, 0] - 1e-6 <= apart <= above[row, 0] + 1e-6
        assert tight[row] <= max(apart, 0.0) + 1e-6
        if solids[i].kind == solids[j].kind == "capsule" and apart > -min(solids[i].radius, solids[j].radius):
            assert tight[row] == pytest.approx(apart, abs=1e-6)
        if FLOOR in (solids[i], solids[j]):
            assert below[row, 0] == pytest.approx(apart, abs=1e-6)


def test_closest_points_move_against_each_other_as_fast_as_they_are_told_to(
    beside: Solution, clearance: Clearance
) -> None:
    """Above the floor nothing turns the object much: what is nearest falls and rises with it."""
    kind = clearance.of_kind("object-floor")
    assert kind is not None
    velocity = beside.object.velocity
    for k in (30, 50, 70):
        lever = kind.points[k, 0] - beside.object.pose[k, :3]
        expected = np.linalg.norm(velocity[k, :3] + np.cross(velocity[k, 3:], lever))
        assert kind.speed[k] == pytest.approx(expected, rel=1e-3)


def test_a_viewer_gets_points_by_time(clearance: Clearance) -> None:
    nearest = clearance.between_bodies
    assert nearest is not None
    for k in (0, 50, 100):
        between = [kind for kind in clearance.kinds if kind.kind not in ("person", "robot")]
        first = min(between, key=lambda kind: float(kind.distance[k]))
        assert nearest.distance[k] == first.distance[k]
        np.testing.assert_array_equal(nearest.points[k], first.points[k])
        assert clearance.pairs[nearest.pair[k]].kind == first.kind
    assert clearance.smallest is clearance.closest[0]
    floor = clearance.closest_of("object-floor")
    assert floor is not None and floor.points[1, 2] == pytest.approx(0.0, abs=1e-9)


def test_the_summary_has_the_smallest_distance_of_each_kind(light: Any) -> None:
    solution = light.solution
    told = summary_dict(solution)["clearance"]
    assert told["limit_m"] == solution.scenario.limits.clearance
    assert set(told["kinds"]) == {kind.kind for kind in solution.clearance.kinds}
    for kind in solution.clearance.kinds:
        entry = told["kinds"][kind.kind]
        assert entry["smallest_m"] == kind.distance.min()
        k = int(np.argmin(np.abs(solution.clearance.time - entry["at_s"])))
        assert solution.clearance.pairs[kind.pair[k]].told == entry["between"]


def test_a_result_that_is_read_has_the_same_clearance(light: Any) -> None:
    again, solution = load_result(light.folder).clearance, light.solution.clearance
    assert again is not None and solution is not None
    for one, other in zip(again.kinds, solution.kinds, strict=True):
        np.testing.assert_array_equal(one.distance, other.distance)


def test_what_comes_too_near_is_no_solution(light: Any) -> None:
    from liftopt.search.cache import SolverCache
    from liftopt.search.session import Session
    from liftopt.search.solve import find_lift

    scenario = light.solution.scenario
    found = find_lift(Session(scenario.replace({"limits.clearance": "off"}), SolverCache())).best
    for limit in (0.0, 0.2):
        checked = verify.verify(found.problem, found.spline, found.result, 1e-6, (), limit).check("clearance")
        asked = replace(light.solution, scenario=scenario.replace({"limits.clearance": limit}))
        short = max(item.pair.asked(limit) - item.distance for item in clearance_of(between_knots(asked)).closest)
        assert checked.value == pytest.approx(max(short, 0.0), abs=1e-6)
        assert checked.passed == (short <= 1e-3)
    assert "clearance" not in {check.name for check in found.verification.checks}
