"""The table of the report on how near bodies come."""

from __future__ import annotations

from liftopt.solution.clearance import Clearance

MOST = 20  # rows


def clearance_rows(clearance: Clearance | None) -> list[dict[str, str]]:
    """Return a row a pair, the nearest first: which, of which kind, how near, and when."""
    if clearance is None:
        return []
    return [
        {
            "pair": item.pair.told,
            "kind": item.pair.kind if "-" in item.pair.kind else f"within the {item.pair.kind}",
            "distance": f"{1e3 * item.distance:.1f}".replace("-", "\N{MINUS SIGN}"),
            "at": f"{item.time:.2f} s",
        }
        for item in clearance.closest[:MOST]
    ]
