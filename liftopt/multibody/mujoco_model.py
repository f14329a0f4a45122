"""The exported models in MuJoCo: the same URDFs, read by another program.

MuJoCo wants three things of a URDF that Pinocchio does not, so it gets a copy of the text: massless links that move
(virtual joints, links between the axes of one anatomical joint) are given ``NEGLIGIBLE`` mass and inertia; fixed links
are kept apart, so that the grasp frames stay; limits, pictures and collision shapes are left out, since contacts and
limits are off.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.trajectory import AgentTrajectory, ObjectTrajectory
from liftopt.types import Array

# Earlier releases leave the term dJ/dt v of a constraint's acceleration out, and their grasps drift.
OLDEST = (3, 7)
NEGLIGIBLE = 1e-12  # [kg] and [kg m^2]: a billionth of a milligram
IGNORED = ("limit", "visual", "collision")


def import_mujoco() -> ModuleType:
    """Return the module ``mujoco``; raises InputError where it is not installed or older than ``OLDEST``."""
    fix = 'pip install "liftopt[crosscheck]"'
    try:
        mujoco = importlib.import_module("mujoco")
    except ImportError:
        raise InputError("mujoco", NO_VALUE, f"is not installed, and only MuJoCo can do this check: {fix}") from None
    version = str(mujoco.__version__)
    if tuple(int(part) for part in version.split(".")[:2]) < OLDEST:
        wanted = ".".join(map(str, OLDEST))
        raise InputError("mujoco", version, f"{wanted} or later, whose constraints know of the velocity: {fix}")
    return mujoco


def spec_of(urdfs: Iterable[str], fixed: Sequence[str] = ()) -> Any:
    """Return one ``MjSpec`` of several models in one world, gravity on, contacts and limits off.

    Args:
        urdfs: texts of the models.
        fixed: names of joints to weld at zero.

    Raises:
        InputError: MuJoCo is not installed.
    """
    mujoco = import_mujoco()
    spec = mujoco.MjSpec.from_string(merged_urdf(urdfs, fixed))
    spec.option.gravity = [0.0, 0.0, -9.81]
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    return spec


def merged_urdf(urdfs: Iterable[str], fixed: Sequence[str] = ()) -> str:
    """Return several models as one URDF, a model without a root ``world`` as a floating body; see above."""
    merged = ElementTree.Element("robot", name="lift")
    options = dict(fusestatic="false", boundmass=f"{NEGLIGIBLE}", boundinertia=f"{NEGLIGIBLE}")
    ElementTree.SubElement(ElementTree.SubElement(merged, "mujoco"), "compiler", options)
    ElementTree.SubElement(merged, "link", name="world")
    for text in urdfs:
        robot = ElementTree.fromstring(text.encode())
        children = {joint.find("child").get("link") for joint in robot.iter("joint")}  # type: ignore[union-attr]
        for link in robot.findall("link"):
            if link.get("name") == "world":
                continue
            if link.get("name") not in children:
                free = ElementTree.SubElement(merged, "joint", name=f"{link.get('name')}_free", type="floating")
                ElementTree.SubElement(free, "parent", link="world")
                ElementTree.SubElement(free, "child", link=str(link.get("name")))
            merged.append(link)
        for joint in robot.findall("joint"):
            if joint.get("name") in fixed:
                joint.set("type", "fixed")
            merged.append(joint)
    for part in list(merged.iter()):
        for kind in IGNORED:
            for child in part.findall(kind):
                part.remove(child)
    return ElementTree.tostring(merged, encoding="unicode")


@dataclass(frozen=True)
class States:
    """A motion in MuJoCo's vectors, at K times.

    A free body's position is x, y, z and a quaternion w first; its velocity is linear along world axes, angular along
    body axes.

    Attributes:
        qpos: (K, nq).
        qvel, qacc: (K, nv).
        tau: (K, nv) joint torques, 0 at the free body [Nm or N].
    """

    qpos: Array
    qvel: Array
    qacc: Array
    tau: Array


def states_of(model: Any, agents: Sequence[AgentTrajectory], lifted: ObjectTrajectory) -> States:
    """Return a motion for a model of ``spec_of``; joints that are welded there are left out."""
    times = len(lifted.pose)
    qpos = np.zeros((times, model.nq))
    qvel, qacc, tau = np.zeros((3, times, model.nv))
    for agent in agents:
        for j, (position, dof) in enumerate(joint_places(model, agent)):
            if dof >= 0:
                qpos[:, position], qvel[:, dof], qacc[:, dof] = agent.q[:, j], agent.v[:, j], agent.a[:, j]
                tau[:, dof] = agent.tau[:, j]
    free = model.joint(f"{lifted.name}_free")
    at, rate = int(free.qposadr[0]), slice(int(free.dofadr[0]), int(free.dofadr[0]) + 6)
    qpos[:, at : at + 3], qpos[:, at + 3 : at + 7] = lifted.pose[:, :3], np.roll(lifted.quaternion, 1, axis=1)
    qvel[:, rate], qacc[:, rate] = (_angular_in_body(lifted, twist) for twist in (lifted.velocity, lifted.acceleration))
    return States(qpos, qvel, qacc, tau)


def joint_places(model: Any, agent: AgentTrajectory) -> list[tuple[int, int]]:
    """Return where each joint of an agent stands in qpos and qvel; (-1, -1) for one that is welded."""
    known = {model.joint(j).name: model.joint(j) for j in range(model.njnt)}
    places = []
    for name in agent.joint_names:
        joint = known.get(name)
        places.append((-1, -1) if joint is None else (int(joint.qposadr[0]), int(joint.dofadr[0])))
    return places


def _angular_in_body(lifted: ObjectTrajectory, twist: Array) -> Array:
    """Return a twist (K, 6) with its angular part in the body's axes; of an acceleration too, since w x w = 0."""
    rotation = Rotation.from_quat(lifted.quaternion)
    return np.hstack([twist[:, :3], rotation.inv().apply(twist[:, 3:])])
