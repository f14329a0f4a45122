"""Studies of lifts by other teams: who is traded, what is varied and how it is told; figures are made up."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib import rc_context

from liftopt.collocation.motion import Motion
from liftopt.commands import pareto as pareto_command
from liftopt.commands import sensitivity as sensitivity_command
from liftopt.errors import InputError
from liftopt.multibody.trajectory import limit_share
from liftopt.scenario.build import task_of
from liftopt.scenario.model import Scenario, load_scenario
from liftopt.studies.parameters import parameters_of
from liftopt.studies.pareto import Front, Point, pareto_front
from liftopt.studies.pareto_plot import pareto_figure
from liftopt.studies.sensitivity import Sensitivity, SensitivityStudy
from liftopt.studies.sensitivity_plot import sensitivity_figure
from liftopt.viz.plots_style import STYLE

Teams = Callable[[str], Any]


def _candidate(team: Any) -> Any:
    """Return a stand-in for a candidate that moves as the team's lift."""
    solution = team.solution
    motion = Motion(solution.time, solution.agents, solution.object)
    return SimpleNamespace(
        scenario=solution.scenario,
        problem=SimpleNamespace(task=task_of(solution.scenario), team=SimpleNamespace(agents=team.agents)),
        spline=SimpleNamespace(intervals=10, phase=np.linspace(0.0, 1.0, len(solution.time))),
        result=SimpleNamespace(objective=100.0),
        at=lambda _: motion,
    )


def _front(team: Any, *between: str) -> Front:
    candidate = _candidate(team)
    points = [Point((w, 2.0 - w), (30.0 / w, 20.0 * w), 0.4, candidate) for w in (1.98, 1.0, 0.02)]
    return Front(team.solution.scenario, (between[0], between[1]), tuple(points), (), ())


def test_a_front_of_three_tells_whom_it_trades_and_what_everybody_does(team_solution: Teams) -> None:
    team = team_solution("two_robots")
    front = _front(team, "human", "far")
    values = pareto_command.front_dict(front)
    for row in values["points"]:
        assert {key.partition("_")[0] for key in row if key.endswith("_effort_N2m2s")} == {"human", "near", "far"}
        for agent in team.solution.agents:
            used = float(limit_share(agent).max())
            assert row[f"{agent.name}_largest_share_of_limit"] == pytest.approx(used, rel=1e-12)
            if agent.name == "near":  # by the trapezoid rule over the knots
                effort = np.trapezoid((agent.tau[:, agent.moving] ** 2).sum(axis=1), team.solution.time)
                assert row["near_effort_N2m2s"] == pytest.approx(effort, rel=1e-12)
    text = pareto_command.table(front, values)
    assert "Traded: human against far; weights kept: near 1." in text
    assert "weights person : far" in text
    head = next(line for line in text.splitlines() if line.startswith(" ") and "weights" in line)
    assert head.split()[-6:] == ["person", "far", "near", "load", "most", "used"]
    with rc_context(STYLE):
        axes = pareto_figure(front).axes[0]
    assert "effort of far" in axes.get_ylabel()
    assert "effort of the person" in axes.get_xlabel()


def test_a_natural_front_tells_shares_of_strength(team_solution: Teams) -> None:
    """By the trapezoid rule over the knots, in seconds."""
    team = team_solution("two_robots")
    natural = team.solution.scenario.replace({"objective.preset": "natural"})
    team = team._replace(solution=replace(team.solution, scenario=natural))
    values = pareto_command.front_dict(_front(team, "human", "far"))
    near = next(agent for agent in team.solution.agents if agent.name == "near")
    effort = np.trapezoid((limit_share(near) ** 2).sum(axis=1), team.solution.time)
    assert values["points"][0]["near_effort_s"] == pytest.approx(effort, rel=1e-12)
    text = pareto_command.table(_front(team, "human", "far"), values)
    assert "squared joint torques as shares of strength" in " ".join(text.split())
    assert "[s]" in text and "N2" not in text


def test_a_front_of_two_people_names_both(team_solution: Teams) -> None:
    front = _front(team_solution("two_people"), "anna", "ben")
    text = pareto_command.table(front, pareto_command.front_dict(front))
    assert "weights anna : ben" in text
    assert "load is anna's mean part" in text
    assert "Traded" not in text
    assert "robot" not in text


@pytest.mark.parametrize(
    ("between", "said"),
    [
        (
            ("human", "neer"),
            "--between = 'neer': must be the name of one who lifts: human, near, far; did you mean near?",
        ),
        (("far", "far"), "--between = 'far far': must be two who lift"),
    ],
)
def test_a_front_between_others_than_two_who_lift_is_refused(
    team_solution: Teams, between: tuple[str, str], said: str
) -> None:
    with pytest.raises(InputError) as caught:
        pareto_front(team_solution("two_robots").solution.scenario, 3, between=between)
    assert str(caught.value) == said


def test_a_front_is_between_the_person_and_the_first_robot_or_whom_one_says(
    team_solution: Teams, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The weights of the two change, their sum kept; the third keeps its own."""
    asked: list[Scenario] = []

    class Walk:
        def __init__(self, scenario: Scenario, pair: tuple[str, str], *_: Any) -> None:
            asked.append(scenario)
            self.pair = pair

        def best(self) -> list[None]:
            return [None, None]

    monkeypatch.setattr("liftopt.studies.pareto._Walk", Walk)
    scenario = team_solution("two_robots").solution.scenario.replace({"near.weight": 3.0})
    for between, expected, total in ((None, ("human", "near"), 4.0), (("far", "human"), ("far", "human"), 2.0)):
        front = pareto_front(scenario, 2, between=between)
        assert front.between == expected
        assert [sum(weights) for weights in front.missing] == pytest.approx([total, total])


def _study(team: Any) -> SensitivityStudy:
    agents = team.agents
    figures = {"objective": 100.0}
    for i, agent in enumerate(agents):
        figures |= {f"effort {agent.name}": 10.0 * (i + 1), f"share {agent.name}": 1.0 / len(agents)}
        figures |= {f"used {name}": 0.1 + 0.01 * j for j, name in enumerate(agent.moving_joints)}
    busiest = tuple(agent.moving_joints[-1] for agent in agents)
    rows = [
        Sensitivity(parameter, 1.0, parameter.change, {name: 0.5 * value for name, value in figures.items()}, 1.0)
        for parameter in parameters_of(team.solution.scenario)
    ]
    return SensitivityStudy(_candidate(team), figures, busiest, tuple(rows), ())


def test_parameters_are_everybodys_by_name(team_solution: Teams) -> None:
    people = {p.name: p.keys for p in parameters_of(team_solution("two_people").solution.scenario)}
    assert people["stature of anna"] == ("anna.stature",)
    assert people["body mass of ben"] == ("ben.mass",)
    assert people["feet to ben"] == ("task.standing_distance",)
    assert not [name for name in people if "robot" in name]
    robots = {p.name: p.keys for p in parameters_of(team_solution("two_robots").solution.scenario)}
    assert robots["stature"] == ("human.stature",)
    assert robots["robot base height of far"] == ("far.base_height",)
    assert robots["start height"] == ("task.start.height",)


def test_robots_alone_have_no_feet() -> None:
    team = load_scenario(Path(__file__).parents[1] / "scenario" / "teams" / "two_sawyers.toml")
    alone = {p.name: p.keys for p in parameters_of(team)}
    assert alone["near to far"] == ("task.standing_distance",)
    assert not [name for name in alone if "feet" in name]


@pytest.mark.parametrize("name", ["two_people", "two_robots"])
def test_the_table_has_columns_for_everybody(team_solution: Teams, name: str) -> None:
    """All slopes are half of what they belong to: efforts change by 50 % a unit, shares by 50 of their points."""
    team = team_solution(name)
    study = _study(team)
    text = sensitivity_command.table(study)
    lines = text.splitlines()
    for agent in team.agents:
        called = "the person" if (name, agent.name) == ("two_robots", "human") else agent.name
        assert f"of {called} " in lines[0]
    head = next(i for i, line in enumerate(lines) if line.startswith("if this"))
    labels = lines[head].split()
    assert labels[3:5] == {"two_people": ["anna", "ben"], "two_robots": ["person", "near"]}[name]
    width = len(lines[head])
    rows = [line for line in lines[head + 2 :] if line.rstrip().endswith("0.50")]
    assert len(rows) == len(study.sensitivities)
    assert {len(row) for row in rows} == {width}
    mass = next(row for row in rows if row.startswith("object mass"))
    numbers = mass.partition("kg")[2].split()
    assert numbers[: 1 + len(team.agents)] == ["+5.00"] * (1 + len(team.agents))


def test_the_figure_has_bars_for_everybody(team_solution: Teams) -> None:
    for name, labels in (
        ("two_people", ["anna's effort", "ben's"]),
        ("two_robots", ["person's effort", "near's", "far's"]),
    ):
        with rc_context(STYLE):
            left, right = sensitivity_figure(_study(team_solution(name))).axes
        assert [text.get_text() for text in left.get_legend().get_texts()] == labels
        assert right.get_title(loc="left") == ("Load each bears" if name == "two_people" else "Load the person bears")
