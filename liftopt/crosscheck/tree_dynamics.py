"""Inverse dynamics of a tree of links by Newton and Euler, in plain NumPy, on numbers read out of the URDF here.

Nothing is shared with Pinocchio: the URDF is taken apart with ElementTree, a posture's frames are in world axes, and
every link's momentum balance is written out about its own centre of mass. All is batched over S states.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from liftopt.types import Array

WORLD = "world"
GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True)
class TreeBody:
    """One rigid body on a link: mass [kg], centre of mass (3,) and inertia about it (3, 3), in the link's axes."""

    mass: float
    com: Array
    inertia: Array


@dataclass(frozen=True)
class Tree:
    """The moving links of a URDF, parents first; what is fixed to a link is part of it.

    Attributes:
        joints: (n,) names.
        parents: (n,) index of the link that carries each, -1 for the world.
        placements: (n, 4, 4) of each link in its parent at zero.
        axes: (n, 3) of each joint in its link's frame.
        bodies: of each link, and last of the world: what rests there.
        frames: link name -> (index, (4, 4) in that link) of every link of the URDF.
    """

    joints: tuple[str, ...]
    parents: tuple[int, ...]
    placements: Array
    axes: Array
    bodies: tuple[tuple[TreeBody, ...], ...]
    frames: dict[str, tuple[int, Array]]


@dataclass(frozen=True)
class TreeForces:
    """What S states of a tree need.

    Attributes:
        tau: (S, n) torques [Nm], in the order of ``Tree.joints``.
        force: (S, 3) of the ground on the tree, what rests there included [N], world axes.
        moment: (S, 3) likewise about the world's origin [Nm].
        positions: frame name -> (S, 3) of the loaded frames in the world [m].
    """

    tau: Array
    force: Array
    moment: Array
    positions: dict[str, Array]


def read_tree(urdf: str, joints: Sequence[str]) -> Tree:
    """Return the tree of a URDF whose root is the link ``world`` and whose moving joints are revolute.

    Args:
        urdf: its text.
        joints: names of the moving joints in the order wanted, parents first.

    Raises:
        ValueError: the URDF moves other joints, or one that is not revolute.
    """
    root = ElementTree.fromstring(urdf)
    by_name = {str(joint.get("name")): joint for joint in root.iter("joint")}
    moving = {name for name, joint in by_name.items() if joint.get("type") != "fixed"}
    if moving != set(joints) or any(by_name[name].get("type") != "revolute" for name in joints):
        raise ValueError(f"the tree must move {sorted(joints)} by revolute joints; it has {sorted(moving)}")
    frames: dict[str, tuple[int, Array]] = {WORLD: (-1, np.eye(4))}
    numbers = {name: k for k, name in enumerate(joints)}
    parents, placements = [-1] * len(joints), np.zeros((len(joints), 4, 4))
    waiting = dict(by_name)
    while waiting:
        ready = [name for name, joint in waiting.items() if _end(joint, "parent") in frames]
        if not ready:
            raise ValueError(f"joints {sorted(waiting)} hang on no link of the tree")
        for name in ready:
            joint = waiting.pop(name)
            carrier, at = frames[_end(joint, "parent")]
            own = at @ _origin(joint.find("origin"))
            if name in numbers:
                parents[numbers[name]], placements[numbers[name]] = carrier, own
                carrier, own = numbers[name], np.eye(4)
            frames[_end(joint, "child")] = carrier, own
    bodies: list[list[TreeBody]] = [[] for _ in range(len(joints) + 1)]
    for link in root.iter("link"):
        if (inertial := link.find("inertial")) is not None:
            carrier, at = frames[str(link.get("name"))]
            bodies[carrier].append(_body(inertial, at))
    axes = np.array([_numbers(by_name[name].find("axis").get("xyz")) for name in joints])  # type: ignore[union-attr]
    return Tree(tuple(joints), tuple(parents), placements, axes, tuple(map(tuple, bodies)), frames)


def tree_forces(tree: Tree, q: Array, v: Array, a: Array, loads: Mapping[str, tuple[Array, Array]]) -> TreeForces:
    """Return what a motion needs.

    Args:
        tree: of n joints.
        q: (S, n) joint positions [rad].
        v: (S, n) joint velocities.
        a: (S, n) joint accelerations.
        loads: frame name -> force and moment (S, 3) on the tree there, world axes [N, Nm].
    """
    samples, n = q.shape
    turn, place = np.zeros((n, samples, 3, 3)), np.zeros((n, samples, 3))
    spin, spin_rate, rate = np.zeros((3, n + 1, samples, 3))  # the last row is the world, which rests
    axis = np.zeros((n, samples, 3))
    for i, parent in enumerate(tree.parents):
        above = turn[parent] if parent >= 0 else np.broadcast_to(np.eye(3), (samples, 3, 3))
        reach = above @ tree.placements[i, :3, 3]
        place[i] = reach + (place[parent] if parent >= 0 else 0.0)
        turn[i] = above @ tree.placements[i, :3, :3] @ _rotation(tree.axes[i], q[:, i])
        axis[i] = turn[i] @ tree.axes[i]
        own = axis[i] * v[:, i, None]
        spin[i] = spin[parent] + own
        spin_rate[i] = spin_rate[parent] + axis[i] * a[:, i, None] + np.cross(spin[parent], own)
        rate[i] = rate[parent] + _carried(spin[parent], spin_rate[parent], reach)
    force, moment = np.zeros((2, n + 1, samples, 3))  # on each link, the moment about the world's origin
    for i, bodies in enumerate(tree.bodies):
        turned = turn[i] if i < n else np.broadcast_to(np.eye(3), (samples, 3, 3))
        origin = place[i] if i < n else np.zeros((samples, 3))
        for body in bodies:
            arm = turned @ body.com
            inertia = turned @ body.inertia @ turned.swapaxes(1, 2)
            need = body.mass * (rate[i] + _carried(spin[i], spin_rate[i], arm) - GRAVITY)
            momentum = (inertia @ spin[i][..., None])[..., 0]
            turning = (inertia @ spin_rate[i][..., None])[..., 0] + np.cross(spin[i], momentum)
            force[i] += need
            moment[i] += np.cross(origin + arm, need) + turning
    positions = {}
    for name, (push, twist) in loads.items():
        i, at = tree.frames[name]
        positions[name] = place[i] + turn[i] @ at[:3, 3]
        force[i] -= push
        moment[i] -= np.cross(positions[name], push) + twist
    tau = np.zeros((samples, n))
    for i in reversed(range(n)):
        tau[:, i] = np.einsum("sc,sc->s", axis[i], moment[i] - np.cross(place[i], force[i]))
        force[tree.parents[i]] += force[i]
        moment[tree.parents[i]] += moment[i]
    return TreeForces(tau, force[-1], moment[-1], positions)


def _carried(spin: Array, spin_rate: Array, arm: Array) -> Array:
    """Return the acceleration (S, 3) of a point at ``arm`` on a body that turns, against the body's own point."""
    return np.asarray(np.cross(spin_rate, arm) + np.cross(spin, np.cross(spin, arm)))


def _rotation(axis: Array, angle: Array) -> Array:
    """Return rotations (S, 3, 3) by angles (S,) about a unit axis (3,), by Rodrigues' formula."""
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    c, s = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
    return np.asarray(np.eye(3) + s * skew + (1.0 - c) * skew @ skew)


def _body(inertial: Element, at: Array) -> TreeBody:
    origin, moments = _origin(inertial.find("origin")), inertial.find("inertia")
    values = {axes: float(moments.get(axes, "0")) for axes in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")}  # type: ignore[union-attr]
    own = np.array([[values[f"i{min(r, c)}{max(r, c)}"] for c in "xyz"] for r in "xyz"])
    placed = at @ origin
    turn = placed[:3, :3]
    mass = float(inertial.find("mass").get("value", "0"))  # type: ignore[union-attr]
    return TreeBody(mass, placed[:3, 3], turn @ own @ turn.T)


def _origin(origin: Element | None) -> Array:
    placement = np.eye(4)
    if origin is not None:
        roll, pitch, yaw = np.array(_numbers(origin.get("rpy", "0 0 0")))[:, None]
        x, y, z = np.eye(3)
        placement[:3, :3] = (_rotation(z, yaw) @ _rotation(y, pitch) @ _rotation(x, roll))[0]
        placement[:3, 3] = _numbers(origin.get("xyz", "0 0 0"))
    return placement


def _end(joint: Element, kind: str) -> str:
    return str(joint.find(kind).get("link"))  # type: ignore[union-attr]


def _numbers(text: str | None) -> tuple[float, ...]:
    return tuple(map(float, (text or "1 0 0").split()))
