"""What a lift depends on; oracles: the lift solved again on both sides, the envelope theorem, sums that must be 1."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from liftopt.cli import main
from liftopt.replan import Replanner
from liftopt.scenario import load_scenario, scenario_to_toml
from liftopt.sensitivity import PARAMETERS, Parameter, Study, changed, figures, peak_knots, study
from liftopt.sensitivity_command import study_dict
from liftopt.workshop import Workshop

ENTRIES = ("solver.name=banded", "solver.starts=1", "solver.intervals=12")


@pytest.fixture(scope="module")
def replanner() -> Replanner:
    return Replanner(workshop=Workshop())


@pytest.fixture(scope="module")
def near(replanner: Replanner) -> Study:
    scenario = load_scenario("table5_near", [*ENTRIES, "solver.tolerance=1e-8"])
    assert replanner.solve(scenario).solved
    assert replanner.latest is not None
    return study(replanner.latest, Workshop())


def test_slopes_are_those_of_the_lift_solved_again(near: Study, replanner: Replanner) -> None:
    """Each parameter on both sides, warm, a third of the way to where the first limit changes or a thousandth."""
    assert [s.parameter for s in near.sensitivities] == list(PARAMETERS)
    peaks, kinds = peak_knots(near.plan), ("objective", "effort", "share", "peak")
    for s in near.sensitivities:
        step, found = min(s.reach / 3, 1e-3 * s.value), []
        for change in (-step, step):
            replanner.latest = near.plan
            plan = replanner.replan(changed(near.plan.scenario, s.parameter, change))
            assert plan is not None
            found.append(figures(plan.problem, plan.spline, plan.result.x, peaks))
        resolved = {name: (found[1][name] - found[0][name]) / (2 * step) for name in near.figures}
        for kind in kinds:
            names = [name for name in resolved if name.startswith(kind)]
            largest = max(abs(resolved[name]) for name in names)
            for name in names:
                assert s.slopes[name] == pytest.approx(resolved[name], abs=2e-3 * largest), (s.parameter.name, name)


def test_objective_slopes_by_tangent_and_by_envelope_agree(near: Study) -> None:
    for s in near.sensitivities:
        assert s.slopes["objective"] == pytest.approx(s.envelope, rel=1e-4)


def test_shares_sum_to_one_whatever_changes(near: Study) -> None:
    assert near.figures["share human"] + near.figures["share robot"] == pytest.approx(1.0)
    for s in near.sensitivities:
        assert s.slopes["share human"] == pytest.approx(-s.slopes["share robot"], abs=1e-6)


def test_free_and_impossible_parameters_are_left_out_with_a_reason(replanner: Replanner) -> None:
    scenario = load_scenario("table5_free", ENTRIES)
    replanner.solve(scenario)
    assert replanner.latest is not None
    grasp = next(p for p in PARAMETERS if p.name == "grasp from feet")
    least = Parameter("balance", ("limits.balance_tolerance",), 0.1, "N, Nm")
    found = study(replanner.latest, Workshop(), (grasp, least))
    assert not found.sensitivities
    assert "free" in found.left_out[0][1]
    assert "must be a number from 0" in found.left_out[1][1]


def test_command_tells_writes_and_takes_a_result(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shipped = load_scenario("table5_free", ENTRIES)
    (tmp_path / "scenario.toml").write_text(scenario_to_toml(shipped), encoding="utf-8")
    assert main(["sensitivity", str(tmp_path), "--plot", str(tmp_path / "bars.svg")]) == 0
    text = capsys.readouterr().out
    for word in ("stature", "object mass", "duration", "grasp from feet is left out"):
        assert word in text
    assert "object mass" in (tmp_path / "bars.svg").read_text(encoding="utf-8")


def test_json_holds_every_slope(near: Study) -> None:
    found = json.loads(json.dumps(study_dict(near), allow_nan=False))
    mass = next(p for p in found["parameters"] if p["keys"] == ["human.mass"])
    assert mass["slopes"].keys() == found["figures"].keys()
    assert mass["slopes"]["effort human"] > 0
    assert mass["unit"] == "kg"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--plot", "bars.gif"], "must end in .svg"),
        (["--set", "table.mass=-1"], "table.mass"),
        (["nowhere"], "no such"),
    ],
)
def test_wrong_use_is_refused_in_one_line(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sensitivity", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
