"""Mechanisms described twice: DH chains with random bodies, and Pinocchio models assembled joint by joint."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest

from liftopt.crosscheck.systems import CheckedSystem
from liftopt.multibody.dh import (
    ROTATION_WORLD_PAPER,
    BodyInertia,
    DHChain,
    DHRow,
    human_rows,
    robot_rows,
    row_origin,
    row_tail,
    table_rows,
)
from liftopt.types import Array

SAWYER_LENGTHS = (0.317, 0.081, 0.1925, 0.4, 0.1685, 0.4, 0.1363, 0.1345, 0.915)


def random_body(rng: np.random.Generator, mass: float) -> BodyInertia:
    """Return a physical body: its inertia is that of ten random point masses about their centre of mass."""
    points = rng.normal(scale=0.1, size=(10, 3))
    points -= points.mean(axis=0)
    inertia = mass / 10 * sum(p @ p * np.eye(3) - np.outer(p, p) for p in points)
    return BodyInertia(mass, rng.normal(scale=0.1, size=3), inertia)


def random_chain(name: str, rows: tuple[DHRow, ...], massless: int, seed: int) -> DHChain:
    rng = np.random.default_rng(seed)
    bodies = (BodyInertia.zero(),) * massless + tuple(random_body(rng, 4.0) for _ in rows[massless:])
    return DHChain(name, rows, bodies)


def assembled_model(chain: DHChain, t_world_root: Array) -> pin.Model:
    """Return the chain as a pin.Model: one joint a row, moving about or along its z, the last DH frame as "tip"."""
    model, parent, placement = pin.Model(), 0, t_world_root
    for row, body in zip(chain.rows, chain.inertias, strict=True):
        kind = pin.JointModelRZ() if row.kind == "revolute" else pin.JointModelPZ()
        parent = model.addJoint(parent, kind, pin.SE3(placement @ row_origin(row)), f"{chain.name}_{row.name}")
        placement = row_tail(row)
        moved = body.transformed(placement[:3, :3], placement[:3, 3])
        model.appendBodyToJoint(parent, pin.Inertia(moved.mass, moved.com, moved.inertia), pin.SE3.Identity())
    model.addFrame(pin.Frame("tip", parent, pin.SE3(placement), pin.FrameType.OP_FRAME))
    return model


RandomArm = Callable[[tuple[DHRow, ...], int], CheckedSystem]


def arm_system(chain: DHChain, t_world_root: Array) -> CheckedSystem:
    model = assembled_model(chain, t_world_root)
    model.lowerPositionLimit, model.upperPositionLimit = np.full(model.nq, -np.pi), np.full(model.nq, np.pi)
    return CheckedSystem(chain, model, t_world_root, ("tip",), np.zeros((1, 3)))


def root(angle: float, x: float, y: float, z: float) -> Array:
    placement = np.eye(4)
    placement[:3, :3] = pin.utils.rotate("z", angle) @ ROTATION_WORLD_PAPER
    placement[:3, 3] = (x, y, z)
    return placement


@pytest.fixture(scope="session", params=["human", "robot"])
def arm(request: pytest.FixtureRequest) -> CheckedSystem:
    """Tables 2 and 3 with random bodies; neither root is at the world's origin, one is turned."""
    if request.param == "human":
        chain = random_chain("human", human_rows(0.95, 0.5, 0.2, 0.3, 0.27, 0.1), 2, seed=1)
        return arm_system(chain, root(0.0, 0.1, -0.2, 0.3))
    return arm_system(random_chain("robot", robot_rows(SAWYER_LENGTHS), 2, seed=2), root(np.pi, 1.9, 0.0, 0.0))


@pytest.fixture(scope="session")
def random_arm() -> RandomArm:
    """Return a function of rows and seed: every link with a random body, the root at a random place."""

    def build(rows: tuple[DHRow, ...], seed: int) -> CheckedSystem:
        angle, *position = np.random.default_rng(seed).uniform(-1, 1, 4)
        return arm_system(random_chain("any", rows, 0, seed), root(3 * angle, *position))

    return build


@pytest.fixture(scope="session")
def table() -> CheckedSystem:
    """Table 4 with a random body whose centre of mass is off the frame's origin, beside a free-flyer."""
    rng = np.random.default_rng(3)
    body = random_body(rng, 2.0)
    t_world_root = root(0.0, 0.0, 0.0, 0.0)
    chain = DHChain("table", table_rows(), (BodyInertia.zero(),) * 5 + (body,))
    at_zero = assembled_model(chain, t_world_root)
    data = at_zero.createData()
    pin.framesForwardKinematics(at_zero, data, np.zeros(6))
    turn = data.oMf[at_zero.getFrameId("tip")].rotation
    seen = body.transformed(turn, np.zeros(3))
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    model.appendBodyToJoint(joint, pin.Inertia(seen.mass, seen.com, seen.inertia), pin.SE3.Identity())
    points = rng.uniform(-0.3, 0.3, (2, 3))
    for name, point in zip(("first", "second"), points @ turn.T, strict=True):
        model.addFrame(pin.Frame(name, joint, pin.SE3(np.eye(3), point), pin.FrameType.OP_FRAME))
    return CheckedSystem(chain, model, t_world_root, ("first", "second"), points)
