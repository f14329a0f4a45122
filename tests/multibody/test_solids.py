"""Solids on joints: oracles are Pinocchio's own reading of the URDF's collision shapes, and coal's distances."""

from __future__ import annotations

from dataclasses import replace
from types import ModuleType
from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin
import pytest

from liftopt.errors import ModelError
from liftopt.multibody.agent import Agent
from liftopt.multibody.solids import FLOOR, Solid, placed_box, solids_of, solids_of_object
from liftopt.scenario.build import agents_of, object_of, obstacles_of
from liftopt.scenario.model import load_scenario

TABLE5 = load_scenario()
AGENTS = {agent.name: agent for agent in agents_of(TABLE5)}
AHEAD = np.array([0.9, 0.2, 0.1])
PROBE = Solid("probe", "", 0, np.eye(4), "box", (0.05, 0.08, 0.11))


def _pinocchios(agent: Agent, q: np.ndarray) -> dict[str, tuple[coal.ShapeBase, np.ndarray]]:
    """Return shape and T_world_shape (4, 4) of every collision geometry of the whole model, by name."""
    model = agent.model
    geometry = pin.buildGeomFromUrdfString(model, agent.urdf, pin.GeometryType.COLLISION)
    data, placed = model.createData(), pin.GeometryData(geometry)
    full = np.zeros(model.nq)
    full[[model.joints[model.getJointId(name)].idx_q for name in agent.moving_joints]] = q
    pin.updateGeometryPlacements(model, data, geometry, placed, full)
    titles = {
        f"{link.get('name')}_{k}": shape.get("name", "")
        for link in ElementTree.fromstring(agent.urdf).iter("link")
        for k, shape in enumerate(link.iter("collision"))
    }
    return {
        titles[shape.name]: (shape.geometry, place.homogeneous)
        for shape, place in zip(geometry.geometryObjects, placed.oMg, strict=True)
    }


@pytest.mark.parametrize("name", AGENTS)
def test_every_collision_shape_is_in_one_solid_at_its_place(name: str, coal_distance: ModuleType) -> None:
    """A probe is as far from a capsule as from the nearest of the three primitives that it is written as."""
    agent, rng = AGENTS[name], np.random.default_rng(3)
    solids = solids_of(agent)
    q = rng.uniform(agent.limits.q_lower, agent.limits.q_upper)
    theirs, model = _pinocchios(agent, q), agent.reduced()
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    request, used = coal.DistanceRequest(), 0
    for solid in solids:
        T_world_joint = data.oMi[solid.joint].homogeneous
        # Far enough ahead of the solid, along x of the joint, not to overlap it.
        probe_at = T_world_joint.copy()
        probe_at[:3, 3] = T_world_joint[:3, :3] @ (solid.points.mean(axis=0) + AHEAD) + T_world_joint[:3, 3]
        parts = [
            (shape, place) for title, (shape, place) in theirs.items()
            if title.split("_collision")[0].removesuffix("_start").removesuffix("_end").replace("_", " ") == solid.name
        ]  # fmt: skip
        used += len(parts)
        expected = min(
            coal.distance(shape, coal.Transform3s(place[:3, :3], place[:3, 3]), coal_distance.coal_shape(PROBE),
                          coal.Transform3s(probe_at[:3, :3], probe_at[:3, 3]), request, coal.DistanceResult())
            for shape, place in parts
        )  # fmt: skip
        found = coal_distance.distance(solid, T_world_joint, PROBE, probe_at)
        if len(parts) == 3 or solid.kind == "box":
            assert found == pytest.approx(expected, abs=1e-5), solid.told
        else:  # a cylinder, and the capsule around it
            assert expected - solid.radius - 1e-5 <= found <= expected + 1e-5, solid.told
    assert used == len(theirs)


def test_points_and_radius_make_up_the_solid(coal_distance: ModuleType) -> None:
    """The support in any direction is the farthest point's, and the radius on top; coal tells where it ends."""
    rng = np.random.default_rng(0)
    for solid in (*solids_of(AGENTS["human"]), *solids_of_object(object_of(TABLE5))):
        for direction in rng.normal(size=(5, 3)):
            n = direction / np.linalg.norm(direction)
            ours = float((solid.points @ n).max()) + solid.radius
            # A half-space beyond the solid, its plane a metre off along n.
            plane = coal.Halfspace(-n, -(ours + 1.0))
            place = coal.Transform3s(solid.T_joint_solid[:3, :3], solid.T_joint_solid[:3, 3])
            away = coal.distance(
                coal_distance.coal_shape(solid), place, plane, coal.Transform3s.Identity(), coal.DistanceRequest(),
                coal.DistanceResult(),
            )  # fmt: skip
            assert away == pytest.approx(1.0, abs=1e-6), solid.told


def test_names_are_readable() -> None:
    told = {solid.told for solid in solids_of(AGENTS["human"])}
    assert {"right forearm of human", "head of human", "left hand of human"} <= told
    assert [solid.told for solid in solids_of_object(object_of(TABLE5))] == ["table"]
    assert FLOOR.told == "floor"
    assert "gripper of robot" in {solid.told for solid in solids_of(AGENTS["robot"])}


def test_an_obstacle_is_placed_by_its_centre() -> None:
    shelf = placed_box("shelf", (0.4, 1.2, 0.1), (0.6, 0.2, 0.5), np.pi / 2)
    low, high = shelf.points.min(axis=0), shelf.points.max(axis=0)
    np.testing.assert_allclose([low, high], [[0.0, 0.0, 0.45], [1.2, 0.4, 0.55]], atol=1e-12)
    (made,) = obstacles_of(
        TABLE5.replace({"obstacles": [{"box": [0.4, 1.2, 0.1], "position": [0.6, 0.2, 0.5], "yaw_deg": 90.0}]})
    )
    assert made.told == "obstacle_1"
    np.testing.assert_allclose(made.points, shelf.points, atol=1e-12)


def test_a_mesh_is_refused() -> None:
    robot = AGENTS["robot"]
    urdf = robot.urdf.replace('<box size="0.78 0.69 0.24"/>', '<mesh filename="foot.stl"/>')
    assert urdf != robot.urdf
    with pytest.raises(ModelError, match="pedestal foot must be a box"):
        solids_of(replace(robot, urdf=urdf))
