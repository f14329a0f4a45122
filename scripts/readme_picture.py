"""Make the picture that README opens with: the shipped lift `pallet` at three moments, into docs/static/lift.png."""

from __future__ import annotations

from pathlib import Path

import liftopt as lo

FILE = Path(__file__).parents[1] / "docs" / "static" / "lift.png"


def main() -> None:
    """Solve the lift and write its picture."""
    lo.solve(lo.load_scenario("pallet")).picture(FILE)
    print(f"Written to {FILE}: {FILE.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
