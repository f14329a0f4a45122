"""How far an answer is from the lift in continuous time, as a solution carries it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftopt.solution.checks import BETWEEN_KNOTS, COMPRESSION, Verification

OTHER_MOTION = "the motion on {intervals} intervals is another one"
NOT_COMPARED = "there was no other mesh to compare with in the time that was left"


@dataclass(frozen=True)
class Accuracy:
    """What the mesh leaves between its knots, and what it does to the objective.

    Attributes:
        closure: largest distance of a grasp point from the object's on a ten times finer grid [m].
        balance: largest residual of the object's balance there [N, Nm].
        torque_excess: most that a torque exceeds its limit there [Nm].
        objective_limit: the objective extrapolated to ever finer meshes; NaN where it cannot be estimated.
        objective_bar: by how much the limit may be off, above or below: the last correction, from the objective on
            the finer of the two meshes that were compared to the limit; NaN likewise.
        objective_error: ``objective / objective_limit - 1``; NaN likewise.
        intervals: of the mesh that was compared for it; 0: none.
        apart: how far the optima on both meshes are apart, root mean square over time, of the joint [rad] or coordinate
            of the object [m, rad] that differs most; NaN without a mesh.
        compression_excess: most that the compression of a spine exceeds its limit on the finer grid [N]; 0 without one.
        remark: why there is no estimate of the objective, empty where there is one.
    """

    closure: float
    balance: float
    torque_excess: float
    objective_limit: float = np.nan
    objective_error: float = np.nan
    objective_bar: float = np.nan
    intervals: int = 0
    apart: float = np.nan
    remark: str = NOT_COMPARED
    compression_excess: float = 0.0

    @staticmethod
    def between_knots(verification: Verification) -> Accuracy:
        """Return what a verification knows; the objective is not estimated."""
        closure, balance, torque = (
            float(verification.check(f"{name} between knots").value)
            for name in ("grasp closure", "balance", "torque limits")
        )
        spines = (check.value for check in verification.checks if check.name == COMPRESSION + BETWEEN_KNOTS)
        return Accuracy(closure, balance, torque, compression_excess=float(max(spines, default=0.0)))

    @property
    def estimated(self) -> bool:
        """Whether there is an estimate of the objective."""
        return bool(np.isfinite(self.objective_error))
