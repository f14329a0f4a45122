"""Sawyer as its manufacturer describes it: links, joints and limits, in the manufacturer's own frames.

Rethink Robotics, sawyer_robot, commit d1ef3d0, sawyer_description/urdf/sawyer_base.urdf.xacro (Apache-2.0).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np

from liftopt.multibody.dh import BodyInertia, rotation_x, rotation_z, translation
from liftopt.multibody.sources import RETHINK, Source
from liftopt.types import Array

SOURCE: Source = RETHINK
PAYLOAD = 4.0  # kg, gripper included; the description has none
PAYLOAD_SOURCE = Source("Rethink Robotics, Sawyer's published specification (4 kg)", "unverified")


@dataclass(frozen=True)
class DescribedLink:
    """Mass [kg], centre of mass [m] and inertia about it (ixx, ixy, ixz, iyy, iyz, izz) [kg m^2], link frame."""

    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]

    def body(self) -> BodyInertia:
        """Return the body in the link's frame."""
        xx, xy, xz, yy, yz, zz = self.inertia
        return BodyInertia(self.mass, np.array(self.com), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


@dataclass(frozen=True)
class DescribedJoint:
    """A revolute joint about its child's z axis: origin in the parent link [m, rad], limits [rad, Nm, rad/s]."""

    xyz: tuple[float, float, float]
    rpy: tuple[float, float, float]
    lower: float
    upper: float
    effort: float
    velocity: float

    def origin(self) -> Array:
        """Return T_parent_joint (4, 4)."""
        return translation(*self.xyz) @ _rpy(*self.rpy)


BASE_LINK = DescribedLink(
    2.0687,
    (-0.0006241, -2.8025e-05, 0.065404),
    (0.0067599, -4.2024e-05, -6.1904e-07, 0.0067877, 1.5888e-05, 0.0074031),
)
PEDESTAL = DescribedLink(
    60.86397744,
    (0.0, 0.0, -0.5),
    (5.0635929, 0.00103417, 0.80199628, 6.08689388, 0.00105311, 4.96191932),
)
# right_l0 to right_l6.
LINKS: tuple[DescribedLink, ...] = (
    DescribedLink(
        5.3213, (0.024366, 0.010969, 0.14363), (0.053314, 0.0047093, 0.011734, 0.057902, 0.0080179, 0.023659)
    ),
    DescribedLink(
        4.505,
        (-0.0030849, -0.026811, 0.092521),
        (0.022398, -0.00023986, -0.00029362, 0.014613, -0.0060875, 0.017295),
    ),
    DescribedLink(
        1.745,
        (-0.00016044, -0.014967, 0.13582),
        (0.025506, 4.4101e-06, 1.4955e-05, 0.0253, -0.0033204, 0.0034179),
    ),
    DescribedLink(
        2.5097,
        (-0.0048135, -0.0281, -0.084154),
        (0.01016, -9.7452e-06, 0.00026624, 0.0065685, 0.0030316, 0.0069078),
    ),
    DescribedLink(
        1.1136,
        (-0.0018844, 0.0069001, 0.1341),
        (0.013557, 1.8109e-05, 0.00013523, 0.013555, 0.0010561, 0.0013658),
    ),
    DescribedLink(
        1.5625,
        (0.0061133, -0.023697, 0.076416),
        (0.0047328, 0.00011526, 4.6269e-05, 0.0029676, -0.0011557, 0.0031762),
    ),
    DescribedLink(
        0.3292,
        (-8.0726e-06, 0.0085838, -0.0049566),
        (0.00031105, 1.4771e-06, -3.7074e-07, 0.00021549, -8.4533e-06, 0.00035976),
    ),
)
# The head turns on right_l0; here it looks forward and is lumped with that link.
HEAD = DescribedLink(
    1.5795,
    (0.0053207, -2.6549e-05, 0.1021),
    (0.011833, -4.4669e-06, 4.9425e-05, 0.0082709, 4.2124e-07, 0.0049661),
)
HEAD_IN_FIRST_LINK = (0.0, 0.0, 0.2965)
# right_j0 to right_j6.
JOINTS: tuple[DescribedJoint, ...] = (
    DescribedJoint((0.0, 0.0, 0.08), (0.0, 0.0, 0.0), -3.0503, 3.0503, 80.0, 1.74),
    DescribedJoint((0.081, 0.05, 0.237), (-1.57079632679, 1.57079632679, 0.0), -3.8095, 2.2736, 80.0, 1.328),
    DescribedJoint((0.0, -0.14, 0.1425), (1.57079632679, 0.0, 0.0), -3.0426, 3.0426, 40.0, 1.957),
    DescribedJoint((0.0, -0.042, 0.26), (-1.57079632679, 0.0, 0.0), -3.0439, 3.0439, 40.0, 1.957),
    DescribedJoint((0.0, -0.125, -0.1265), (1.57079632679, 0.0, 0.0), -2.9761, 2.9761, 9.0, 3.485),
    DescribedJoint((0.0, 0.031, 0.275), (-1.57079632679, 0.0, 0.0), -2.9761, 2.9761, 9.0, 3.485),
    DescribedJoint((0.0, -0.11, 0.1053), (-1.57079632679, -0.17453, 3.1416), -4.7124, 4.7124, 9.0, 4.545),
)
FLANGE_IN_LAST_LINK = (0.0, 0.0, 0.0245)  # right_hand


def described_frames(q: Array) -> list[Array]:
    """Return T_base_link (4, 4) of right_l0 to right_l6 at the manufacturer's joint angles ``q`` (7,) [rad]."""
    frames, current = [], np.eye(4)
    for joint, angle in zip(JOINTS, q, strict=True):
        current = current @ joint.origin() @ rotation_z(float(angle))
        frames.append(current)
    return frames


def _rpy(roll: float, pitch: float, yaw: float) -> Array:
    rotation_y = rotation_x(-np.pi / 2) @ rotation_z(pitch) @ rotation_x(np.pi / 2)
    return reduce(np.matmul, (rotation_z(yaw), rotation_y, rotation_x(roll)))
