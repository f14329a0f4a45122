"""Mesh refinement; oracles: a second transcription's limit, Richardson on made-up figures, the fine mesh itself."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from liftopt.collocation.solvers.banded import Banded
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.ipopt import Ipopt
from liftopt.collocation.solvers.result import PRUNED, SolverResult
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.transfer import transfer, transfer_multipliers
from liftopt.commands.cli import main
from liftopt.control.replanning import Replanner
from liftopt.scenario.model import load_scenario
from liftopt.scenario.settings import Refine
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.search.mesh_accuracy import compared, distance, unmet
from liftopt.search.mesh_refinement import refine_mesh
from liftopt.search.optima import SAME_OPTIMUM, indistinguishable
from liftopt.search.optimum_on_mesh import optimum_on_mesh
from liftopt.search.session import Session
from liftopt.search.solve import solve
from liftopt.solution.accuracy import Accuracy
from liftopt.solution.solution import Solution
from liftopt.solution.summary import summary_dict
from liftopt.storage.reader import load_result
from liftopt.storage.writer import save

BANDED = ("solver.name=banded", "solver.starts=2", "solver.time_limit=3600")
# Hermite-Simpson on the states without zero acceleration at the ends, on 20 intervals: crosscheck/transcriptions.py.
LIMIT_OF_TABLE5 = 817.3


@pytest.fixture(scope="module")
def refined() -> Solution:
    return solve(load_scenario("table5_paper", [*BANDED, "refine.on=true"]))


@pytest.fixture(scope="module")
def coarse() -> Candidate:
    replanner = Replanner()
    assert replanner.solve(load_scenario("table5_paper", BANDED)).solved
    assert replanner.latest is not None
    return replanner.latest


def test_refined_lift_meets_its_tolerances_and_the_second_transcriptions_limit(refined: Solution) -> None:
    assert refined.solved
    accuracy, wanted = refined.accuracy, refined.scenario.refine
    assert accuracy is not None
    assert unmet(accuracy, wanted) == ""
    assert accuracy.objective_limit == pytest.approx(LIMIT_OF_TABLE5, rel=2e-3)
    assert abs(accuracy.objective_limit - LIMIT_OF_TABLE5) <= accuracy.objective_bar
    # What it says of the knots is what Pinocchio finds on a finer grid.
    assert accuracy.closure == refined.verification.check("grasp closure between knots").value
    assert accuracy.balance == refined.verification.check("balance between knots").value
    assert any(note.startswith(f"mesh refined from N = 20 to {refined.intervals}") for note in refined.notes)
    assert [start.name for start in refined.starts].count(refined.kept_start) == 1


def test_every_answer_carries_its_limit_with_a_bar_from_a_finer_mesh(coarse: Candidate) -> None:
    """From N = 20 and 40 the limit is within 0.5 % of the second transcription's, and within its own bar."""
    solution = Replanner().solve(coarse.scenario)
    accuracy = solution.accuracy
    assert accuracy is not None
    assert (solution.intervals, accuracy.intervals) == (20, 40)
    assert accuracy.objective_limit == pytest.approx(LIMIT_OF_TABLE5, rel=5e-3)
    assert abs(accuracy.objective_limit - LIMIT_OF_TABLE5) <= accuracy.objective_bar < 0.01 * LIMIT_OF_TABLE5
    assert accuracy.objective_error == pytest.approx(solution.objective / accuracy.objective_limit - 1)
    assert summary_dict(solution)["accuracy"]["objective_error"] == accuracy.objective_error


def test_motion_on_a_finer_mesh_is_the_same_motion(coarse: Candidate) -> None:
    """Nested spline spaces: at every time and back again, to rounding."""
    spline = RestToRestSpline(2 * coarse.spline.intervals)
    problem = SolverCache().problem(coarse.scenario, spline)
    x = transfer(coarse.problem, coarse.spline, coarse.result.x, problem, spline)
    phase = np.linspace(0.0, 1.0, 173)
    before = coarse.spline.basis(phase) @ coarse.problem.unpack(coarse.result.x)[0]
    np.testing.assert_allclose(spline.basis(phase) @ problem.unpack(x)[0], before, atol=1e-9)
    back = transfer(problem, spline, x, coarse.problem, coarse.spline)
    np.testing.assert_allclose(back, coarse.result.x, atol=1e-9)


def test_a_candidate_that_cannot_win_is_given_up_and_heard_of(coarse: Candidate) -> None:
    """Against an incumbent of a tenth of its objective, and against none."""
    heard: list[tuple[str, str]] = []
    incumbent = replace(coarse.result, objective=0.1 * coarse.result.objective)

    def tell(name: str, result: SolverResult) -> None:
        heard.append((name, result.status))

    given = (SolverCache(), coarse, 40, ("banded",), NEVER, lambda line: None)
    assert optimum_on_mesh(*given, incumbent=incumbent, on_solve=tell) is None
    there = optimum_on_mesh(*given, on_solve=tell)
    assert there is not None
    assert heard == [(there.start, PRUNED), (there.start, there.result.status)]


def test_the_finer_mesh_is_also_solved_afresh_and_the_better_kept(coarse: Candidate) -> None:
    """The oracle is a cold solve of the same motion beside a warm one."""
    session = Session(coarse.scenario, SolverCache())
    found = refine_mesh(session, [coarse, coarse], 40)
    assert found is not None and found.best.solved
    best = found.best
    names = [record.name for record in session.records]
    assert names == [f"{coarse.start}, N = 40"] * 2 + [f"{coarse.start}, without multipliers on 40, N = 40"]
    assert best.origin is coarse and len(found.others) == len({round(p.result.objective, 2) for p in found.others})
    x = transfer(coarse.problem, coarse.spline, coarse.result.x, best.problem, best.spline)
    cold = session.solvers(best.problem)[0].solve(x, deadline=NEVER, problem=best.problem, incumbent=best.result)
    warm = optimum_on_mesh(SolverCache(), coarse, 40, ("banded",), NEVER, lambda line: None)
    assert warm is not None and cold.iterations > 1.5 * warm.result.iterations
    assert abs(session.records[2].iterations - cold.iterations) <= 2
    led = [result.objective for result in (warm.result, cold) if result.converged]
    assert best.result.objective == pytest.approx(min(led), rel=SAME_OPTIMUM)


def test_a_start_with_an_incumbent_that_fails_is_left_and_meshes_between_are_skipped_where_nothing_is_found(
    coarse: Candidate, monkeypatch: pytest.MonkeyPatch
) -> None:
    """IPOPT is no help against an incumbent; from 20 intervals 80 are reached even if 40 fail."""
    solve = Banded.solve

    def fail_on_40(self: Banded, x0: Any, **given: Any) -> SolverResult:
        result = solve(self, x0, **given)
        fails = len(self.problem.mesh.phase) == 41
        return replace(result, converged=False, status="Maximum_Iterations_Exceeded") if fails else result

    def never(self: Ipopt, *_: Any, **__: Any) -> SolverResult:
        raise AssertionError("IPOPT was asked")

    with monkeypatch.context() as patch:
        patch.setattr(Banded, "solve", fail_on_40)
        patch.setattr(Ipopt, "solve", never)
        incumbent = coarse.result
        assert (
            optimum_on_mesh(SolverCache(), coarse, 40, ("banded", "ipopt"), NEVER, lambda line: None, incumbent) is None
        )
    monkeypatch.setattr(Banded, "solve", fail_on_40)
    monkeypatch.setattr(Ipopt, "solve", lambda self, x0, **_: replace(coarse.result, converged=False))
    found = refine_mesh(Session(coarse.scenario, SolverCache()), [coarse], 80)
    assert found is not None and found.best.solved and found.best.origin is coarse


def test_multipliers_keep_the_sum_over_time(coarse: Candidate) -> None:
    """A multiplier times what it stands for is the objective's change, whatever the mesh: equal sums, row by row."""
    there = optimum_on_mesh(SolverCache(), coarse, 40, ("banded",), NEVER, lambda line: None)
    assert there is not None
    assert distance(coarse, there) < 0.2
    moved = transfer_multipliers(coarse.problem, coarse.result.multipliers, there.problem)
    blocks = zip(coarse.problem.constraints.blocks, there.problem.constraints.blocks, strict=True)
    for before, after in blocks:
        n = len(before.labels)
        total = coarse.result.multipliers.g[before.rows].reshape(-1, n).sum(axis=0)
        spread = moved.g[after.rows].reshape(-1, n).sum(axis=0)
        largest = np.abs(coarse.result.multipliers.g[before.rows]).max()
        np.testing.assert_allclose(spread, total, atol=0.5 * largest + 1e-9)
    # And they are near those of the optimum there: the balance's, an equality that is always active.
    balance = next(b.rows for b in there.problem.constraints.blocks if b.name == "balance")
    exact = there.result.multipliers.g[balance]
    assert np.linalg.norm(moved.g[balance] - exact) < 0.5 * np.linalg.norm(exact)


def _candidate(intervals: int, objective: float, bent: float = 0.0, rest: str = "velocity") -> Any:
    spline = RestToRestSpline(intervals, rest)
    control = bent * np.sin(np.pi * spline.greville)[:, None]
    checks = {"grasp closure between knots": 2e-4, "balance between knots": 0.05, "torque limits between knots": 0.0}
    return SimpleNamespace(
        spline=spline,
        problem=SimpleNamespace(unpack=lambda x: (control, None)),
        result=SimpleNamespace(x=None, objective=objective, converged=True),
        verification=SimpleNamespace(check=lambda name: SimpleNamespace(value=checks[name]), checks=()),
    )


@pytest.mark.parametrize(("here", "there"), [(20, 10), (20, 40), (21, 10)])
@pytest.mark.parametrize(("rest", "order"), [("velocity", 2), ("acceleration", 1)])
def test_limit_of_an_error_of_the_rests_order_is_exact(here: int, there: int, rest: str, order: int) -> None:
    """Closed form: J(N) = 100 + 60 / N**p; the bar is what is left of it on the finer mesh."""
    accuracy = compared(
        *(_candidate(n, 100 + 60 / n**order, rest=rest) for n in (here, there)),
    )
    assert accuracy.objective_limit == pytest.approx(100.0)
    assert accuracy.objective_error == pytest.approx(0.6 / here**order)
    assert accuracy.objective_bar == pytest.approx(60 / max(here, there) ** order)


def test_another_motion_gives_no_estimate_and_says_so() -> None:
    accuracy = compared(_candidate(20, 100.0), _candidate(10, 110.0, bent=2.0))
    assert not accuracy.estimated
    assert "another" in accuracy.remark


def test_what_is_unmet_is_named_with_its_amount() -> None:
    wanted = Refine(objective_error=0.02, closure=1e-4, balance=0.1, torque_excess=0.1)
    assert unmet(Accuracy(1e-5, 0.01, 0.0, 100.0, 0.01), wanted) == ""
    text = unmet(Accuracy(2e-4, 0.2, 0.3), wanted)
    for words in ("objective unknown", "0.2 mm (0.1 mm", "0.2 N, Nm (0.1", "0.3 Nm (0.1"):
        assert words in text


def test_indistinguishable_are_what_the_mesh_cannot_tell_apart() -> None:
    candidates = [_candidate(20, objective) for objective in (100.0, 100.001, 105.0, 130.0)]
    known = Accuracy(0.0, 0.0, 0.0, 90.0, 0.1)
    assert [candidate.result.objective for candidate in indistinguishable(candidates, candidates[0], known)] == [
        100.0,
        105.0,
    ]
    everything = indistinguishable(candidates, candidates[0], Accuracy(0.0, 0.0, 0.0))
    assert [candidate.result.objective for candidate in everything] == [100.0, 105.0, 130.0]


def test_accuracy_is_written_read_and_told(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    cheap = ["solver.name=banded", "solver.starts=1", "solver.intervals=12", "refine.objective_error=0.1"]
    words = [word for entry in cheap for word in ("--set", entry)]
    assert main(["solve", "table5_free", "--refine", "--out", str(tmp_path), *words]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "above its limit of" in text
    again = load_result(tmp_path)
    assert again.scenario.refine.on
    assert again.accuracy is not None
    assert again.accuracy.objective_error <= 0.1
    save(replace(again, accuracy=replace(again.accuracy, objective_limit=np.nan)), tmp_path)
    once_more = load_result(tmp_path).accuracy
    assert once_more is not None
    assert np.isnan(once_more.objective_limit)
    save(replace(again, accuracy=None), tmp_path)
    assert load_result(tmp_path).accuracy is None
