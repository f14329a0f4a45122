"""What a lift depends on; oracles: the optimality conditions, the lift solved again, the envelope theorem, sums."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liftopt.studies.sensitivity
from liftopt.collocation.parametric import Optimum, Tangent
from liftopt.collocation.problem import Problem
from liftopt.commands.cli import main
from liftopt.commands.sensitivity import study_dict, table
from liftopt.control.replanning import Replanner
from liftopt.multibody.trajectory import limit_share
from liftopt.scenario.file import shipped_scenarios
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.candidate import Candidate
from liftopt.studies.parameters import Parameter, changed, parameters_of
from liftopt.studies.sensitivity import SensitivityStudy, figures, study

pytestmark = pytest.mark.long
PAPER = ("objective.preset=paper", "limits.clearance=off")
ENTRIES = (*PAPER, "solver.name=banded", "solver.starts=1", "solver.intervals=12")
PARAMETERS = parameters_of(load_scenario())


@pytest.fixture(scope="module")
def cache() -> SolverCache:
    return SolverCache()


@pytest.fixture(scope="module")
def replanner(cache: SolverCache) -> Replanner:
    return Replanner(cache=cache)


@pytest.fixture(scope="module")
def candidate(replanner: Replanner) -> Candidate:
    scenario = load_scenario("table5_near", [*ENTRIES, "solver.tolerance=1e-8"])
    assert replanner.solve(scenario).solved
    assert replanner.latest is not None
    return replanner.latest


@pytest.fixture(scope="module")
def near(candidate: Candidate, cache: SolverCache) -> SensitivityStudy:
    return study(candidate, cache)


def _tangent(candidate: Candidate, parameter: Parameter, step: float) -> tuple[Tangent, list[Problem]]:
    """The optimum's own derivative, which no solve takes part in, and the problems below and above."""
    cache = SolverCache()  # of its own: problems are not shared
    sides = [
        cache.problem(changed(candidate.scenario, parameter, change), candidate.spline) for change in (-step, step)
    ]
    return Optimum(candidate.problem, candidate.result.x, candidate.result.multipliers).tangent(*sides, step), sides


def test_slopes_of_small_changes_are_those_of_the_optimality_conditions(
    candidate: Candidate, cache: SolverCache
) -> None:
    """Within what no limit changes sides in; implicit differentiation of the KKT conditions is the oracle."""
    tangents, small = {}, []
    for parameter in PARAMETERS:
        value = {"stature": 1.75, "body mass": 75.0, "object mass": 2.0, "duration": 2.0}.get(parameter.name, 1.0)
        tangent, _ = _tangent(candidate, parameter, 1e-4 * value)
        small.append(replace(parameter, change=min(tangent.reach / 3, 1e-3 * value)))
        tangents[parameter.name] = _tangent(candidate, parameter, small[-1].change)
    found = study(candidate, cache, small)
    assert [s.parameter for s in found.sensitivities] == small
    for s in found.sensitivities:
        assert s.is_reliable
        tangent, problems = tangents[s.parameter.name]
        low, high = (
            figures(
                replace(
                    candidate,
                    problem=problem,
                    result=replace(candidate.result, x=candidate.result.x + change * tangent.x),
                )
            )
            for problem, change in zip(problems, (-s.change, s.change), strict=True)
        )
        for kind in ("objective", "effort", "share", "peak", "used"):
            names = [name for name in low if name.startswith(kind)]
            expected = {name: (high[name] - low[name]) / (2 * s.change) for name in names}
            largest = max(map(abs, expected.values()))
            for name in names:
                assert s.slopes[name] == pytest.approx(expected[name], abs=5e-3 * largest), (s.parameter.name, name)


def test_slopes_are_those_of_the_lift_solved_again(
    near: SensitivityStudy, candidate: Candidate, replanner: Replanner
) -> None:
    """At half the change, where the promise is at most a tenth off, or next to nothing."""
    assert [s.parameter for s in near.sensitivities] == list(PARAMETERS)
    assert sum(s.is_reliable for s in near.sensitivities) >= 8
    for s in filter(lambda s: s.is_reliable, near.sensitivities):
        found = []
        for change in (-s.change / 2, s.change / 2):
            replanner.latest = candidate
            again = replanner.replan(changed(candidate.scenario, s.parameter, change))
            assert again is not None
            found.append(figures(again))
        for name in ("objective", "effort human", "effort robot", "share human", *(f"used {j}" for j in near.busiest)):
            whole = 1.0 if name.startswith(("share", "used")) else near.figures[name]
            half = found[1][name] - found[0][name]
            assert s.slopes[name] * s.change == pytest.approx(half, rel=0.12, abs=0.0025 * whole), (s.parameter, name)


def test_objective_slopes_by_solving_again_and_by_envelope_agree(near: SensitivityStudy) -> None:
    """The envelope theorem gives the slope at the optimum, so they differ by what the objective bends."""
    for s in filter(lambda s: s.is_reliable, near.sensitivities):
        assert s.slopes["objective"] == pytest.approx(s.envelope, rel=0.05, abs=0.002 * near.figures["objective"])


def test_use_of_a_joint_is_torque_over_the_limit_in_its_direction(near: SensitivityStudy, candidate: Candidate) -> None:
    """By the definition, at ten times the knots; one limit of a person's joint is up to twice the other."""
    for agent in candidate.at(
        np.linspace(0.0, candidate.problem.task.duration, 10 * candidate.spline.intervals + 1)
    ).agents:
        names = [agent.joint_names[j] for j in np.flatnonzero(agent.moving)]
        uses = {}
        for column, name in enumerate(names):
            tau = agent.tau[:, agent.moving][:, column]
            upper, lower = agent.limits.tau_upper[column], agent.limits.tau_lower[column]
            uses[name] = max(tau.max() / upper, tau.min() / lower)
            assert near.figures[f"used {name}"] == pytest.approx(uses[name])
            assert near.figures[f"peak {name}"] == pytest.approx(np.abs(tau).max())
        assert max(uses, key=lambda name: uses[name]) in near.busiest


@pytest.mark.parametrize("name", [name for name in shipped_scenarios() if name.startswith("table5")])
def test_the_table_of_a_shipped_scenario_is_usable(
    name: str, solved: Callable[..., Any], capsys: pytest.CaptureFixture[str]
) -> None:
    """Most rows can be relied on, the others say why, and the joints are those that solve names."""
    assert main(["sensitivity", name, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    rows = found["parameters"]
    assert len(rows) >= 9
    assert sum(row["reliable"] for row in rows) >= 0.7 * len(rows)
    usual = {p.name: p.change for p in PARAMETERS}
    for row in rows:
        assert row["reliable"] is (row["doubt"] is None)
        assert row["change"] <= usual[row["name"]]
        assert (row["change"] < usual[row["name"]]) <= (row["not_larger_because"] is not None)
    for joint, agent in zip(found["busiest"], solved(name).solution.agents, strict=True):
        most = limit_share(agent).max(axis=0)
        assert joint == [agent.joint_names[j] for j in np.flatnonzero(agent.moving)][int(most.argmax())]


DURATION = next(p for p in PARAMETERS if p.name == "duration")


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (
            lambda candidate: replace(candidate, result=replace(candidate.result, x=candidate.result.x + 0.5)),
            "another optimum",
        ),
        (lambda candidate: None, "no verified lift is found"),
    ],
)
def test_beyond_a_jump_or_a_failure_a_smaller_change_is_taken(
    spoil: Callable[[Candidate], Candidate | None],
    said: str,
    candidate: Candidate,
    cache: SolverCache,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Solves of more than 30 ms longer are spoilt: the largest change without is 25 ms."""
    true = Replanner.replan

    def replan(self: Replanner, scenario: Scenario) -> Candidate | None:
        again = true(self, scenario)
        return spoil(again) if again is not None and scenario.duration > 2.03 else again

    monkeypatch.setattr(Replanner, "replan", replan)
    (found,) = study(candidate, cache, (DURATION,)).sensitivities
    assert said in found.beyond
    assert found.change <= 0.025


def test_what_never_is_in_proportion_is_marked_with_the_reason(
    candidate: Candidate, cache: SolverCache, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The person's effort made to rise both ways, as at a kink: no step helps."""
    true = liftopt.studies.sensitivity.figures

    def kinked(of: Candidate) -> dict[str, float]:
        found = true(of)
        found["effort human"] *= 1 + 2 * abs(of.scenario.duration - 2.0)
        return found

    monkeypatch.setattr("liftopt.studies.sensitivity.figures", kinked)
    found = study(candidate, cache, (DURATION,))
    (row,) = found.sensitivities
    assert not row.is_reliable
    assert row.change == 0.1
    assert "effort human" in row.doubt
    lines = table(found).splitlines()
    assert any(line.startswith("duration") and "+0.1 s !" in line for line in lines)
    assert any(line.startswith("  duration +0.1 s: effort human") for line in lines)


def test_shares_sum_to_one_whatever_changes(near: SensitivityStudy) -> None:
    assert near.figures["share human"] + near.figures["share robot"] == pytest.approx(1.0)
    for s in near.sensitivities:
        assert s.slopes["share human"] == pytest.approx(-s.slopes["share robot"], abs=1e-6)


def test_free_and_impossible_parameters_are_left_out_with_a_reason(replanner: Replanner, cache: SolverCache) -> None:
    scenario = load_scenario("table5_free", ENTRIES)
    replanner.solve(scenario)
    assert replanner.latest is not None
    grasp = next(p for p in PARAMETERS if p.name == "grasp from feet")
    least = Parameter("balance", ("limits.balance_tolerance",), 0.1, "N, Nm")
    found = study(replanner.latest, cache, (grasp, least))
    assert not found.sensitivities
    assert "free" in found.left_out[0][1]
    assert "must be a number from 0" in found.left_out[1][1]


def test_command_tells_writes_and_takes_a_result(
    solved: Callable[..., Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = solved("table5_free", *ENTRIES).folder
    assert main(["sensitivity", str(folder), "--plot", str(tmp_path / "bars.svg")]) == 0
    text = capsys.readouterr().out
    for word in ("stature", "object mass", "duration", "grasp from feet is left out"):
        assert word in text
    assert "object mass" in (tmp_path / "bars.svg").read_text(encoding="utf-8")


def test_json_holds_every_slope(near: SensitivityStudy) -> None:
    found = json.loads(json.dumps(study_dict(near), allow_nan=False))
    mass = next(p for p in found["parameters"] if p["keys"] == ["human.mass"])
    assert mass["slopes"].keys() == found["figures"].keys()
    assert mass["slopes"]["effort human"] > 0
    assert mass["unit"] == "kg"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--plot", "bars.gif"], "must end in .svg"),
        (["--set", "object.mass=-1"], "object.mass"),
        (["nowhere"], "no such"),
    ],
)
def test_wrong_use_is_refused_in_one_line(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sensitivity", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_planes_have_settled_before_a_lift_is_differentiated() -> None:
    """Oracle: the lift solved once more, which moves its objective no more, as it did before."""
    cheap = {"solver.intervals": 14, "solver.starts": 1, "solver.tries": 0}
    replanner = Replanner()
    assert replanner.solve(load_scenario("floor_box", cheap)).solved
    found = replanner.latest
    assert found is not None and found.problem.planes is not None
    settled = liftopt.studies.sensitivity._settled(replanner, found)
    replanner.latest = settled
    again = replanner.replan(settled.scenario)
    assert again is not None
    first, then, after = (figures(each)["objective"] for each in (found, settled, again))
    assert abs(first - then) > 1e-4 * then
    assert after == pytest.approx(then, rel=2e-6)
