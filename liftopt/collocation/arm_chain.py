"""A serial arm at one knot, on CasADi symbols: what its motion takes, and what the derivatives of that are made of.

It is a tree of ``tree_dynamics`` without branches whose links are parameters and not a model's. The hub is the first
link's frame: near it most entries of rotations and axes are zero.
"""

from __future__ import annotations

from typing import Any

from liftopt.collocation.arm_numbers import Reader, StepSymbols, read_bodies, read_steps
from liftopt.collocation.spatial_symbols import Force, Mass, Motion, Placed, Turning
from liftopt.collocation.tree_dynamics import Tree


class ArmChain(Tree):
    """The arm; lists are by joint, as a tree's are.

    Attributes:
        to_world: (3, 3) rotation from the hub's axes to the world's.
        base: placement of the base in the world.
    """

    def __init__(
        self, kinds: str, reader: Reader, rates: tuple[Any, Any, Any], torques: Any, gravity: Any, period: Any
    ) -> None:  # fmt: skip
        """Set the arm up.

        Args:
            kinds: of the joints from the base on, R or P.
            reader: of the arm's numbers.
            rates: (n,) joint positions, and their first and second derivatives by the phase.
            torques: (n,) weights of the torques.
            gravity: (3,) in the world [m/s^2].
            period: [s].
        """
        import casadi as ca

        self.parents, self.joints = [0, *range(len(kinds))], range(1, len(kinds) + 1)
        self.base = reader.placement()
        q, v, a = rates
        self.placed = _placed(kinds, read_steps(kinds, reader), q)
        self.axis = [_rest(), *(_axis(kinds[j - 1], self.placed[j]) for j in self.joints)]
        self.to_world = ca.mtimes(self.base.rotation, self.placed[0].rotation.T)
        # Rates are by the phase: masses over T^2 and gravity times T^2 come to the same.
        self._move(ca.mtimes(self.to_world.T, gravity * period**2), v, a, torques)
        self._sum(read_bodies(kinds, reader, 1 / period**2))

    def _move(self, gravity: Any, v: Any, a: Any, torques: Any) -> None:
        import casadi as ca

        none, first = ca.SX(3, 1), self.axis[1]
        self.weight, self.moved, self.lifted, self.weighted = [_rest()], [_rest()], [_rest()], [_rest()]
        self._acceleration = [Motion(none, -gravity)]
        # The hub is at rest for the observer there, and the base moves back.
        self._velocity = [Motion(none, -first.linear * v[0])]
        for j in self.joints:
            axis, i = self.axis[j], j - 1
            moved = self._velocity[i].cross(axis)
            self.moved.append(moved)
            self.lifted.append(self._acceleration[i].cross(axis) + self._velocity[i].cross(moved))
            self.weighted.append(self.weight[i].cross(axis))
            self._velocity.append(self._velocity[i] + axis * v[i] if i else Motion(first.angular * v[0], none))
            self._acceleration.append(self._acceleration[i] + axis * a[i] + moved * v[i])
            self.weight.append(self.weight[i] + axis * torques[i])

    def _sum(self, bodies: list[Mass]) -> None:
        import casadi as ca

        none, count = ca.SX(3, 1), len(self.parents)
        self.carried = [Mass(ca.SX(1, 1), none, ca.SX(3, 3))] * count
        self.load, self.momentum = [Force(none, none)] * count, [Force(none, none)] * count
        self.turning, self.weight_turning = [Turning(ca.SX(3, 3), none)] * count, [Turning(ca.SX(3, 3), none)] * count
        self.power = [none] * count
        sums: tuple[list[Any], ...] = (
            self.carried, self.load, self.momentum, self.turning, self.weight_turning, self.power
        )  # fmt: skip
        for j in reversed(self.joints):
            twist, weight, body = self._velocity[j], self.weight[j], _seen(bodies[j - 1], self.placed[j])
            turning = body.turning(twist)
            load = body.times(self._acceleration[j]) + twist.cross_force(body.times(twist))
            power = turning.transposed_times(weight)
            own = (body, load, body.times(weight), turning, body.turning(weight), power)
            for total, one in zip(sums, own, strict=True):
                total[j] += one
                total[j - 1] = total[j]


def _rest() -> Motion:
    import casadi as ca

    return Motion(ca.SX(3, 1), ca.SX(3, 1))


def _placed(kinds: str, steps: list[StepSymbols], q: Any) -> list[Placed]:
    """Return where the first link sees the base and the links."""
    import casadi as ca

    hub = Placed(ca.SX.eye(3), ca.SX(3, 1))
    found = [steps[0].then(hub, kinds[0], q[0]).inverse(), hub]
    for j in range(1, len(kinds)):
        found.append(steps[j].then(found[j], kinds[j], q[j]))
    return found


def _axis(kind: str, placed: Placed) -> Motion:
    """Return the twist of what a joint carries at a rate of one."""
    import casadi as ca

    axis = placed.rotation[:, 2]
    return Motion(ca.SX(3, 1), axis) if kind == "P" else Motion(axis, ca.cross(placed.origin, axis))


def _seen(body: Mass, placed: Placed) -> Mass:
    """Return a link's body about the hub."""
    import casadi as ca

    far, first = placed.origin, ca.mtimes(placed.rotation, body.first)
    turned = ca.mtimes(placed.rotation, ca.mtimes(body.inertia, placed.rotation.T))
    mixed = ca.mtimes(first, far.T)
    steiner = body.mass * (ca.dot(far, far) * ca.SX.eye(3) - ca.mtimes(far, far.T))
    about_hub = turned + 2 * ca.dot(first, far) * ca.SX.eye(3) - mixed - mixed.T + steiner
    return Mass(body.mass, first + body.mass * far, ca.triu2symm(ca.triu(about_hub)))
