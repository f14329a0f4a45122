"""The cross-check as a table: four models, every quantity, its oracle and the worst error found."""

from __future__ import annotations

from dataclasses import dataclass
from io import StringIO

import numpy as np
from rich.console import Console
from rich.table import Table

from liftopt.crosscheck.arm_checks import arm_checks
from liftopt.crosscheck.comparison import Comparison
from liftopt.crosscheck.default_systems import default_human, default_robot, default_table, default_whole_person
from liftopt.crosscheck.table_checks import table_checks
from liftopt.crosscheck.tree_checks import tree_checks
from liftopt.errors import InputError


@dataclass(frozen=True)
class CrosscheckReport:
    """All comparisons of one run.

    Attributes:
        rows: one comparison each.
        samples: random states a model.
        seed: of the random states.
    """

    rows: tuple[Comparison, ...]
    samples: int
    seed: int

    @property
    def passed(self) -> bool:
        """Whether every comparison is within its tolerance."""
        return all(row.passed for row in self.rows)


def crosscheck_report(samples: int = 1000, seed: int = 0) -> CrosscheckReport:
    """Compare recursions with Pinocchio: over the DH chains of the default human, robot and table; over a whole person.

    Args:
        samples: random states a model, at least 1.
        seed: of the random states.

    Raises:
        InputError: ``samples`` is below 1.
    """
    if samples < 1:
        raise InputError("samples", samples, "at least 1 random state a model")
    rng = np.random.default_rng(seed)
    rows = [
        *arm_checks(default_human(), samples, rng),
        *arm_checks(default_robot(), samples, rng),
        *table_checks(default_table(), samples, rng),
        *tree_checks(default_whole_person(), samples, rng),
    ]
    return CrosscheckReport(tuple(rows), samples, seed)


def render(report: CrosscheckReport) -> str:
    """Return the report as a plain text table, one line a comparison, and a verdict."""
    table = Table(box=None, pad_edge=False)
    for heading in ("model", "quantity", "oracle"):
        table.add_column(heading, no_wrap=True)
    for heading in ("worst error", "unit", "relative", "allowed", ""):
        table.add_column(heading, no_wrap=True, justify="left" if heading == "unit" else "right")
    for row in report.rows:
        table.add_row(
            row.model,
            row.quantity,
            row.oracle,
            f"{row.absolute:.1e}",
            row.unit,
            f"{row.relative:.1e}",
            f"{row.tolerance:.1e}",
            "ok" if row.passed else "FAIL",
        )
    text = StringIO()
    console = Console(file=text, width=200, color_system=None, force_terminal=False, markup=False, highlight=False)
    console.print(table)
    failed = sum(not row.passed for row in report.rows)
    verdict = "all agree" if failed == 0 else f"{failed} DISAGREE"
    console.print(
        f"{len(report.rows)} comparisons on {report.samples} random states a model (seed {report.seed}): {verdict}."
    )
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines())
