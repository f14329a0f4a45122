"""The coarse search: Pinocchio judges its optima, and they must be what the fine mesh is given."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.errors import SolverError
from liftopt.scenario.model import load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.coarse_search import ROUGH, _unseen, coarse_search
from liftopt.search.initial_guess import InitialGuess, InitialGuessSet, initial_guesses
from liftopt.search.mesh_refinement import COARSE, meshes_below
from liftopt.search.optima import PROMISING, SAME_OPTIMUM
from liftopt.search.session import Session
from liftopt.search.solve import search
from liftopt.search.variations import TURN


def _session(*overrides: str) -> tuple[Session, InitialGuessSet]:
    session = Session(
        load_scenario("table5_near", ["objective.preset=paper", "limits.clearance=off", *overrides]), SolverCache()
    )
    guesses = initial_guesses(session.problem(session.spline), 12, 0, NEVER, None, session.postures)
    assert guesses is not None
    return session, guesses


def test_it_brings_different_optima_of_half_the_intervals_the_best_first() -> None:
    """Each is first-order optimal by Pinocchio's derivatives, as far as a coarse search goes."""
    session, guesses = _session("solver.starts=3")
    candidates = coarse_search(session, session.spline, guesses, 12)
    assert 1 <= len(candidates) <= 3
    objectives = np.array([candidate.result.objective for candidate in candidates])
    assert (np.diff(objectives) > SAME_OPTIMUM * objectives[:-1]).all()
    assert objectives[-1] <= PROMISING * objectives[0]
    for candidate in candidates:
        assert candidate.spline.intervals == 10 and candidate.start.endswith(", N = 10")
        assert candidate.verification.kkt_error <= ROUGH * candidate.result.objective
    assert session.notes[-1].endswith(f"the best {len(candidates)} were taken to 20")


@given(intervals=st.integers(12, 400))
def test_meshes_below_double_up_to_the_one_asked_for(intervals: int) -> None:
    meshes = [*meshes_below(intervals), intervals]
    assert meshes[0] < 2 * COARSE and (len(meshes) == 2 or meshes[0] >= COARSE)
    for coarse, fine in pairwise(meshes):
        assert fine <= 2 * coarse <= fine + 1


def test_a_fine_mesh_is_reached_from_mesh_to_mesh() -> None:
    session, _ = _session("solver.starts=2", "solver.tries=4", "solver.intervals=80")
    candidate = search(session).best
    assert candidate.solved
    chain = [candidate]
    while chain[-1].origin is not None:
        chain.append(chain[-1].origin)
    assert [link.spline.intervals for link in chain] == [80, 40, 20]
    assert any(" variations on 20 intervals led to" in note for note in session.notes)
    recorded = [record.name for record in session.records]
    assert any(name.endswith(", N = 40") for name in recorded) and not recorded[-1].endswith(", N = 80")
    assert len(set(recorded)) == len(recorded)


def test_no_coarse_search_where_half_the_mesh_is_too_coarse_or_no_tries_are_asked_for() -> None:
    coarse, guesses = _session("solver.intervals=10")
    assert coarse_search(coarse, coarse.spline, guesses, 12) == []
    session, guesses = _session()
    assert coarse_search(session, session.spline, guesses, 0) == []
    assert session.notes == []


def test_the_search_goes_on_where_the_solver_of_the_coarse_search_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    session, guesses = _session()

    def missing(*_: object) -> None:
        raise SolverError("not installed")

    monkeypatch.setattr(session.cache, "solver", missing)
    assert coarse_search(session, session.spline, guesses, 12) == []


def test_the_chance_of_something_new_is_the_share_of_what_was_found_once() -> None:
    """Good (1953), by hand: of six starts that converged, to 1, 1, 2, 3, 3 and 4, two led where no other did."""
    x = np.zeros(1)

    def tried(*objectives: float) -> list[tuple[InitialGuess, SolverResult]]:
        return [
            (InitialGuess("", x), SolverResult(x, Multipliers(x, x), J, 1, bool(np.isfinite(J)), "", 0.0, 0.0))
            for J in objectives
        ]

    assert _unseen(tried(3.0, 1.0, 4.0, 1.0 + 1e-6, np.nan, 3.0, 2.0)) == pytest.approx(2 / 6)
    assert _unseen(tried(1.0, 2.0)) == 1.0
    assert _unseen(tried(1.0, 1.0)) == 0.0
    assert _unseen(tried(np.nan)) == 1.0


def test_where_an_optimum_was_found_once_the_best_are_varied() -> None:
    """At least one turn of variations; Pinocchio's derivatives judge the optima."""
    overrides = ["object.mass=9", "duration=5", "task.start.human_distance=free", "task.end.human_distance=free"]
    session, guesses = _session(*overrides)
    candidates = coarse_search(session, session.spline, guesses, 12)
    assert candidates and int(session.notes[-1].split()[3]) >= TURN
    for candidate in candidates:
        assert candidate.verification.kkt_error <= ROUGH * candidate.result.objective
