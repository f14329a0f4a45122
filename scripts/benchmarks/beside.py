"""Our own solvers on the very problem that a rival has, from the same start, at the same tolerance."""

from __future__ import annotations

from typing import Any

from benchmarks.case import Case, Timing, measure

OURS = ("banded", "ipopt")
TIMES = 3


class Beside:
    """Times both solvers before and after a rival, so that what else the machine does meets all alike.

    Attributes:
        case: the problem, start and tolerance.
        results: of each solver.
    """

    def __init__(self, case: Case) -> None:
        self.case = case
        self._solvers = {name: case.solver(name) for name in OURS}
        self._timings: dict[str, list[Timing]] = {name: [] for name in OURS}
        for solver in self._solvers.values():
            case.solve(solver)  # a first call takes longer
        self.results = {name: self._timed(name) for name in OURS}

    def finish(self) -> dict[str, dict[str, Any]]:
        """Return the times [ms], iterations and objective of each; ``objective`` is None where it did not converge."""
        self.results = {name: self._timed(name) for name in OURS}
        return {name: self._plain(name) for name in OURS}

    def _timed(self, name: str) -> Any:
        timing, result = measure(TIMES, self.case.solve, self._solvers[name])
        self._timings[name].append(timing)
        return result

    def _plain(self, name: str) -> dict[str, Any]:
        wall, cpu = (sum((getattr(timing, kind) for timing in self._timings[name]), ()) for kind in ("wall", "cpu"))
        result = self.results[name]
        return {
            **Timing(wall, cpu).plain(),
            "iterations": result.iterations,
            "objective": result.objective if result.converged else None,
            "status": result.status,
        }


def said(found: dict[str, dict[str, Any]]) -> str:
    """Return what the note of a row says of ours."""
    words = []
    for name, own in found.items():
        how = f"J {own['objective']:.1f}" if own["objective"] is not None else own["status"]
        words.append(f"{name} {own['median_ms']:.0f} ms, {own['iterations']} iterations, {how}")
    return "; ".join(words)
