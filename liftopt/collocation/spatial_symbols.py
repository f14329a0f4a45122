"""Spatial vectors and rigid bodies on CasADi symbols, about one point and along one set of axes.

Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 2; a pair holds the angular part first.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Placed:
    """A frame as another sees it: rotation (3, 3) and origin (3,)."""

    rotation: Any
    origin: Any

    def __mul__(self, other: Placed) -> Placed:
        import casadi as ca

        return Placed(ca.mtimes(self.rotation, other.rotation), self.origin + ca.mtimes(self.rotation, other.origin))

    def inverse(self) -> Placed:
        """Return the other frame as this one sees it."""
        import casadi as ca

        return Placed(self.rotation.T, -ca.mtimes(self.rotation.T, self.origin))


@dataclass(frozen=True)
class Motion:
    """A twist: angular velocity and the velocity of what is at the origin, (3,) each."""

    angular: Any
    linear: Any

    @staticmethod
    def rest() -> Motion:
        """Return the twist of what does not move."""
        import casadi as ca

        return Motion(ca.SX(3, 1), ca.SX(3, 1))

    @staticmethod
    def of_joint(axis: Any, origin: Any, slides: bool) -> Motion:
        """Return the twist of what a joint at an origin carries at a rate of one, along or about an axis (3,)."""
        import casadi as ca

        return Motion(ca.SX(3, 1), axis) if slides else Motion(axis, ca.cross(origin, axis))

    def __add__(self, other: Motion) -> Motion:
        return Motion(self.angular + other.angular, self.linear + other.linear)

    def __mul__(self, factor: Any) -> Motion:
        return Motion(self.angular * factor, self.linear * factor)

    def cross(self, other: Motion) -> Motion:
        """Return the rate of ``other`` where it moves with this twist."""
        import casadi as ca

        linear = ca.cross(self.angular, other.linear) + ca.cross(self.linear, other.angular)
        return Motion(ca.cross(self.angular, other.angular), linear)

    def cross_force(self, force: Force) -> Force:
        """Return the rate of ``force`` where it moves with this twist."""
        import casadi as ca

        moment = ca.cross(self.angular, force.moment) + ca.cross(self.linear, force.force)
        return Force(moment, ca.cross(self.angular, force.force))

    def dot(self, force: Force) -> Any:
        """Return the power of ``force``."""
        import casadi as ca

        return ca.dot(self.angular, force.moment) + ca.dot(self.linear, force.force)

    def at(self, point: Any) -> Any:
        """Return the velocity (3,) of what is at a point."""
        import casadi as ca

        return self.linear + ca.cross(self.angular, point)


@dataclass(frozen=True)
class Force:
    """A wrench: moment about the origin and force, (3,) each."""

    moment: Any
    force: Any

    def __add__(self, other: Force) -> Force:
        return Force(self.moment + other.moment, self.force + other.force)

    def __mul__(self, factor: Any) -> Force:
        return Force(self.moment * factor, self.force * factor)


@dataclass(frozen=True)
class Mass:
    """Rigid bodies: mass, its first moment (3,), and the rotational inertia (3, 3) about the origin."""

    mass: Any
    first: Any
    inertia: Any

    def __add__(self, other: Mass) -> Mass:
        return Mass(self.mass + other.mass, self.first + other.first, self.inertia + other.inertia)

    def times(self, twist: Motion) -> Force:
        """Return the momentum at a twist."""
        import casadi as ca

        moment = ca.mtimes(self.inertia, twist.angular) + ca.cross(self.first, twist.linear)
        return Force(moment, self.mass * twist.linear - ca.cross(self.first, twist.angular))

    def turning(self, twist: Motion) -> Turning:
        """Return the map of Coriolis where the bodies move with ``twist``."""
        import casadi as ca

        second = ca.trace(self.inertia) / 2 * ca.SX.eye(3) - self.inertia
        moved = ca.mtimes(ca.skew(twist.angular), second) + ca.mtimes(twist.linear, self.first.T)
        return Turning(2 * (ca.trace(moved) * ca.SX.eye(3) - moved), 2 * self.times(twist).force)


@dataclass(frozen=True)
class Turning:
    """The map from a twist to the wrench of Coriolis, ``sum 2 m w x (velocity)``, of bodies that move.

    It is ``(v x* I) - I (v x) + (I v) x*`` of a body's inertia I and twist v: only the angular part x of a twist
    counts. See Echeandia and Wensing, Numerical Methods to Compute the Coriolis Matrix and Christoffel Symbols (2021).

    Attributes:
        moment: (3, 3) of x.
        momentum: (3,) twice the linear momentum.
    """

    moment: Any
    momentum: Any

    def __add__(self, other: Turning) -> Turning:
        return Turning(self.moment + other.moment, self.momentum + other.momentum)

    def times(self, twist: Motion) -> Force:
        """Return the wrench."""
        import casadi as ca

        return Force(ca.mtimes(self.moment, twist.angular), ca.cross(twist.angular, self.momentum))

    def transposed_times(self, twist: Motion) -> Any:
        """Return the moment (3,) of the transposed map, which has no force."""
        import casadi as ca

        return ca.mtimes(self.moment.T, twist.angular) + ca.cross(self.momentum, twist.linear)
