"""Plots of other teams: everybody's curves under everybody's name, against the trajectories they show."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from liftopt.ergonomics.measures import ergonomics_of
from liftopt.scenario.model import load_scenario
from liftopt.solution.grasp_loads import shares
from liftopt.viz.plots import drawn, plots_of, write_plots
from liftopt.viz.plots_data import Lift
from liftopt.viz.who import stand_opposite

PERSON = ("arm", "angles", "recorded", "torques", "ground_reaction", "strength_used", "spine_load", "posture_score")
TURNED = {"human.heading_deg": 90.0, "task.start.human_distance": None, "task.end.human_distance": None}
WHOLE = ("snapshots", "grasp_forces", "object_motion", "clearance")


@pytest.fixture(scope="module")
def lift(team: Any) -> Lift:
    return Lift.of(team.solution)


@pytest.fixture(scope="module")
def people(two_people: Any) -> tuple[Lift, dict[str, Figure]]:
    lift = Lift.of(two_people.solution)
    return lift, {plot.name: drawn(plot, lift) for plot in plots_of(lift)}


def _panel(figure: Figure, title: str) -> Any:
    (axes,) = (axes for axes in figure.axes if axes.get_title(loc="left").startswith(title))
    return axes


def test_every_person_and_robot_has_files_by_name(two_people: Any, two_robots: Any) -> None:
    named = {plot.name: plot for plot in plots_of(Lift.of(two_people.solution))}
    assert set(named) == {*WHOLE, *(f"{name}_{what}" for name in ("anna", "ben") for what in PERSON)}
    assert named["ben_angles"].caption.startswith("All joint angles of ben within")
    assert named["grasp_forces"].caption.startswith("Force of anna and ben on the object")
    robots = {f"{name}_{what}" for name in ("near", "far") for what in ("angles", "torques")}
    person = {"human_arm", "human_angles", "recorded_angles", "human_torques", "ground_reaction", "strength_used"}
    person |= {"spine_load", "posture_score"}
    assert {plot.name for plot in plots_of(Lift.of(two_robots.solution))} == {*WHOLE, *robots, *person}


def test_files_are_written(two_robots: Any, tmp_path: Path) -> None:
    files = write_plots(two_robots.solution, tmp_path, ("svg",))
    assert len({file.name for file in files}) == len(files) == len(WHOLE) + len(PERSON) + 4
    assert all(file.stat().st_size > 10_000 for file in files)


@pytest.mark.parametrize("name", ["anna", "ben"])
def test_joint_curves_are_of_whom_they_are_said_to_be(people: tuple[Lift, dict[str, Figure]], name: str) -> None:
    lift, figures = people
    agent = lift.dense[name]
    for joint, title, sign in (("Q2", "Trunk flexion", 1), ("Q7", "Elbow flexion", -1), ("Q10", "Wrist ulnar", 1)):
        column = agent.joint_names.index(f"{name}_{joint}")
        for what, values in (("angles", np.degrees(agent.q)), ("torques", agent.tau)):
            shown = _panel(figures[f"{name}_{what}"], title).lines[0].get_ydata()
            np.testing.assert_allclose(shown, sign * values[:, column], atol=1e-12)
    for what in PERSON:
        assert [text.get_text() for text in figures[f"{name}_{what}"].texts] == [name]


@pytest.mark.parametrize("name", ["anna", "ben"])
def test_ground_and_strength_are_each_persons_own(people: tuple[Lift, dict[str, Figure]], name: str) -> None:
    lift, figures = people
    agent = lift.dense[name]
    force = _panel(figures[f"{name}_ground_reaction"], f"Ground reaction force on {name}")
    np.testing.assert_allclose(force.lines[0].get_ydata(), agent.ground_force[:, 0], atol=1e-12)
    strength = _panel(figures[f"{name}_strength_used"], f"Strength used by each joint of {name}")
    peaks = [text.get_text() for text in strength.texts if text.get_text().endswith("%")]
    assert peaks == [f"{100 * use.peak:.0f} %" for use in ergonomics_of(lift.dense, agent).strength]
    score = _panel(figures[f"{name}_posture_score"], "RULA grand score")
    np.testing.assert_array_equal(score.lines[0].get_ydata(), ergonomics_of(lift.dense, agent).rula.grand)


def test_forces_and_shares_of_everybody(lift: Lift) -> None:
    (plot,) = (plot for plot in plots_of(lift) if plot.name == "grasp_forces")
    figure, agents = drawn(plot, lift), lift.dense.agents
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    for axes, title, agent in zip(figure.axes, titles, agents, strict=False):
        who = "the person" if agent.name == "human" else agent.name
        assert title.startswith(f"Force of {who} on the {lift.dense.object.name}")
        for i in range(3):
            np.testing.assert_allclose(axes.lines[i].get_ydata(), agent.load[:, i], atol=1e-12)
    share = _panel(figure, "Load share")
    for line, agent, part in zip(share.lines, agents, shares(agents), strict=False):
        assert line.get_label() == agent.name
        np.testing.assert_allclose(line.get_ydata(), 100 * part, atol=1e-9)


def test_snapshots_show_everybody(lift: Lift) -> None:
    """An arrow and a path a hand, in a color of its own, none of which hides another; the words tell whose they are."""
    (plot,) = (plot for plot in plots_of(lift) if plot.name == "snapshots")
    figure, agents = drawn(plot, lift), lift.dense.agents
    for axes in (figure.axes[0], figure.axes[-1]):
        arrows = [patch for patch in axes.patches if hasattr(patch, "get_arrowstyle")]
        assert len({tuple(arrow.get_edgecolor()) for arrow in arrows}) == len(agents)
        starts = np.array([arrow._posA_posB[0] for arrow in arrows])
        apart = np.linalg.norm(starts[:, None] - starts[None], axis=2) + 1e3 * np.eye(len(starts))
        assert apart.min() > 15.0  # pixels
        low, high = (np.array([*axes.get_xlim(), *axes.get_ylim()])[i] for i in ([0, 3], [1, 2]))
        for i in range(len(agents)):
            path = axes.lines[2 * i].get_xydata()
            assert np.all((low < path) & (path < high))
    words = figure.get_supxlabel()
    for agent in agents:
        assert f"by {'the person' if agent.name == 'human' else agent.name} (" in words
    assert "Lines: paths of the hands" in words


@pytest.mark.parametrize(
    ("changes", "opposite"),
    [({}, True), (TURNED, False), ({"robot.base.y": 0.3}, False), ({"robot.base.x": -1.5}, False)],
    ids=["default", "turned", "beside", "behind"],
)
def test_axes_are_told_by_person_and_robot_only_where_that_is_true(changes: dict[str, Any], opposite: bool) -> None:
    assert stand_opposite(load_scenario("table5", changes)) is opposite


def test_axes_of_other_teams_are_told_by_letters(two_people: Any, two_robots: Any) -> None:
    assert not stand_opposite(two_people.solution.scenario)
    assert not stand_opposite(two_robots.solution.scenario)
