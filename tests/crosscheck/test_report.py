"""The cross-check a user runs: DH recursion beside the models loaded from their URDFs, by Pinocchio's algorithms."""

import ast
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import liftopt
from liftopt.crosscheck.arm_checks import arm_checks
from liftopt.crosscheck.comparison import compare
from liftopt.crosscheck.default_systems import default_human, default_robot, default_table
from liftopt.crosscheck.report import CrosscheckReport, crosscheck_report, render
from liftopt.crosscheck.systems import CheckedSystem
from liftopt.crosscheck.table_checks import table_checks
from liftopt.errors import InputError

PACKAGE = Path(next(iter(liftopt.__path__)))


@pytest.fixture(scope="module")
def report() -> CrosscheckReport:
    return crosscheck_report()


def test_all_models_agree_with_pinocchio_on_a_thousand_states(report: CrosscheckReport) -> None:
    """Pinocchio on the URDF-loaded models; 1e-9 absolute, finite differences within their own bound."""
    assert report.samples == 1000
    assert {row.model for row in report.rows} == {"human", "human, whole", "robot", "table"}
    assert [row for row in report.rows if not row.passed] == []
    assert all(row.tolerance <= 1e-9 and row.samples == 1000 for row in report.rows)
    assert report.passed


def test_rendered_table_has_a_line_for_each_comparison_and_a_verdict(report: CrosscheckReport) -> None:
    text = render(report)
    heading, *lines, verdict = text.splitlines()
    assert heading.split()[:3] == ["model", "quantity", "oracle"]
    assert len(lines) == len(report.rows)
    assert all(row.quantity in line and row.oracle in line for row, line in zip(report.rows, lines, strict=True))
    assert verdict.endswith("(seed 0): all agree.")
    assert "\x1b" not in text and "…" not in text


def test_a_disagreement_is_shown_as_one(report: CrosscheckReport) -> None:
    broken = replace(report, rows=(replace(report.rows[0], passed=False), *report.rows[1:]))
    assert not broken.passed
    assert "FAIL" in render(broken) and "1 DISAGREE" in render(broken)


@pytest.mark.parametrize("build", [default_human, default_robot])
def test_a_centre_of_mass_off_by_ten_nanometres_is_found(build: Callable[[], CheckedSystem]) -> None:
    """The check has teeth: 10 nm on one body is far above rounding."""
    system = build()
    bodies = list(system.chain.inertias)
    bodies[5] = replace(bodies[5], com=bodies[5].com + 1e-8)
    spoilt = replace(system, chain=replace(system.chain, inertias=tuple(bodies)))
    failed = {row.quantity for row in arm_checks(spoilt, 20, np.random.default_rng(0)) if not row.passed}
    assert {"torque, no load (eqs. 1-3)", "ground moment (Fig. 2)"} <= failed


def test_a_grasp_point_off_by_ten_nanometres_is_found() -> None:
    system = replace(default_table(), grasp_points=default_table().grasp_points + 1e-8)
    failed = {row.quantity for row in table_checks(system, 20, np.random.default_rng(0)) if not row.passed}
    assert {"grasp position (A_n)", "force sensitivity (eqs. 7-9)", "wrench on the body, two grasps"} <= failed


def test_not_a_number_is_a_disagreement() -> None:
    assert not compare("m", "q", "o", "m", np.array([[0.0, np.nan]]), np.zeros((1, 2))).passed


def test_no_samples_are_refused_with_the_key() -> None:
    with pytest.raises(InputError, match="samples = 0: at least 1"):
        crosscheck_report(samples=0)


def test_seed_decides_the_states() -> None:
    assert crosscheck_report(3, seed=1) == crosscheck_report(3, seed=1)
    assert crosscheck_report(3, seed=1).rows != crosscheck_report(3, seed=2).rows


def _imports(path: Path) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def test_only_the_command_line_imports_the_crosscheck() -> None:
    """Source text: an independent check must not be a part of what it checks."""
    for path in PACKAGE.rglob("*.py"):
        relative = path.relative_to(PACKAGE)
        if relative.parts[0] not in ("crosscheck", "commands"):
            assert not any("crosscheck" in name for name in _imports(path)), relative


def test_crosscheck_imports_nothing_of_the_solve() -> None:
    """Source text: numpy, Pinocchio, the models and their errors; Pinocchio only on the oracle's side.

    What judges a result reads it too; the two transcriptions are compared by one module that solves with both.
    """
    result = (
        "liftopt.solution.checks",
        "liftopt.solution.interpolation",
        "liftopt.multibody.mujoco_model",
        "liftopt.scenario.build",
        "liftopt.solution.solution",
    )
    judges = {
        "energy.py": (*result, "liftopt.multibody.trajectory"),
        "hermite_simpson.py": ("casadi", "functools", "time", "liftopt.collocation.task"),
        "holds.py": ("casadi",),
        "instant.py": ("casadi", "itertools", "liftopt.collocation.task", "liftopt.pinocchio_casadi"),
        "integrand.py": ("casadi", "liftopt.collocation.task"),
        "motion_report.py": result,
        "mujoco_balls.py": (*result, "liftopt.multibody.trajectory"),
        "mujoco_dynamics.py": result,
        "mujoco_forward.py": (*result, "functools"),
        "tree_dynamics.py": ("xml",),
    }
    allowed = (
        "__future__",
        "collections",
        "dataclasses",
        "io",
        "math",
        "typing",
        "numpy",
        "pinocchio",
        "rich",
        "liftopt.crosscheck",
        "liftopt.multibody",
        "liftopt.errors",
        "liftopt.types",
    )
    for path in set((PACKAGE / "crosscheck").glob("*.py")) - {PACKAGE / "crosscheck" / "transcriptions.py"}:
        for name in _imports(path):
            assert name.startswith((*allowed, *judges.get(path.name, ()))), (path.name, name)
    recursion = (
        "kinematics.py", "lagrangian.py", "sensitivity.py", "floating_base.py", "ground_reaction.py",
        "tree_dynamics.py",
    )  # fmt: skip
    for name in recursion:
        assert not any("pinocchio" in imported for imported in _imports(PACKAGE / "crosscheck" / name)), name
