"""A tree of links on CasADi symbols: what its motion takes, and what the derivatives of that are made of.

A weighted sum of joint torques is the virtual power of the links at the joint rates that the weights are,
``sum_i w_i . (I_i a_i + v_i x* I_i v_i)``, and the weights of the base's reaction are a twist of the base. A joint
above joint j changes what j carries only by the twists and the acceleration that j is given. So every derivative by a
pair of joints is a few products of six numbers of each, which takes far fewer instructions than CasADi's derivatives
of Pinocchio's recursion. Analytical derivatives: Singh, Russell and Wensing, Efficient Analytical Derivatives of
Rigid-Body Dynamics using Spatial Vector Algebra (2022), and Analytical Second-Order Partial Derivatives of Rigid-Body
Inverse Dynamics (2022).

All vectors are along the axes of one link and about one point of it, the hub, where few of their entries count; and
they are seen by an observer who moves as that point does at this moment, which changes no torque.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from liftopt.collocation.dynamics import STRUCTURAL_ZERO
from liftopt.collocation.spatial_symbols import Force, Mass, Motion, Placed, Turning


class Tree:
    """The tree at one knot. Lists are by joint; entry 0 is the base, and of sums that of all that moves.

    Attributes:
        n: number of joints; ``joints`` their numbers; ``parents`` the joints that carry them.
        at: places of their rates.
        placed: frames of the links.
        axis: twist S of what joint j carries at a rate of one; ``moved`` is its rate where it moves with the link
            before, ``weighted`` where that moves by the weights; ``lifted`` is its second rate, by gravity too.
        weight: twists of the links by the weights.
        carried, load, momentum: sums over a joint's link and all that it carries: of masses, of the forces that the
            motion takes, and of momenta by the weights.
        turning, weight_turning: sums of the maps of Coriolis, where the links move, and move by the weights.
        power: sums of the moments (3,) by whose product with a further angular velocity the weighted sum grows.
    """

    def __init__(
        self, cpin: Any, model: Any, structure: pin.Model, rates: tuple[Any, Any, Any], weights: tuple[Any, Any, Any]
    ) -> None:
        """Set the tree up.

        Args:
            cpin: pinocchio.casadi.
            model: on symbols.
            structure: the same model in numbers, of which only the structure counts.
            rates: (n,) joint positions, velocities and accelerations.
            weights: (n,) of the torques, (3,) of the force and (3,) of the moment at the base.
        """
        import casadi as ca

        q, *others = rates
        self.n, self.joints = int(structure.nv), range(1, structure.njoints)
        self.parents, self.at = [int(parent) for parent in structure.parents], _index(structure)
        hub = _hub(structure)
        self.placed = _placed(cpin, model, structure, hub, q)
        self.axis = [Motion.rest(), *(_axis(structure.joints[j], self.placed[j]) for j in self.joints)]
        (torques, force, moment), base = weights, self.placed[0]
        turn = ca.mtimes(base.rotation, moment)
        self.weight = [Motion(turn, ca.mtimes(base.rotation, force) + ca.cross(base.origin, turn))]
        self._add_motion(self.parents[hub], ca.mtimes(base.rotation, model.gravity.linear), (*others, torques))
        bodies = {j: _body(model.inertias[j], self.placed[j]) for j in self.joints if structure.inertias[j].mass}
        self._add_sums(bodies)

    def _add_motion(self, still: int, gravity: Any, rates: tuple[Any, Any, Any]) -> None:
        """Add what links do; ``weight`` holds the base's already.

        Args:
            still: joint to whose link the hub is fixed.
            gravity: (3,) along the hub's axes.
            rates: (n,) joint velocities and accelerations, and weights of the torques.
        """
        import casadi as ca

        at, (v, a, torques) = self.at, rates
        self.moved, self.lifted, self.weighted = [Motion.rest()], [Motion.rest()], [Motion.rest()]
        self._acceleration = [Motion(ca.SX(3, 1), -gravity)]
        # The hub is at rest for the observer there, and the links before it move back.
        back, drift = ca.SX(3, 1), {0: ca.SX(3, 1)}
        for j in reversed(self.path(still)):
            drift[j] = back
            back = drift[self.parents[j]] = back - self.axis[j].linear * v[at[j]]
        self._velocity = [Motion(ca.SX(3, 1), drift[0])]
        for j in self.joints:
            axis, i = self.axis[j], self.parents[j]
            moved = self._velocity[i].cross(axis)
            self.moved.append(moved)
            self.lifted.append(self._acceleration[i].cross(axis) + self._velocity[i].cross(moved))
            self.weighted.append(self.weight[i].cross(axis))
            velocity = self._velocity[i] + axis * v[at[j]]
            self._velocity.append(Motion(velocity.angular, drift.get(j, velocity.linear)))
            self._acceleration.append(self._acceleration[i] + axis * a[at[j]] + moved * v[at[j]])
            self.weight.append(self.weight[i] + axis * torques[at[j]])

    def _add_sums(self, bodies: dict[int, Mass]) -> None:
        """Add the sums over links; ``bodies`` are those that have a mass, as the hub sees them, by joint."""
        import casadi as ca

        none, count = ca.SX(3, 1), len(self.parents)
        self.carried = [Mass(ca.SX(0), none, ca.SX(3, 3))] * count
        self.load, self.momentum = [Force(none, none)] * count, [Force(none, none)] * count
        self.turning, self.weight_turning = [Turning(ca.SX(3, 3), none)] * count, [Turning(ca.SX(3, 3), none)] * count
        self.power = [none] * count
        sums: tuple[list[Any], ...] = (
            self.carried, self.load, self.momentum, self.turning, self.weight_turning, self.power
        )  # fmt: skip
        for j in reversed(self.joints):
            twist, weight = self._velocity[j], self.weight[j]
            if body := bodies.get(j):
                turning = body.turning(twist)
                load = body.times(self._acceleration[j]) + twist.cross_force(body.times(twist))
                power = turning.transposed_times(weight)
                own = (body, load, body.times(weight), turning, body.turning(weight), power)
                for total, one in zip(sums, own, strict=True):
                    total[j] += one
            for total in sums:
                total[self.parents[j]] = total[self.parents[j]] + total[j]

    def path(self, joint: int) -> list[int]:
        """Return the joints from the base to one, which is the last."""
        return [*self.path(self.parents[joint]), joint] if joint else []

    def column(self, j: int) -> tuple[Force, Force, Force]:
        """Return the slopes of the load of all joints above by position, velocity and acceleration of joint j."""
        carried, turning, axis, moved = self.carried[j], self.turning[j], self.axis[j], self.moved[j]
        by_position = carried.times(self.lifted[j]) + turning.times(moved) + axis.cross_force(self.load[j])
        return by_position, carried.times(moved) * 2 + turning.times(axis), carried.times(axis)

    def row(self, j: int) -> tuple[Any, Force]:
        """Return (drag (3,), inertia), which give the slopes of the torque of joint j by joints above it.

        Of joint k with S, S' and S'' (``axis``, ``moved``, ``lifted``) they are S' . drag + S'' . inertia by the
        position, S . drag + 2 S' . inertia by the velocity, S . inertia by the acceleration.
        """
        return self.turning[j].transposed_times(self.axis[j]), self.carried[j].times(self.axis[j])

    def add_slopes(self, found: Any, j: int, columns: Sequence[Force], pushed: Any) -> None:
        """Write the slopes of torques by joint j and those above it, and of these by j.

        Args:
            found: slopes, torques first, by positions, velocities and accelerations; changed.
            j: the joint.
            columns: ``column`` (j), and what the hands' forces add to the first.
            pushed: (3,) moment by which the load on joint j changes where a joint above turns what the hands hold.
        """
        import casadi as ca

        own, n, (drag, momentum) = self.at[j], self.n, self.row(j)
        for k in self.path(j):
            above, axis, moved = self.at[k], self.axis[k], self.moved[k]
            if k != j:
                found[own, above] = (
                    self.lifted[k].dot(momentum) + ca.dot(moved.angular, drag) + ca.dot(axis.angular, pushed)
                )
                found[own, n + above] = 2 * moved.dot(momentum) + ca.dot(axis.angular, drag)
                found[own, 2 * n + above] = axis.dot(momentum)
            for order, column in enumerate(columns):
                found[above, order * n + own] = axis.dot(column)

    def slope(self, j: int) -> tuple[Any, Any, Any]:
        """Return the slopes of the weighted sum by position, velocity and acceleration of joint j."""
        import casadi as ca

        momentum, power, axis, moved = self.momentum[j], self.power[j], self.axis[j], self.moved[j]
        by_position = self.weighted[j].dot(self.load[j]) + ca.dot(power, moved.angular) + self.lifted[j].dot(momentum)
        return by_position, ca.dot(power, axis.angular) + 2 * moved.dot(momentum), axis.dot(momentum)

    def bend(self, j: int) -> tuple[Force, Force, Force]:
        """Return (X, Y, Z), which with ``column`` (C, D, E) give the second derivatives by joint j and those above.

        Of joint k with S, S', S'' as in ``row`` and ``weighted`` W they are, the slope by the position of j by that of
        k: W . C + S' . X + S'' . Y, by its velocity: S . X + 2 S' . Y, by its acceleration: S . Y; the slope by the
        velocity of j by the position of k: W . D + S' . Z, by its velocity: S . Z; the slope by the acceleration of j
        by the position of k: W . E.
        """
        import casadi as ca

        carried, axis, moved, weighted = self.carried[j], self.axis[j], self.moved[j], self.weighted[j]
        dragged, turning = axis.cross_force(self.momentum[j]), self.weight_turning[j]
        moment = self.turning[j].transposed_times(weighted) + ca.cross(axis.angular, self.power[j])
        x = turning.times(moved) * -1 + moved.cross_force(self.momentum[j]) * 2
        return (
            Force(x.moment + moment, x.force),
            carried.times(weighted) + dragged,
            turning.times(axis) * -1 + dragged * 2,
        )

    def add_bends(self, found: Any, j: int, columns: Sequence[Force], bent: Any) -> None:
        """Write the second derivatives of the weighted sum by joint j and those above it.

        Args:
            found: they, by positions, velocities and accelerations, the upper triangle; changed.
            j: the joint.
            columns: as ``add_slopes`` has them.
            bent: (3,) moment that the hands add, see ``standing_hand.Hand.bent``.
        """
        import casadi as ca

        own, n, (by_position, by_rate, momentum) = self.at[j], self.n, columns
        by_velocity, by_acceleration, rates = self.bend(j)
        for k in self.path(j):
            above, axis, moved, weighted = self.at[k], self.axis[k], self.moved[k], self.weighted[k]
            found[above, own] = (
                weighted.dot(by_position) + moved.dot(by_velocity) + self.lifted[k].dot(by_acceleration)
                + ca.dot(axis.angular, bent)
            )  # fmt: skip
            found[own, n + above] = axis.dot(by_velocity) + 2 * moved.dot(by_acceleration)
            found[own, 2 * n + above] = axis.dot(by_acceleration)
            found[above, n + own] = weighted.dot(by_rate) + moved.dot(rates)
            found[n + above, n + own] = axis.dot(rates)
            found[above, 2 * n + own] = weighted.dot(momentum)


def _index(structure: pin.Model) -> list[int]:
    return [int(joint.idx_v) for joint in structure.joints]


def _hub(structure: pin.Model) -> int:
    """Return the joint whose placement is the hub: the first of those before the first branching with one centre."""
    children: list[list[int]] = [[] for _ in range(structure.njoints)]
    for j in range(1, structure.njoints):
        children[structure.parents[j]].append(j)
    joint = children[0][0]
    while len(children[joint]) == 1:
        joint = children[joint][0]
    if not children[joint]:
        return children[0][0]
    while structure.parents[joint] and np.abs(structure.jointPlacements[joint].translation).max() < STRUCTURAL_ZERO:
        joint = int(structure.parents[joint])
    return joint


def _placed(cpin: Any, model: Any, structure: pin.Model, hub: int, q: Any) -> list[Placed]:
    """Return where the hub sees the links: it is fixed to the link that carries joint ``hub``."""
    centred, data = cpin.Model(model), model.createData()
    before = centred.jointPlacements[hub].copy()
    centred.jointPlacements[hub] = cpin.SE3.Identity()
    cpin.forwardKinematics(centred, data, q)
    steps = [Placed(step.rotation, step.translation) for step in data.liMi]
    joint = int(structure.parents[hub])
    found = {joint: Placed(before.rotation, before.translation).inverse(), hub: steps[hub]}
    while joint:
        above = int(structure.parents[joint])
        found[above] = found[joint] * steps[joint].inverse()
        joint = above
    for j in range(1, structure.njoints):
        if j not in found:
            found[j] = found[int(structure.parents[j])] * steps[j]
    return [found[j] for j in range(structure.njoints)]


def _axis(joint: Any, placed: Placed) -> Motion:
    """Return the twist of what a joint carries at a rate of one."""
    import casadi as ca

    kind = joint.shortname().removeprefix("JointModel")
    if kind.endswith("Unaligned"):
        axis = ca.mtimes(placed.rotation, ca.SX(ca.sparsify(ca.DM(joint.extract().axis))))
    else:
        axis = placed.rotation[:, "XYZ".index(kind[-1])]
    return Motion.of_joint(axis, placed.origin, kind.startswith("P"))


def _body(inertia: Any, placed: Placed) -> Mass:
    """Return a link as the hub sees it."""
    import casadi as ca

    centre = placed.origin + ca.mtimes(placed.rotation, inertia.lever)
    first, turned = inertia.mass * centre, ca.mtimes(placed.rotation, ca.mtimes(inertia.inertia, placed.rotation.T))
    steiner = ca.dot(first, centre) * ca.SX.eye(3) - ca.mtimes(first, centre.T)
    return Mass(inertia.mass, first, ca.triu2symm(ca.triu(turned + steiner)))
