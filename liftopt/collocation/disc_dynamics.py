"""What happens at one knot of an agent whose disc must not be pressed too much: three outputs more.

The functions of ``standing_dynamics`` again, of the tree that is cut at the disc: joints that never move transmit what
passes there, so their torques, and these torques' derivatives, are outputs like any other's. With their positions and
rates at zero in the expressions, hardly an instruction is left of the joints themselves.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.collocation.closed_form import closed_form_functions
from liftopt.collocation.dynamics import KnotFunctions, symbolic_model
from liftopt.collocation.standing_dynamics import StandingTopology
from liftopt.collocation.standing_knot import StandingKnot
from liftopt.multibody.disc import CUT_JOINTS, Disc, at_the_cut, cut_model
from liftopt.types import Array

Index = npt.NDArray[np.int64]


@dataclass(frozen=True)
class DiscTopology(StandingTopology):
    """A tree as these kernels see it; its model has the joints at the cut.

    Attributes:
        cut: place of the first of their rates.
    """

    cut: int = 0

    @staticmethod
    def pressed(
        model: pin.Model, frames: tuple[str, ...], T_world_base: Array, *grips: Array, disc: Disc, trunk: str = ""
    ) -> DiscTopology:
        """Read the topology out of a Pinocchio model; other arguments as ``StandingTopology.standing``."""
        found = StandingTopology.standing(cut_model(model, disc), frames, T_world_base, *grips, trunk=trunk)
        return DiscTopology(**vars(found), cut=at_the_cut(found.model, disc.joint).start)

    def signature(self) -> str:
        """Return a digest of all that a kernel is generated from; equal signatures share a kernel."""
        digest = hashlib.sha256(f"{StandingTopology.signature(self)} {self.cut}".encode())
        digest.update(Path(__file__).read_bytes())
        return digest.hexdigest()


@dataclass(frozen=True)
class CutOrder:
    """Where knot variables and outputs are among those of the tree that is cut, whose disc's outputs come last here.

    Attributes:
        variables: (n_y,) places of the knot variables that are not of the joints at the cut.
        outputs: (n_c,) places of the outputs.
    """

    variables: Index
    outputs: Index

    @staticmethod
    def of(n_y: int, n_c: int, n: int, cut: int) -> CutOrder:
        """Return the order where the tree that is cut has so many knot variables, outputs and joints."""
        at_cut = np.arange(cut, cut + CUT_JOINTS)
        variables = np.setdiff1d(np.arange(n_y), np.concatenate([order * n + at_cut for order in range(3)]))
        return CutOrder(variables, np.concatenate([np.setdiff1d(np.arange(n_c), at_cut), at_cut]))


class DiscKnot:
    """The symbols and what they make; see ``closed_form.ClosedForm``."""

    def __init__(self, tree: StandingKnot, cut: int) -> None:
        """Set the knot up on that of the tree that is cut, where the rates at the cut begin."""
        import casadi as ca

        n_y, n_c = int(tree.y.shape[0]), int(tree.m.shape[0])
        order = CutOrder.of(n_y, n_c, tree.n, cut)
        self._tree, self._variables, self._outputs = tree, order.variables.tolist(), order.outputs.tolist()
        self.squared, self.p = tree.squared - CUT_JOINTS, tree.p
        self.y, self.m = ca.SX.sym("y", len(self._variables)), ca.SX.sym("m", n_c)
        self._all_y, self._all_m = ca.SX(n_y, 1), ca.SX(n_c, 1)
        self._all_y[self._variables], self._all_m[self._outputs] = self.y, self.m

    def value(self) -> Any:
        """Return the outputs."""
        return self._at_rest(self._tree.value())[self._outputs]

    def gradient(self) -> Any:
        """Return the slopes of the weighted sum of the outputs."""
        return self._at_rest(self._tree.gradient())[self._variables]

    def jacobian(self) -> Any:
        """Return the slopes of the outputs."""
        return self._at_rest(self._tree.jacobian()[self._outputs, self._variables])

    def curvature(self) -> Any:
        """Return the upper triangle of the second derivatives of the weighted sum of the outputs."""
        return self._at_rest(self._tree.curvature()[self._variables, self._variables])

    def _at_rest(self, found: Any) -> Any:
        """Return an expression with the joints at the cut at rest."""
        import casadi as ca

        function = ca.Function("cut", [self._tree.y, self._tree.p, self._tree.m], [found])
        return ca.sparsify(function(self._all_y, self.p, self._all_m))


def disc_agent_functions(topology: DiscTopology) -> KnotFunctions:
    """Return the functions of an agent: knot variables as in ``standing_dynamics``, and outputs.

    After those come what passes the disc: axial force, lateral moment, moment that extends [N, Nm, Nm].
    """
    cpin, model, entries = symbolic_model(topology)
    up = topology.up if topology.trunk else None
    tree = StandingKnot(cpin, model, topology.model, topology.frames, entries, topology.trunk, up)
    return closed_form_functions(DiscKnot(tree, topology.cut))
