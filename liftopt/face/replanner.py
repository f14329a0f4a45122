"""One lift after the other, each from the optimum of the one before."""

from __future__ import annotations

from liftopt.control import replanning
from liftopt.face.lift import Solution
from liftopt.scenario.model import Scenario


class Replanner(replanning.Replanner):
    """Plans one scenario after the other, each from the optimum of the one before; for one thread.

    A warm solve takes milliseconds and follows one local optimum as the scenario changes. Where a better one has
    appeared elsewhere, only ``solve(..., cold=True)`` finds it.
    """

    def solve(self, scenario: Scenario, *, cold: bool = False) -> Solution:
        """Return the verified solution of a scenario; of one that has none, ``status`` says why.

        Args:
            scenario: what to lift.
            cold: solve from several starts even if there is an optimum to start from.

        Raises:
            InputError: a value of the scenario cannot be used.
            SolverError: the solver cannot run at all.
        """
        return Solution.of(super().solve(scenario, cold=cold))
