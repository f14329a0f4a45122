"""Models on which the symbolic algorithms are compared with Pinocchio in double precision."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from liftopt.multibody.person.human import human_agent
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.placement import facing
from liftopt.multibody.robots.sawyer import sawyer_agent
from liftopt.multibody.table import lifted_table

RANDOM_MODELS = 6
MODEL_NAMES = ("human", "sawyer", "table", "panda", "ur5", *(f"random_{seed}" for seed in range(RANDOM_MODELS)))


def robot_urdf(path: str) -> str:
    """Return the path of a URDF of example-robot-data, whose wheel holds files and no Python module."""
    try:
        prefix = distribution("example-robot-data").locate_file("cmeel.prefix")
    except PackageNotFoundError:
        pytest.skip("example-robot-data is not installed")
    return str(Path(str(prefix)) / "share/example-robot-data/robots" / path)


def _random_axis(rng: np.random.Generator) -> np.ndarray:
    axis = rng.normal(size=3)
    return axis / np.linalg.norm(axis)


def _random_inertia(rng: np.random.Generator) -> pin.Inertia:
    square = rng.normal(size=(3, 3))
    return pin.Inertia(rng.uniform(0.1, 5.0), rng.normal(size=3), square @ square.T + np.eye(3))


def _random_placement(rng: np.random.Generator) -> pin.SE3:
    return pin.exp6(rng.normal(size=6))


def random_tree(seed: int, joints: int = 9) -> pin.Model:
    """Return a tree with every supported kind of joint in a random order, bodies on fixed joints, and armature."""
    rng = np.random.default_rng(seed)
    kinds: list[Callable[[], pin.JointModel]] = [
        pin.JointModelRX,
        pin.JointModelRY,
        pin.JointModelRZ,
        pin.JointModelPX,
        pin.JointModelPY,
        pin.JointModelPZ,
        lambda: pin.JointModelRevoluteUnaligned(*_random_axis(rng)),
        lambda: pin.JointModelPrismaticUnaligned(*_random_axis(rng)),
        pin.JointModelFreeFlyer,
        pin.JointModelSpherical,
    ]
    model = pin.Model()
    model.name = f"random_{seed}"
    for number, kind in enumerate(rng.permutation(len(kinds))[:joints]):
        parent = int(rng.integers(0, model.njoints))
        joint = model.addJoint(parent, kinds[kind](), _random_placement(rng), f"joint_{number}")
        model.addJointFrame(joint)
        model.appendBodyToJoint(joint, _random_inertia(rng), _random_placement(rng))
        # What a fixed joint of a URDF becomes: a frame, and inertia lumped with the moving body.
        fixed = pin.Frame(f"fixed_{number}", joint, 0, _random_placement(rng), pin.FrameType.FIXED_JOINT)
        model.addFrame(fixed)
        model.appendBodyToJoint(joint, _random_inertia(rng), fixed.placement)
    model.armature = rng.uniform(0.0, 0.5, model.nv)
    model.gravity = pin.Motion(rng.normal(size=3), np.zeros(3))
    return model


def _build(name: str) -> pin.Model:
    if name == "human":
        return human_agent(Subject(stature=1.75, mass=75.0, sex="male")).model
    if name == "sawyer":
        return sawyer_agent(place=facing(1.9), base_height=0.915, tool_length=0.15, tool_mass=0.4).model
    if name == "table":
        return lifted_table(mass=2.0, depth=0.45, width=0.31, height=0.02).model
    if name == "panda":
        return pin.buildModelFromUrdf(robot_urdf("panda_description/urdf/panda.urdf"))
    if name == "ur5":
        return pin.buildModelFromUrdf(robot_urdf("ur_description/urdf/ur5_robot.urdf"))
    return random_tree(int(name.removeprefix("random_")))


@pytest.fixture(scope="module", params=MODEL_NAMES)
def pin_model(request: pytest.FixtureRequest) -> pin.Model:
    """Return each model of the comparison in turn."""
    return _build(request.param)


@pytest.fixture
def tree() -> pin.Model:
    """Return one random tree."""
    return random_tree(0)


@pytest.fixture(scope="session")
def kinova() -> pin.Model:
    """Return an arm with continuous joints, which are not supported."""
    return pin.buildModelFromUrdf(robot_urdf("kinova_description/robots/kinova.urdf"))
