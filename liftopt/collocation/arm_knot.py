"""The outputs of a serial arm that holds at one knot, on CasADi symbols, and their first and second derivatives.

They are those of ``wrench_dynamics``. ``arm_chain`` knows what the motion takes; here are the hand,
the object's attitude, and where each derivative belongs. Joint k is before joint j, or is j, throughout.
"""

from __future__ import annotations

from typing import Any

from liftopt.collocation.arm_chain import ArmChain
from liftopt.collocation.arm_numbers import Reader
from liftopt.collocation.dynamics import roll_pitch_yaw
from liftopt.collocation.spatial_symbols import Force
from liftopt.collocation.standing_hand import Hand

# After the torques: p_world_grasp, f . f, m . m, cosine, f_object, m_object.
HAND_OUTPUTS, COSINE = 12, 5


class ArmKnot:
    """The symbols and what they make.

    Attributes:
        y, p, m: knot variables, parameters (the period first), weights of the outputs; see ``arm_dynamics``.
        n: number of joints, and of the outputs that may enter an objective squared (``squared``).
    """

    def __init__(self, kinds: str, numbers: int, gravity: Any) -> None:
        """Set the knot up.

        Args:
            kinds: of the joints from the base on, R or P.
            numbers: how many parameters there are beside the period.
            gravity: (3,) in the world.
        """
        import casadi as ca

        self.n = self.squared = len(kinds)
        period, symbols = ca.SX.sym("T"), ca.SX.sym("p", numbers)
        q, dq, ddq = (ca.SX.sym(name, self.n) for name in ("q", "dq", "ddq"))
        self.force, self.moment, self.angles = (ca.SX.sym(name, 3) for name in ("f", "m", "r"))
        self.others = ca.vertcat(self.force, self.moment, self.angles)
        self.y, self.p = ca.vertcat(q, dq, ddq, self.others), ca.vertcat(period, symbols)
        self.m = ca.SX.sym("w", self.n + HAND_OUTPUTS)
        reader = Reader(symbols)
        self.chain = ArmChain(kinds, reader, (q, dq, ddq), self.m[: self.n], gravity, period)
        self.attitude, _ = roll_pitch_yaw(ca, self.angles)
        self.hand = self._hand(reader)

    def _hand(self, reader: Reader) -> Hand:
        import casadi as ca

        last, n = self.chain.placed[-1], self.n
        grip, point = ca.mtimes(last.rotation, reader.rotation()), ca.mtimes(last.rotation, reader.take(3))
        force, moment, pull, aim = map(self._to_hub, (self.force, self.moment, self.m[n : n + 3], self.attitude))
        return Hand.of(self.chain, n, last.origin + point, force, moment, pull, self.m[n + COSINE], grip, aim)

    def value(self) -> Any:
        """Return the outputs."""
        import casadi as ca

        chain, hand = self.chain, self.hand
        torques = [
            chain.axis[j].dot(chain.load[j])
            + ca.dot(hand.reach[j], hand.force)
            + ca.dot(hand.axis[j], hand.moment)
            for j in chain.joints
        ]  # fmt: skip
        point = chain.base.origin + self._to_world(hand.point - chain.placed[0].origin)
        return ca.vertcat(*torques, point, self._own())

    def gradient(self) -> Any:
        """Return the slopes of the weighted sum of the outputs."""
        import casadi as ca

        chain, n, hand = self.chain, self.n, self.hand
        found, whole = ca.SX(3 * n, 1), chain.weight[n]
        for j in chain.joints:
            by_position, by_velocity, by_acceleration = chain.slope(j)
            found[j - 1], found[n + j - 1] = by_position + hand.slope(j), by_velocity
            found[2 * n + j - 1] = by_acceleration
        others = self._weighted_own()
        others += ca.dot(self.force, self._to_world(whole.at(hand.point)))
        others += ca.dot(self.moment, self._to_world(whole.angular))
        return ca.vertcat(found, ca.gradient(others, self.others))

    def jacobian(self) -> Any:
        """Return the slopes of the outputs."""
        import casadi as ca

        chain, n, hand = self.chain, self.n, self.hand
        found, turn = ca.SX(self.m.shape[0], self.y.shape[0]), hand.turn(hand.aim)
        for j in chain.joints:
            own, reach = chain.at[j], self._to_world(hand.reach[j])
            chain.add_slopes(found, j, self._columns(j), self._pressed(j) + ca.cross(hand.axis[j], hand.moment))
            found[own, 3 * n : 3 * n + 3], found[n : n + 3, own] = reach.T, reach
            found[own, 3 * n + 3 : 3 * n + 6] = self._to_world(hand.axis[j]).T
            found[n + COSINE, own] = ca.dot(hand.axis[j], turn)
        found[n + 3 :, 3 * n :] = ca.jacobian(self._own(), self.others)
        return ca.sparsify(found)

    def curvature(self) -> Any:
        """Return the upper triangle of the second derivatives of the weighted sum of the outputs."""
        import casadi as ca

        chain, n, hand, size = self.chain, self.n, self.hand, self.y.shape[0]
        found = ca.SX(size, size)
        for j in chain.joints:
            own = chain.at[j]
            chain.add_bends(found, j, self._columns(j), hand.bent(j))
            found[own, 3 * n : 3 * n + 3] = self._to_world(hand.swing[j]).T
            found[own, 3 * n + 3 : 3 * n + 6] = self._to_world(hand.tilt[j]).T
        found[:n, 3 * n + 6 :] = self._twisted()
        found[3 * n :, 3 * n :] = ca.hessian(self._weighted_own(), self.others)[0]
        return ca.triu(ca.sparsify(found))

    def _twisted(self) -> Any:
        """Return the derivatives (n, 3) of the weighted cosine by the joints and the object's attitude."""
        import casadi as ca

        hand, by_angles = self.hand, ca.horzsplit(ca.jacobian(ca.vec(self.attitude), self.angles))
        turns = ca.horzcat(*(hand.alike * hand.turn(self._to_hub(ca.reshape(aim, 3, 3))) for aim in by_angles))
        return ca.mtimes(ca.horzcat(*(hand.axis[j] for j in self.chain.joints)).T, turns)

    def _pressed(self, j: int) -> Any:
        """Return the moment (3,) by which the load on joint j changes where it moves the hand's force."""
        import casadi as ca

        return ca.cross(self.hand.reach[j], self.hand.force)

    def _columns(self, j: int) -> tuple[Force, Force, Force]:
        by_position, *by_rates = self.chain.column(j)
        return Force(by_position.moment + self._pressed(j), by_position.force), by_rates[0], by_rates[1]

    def _own(self) -> Any:
        """Return the outputs after the grasp point: of them the joints move the cosine alone."""
        import casadi as ca

        f, m, turned = self.force, self.moment, self.attitude.T
        cosine = (ca.dot(self.hand.grip, self.hand.aim) - 1) / 2
        return ca.vertcat(ca.dot(f, f), ca.dot(m, m), cosine, ca.mtimes(turned, f), ca.mtimes(turned, m))

    def _weighted_own(self) -> Any:
        import casadi as ca

        return ca.dot(self.m[self.n + 3 :], self._own())

    def _to_hub(self, world: Any) -> Any:
        import casadi as ca

        return ca.mtimes(self.chain.to_world.T, world)

    def _to_world(self, hub: Any) -> Any:
        import casadi as ca

        return ca.mtimes(self.chain.to_world, hub)
