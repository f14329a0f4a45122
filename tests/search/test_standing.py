"""What stands and overlaps; oracle: the sizes of the boxes, by hand."""

from __future__ import annotations

import pytest

from liftopt.scenario.model import Scenario, load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.session import Session
from liftopt.search.solve import search
from liftopt.search.standing import standing_overlaps

# Sawyer's pedestal foot is a box of 0.78 x 0.69 x 0.24 m; its base is 1.9 m ahead of the feet.
FOOT, BASE = 0.345, 1.9


@pytest.fixture(scope="module")
def cache() -> SolverCache:
    return SolverCache()


def pallet(gap: float, clearance: float | str = 0.0) -> Scenario:
    """Return a lift beside a pallet, so far from the pedestal's foot."""
    box = {"name": "pallet", "box": [0.4, 0.4, 0.2], "position": [BASE, FOOT + 0.2 + gap, 0.1]}
    return load_scenario("table5", {"obstacles": [box], "limits.clearance": clearance})


@pytest.mark.parametrize(
    ("gap", "clearance", "amount"),
    [(-0.015, 0.0, 0.015), (0.01, 0.05, 0.04), (0.0, 0.0, None), (0.01, 0.0, None), (-0.015, "off", None)],
)
def test_a_pallet_beside_the_pedestal(
    cache: SolverCache, gap: float, clearance: float | str, amount: float | None
) -> None:
    session = Session(pallet(gap, clearance), cache)
    reasons = standing_overlaps(session, session.problem(session.spline))
    if amount is None:
        assert not reasons
        return
    first = reasons[0]
    assert (first.constraint, first.who, first.static) == ("clearance", "pedestal foot of robot and pallet", True)
    assert first.amount == pytest.approx(amount, abs=1e-6)
    assert "pedestal foot of robot and pallet come" in first.message


def test_no_start_is_tried(cache: SolverCache) -> None:
    session = Session(pallet(-0.1), cache)
    found = search(session)
    assert not found.best.usable and not session.records
    assert "where they stand" in found.best.outcome
