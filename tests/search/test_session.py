"""The session: what time was over at is noted once, and the clock of a lift is shared out as promised."""

from __future__ import annotations

import time

import pytest

from liftopt.collocation.solvers.deadline import Deadline
from liftopt.scenario.model import load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.session import FINISHING_SHARE, TRYING_SHARE, Session


@pytest.fixture
def session() -> Session:
    return Session(load_scenario("table5_paper", ["solver.intervals=8", "solver.time_limit=100"]), SolverCache())


def test_each_phase_has_its_share_of_the_limit(session: Session) -> None:
    began = session.limit.began
    assert session.deadline.at == pytest.approx(began + 100.0 * TRYING_SHARE)
    session.finish()
    assert session.deadline.at == pytest.approx(began + 100.0 * FINISHING_SHARE)


def test_the_stage_at_which_time_was_over_is_noted_once(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    session.progress("first")
    assert session.notes == [] and session.cut == ""
    session.limit = Deadline(at=time.monotonic() - 1.0, began=time.monotonic() - 101.0)
    session.progress("second")
    session.progress("third")
    session.note_time()
    assert session.notes == [session.cut]
    assert session.cut.startswith("the time limit of 100 s ") and session.cut.endswith("(first)")


def test_stages_hear_of_the_same_problem_and_solvers(session: Session) -> None:
    """What one stage was given, the next gets again: kernels and solvers are built once."""
    problem = session.problem(session.spline)
    assert session.problem(session.spline) is problem
    assert [id(solver) for solver in session.solvers(problem)] == [id(solver) for solver in session.solvers(problem)]
