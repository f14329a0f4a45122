"""``import liftopt as lo``: which names it offers, that they are typed and documented, and that it is lazy."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import liftopt as lo

MOST_NAMES = 35
HEAVY = ("numpy", "casadi", "pinocchio", "scipy", "matplotlib", "xarray", "pydantic")
# As a user writes it; the mesh is coarse and the starts are few only to spare time.
AS_WRITTEN = """
import sys
import liftopt as lo

scenario = lo.load_scenario("table5", {"object.mass": 3.0, "solver.intervals": 10, "solver.starts": 1})
solution = lo.solve(scenario)
assert solution.solved, solution.status
assert solution["robot"].tau.shape == (len(solution.time), 10)
dataset = solution.to_xarray()
solution.save(sys.argv[1])
again = lo.load(sys.argv[1])
assert again.to_xarray().equals(dataset)
again.report(sys.argv[2])

built = lo.Scenario(
    agents={
        "human": lo.Person(stature=1.75, mass=75.0, sex="male"),
        "robot": lo.Robot(model="sawyer"),
    },
    object=lo.Box(mass=3.0, depth=0.45, width=0.31, height=0.02),
    task=lo.Lift(
        standing_distance=1.9,
        start=lo.GraspPlace(height=0.9, human_distance=0.4),
        end=lo.GraspPlace(height=1.4, human_distance=0.4),
    ),
    solver=lo.Solver(intervals=10, starts=1),
)
assert lo.solve(built).objective == solution.objective
"""


def test_few_names_are_public() -> None:
    assert 20 <= len(lo.__all__) <= MOST_NAMES


def test_the_stub_and_the_package_name_the_same() -> None:
    stub = ast.parse(Path(lo.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    names = {alias.asname for node in stub.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    assert names == set(lo.__all__)
    assert names <= set(dir(lo))


@pytest.mark.parametrize("name", lo.__all__)
def test_every_name_is_documented_and_typed(name: str) -> None:
    thing = getattr(lo, name)
    assert inspect.getdoc(thing)
    if inspect.isfunction(thing):
        hints = inspect.get_annotations(thing)
        assert set(hints) == {*inspect.signature(thing).parameters, "return"}


def test_nothing_heavy_is_imported_before_it_is_used(tmp_path: Path) -> None:
    code = f"import liftopt, sys; print(*[name for name in {HEAVY!r} if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == ""


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="solv_e"):
        lo.solv_e  # noqa: B018


def test_it_runs_as_written(tmp_path: Path) -> None:
    arguments = [str(tmp_path / "mine"), str(tmp_path / "lift.html")]
    command = [sys.executable, "-c", AS_WRITTEN, *arguments]
    # Not in the source tree, which would be imported instead of what is installed.
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "lift.html").stat().st_size > 0


def test_a_replanner_gives_solutions_that_save(tmp_path: Path) -> None:
    scenario = lo.load_scenario("table5", {"solver.intervals": 10, "solver.starts": 1})
    replanner = lo.Replanner()
    assert isinstance(replanner.solve(scenario), lo.Solution)
    warm = replanner.solve(scenario.replace({"object.mass": 2.2}))
    assert warm.solved
    warm.save(tmp_path / "warm")
    assert lo.load(tmp_path / "warm").objective == warm.objective
