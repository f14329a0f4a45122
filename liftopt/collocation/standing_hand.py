"""A hand of a tree and its grasp at one knot, on CasADi symbols, and what it adds to derivatives by joints above it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from liftopt.collocation.tree_dynamics import Tree


@dataclass(frozen=True)
class Hand:
    """A hand and its grasp, along the hub's axes.

    Attributes:
        joint: that carries it.
        point: (3,) grasp point.
        force, moment: (3,) that it exerts on the object.
        pull: (3,) weight of the point's position; ``alike`` that of the cosine.
        grip, aim: (3, 3) grip axes and the object's axes.
        axis: by joint above it, (3,) angular velocity at a rate of one; ``reach`` slope (3,) of the point; ``swing`` of
            the point's velocity by the weights; ``tilt`` of the angular velocity by the weights.
    """

    joint: int
    point: Any
    force: Any
    moment: Any
    pull: Any
    alike: Any
    grip: Any
    aim: Any
    axis: dict[int, Any]
    reach: dict[int, Any]
    swing: dict[int, Any]
    tilt: dict[int, Any]

    @staticmethod
    def of(
        tree: Tree, joint: int, point: Any, force: Any, moment: Any, pull: Any, alike: Any, grip: Any, aim: Any
    ) -> Hand:
        """Return a hand of a tree; arguments as the attributes."""
        import casadi as ca

        axes, reach, swing, tilt, whole = {}, {}, {}, {}, tree.weight[joint]
        for j in tree.path(joint):
            above = tree.weight[tree.parents[j]]
            axes[j], reach[j] = tree.axis[j].angular, tree.axis[j].at(point)
            apart = whole.at(point) - above.at(point)
            swing[j] = ca.cross(above.angular, reach[j]) + ca.cross(axes[j], apart)
            tilt[j] = ca.cross(axes[j], whole.angular - above.angular)
        return Hand(joint, point, force, moment, pull, alike, grip, aim, axes, reach, swing, tilt)

    def turn(self, aim: Any) -> Any:
        """Return the slope (3,) of the cosine by a turn of the hand, for axes of the object."""
        import casadi as ca

        return sum(ca.cross(self.grip[:, c], aim[:, c]) for c in range(3)) / 2

    def slope(self, j: int) -> Any:
        """Return the slope of the hand's share of the weighted sum by the position of joint j."""
        import casadi as ca

        by_wrench = ca.dot(self.swing[j], self.force) + ca.dot(self.tilt[j], self.moment)
        by_place = ca.dot(self.reach[j], self.pull) + self.alike * ca.dot(self.axis[j], self.turn(self.aim))
        return by_wrench + by_place

    def bent(self, j: int) -> Any:
        """Return the moment (3,) by whose product with the axis of a joint above, or j, that slope changes with it."""
        import casadi as ca

        axis, product = self.axis[j], ca.mtimes(self.grip, self.aim.T)
        by_wrench = ca.cross(self.swing[j], self.force) + ca.cross(self.tilt[j], self.moment)
        by_turn = self.alike / 2 * (ca.mtimes(product, axis) - ca.trace(product) * axis)
        return by_wrench + ca.cross(self.reach[j], self.pull) + by_turn
