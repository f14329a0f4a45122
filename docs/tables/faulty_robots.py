"""What becomes of robots with the faults of public threads; the tests hold the table to it."""

from __future__ import annotations

import csv
from pathlib import Path

from tables import table

FILE = Path(__file__).parent / "faulty_robots.csv"


def faulty_robots() -> str:
    """Return each fault with the thread that tells of it, the outcome, and what is found."""
    with FILE.open(encoding="utf-8", newline="") as file:
        rows = [
            (f"[{row['fault']}]({row['thread']})", row["outcome"], f"`{row['found']}`" if row["found"] else "")
            for row in csv.DictReader(file)
        ]
    return table(("in the file", "outcome", "what is found, and where"), rows)
