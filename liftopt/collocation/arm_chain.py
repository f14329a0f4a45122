"""A serial arm at one knot, on CasADi symbols: what its motion takes, and what the derivatives of that are made of.

It is a tree of ``tree_dynamics`` without branches whose links are parameters and not a model's. The hub is the first
link's frame: near it most entries of rotations and axes are zero.
"""

from __future__ import annotations

from typing import Any

from liftopt.collocation.arm_numbers import Reader, StepSymbols, read_bodies, read_steps
from liftopt.collocation.spatial_symbols import Mass, Motion, Placed
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

        self.n = len(kinds)
        self.parents, self.joints, self.at = [0, *range(self.n)], range(1, self.n + 1), [-1, *range(self.n)]
        self.base = reader.placement()
        q, *others = rates
        self.placed = _placed(kinds, read_steps(kinds, reader), q)
        placed = zip(kinds, self.placed[1:], strict=True)
        twists = (Motion.of_joint(at.rotation[:, 2], at.origin, kind == "P") for kind, at in placed)
        self.axis, self.weight = [Motion.rest(), *twists], [Motion.rest()]
        self.to_world = ca.mtimes(self.base.rotation, self.placed[0].rotation.T)
        # Rates are by the phase: masses over T^2 and gravity times T^2 come to the same.
        self._add_motion(1, ca.mtimes(self.to_world.T, gravity * period**2), (*others, torques))
        bodies = read_bodies(kinds, reader, 1 / period**2)
        self._add_sums({j: _seen(bodies[j - 1], self.placed[j]) for j in self.joints})


def _placed(kinds: str, steps: list[StepSymbols], q: Any) -> list[Placed]:
    """Return where the first link sees the base and the links."""
    import casadi as ca

    hub = Placed(ca.SX.eye(3), ca.SX(3, 1))
    found = [steps[0].then(hub, kinds[0], q[0]).inverse(), hub]
    for j in range(1, len(kinds)):
        found.append(steps[j].then(found[j], kinds[j], q[j]))
    return found


def _seen(body: Mass, placed: Placed) -> Mass:
    """Return a link's body about the hub."""
    import casadi as ca

    far, first = placed.origin, ca.mtimes(placed.rotation, body.first)
    turned = ca.mtimes(placed.rotation, ca.mtimes(body.inertia, placed.rotation.T))
    mixed = ca.mtimes(first, far.T)
    steiner = body.mass * (ca.dot(far, far) * ca.SX.eye(3) - ca.mtimes(far, far.T))
    about_hub = turned + 2 * ca.dot(first, far) * ca.SX.eye(3) - mixed - mixed.T + steiner
    return Mass(body.mass, first + body.mass * far, ca.triu2symm(ca.triu(about_hub)))
