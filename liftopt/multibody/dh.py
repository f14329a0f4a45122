"""Denavit-Hartenberg chains: Tables 2, 3 and 4 of the paper as data, and the transform of one row.

Arefeen, Quarnstrom, Syed, Bai, Xiang (2023), "Human-Robot Collaborative Lifting Motion Prediction and
Experimental Validation", J Intell Robot Syst, doi 10.1007/s10846-023-02013-y. Angles in rad, lengths in m.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Literal

import numpy as np

from liftopt.types import Array

JointKind = Literal["prismatic", "revolute"]


@dataclass(frozen=True)
class DHRow:
    """One row of a DH table: ``A = Rz(theta) Tz(d) Tx(a) Rx(alpha)``, the joint variable added to theta or d.

    Attributes:
        name: joint name as in the paper (``"GT1"``, ``"Q4"``, ``"GR2"``).
        kind: ``"prismatic"`` adds the variable to ``d``, ``"revolute"`` to ``theta``.
        theta: default angle about z [rad].
        d: default offset along z [m].
        a: offset along the turned x [m].
        alpha: twist about the turned x [rad].
    """

    name: str
    kind: JointKind
    theta: float
    d: float
    a: float
    alpha: float


@dataclass(frozen=True)
class BodyInertia:
    """Mass properties of one body.

    Attributes:
        mass: [kg].
        com: (3,) centre of mass in the body's frame [m].
        inertia: (3, 3) rotational inertia about the centre of mass, axes of the body's frame [kg m^2].
    """

    mass: float
    com: Array
    inertia: Array

    @staticmethod
    def zero() -> BodyInertia:
        """Return the massless body of a virtual joint."""
        return BodyInertia(0.0, np.zeros(3), np.zeros((3, 3)))

    def transformed(self, rotation: Array, translation: Array) -> BodyInertia:
        """Return the same body seen from frame A, given R_A_B (3, 3) and p_A_B (3,) of its present frame B."""
        return BodyInertia(self.mass, rotation @ self.com + translation, rotation @ self.inertia @ rotation.T)

    def rounded(self) -> BodyInertia:
        """Return the body to 12 decimals: sums of products below that may differ from one processor to the next."""
        return BodyInertia(round(self.mass, 12), np.round(self.com, 12) + 0.0, np.round(self.inertia, 12) + 0.0)

    def __add__(self, other: BodyInertia) -> BodyInertia:
        """Lump two bodies whose properties are given in one frame (parallel-axis theorem)."""
        mass = self.mass + other.mass
        if mass == 0.0:
            return BodyInertia.zero()
        com = (self.mass * self.com + other.mass * other.com) / mass
        inertia = np.zeros((3, 3))
        for body in (self, other):
            r = body.com - com
            inertia += body.inertia + body.mass * (r @ r * np.eye(3) - np.outer(r, r))
        return BodyInertia(mass, com, inertia)


@dataclass(frozen=True)
class DHChain:
    """A serial chain: DH rows and the body that each row moves, its inertia in that row's DH frame.

    Attributes:
        name: prefix of the joint names in the exported URDF (``"human"``, ``"robot"``, ``"table"``).
        rows: the DH table.
        inertias: one ``BodyInertia`` per row, in the DH frame after that row.
    """

    name: str
    rows: tuple[DHRow, ...]
    inertias: tuple[BodyInertia, ...]

    def __post_init__(self) -> None:
        if len(self.rows) != len(self.inertias):
            raise ValueError(f"{self.name}: {len(self.rows)} rows but {len(self.inertias)} inertias")


def rotation_z(angle: float) -> Array:
    """Return the (4, 4) rotation about z by ``angle`` [rad]; multiples of pi/2 are exact."""
    c, s = _cos_sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def rotation_x(angle: float) -> Array:
    """Return the (4, 4) rotation about x by ``angle`` [rad]; multiples of pi/2 are exact."""
    c, s = _cos_sin(angle)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]])


def translation(x: float, y: float, z: float) -> Array:
    """Return the (4, 4) translation by (x, y, z) [m]."""
    transform = np.eye(4)
    transform[:3, 3] = (x, y, z)
    return transform


def row_transform(row: DHRow, q: float = 0.0) -> Array:
    """Return A (4, 4) of one row at joint value ``q`` [rad or m]: ``Rz(theta) Tz(d) Tx(a) Rx(alpha)``."""
    revolute = row.kind == "revolute"
    theta = row.theta + (q if revolute else 0.0)
    d = row.d + (0.0 if revolute else q)
    return rotation_z(theta) @ translation(0, 0, d) @ translation(row.a, 0, 0) @ rotation_x(row.alpha)


def row_origin(row: DHRow) -> Array:
    """Return the (4, 4) part of a row before its motion: ``Rz(theta)``, with ``Tz(d)`` if it is prismatic."""
    origin = rotation_z(row.theta)
    return origin @ translation(0, 0, row.d) if row.kind == "prismatic" else origin


def row_tail(row: DHRow) -> Array:
    """Return the (4, 4) part of a row after its motion: ``Tz(d) Tx(a) Rx(alpha)``, without ``Tz(d)`` if prismatic."""
    tail = translation(row.a, 0, 0) @ rotation_x(row.alpha)
    return tail if row.kind == "prismatic" else translation(0, 0, row.d) @ tail


def frame_transforms(chain: DHChain, q: Array) -> list[Array]:
    """Return the (4, 4) placement of every DH frame in the chain's root frame at ``q`` (n,) [rad, m]."""
    transforms, current = [], np.eye(4)
    for row, value in zip(chain.rows, q, strict=True):
        current = current @ row_transform(row, float(value))
        transforms.append(current)
    return transforms


def human_rows(l1: float, l2: float, l3: float, l4: float, l5: float, l6: float) -> tuple[DHRow, ...]:
    """Return Table 2, the human arm: L1 foot to spine, L2 spine to shoulder height, L3 half breadth, L4-L6 arm [m]."""
    h = pi / 2
    return (
        DHRow("GT1", "prismatic", h, 0.0, 0.0, h),
        DHRow("GT2", "prismatic", h, 0.0, 0.0, h),
        DHRow("GT3", "prismatic", h, l1, 0.0, h),
        DHRow("Q1", "revolute", h, 0.0, 0.0, h),
        DHRow("Q2", "revolute", h, 0.0, 0.0, h),
        DHRow("Q3", "revolute", -h, l2, l3, -h),
        DHRow("Q4", "revolute", h, 0.0, 0.0, h),
        DHRow("Q5", "revolute", -h, 0.0, 0.0, h),
        DHRow("Q6", "revolute", 0.0, -l4, 0.0, h),
        DHRow("Q7", "revolute", 0.0, 0.0, 0.0, h),
        DHRow("Q8", "revolute", 0.0, l5, 0.0, -h),
        DHRow("Q9", "revolute", h, 0.0, 0.0, -h),
        DHRow("Q10", "revolute", 0.0, 0.0, -l6, 0.0),
    )


def robot_rows(lengths: tuple[float, float, float, float, float, float, float, float, float]) -> tuple[DHRow, ...]:
    """Return Table 3, the Sawyer arm, for its lengths l1 to l9 [m]; l9 is the height of the base."""
    h = pi / 2
    l1, l2, l3, l4, l5, l6, l7, l8, l9 = lengths
    return (
        DHRow("GT1", "prismatic", h, 0.0, 0.0, h),
        DHRow("GT2", "prismatic", h, 0.0, 0.0, h),
        DHRow("GT3", "prismatic", 0.0, l9, 0.0, 0.0),
        DHRow("Q1", "revolute", 0.0, l1, l2, -h),
        DHRow("Q2", "revolute", -h, l3, 0.0, -h),
        DHRow("Q3", "revolute", pi, l4, 0.0, h),
        DHRow("Q4", "revolute", 0.0, l5, 0.0, -h),
        DHRow("Q5", "revolute", 0.0, l6, 0.0, -h),
        DHRow("Q6", "revolute", pi, l7, 0.0, -h),
        DHRow("Q7", "revolute", -h, l8, 0.0, 0.0),
    )


def table_rows() -> tuple[DHRow, ...]:
    """Return Table 4, the floating-base table: three global translations, then three global rotations."""
    h = pi / 2
    return (
        DHRow("GT1", "prismatic", h, 0.0, 0.0, h),
        DHRow("GT2", "prismatic", h, 0.0, 0.0, h),
        DHRow("GT3", "prismatic", h, 0.0, 0.0, h),
        DHRow("GR1", "revolute", h, 0.0, 0.0, h),
        DHRow("GR2", "revolute", h, 0.0, 0.0, h),
        DHRow("GR3", "revolute", -h, 0.0, 0.0, -h),
    )


# World (Z up, X human to robot, Y to the human's left) from the paper's frame (Y up, Z forward, X left).
ROTATION_WORLD_PAPER: Array = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def _cos_sin(angle: float) -> tuple[float, float]:
    quarter_turns = angle / (pi / 2)
    if abs(quarter_turns - round(quarter_turns)) < 1e-12:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarter_turns) % 4]
    return float(np.cos(angle)), float(np.sin(angle))
