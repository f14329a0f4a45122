"""The outputs of a tree with several hands at one knot, on CasADi symbols, and their first and second derivatives.

``tree_dynamics`` knows what the motion takes; here are the hands, the object's attitude and the base's place, and where
each derivative belongs. Joint k is above joint j, or is j, throughout.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from liftopt.collocation.dynamics import roll_pitch_yaw
from liftopt.collocation.spatial_symbols import Force
from liftopt.collocation.standing_hand import Hand
from liftopt.collocation.standing_place import PLACE_SIZE, base_of
from liftopt.collocation.tree_dynamics import Tree
from liftopt.collocation.wrench_dynamics import WRENCH_SIZE
from liftopt.types import Array

# Of each hand: p_world_grasp, f . f, m . m, cosine, f_object, m_object; then the ground's force and moment.
HAND_OUTPUTS, GROUND_OUTPUTS = 12, 6
POINT, OWN, COSINE = slice(0, 3), slice(3, 12), 5
GRIP_SIZE = 9  # parameters of each hand, after those of the model and of the place


class StandingKnot:
    """The symbols and what they make.

    Attributes:
        y, p, m: knot variables, parameters (the period first), weights of the outputs; see ``standing_dynamics``.
        n: number of joints; ``squared`` that of the leading outputs that may enter an objective squared.
    """

    def __init__(
        self, cpin: Any, model: Any, structure: pin.Model, frames: tuple[str, ...], entries: Any,
        trunk: int = 0, up: Array | None = None,
    ) -> None:  # fmt: skip
        """Set the knot up.

        Args:
            cpin: pinocchio.casadi.
            model: on symbols, in the axes of the base.
            structure: the same model in numbers, of which only the structure counts.
            frames: of the hands.
            entries: symbols of the model's entries, the place and the grips.
            trunk: joint whose link's lean is an output, 0 for none.
            up: (3,) direction in that link that is up where it does not lean.
        """
        import casadi as ca

        self.n, self.structure, hands = int(structure.nv), structure, len(frames)
        self.squared = self.n + (trunk > 0)
        period = ca.SX.sym("T")
        q, dq, ddq = (ca.SX.sym(name, self.n) for name in ("q", "dq", "ddq"))
        self.held, self.angles = ca.SX.sym("f", WRENCH_SIZE * hands), ca.SX.sym("r", 3)
        self.y, self.p = ca.vertcat(q, dq, ddq, self.held, self.angles), ca.vertcat(period, entries)
        self.ground = self.squared + HAND_OUTPUTS * hands
        self.m = ca.SX.sym("m", self.ground + GROUND_OUTPUTS)
        sizes = np.cumsum([0, self.n, self.squared - self.n, *[HAND_OUTPUTS] * hands, 3, 3])
        torques, leaning, *self.weights, force, moment = ca.vertsplit(self.m, sizes.tolist())
        # Rates are by the phase: masses over T^2 and gravity times T^2 come to the same.
        for j in range(1, structure.njoints):
            body = model.inertias[j]
            model.inertias[j] = cpin.Inertia(body.mass / period**2, body.lever, body.inertia / period**2)
        model.gravity = cpin.Motion(model.gravity.linear * period**2, model.gravity.angular)
        self.tree = Tree(cpin, model, structure, (q, dq, ddq), (torques, force, moment))
        self.lean = ca.SX(0, 1) if up is None else 1 - self._to_base(ca.mtimes(self.tree.placed[trunk].rotation, up))[2]
        self.leaning = ca.dot(leaning, self.lean)  # its share of the weighted sum

        place, grips = entries[-PLACE_SIZE - GRIP_SIZE * hands :][:PLACE_SIZE], entries[-GRIP_SIZE * hands :]
        self.base = base_of(place)
        self.attitude, _ = roll_pitch_yaw(ca, self.angles)
        turns = [ca.reshape(grip, 3, 3).T for grip in ca.vertsplit(grips, GRIP_SIZE)]
        found = [structure.getFrameId(name) for name in frames]
        self.hands = [
            self._hand(model, i, frame, turn) for i, (frame, turn) in enumerate(zip(found, turns, strict=True))
        ]

    def value(self) -> Any:
        """Return the outputs."""
        import casadi as ca

        tree, torques, outputs, ground = self.tree, [], [], self.tree.load[0]
        for j in tree.joints:
            torque = tree.axis[j].dot(tree.load[j])
            for hand in self._carried(j):
                torque += ca.dot(hand.reach[j], hand.force) + ca.dot(tree.axis[j].angular, hand.moment)
            torques.append(torque)
        for i, hand in enumerate(self.hands):
            ground += Force(hand.moment + ca.cross(hand.point, hand.force), hand.force)
            outputs += [self.base.origin + self._to_world(hand.point - tree.placed[0].origin), self._own(i)]
        return ca.vertcat(*torques, self.lean, *outputs, self._at_base(ground))

    def gradient(self) -> Any:
        """Return the slopes of the weighted sum of the outputs."""
        import casadi as ca

        tree, found, others = self.tree, ca.SX(3 * self.n, 1), ca.SX(0)
        for j in tree.joints:
            by_position, *by_rates = tree.slope(j)
            by_position = sum((hand.slope(j) for hand in self._carried(j)), by_position)
            for order, slope in enumerate((by_position, *by_rates)):
                found[order * self.n + tree.at[j]] = slope
        for i, hand in enumerate(self.hands):
            whole, (force, moment) = tree.weight[hand.joint], self._wrench(i)
            others += ca.dot(force, self._to_world(whole.at(hand.point))) + ca.dot(
                moment, self._to_world(whole.angular)
            )
            others += ca.dot(self.weights[i][OWN], self._own(i))
        if self.squared > self.n:
            found[: self.n] += ca.gradient(self.leaning, self.y[: self.n])
        return ca.vertcat(found, ca.gradient(others, ca.vertcat(self.held, self.angles)))

    def jacobian(self) -> Any:
        """Return the slopes of the outputs."""
        import casadi as ca

        tree, n = self.tree, self.n
        found = ca.SX(self.m.shape[0], self.y.shape[0])
        for j in tree.joints:
            own, columns = tree.at[j], self._columns(j)
            pushed = self._pressed(j)
            for hand in self._carried(j):
                pushed += ca.cross(tree.axis[j].angular, hand.moment)
            tree.add_slopes(found, j, columns, pushed)
            for order, column in enumerate(columns):
                found[self.ground :, order * n + own] = self._at_base(column)
        if self.squared > n:
            found[n, :n] = ca.jacobian(self.lean, self.y[:n])
        for i in range(len(self.hands)):
            self._add_hand_slopes(found, i)
        return ca.sparsify(found)

    def _add_hand_slopes(self, found: Any, i: int) -> None:
        import casadi as ca

        hand, first, force = self.hands[i], self.squared + HAND_OUTPUTS * i, self._force(i)
        turn = hand.turn(hand.aim)
        for j in self.tree.path(hand.joint):
            own, reach = self.tree.at[j], self._to_world(hand.reach[j])
            axis = self.tree.axis[j].angular
            found[own, force : force + 3], found[own, force + 3 : force + 6] = reach.T, self._to_world(axis).T
            found[first : first + 3, own] = reach
            found[first + COSINE, own] = ca.dot(axis, turn)
        others = ca.vertcat(self.held, self.angles)
        found[first + 3 : first + HAND_OUTPUTS, 3 * self.n :] = ca.jacobian(self._own(i), others)
        lever, turned = self._to_base(hand.point - self.tree.placed[0].origin), self.base.rotation.T
        moment = self.ground + 3
        found[self.ground : moment, force : force + 3] = found[moment:, force + 3 : force + 6] = turned
        found[moment:, force : force + 3] = ca.mtimes(ca.skew(lever), turned)

    def curvature(self) -> Any:
        """Return the upper triangle of the second derivatives of the weighted sum of the outputs."""
        import casadi as ca

        tree, n, size = self.tree, self.n, self.y.shape[0]
        found, others = ca.SX(size, size), ca.SX(0)
        for j in tree.joints:
            bent = sum((hand.bent(j) for hand in self._carried(j)), ca.SX(3, 1))
            tree.add_bends(found, j, self._columns(j), bent)
        by_angles = ca.horzsplit(ca.jacobian(ca.vec(self.attitude), self.angles))
        for i, hand in enumerate(self.hands):
            force, angles = self._force(i), size - len(by_angles)
            others += ca.dot(self.weights[i][OWN], self._own(i))
            turns = ca.horzcat(*(hand.alike * hand.turn(self._to_hub(ca.reshape(aim, 3, 3))) for aim in by_angles))
            for j in tree.path(hand.joint):
                own = tree.at[j]
                found[own, force : force + 3] = self._to_world(hand.swing[j]).T
                found[own, force + 3 : force + 6] = self._to_world(hand.tilt[j]).T
                found[own, angles:] += ca.mtimes(tree.axis[j].angular.T, turns)
        if self.squared > n:
            found[:n, :n] += ca.hessian(self.leaning, self.y[:n])[0]
        found[3 * n :, 3 * n :] = ca.hessian(others, ca.vertcat(self.held, self.angles))[0]
        return ca.triu(ca.sparsify(found))

    def _pressed(self, j: int) -> Any:
        """Return the moment (3,) by which the load on joint j changes where it moves the hands' forces."""
        import casadi as ca

        return sum((ca.cross(hand.reach[j], hand.force) for hand in self._carried(j)), ca.SX(3, 1))

    def _columns(self, j: int) -> tuple[Force, Force, Force]:
        by_position, *by_rates = self.tree.column(j)
        return Force(by_position.moment + self._pressed(j), by_position.force), by_rates[0], by_rates[1]

    def _hand(self, model: Any, i: int, frame: int, turn: Any) -> Hand:
        import casadi as ca

        joint = int(self.structure.frames[frame].parentJoint)
        placed, (force, moment) = self.tree.placed[joint], map(self._to_hub, self._wrench(i))
        point = placed.origin + ca.mtimes(placed.rotation, model.frames[frame].placement.translation)
        pull, alike = self._to_hub(self.weights[i][POINT]), self.weights[i][COSINE]
        grip, aim = ca.mtimes(placed.rotation, turn), self._to_hub(self.attitude)
        return Hand.of(self.tree, joint, point, force, moment, pull, alike, grip, aim)

    def _own(self, i: int) -> Any:
        """Return a hand's outputs but the first three: of them the joints move the cosine alone."""
        import casadi as ca

        (f, m), hand = self._wrench(i), self.hands[i]
        cosine = (ca.dot(hand.grip, hand.aim) - 1) / 2
        return ca.vertcat(
            ca.dot(f, f), ca.dot(m, m), cosine, ca.mtimes(self.attitude.T, f), ca.mtimes(self.attitude.T, m)
        )

    def _wrench(self, i: int) -> tuple[Any, Any]:
        """Return force and moment of a hand, world axes."""
        return self.held[WRENCH_SIZE * i :][:3], self.held[WRENCH_SIZE * i + 3 :][:3]

    def _carried(self, j: int) -> list[Hand]:
        return [hand for hand in self.hands if j in hand.reach]

    def _force(self, i: int) -> int:
        return 3 * self.n + WRENCH_SIZE * i

    def _to_hub(self, world: Any) -> Any:
        import casadi as ca

        return ca.mtimes(self.tree.placed[0].rotation, ca.mtimes(self.base.rotation.T, world))

    def _to_base(self, hub: Any) -> Any:
        import casadi as ca

        return ca.mtimes(self.tree.placed[0].rotation.T, hub)

    def _to_world(self, hub: Any) -> Any:
        import casadi as ca

        return ca.mtimes(self.base.rotation, self._to_base(hub))

    def _at_base(self, load: Force) -> Any:
        """Return force and moment (6,) about the base's origin in its axes."""
        import casadi as ca

        moment = load.moment - ca.cross(self.tree.placed[0].origin, load.force)
        return ca.vertcat(self._to_base(load.force), self._to_base(moment))
