"""A lift whose spine may be pressed with no more than so much.

Oracles: the load through the disc by inverse dynamics as the assessment tells it, the same lift without the limit, and
static postures under the limit that is said to be needed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from liftopt.collocation.elastic_mode import SoftProblem
from liftopt.collocation.motion import motion_at
from liftopt.collocation.parametric import Optimum
from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.solvers.result import Multipliers, SolverResult
from liftopt.ergonomics.spine import load_through, spine_load
from liftopt.errors import InputError
from liftopt.scenario.build import motions_of
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.scenario.settings import Refine
from liftopt.search.adjustables import adjustables
from liftopt.search.cache import BANDED, SolverCache
from liftopt.search.feasibility_screen import screen_ends
from liftopt.search.infeasibility import find_least_violation
from liftopt.search.initial_guess import posture_starts
from liftopt.search.mesh_accuracy import unmet
from liftopt.search.solve import solve
from liftopt.solution.checks import Check
from liftopt.solution.finding import CAUTION
from liftopt.solution.solution import Solution
from liftopt.solution.verify import verify
from liftopt.viz.plots_data import Lift
from liftopt.viz.plots_spine import spine_load as plot_of_spine

KEY = "limits.spine_compression"
SMALL = ("solver.intervals=10", "solver.tries=0", "solver.starts=2", "limits.clearance=off", "solver.time_limit=3600")


@dataclass(frozen=True)
class Free:
    """The lift without a limit."""

    cache: SolverCache
    scenario: Scenario
    problem: Problem
    optimum: SolverResult

    def limited(self, most: float) -> Problem:
        """Return the same lift with a limit."""
        scenario = self.scenario.replace({KEY: most})
        return self.cache.problem(scenario, motions_of(scenario))

    def excess(self, problem: Problem) -> Check:
        """Return by how much the motion without the limit is beyond it."""
        none = Multipliers(np.zeros(problem.layout.n_x), np.zeros(problem.constraints.linear.shape[0]))
        found = verify(problem, motions_of(self.scenario), replace(self.optimum, multipliers=none), 1e-6)
        return found.check("compression of the spine")

    def solved(self, problem: Problem, x: np.ndarray) -> SolverResult:
        """Return what the banded solver comes to from a motion."""
        return self.cache.solver(problem, self.scenario, BANDED).solve(x, deadline=NEVER, problem=problem)


@pytest.fixture(scope="module")
def limited() -> Solution:
    return solve(load_scenario("floor_box", [*SMALL, f"{KEY}=3200"]))


@pytest.fixture(scope="module")
def free() -> Free:
    cache, scenario = SolverCache(), load_scenario("floor_box", [*SMALL, "solver.tolerance=1e-8"])
    problem = cache.problem(scenario, motions_of(scenario))
    starts = posture_starts(problem, 1, 0, NEVER, postures=cache.postures(problem, scenario))
    optimum = cache.solver(problem, scenario, BANDED).solve(starts[0].x, deadline=NEVER)
    assert optimum.converged
    return Free(cache, scenario, problem, optimum)


def _compression(solution: Solution) -> np.ndarray:
    return spine_load(solution, solution["human"]).compression


def test_the_limit_holds_at_every_knot_and_is_verified(limited: Solution) -> None:
    assert limited.solved, limited.status
    pressed = _compression(limited)
    assert pressed.max() <= 3200.0 + 1e-6
    assert pressed.max() > 3199.0  # it shapes the lift
    assert limited.verification.check("compression of the spine").passed
    assert limited.verification.kkt_error <= limited.scenario.solver.tolerance
    assert limited.scenario.limits.spine_compression == 3200.0
    (told,) = [finding for finding in limited.assessment if finding.code == "person.spine_limit"]
    assert (told.severity, told.limit) == (CAUTION, 3200.0)
    assert told.value is not None and told.value >= pressed.max()  # between the knots too


def test_refining_goes_on_while_it_is_exceeded_between_the_knots(limited: Solution) -> None:
    """The load between the knots, as the finding tells it, beyond the limit."""
    assert limited.accuracy is not None
    (told,) = [finding for finding in limited.assessment if finding.code == "person.spine_limit"]
    assert told.value is not None
    assert limited.accuracy.compression_excess == pytest.approx(told.value - 3200.0, rel=1e-6)
    assert limited.accuracy.compression_excess > 1.0
    short = unmet(limited.accuracy, Refine(compression_excess=1.0))
    assert f"compression above its limit between knots {limited.accuracy.compression_excess:.2g} N (1 N asked)" in short
    assert "compression" not in unmet(limited.accuracy, Refine(compression_excess=1000.0))


def test_the_plot_shows_it(limited: Solution) -> None:
    lift = Lift.of(limited)
    pressing = plot_of_spine(lift, lift.dense["human"]).axes[0]
    assert "limit of this lift 3200 N" in [text.get_text() for text in pressing.texts]
    assert [3200.0, 3200.0] in [list(line.get_ydata()) for line in pressing.lines]


def test_it_costs(free: Free) -> None:
    """From the optimum without the limit; its motion presses more, and what presses less takes more."""
    spline = motions_of(free.scenario)
    before = verify(free.problem, spline, free.optimum, 1e-6)
    assert not any("spine" in check.name for check in before.checks)
    problem = free.limited(3400.0)
    unlimited = free.excess(problem)
    assert unlimited.value > 100.0 and not unlimited.passed
    optimum = free.solved(problem, free.optimum.x)
    assert optimum.converged and optimum.objective > free.optimum.objective
    assert verify(problem, spline, optimum, 1e-6).passed


def test_what_a_newton_costs(free: Free) -> None:
    """The slope of the optimum by the limit, from its multipliers, against optima on both sides."""
    step = 1.0
    problem, *sides = (free.limited(most) for most in (3400.0, 3400.0 - step, 3400.0 + step))
    optimum = free.solved(problem, free.optimum.x)
    below, above = (free.solved(side, optimum.x).objective for side in sides)
    tangent = Optimum(problem, optimum.x, optimum.multipliers).tangent(*sides, step)
    assert tangent.objective < 0.0
    assert tangent.objective == pytest.approx((above - below) / (2.0 * step), rel=1e-3)


def test_another_limit_is_another_bound_and_nothing_else(free: Free) -> None:
    one, other = free.limited(4000.0), free.limited(3000.0)
    assert one.interchangeable(other) and not one.interchangeable(free.problem)
    differ = np.flatnonzero(one.constraints.upper != other.constraints.upper)
    (block,) = [block for block in one.constraints.blocks if block.name == "compression"]
    assert differ.tolist() == list(range(block.rows.start, block.rows.stop))
    assert [b.name for b in free.problem.constraints.blocks if b.name == "compression"] == []


def test_what_a_motion_breaks_is_told_in_newtons(free: Free) -> None:
    problem = free.limited(3000.0)
    soft = SoftProblem(problem.team, problem.task, problem.mesh)
    slack = soft.start(free.optimum.x)[problem.layout.n_x :]
    (broken,) = [v for v in soft.violations(slack) if v.constraint == "compression"]
    excess = free.excess(problem)
    assert (broken.who, broken.unit) == ("human", "N")
    assert broken.amount == pytest.approx(excess.value, rel=1e-9)
    assert broken.share == pytest.approx(excess.value / 3000.0, rel=1e-9)
    assert f"human at {broken.time:.2f} s" == excess.where


def test_the_motion_that_breaks_least_presses_the_spine_too_much(free: Free) -> None:
    """No posture keeps it, see below; the load through the disc of that motion is the oracle."""
    problem, spline = free.limited(1500.0), motions_of(free.scenario)
    least = find_least_violation(problem, [free.optimum.x], NEVER)
    assert least is not None and least.sure
    (reason,) = [reason for reason in least.reasons if reason.constraint == "compression"]
    person = motion_at(problem, spline, least.x, problem.mesh.phase).agents[0]
    (agent,) = problem.team.agents
    assert agent.disc is not None
    pressed = load_through(agent, person, agent.disc.upright, agent.disc.place).compression
    assert reason.amount == pytest.approx(pressed.max() - 1500.0, rel=1e-3)
    assert f"the lumbar spine of human is pressed with {reason.amount:.3g} N" in reason.message


def test_a_limit_that_no_posture_keeps_is_named_with_what_it_takes(free: Free) -> None:
    """With as much as is said to be needed the postures hold; what may help is offered."""
    reasons, _ = screen_ends(free.limited(1500.0), 0, NEVER)
    (reason,) = [reason for reason in reasons if reason.time == 0.0]
    assert (reason.constraint, reason.who, reason.unit) == ("compression", "human", "times the limit")
    assert (
        f"about {reason.amount:.2f} times the limit on the compression of the lumbar spine of human" in reason.message
    )
    assert screen_ends(free.limited(1.001 * reason.amount * 1500.0), 0, NEVER)[0] == []
    scenario = free.scenario.replace({KEY: 1500.0})
    offered = {item.keys: item.hint(scenario, reasons) for item in adjustables(scenario)}
    assert offered[KEY,] * 50.0 >= 1500.0 * reason.share
    assert offered["object.mass",] > 0
    assert (KEY,) not in {item.keys for item in adjustables(free.scenario)}


@pytest.mark.parametrize(
    ("name", "changes", "words"),
    [
        ("table5", (), 'set human.body = "whole"'),
        ("floor_box", (f"{KEY}=499",), 'must be a number from 500 to 20000 N, or "off"'),
    ],
)
def test_what_cannot_be_asked_is_refused(name: str, changes: tuple[str, ...], words: str) -> None:
    with pytest.raises(InputError, match=KEY) as refused:
        load_scenario(name, [f"{KEY}=3000", *changes][-1:])
    assert words in str(refused.value)
