"""Work and energy along a solved lift. Oracles: conservation of energy, Simpson's order, weight times height."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from liftopt.crosscheck.energy import energy_books, unexplained

CHEAP = ("solver.intervals=10", "solver.starts=1")


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Any:
    return solved("table5_paper", *CHEAP).solution


def test_energy_is_conserved_but_for_an_error_of_fourth_order_in_the_quadrature(solution):
    errors = np.array([[books.error for books in energy_books(solution, panels)] for panels in (2, 4, 8)])
    assert np.all(errors[:-1] > 12 * errors[1:])
    assert all(books.relative < 1e-6 for books in energy_books(solution, 8))


def test_the_object_gains_its_weight_times_the_height_it_is_lifted(solution):
    *agents, lifted, together = energy_books(solution, 2)
    table = solution.scenario.object.mass * 9.81 * (solution.object.pose[-1, 2] - solution.object.pose[0, 2])
    assert lifted.change[-1] == pytest.approx(table, rel=1e-12)
    assert table == pytest.approx(2.0 * 9.81 * 0.5, rel=1e-9)
    assert together.change[-1] == pytest.approx(sum(books.change[-1] for books in (*agents, lifted)), rel=1e-12)


def test_what_the_transcription_leaves_shrinks_with_the_mesh(solution, solved):
    """At second order, which from N = 40 to 80 is a factor of 4; on 10 intervals closure is too wide between knots."""
    fine, finest = (solved("table5_paper", f"solver.intervals={n}", "solver.starts=1").solution for n in (40, 80))
    assert (solution.intervals, fine.intervals, finest.intervals) == (20, 40, 80)
    assert unexplained(energy_books(fine, 2)) < unexplained(energy_books(solution, 2)) / 2
    assert unexplained(energy_books(finest, 2)) < unexplained(energy_books(fine, 2)) / 4
    assert unexplained(energy_books(solution, 2)) < 1e-3


def test_a_velocity_that_is_not_the_motions_breaks_the_books(solution):
    human, robot = solution.agents
    wrong = replace(solution, agents=(replace(human, v=1.001 * human.v), robot))
    books = {each.name: each.relative for each in energy_books(wrong, 8)}
    assert books["human"] > 1e-5
    assert books["robot"] < 1e-6


def test_a_heavier_object_than_was_solved_leaves_work_that_nobody_does(solution):
    table = solution.urdfs["table"]
    heavier = table.replace('<mass value="2.0"/>', '<mass value="2.2"/>')
    assert heavier != table
    wrong = replace(solution, urdfs=solution.urdfs | {"table": heavier})
    # A tenth of the table's 9.8 J, of the 32 J of all.
    assert unexplained(energy_books(wrong, 2)) > 0.02
