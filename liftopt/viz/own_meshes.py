"""Which robots of a lift are drawn with their own meshes, and where those may come from.

A result may come from anybody, and so does what its scenario names. What is looked up without being asked is what is
installed here: robots known by name. The file that a scenario names is read only where the caller says so, and then as
plain URDF: no xacro is expanded, no mesh is opened that is no stl, obj or dae or is beyond its bounds (``mesh_file``).
Whatever is read must be the very arm of the result, joint by joint; else, and without files, the shapes that the result
itself has are drawn.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin

from liftopt.errors import InputError
from liftopt.multibody.agent import Agent
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.examination import examined
from liftopt.multibody.robots.read_robot import read_robot
from liftopt.multibody.robots.robot_urdf import own_joint, turned
from liftopt.scenario.build import agent_of
from liftopt.scenario.robot import Robot
from liftopt.scenario.robot_defaults import SAWYER, is_file
from liftopt.solution.solution import Solution
from liftopt.types import Array
from liftopt.viz.robot_figure import FigurePiece, figure_of

Meshes = bool | str | Path
Figures = dict[str, tuple[FigurePiece, ...]]
FOLDERS = ("", "urdf", "robots")  # of a description, where its URDF is looked for
SAME = 1e-4  # [m], and of rotations: so well an arm's joints are those of the result


def figures_of(solution: Solution, meshes: Meshes = False) -> Figures:
    """Return what the robots of a lift are drawn with, by agent; nothing of one that is drawn with plain shapes.

    Args:
        solution: the lift.
        meshes: False looks only for robots that are known by name; True reads the file that the scenario names too; a
            path is that of the file to read instead, or of the folder that it is in.

    Raises:
        InputError: a file that was asked for cannot be read, or is of another robot.
    """
    found: Figures = {}
    for name, robot in solution.scenario.agents.items():
        if isinstance(robot, Robot) and robot.model != SAWYER:
            agent = agent_of(solution.scenario, name, solution.urdfs)
            chain = _known_chain(robot, agent) if robot.model in known_robots() else _chain(robot, agent, meshes)
            if chain is not None:
                found[name] = figure_of(chain)
    return found


def _known_chain(robot: Robot, agent: Agent) -> RobotChain | None:
    """Return the chain of a robot that is known by name, if it is installed and still the same."""
    try:
        chain = robot.chosen().examination().chain
    except InputError:
        return None
    return chain if is_of(chain, agent) else None


def _chain(robot: Robot, agent: Agent, meshes: Meshes) -> RobotChain | None:
    """Return the chain of a robot from a file, where the caller wants it to be read."""
    if meshes is False or not is_file(robot.model):
        return None
    file = Path(robot.model) if meshes is True else _file(Path(meshes), Path(robot.model).name)
    if file.suffix.lower() == ".xacro":
        raise InputError("meshes", str(file), "must be a URDF: xacro is not expanded for a picture")
    chain = examined(
        read_robot(file, expand=False), grasp_frame=robot.grasp_frame, base=robot.base_link, locked=robot.locked
    ).chain
    if not is_of(chain, agent):
        raise InputError("meshes", str(file), f"is another robot than {agent.name!r} of this lift")
    return chain


def _file(given: Path, name: str) -> Path:
    """Return the file in a folder that has the name of the scenario's, or the file that was given."""
    if not given.is_dir():
        return given
    return next((path for folder in FOLDERS if (path := given / folder / name).is_file()), given / name)


def is_of(chain: RobotChain, agent: Agent) -> bool:
    """Return whether a chain has an agent's joints, at the same places."""
    model = agent.model
    if [own_joint(agent.name, joint.name) for joint in chain.joints] != list(model.names)[1:]:
        return False
    data = model.createData()
    pin.forwardKinematics(model, data, np.zeros(model.nq))
    places: list[Array] = []
    before = np.eye(4)
    for link in chain.links:
        before = before @ link.placement
        places.append(before @ turned(link))
    first, own = np.linalg.inv(places[0]), np.linalg.inv(data.oMi[1].homogeneous)
    pairs = zip(places, list(data.oMi)[1:], strict=True)
    return all(np.allclose(first @ there, own @ here.homogeneous, rtol=0.0, atol=SAME) for there, here in pairs)
