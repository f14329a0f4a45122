"""Where the links of a serial arm are: the functions of ``pose_kernels``, every placement between joints a parameter.

One kernel serves every arm with the same kinds of joints in the same order. It gives the poses of all links, whichever
carry something, and in the frames that the model gives them. Joint k is before joint j, or is j, throughout.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from liftopt.collocation import arm_frames, arm_numbers, spatial_symbols
from liftopt.collocation.arm_dynamics import signature_of
from liftopt.collocation.arm_frames import arm_kinds
from liftopt.collocation.arm_numbers import Reader, about_z, along_z, placement_numbers
from liftopt.collocation.dynamics import KnotFunctions
from liftopt.collocation.pose_kernels import POSE_SIZE, PoseTopology
from liftopt.collocation.spatial_symbols import Placed

PARTS = (arm_frames, arm_numbers, spatial_symbols)


@dataclass(frozen=True)
class ArmPoseTopology(PoseTopology):
    """A serial arm as these kernels see it; its entries are the placements of its joints where the ones before are.

    Attributes:
        kinds: of its joints from the base on, R for one that turns and P for one that slides.
    """

    kinds: str = ""

    @staticmethod
    def of_links(model: pin.Model) -> ArmPoseTopology:
        """Read the topology out of a Pinocchio model.

        Raises:
            ModelError: it is no serial arm, or a joint neither turns about nor slides along its z axis.
        """
        kinds, joints = arm_kinds(model), tuple(range(1, model.njoints))
        places = [model.jointPlacements[j] for j in joints]
        numbers = np.concatenate([placement_numbers(place.rotation, place.translation) for place in places])
        return ArmPoseTopology(model, (), numbers, joints, kinds)

    @property
    def parameters(self) -> Any:
        """Values (p,) that a kernel takes."""
        return self.entries

    def signature(self) -> str:
        """Return a digest of all that a kernel is generated from; equal signatures share a kernel."""
        return signature_of(self.kinds, self.model, __file__, *(str(part.__file__) for part in PARTS))


def arm_pose_functions(topology: ArmPoseTopology) -> KnotFunctions:
    """Return the functions of an arm's links: y = q, c = (p_world_joint, R_world_joint by columns) of each joint."""
    import casadi as ca

    kinds, n = topology.kinds, len(topology.kinds)
    q, period, numbers = ca.SX.sym("q", n), ca.SX.sym("T"), ca.SX.sym("p", len(topology.entries))
    m, links, p = ca.SX.sym("m", POSE_SIZE * n), _links(kinds, q, Reader(numbers)), ca.vertcat(period, numbers)
    gradient, curvature = _weighted(kinds, links, ca.vertsplit(m, POSE_SIZE))
    c = ca.densify(ca.vertcat(*(ca.vertcat(link.origin, ca.vec(link.rotation)) for link in links)))
    slopes = _slopes(kinds, links)
    leading, d = ca.SX.sym("slopes", slopes.sparsity()), ca.SX.sym("d", 0)
    return KnotFunctions(
        value=ca.Function("value", [q, p], ca.cse([c])),
        gradient=ca.Function("gradient", [q, p, m], ca.cse([ca.densify(gradient)])),
        jacobian=ca.Function("jacobian", [q, p], ca.cse([slopes])),
        curvature=ca.Function("curvature", [q, p, m], ca.cse([curvature])),
        squares=ca.Function("squares", [leading, d], [ca.SX(n, n)]),
    )


def _links(kinds: str, q: Any, reader: Reader) -> list[Placed]:
    """Return where the links are in the world."""
    import casadi as ca

    found: list[Placed] = []
    for j, kind in enumerate(kinds):
        place = reader.placement()
        place = found[-1] * place if found else place
        if kind == "R":
            found.append(Placed(ca.mtimes(place.rotation, about_z(q[j])), place.origin))
        else:
            found.append(Placed(place.rotation, place.origin + ca.mtimes(place.rotation, along_z(q[j]))))
    return found


def _slopes(kinds: str, links: list[Placed]) -> Any:
    """Return the slopes (12 n, n) of all poses."""
    import casadi as ca

    found = ca.SX(POSE_SIZE * len(kinds), len(kinds))
    for j, link in enumerate(links):
        first = POSE_SIZE * j
        for k in range(j + 1):
            axis = links[k].rotation[:, 2]
            if kinds[k] == "P":
                found[first : first + 3, k] = axis
                continue
            found[first : first + 3, k] = ca.cross(axis, link.origin - links[k].origin)
            for column in range(3):
                at = first + 3 * (column + 1)
                found[at : at + 3, k] = ca.cross(axis, link.rotation[:, column])
    return ca.sparsify(found)


def _weighted(kinds: str, links: list[Placed], weights: list[Any]) -> tuple[Any, Any]:
    """Return slopes (n,) and the upper triangle (n, n) of the second derivatives of the weighted sum of all poses.

    With the weights w of a link's position p and W of its rotation R, and o the origin of joint j, sums over all links
    that j carries are the force w and the matrix (p - o) w^T + R W^T, whose antisymmetric part is the moment.
    """
    import casadi as ca

    n = len(kinds)
    slope, bend, force, spread = ca.SX(n, 1), ca.SX(n, n), ca.SX(3, 1), ca.SX(3, 3)
    for j in reversed(range(n)):
        link, kind, axis = links[j], kinds[j], links[j].rotation[:, 2]
        by_position, by_rotation = weights[j][:3], ca.reshape(weights[j][3:], 3, 3)
        force = force + by_position
        # About the world's origin; then about this joint's.
        spread = spread + ca.mtimes(link.origin, by_position.T) + ca.mtimes(link.rotation, by_rotation.T)
        about = spread - ca.mtimes(link.origin, force.T)
        if kind == "R":
            moment = ca.vertcat(about[1, 2] - about[2, 1], about[2, 0] - about[0, 2], about[0, 1] - about[1, 0])
            slope[j] = ca.dot(axis, moment)
            turned = ca.mtimes(about, axis) - ca.trace(about) * axis
        else:
            slope[j] = ca.dot(axis, force)
            turned = ca.cross(axis, force)
        for k in range(j + 1):
            if kinds[k] == "R" and (kind == "R" or k < j):
                bend[k, j] = ca.dot(links[k].rotation[:, 2], turned)
    return slope, ca.triu(ca.sparsify(bend))
