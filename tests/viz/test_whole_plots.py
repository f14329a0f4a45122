"""Plots and report of people with legs and two hands: each curve against the trajectory it shows, words against it."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import unescape
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from liftopt.ergonomics.measures import ergonomics_of
from liftopt.multibody.joint_curves import anatomy_of, human_curves
from liftopt.multibody.person.whole_joints import WHOLE_RANGES
from liftopt.viz.plots import drawn, plots_of
from liftopt.viz.plots_data import Lift
from liftopt.viz.report import report_html

pytestmark = pytest.mark.long
PARTS = {"legs": 3, "trunk": 3, "right arm": 7, "left arm": 7}


@pytest.fixture(scope="module")
def lift(team_solution: Callable[[str], Any]) -> Lift:
    return Lift.of(team_solution("squat").solution)


@pytest.fixture(scope="module")
def figures(lift: Lift) -> dict[str, Figure]:
    return {plot.name: drawn(plot, lift) for plot in plots_of(lift)}


@pytest.fixture(scope="module")
def pages(team_solution: Callable[[str], Any], figures: dict[str, Figure]) -> dict[str, str]:
    """Return reports by the team's name, without the playback and the drawings inside them.

    All figures are drawn, and none is written: matplotlib takes as long for that.
    """
    found = {}
    for name in ("squat", "two_whole"):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("liftopt.viz.report_figures.rendered", lambda *_: b'<svg viewBox="0 0 1 1"></svg>')
            if name == "squat":  # its figures are at hand
                patch.setattr("liftopt.viz.report_figures.drawn", lambda plot, _: figures[plot.name])
            page = re.sub(r'srcdoc="[^"]*"', "", report_html(team_solution(name).solution))
        found[name] = re.sub(r"<svg.*?</svg>", "<svg></svg>", page, flags=re.DOTALL)
    return found


def _panel(figure: Figure, title: str) -> Any:
    (axes,) = (axes for axes in figure.axes if axes.get_title(loc="left").startswith(title))
    return axes


def _words(page: str) -> str:
    return " ".join(unescape(re.sub(r"<[^>]*>", " ", page)).split())


def test_anatomical_names_and_signs_are_those_of_the_ranges_of_motion(lift: Lift) -> None:
    (person,) = lift.dense.agents
    for joint, item in zip(anatomy_of(person), WHOLE_RANGES, strict=True):
        positive = item.positive if joint.sign > 0 else item.negative
        assert joint.joint == item.joint
        assert positive.split()[-1] in joint.motion
        side = item.joint.partition("_")[0]
        assert joint.motion.startswith(side) == (not side.startswith("Q"))
    parts = [joint.part for joint in anatomy_of(person)]
    assert {part: parts.count(part) for part in parts} == PARTS
    labels = [curve.label for curve in human_curves(person)]
    assert labels[1] == "Knee flexion"
    assert labels[-4] == "Left elbow flexion (\N{MINUS SIGN}Q7)"


@pytest.mark.parametrize("what", ["angles", "torques"])
def test_all_twenty_joints_are_drawn_the_left_arm_beside_the_right(
    figures: dict[str, Figure], lift: Lift, what: str
) -> None:
    (person,) = lift.dense.agents
    figure = figures[f"human_{what}"]
    for curve in human_curves(person):
        shown = _panel(figure, curve.label).lines[0].get_ydata()
        column = person.joint_names.index(f"human_{curve.joint}")
        sign = -1.0 if "\N{MINUS SIGN}" in curve.label else 1.0
        values = np.degrees(person.q) if what == "angles" else person.tau
        np.testing.assert_allclose(shown, sign * values[:, column], atol=1e-12)
    right, left = (_panel(figure, f"{side} elbow flexion").get_position() for side in ("Right", "Left"))
    assert right.y0 == pytest.approx(left.y0)
    assert right.x1 < left.x0
    assert [axes.get_title(loc="left") for axes in figure.axes[:3]] == [
        "Ankle dorsiflexion", "Trunk bend to the right (Q1)", "Knee flexion",
    ]  # fmt: skip


def test_both_arms_have_their_shoulder_and_elbow(figures: dict[str, Figure], lift: Lift) -> None:
    (person,) = lift.dense.agents
    for side in ("Right", "Left"):
        elbow = _panel(figures["human_arm"], f"{side} elbow flexion (\N{MINUS SIGN}Q7): angle").lines[0].get_ydata()
        column = person.joint_names.index(f"human_{side.lower()}_Q7")
        np.testing.assert_allclose(elbow, -np.degrees(person.q[:, column]), atol=1e-12)


def test_the_centre_of_pressure_is_where_the_ground_has_no_moment_about_level_axes(
    figures: dict[str, Figure], lift: Lift
) -> None:
    """Closed form: from the feet's origin it is -My / Fz ahead and Mx / Fz to the left."""
    (person,) = lift.dense.agents
    force, moment = person.ground_force, person.ground_moment
    ahead, left = -moment[:, 1] / force[:, 2], moment[:, 0] / force[:, 2]
    figure = figures["centre_of_pressure"]
    path, start, end = _panel(figure, "Centre of pressure").lines[:3]
    np.testing.assert_allclose(path.get_xdata(), -100.0 * left, atol=1e-9)
    np.testing.assert_allclose(path.get_ydata(), 100.0 * ahead, atol=1e-9)
    assert (start.get_ydata()[0], end.get_ydata()[0]) == (path.get_ydata()[0], path.get_ydata()[-1])
    assert person.stance is not None
    back, front, aside = person.stance.support
    expected = np.min([ahead - back, front - ahead, aside - np.abs(left)], axis=0)
    np.testing.assert_allclose(_panel(figure, "Margin of the person").lines[0].get_ydata(), 100 * expected, atol=1e-9)


def test_each_hand_has_its_force_and_its_part_of_the_load(figures: dict[str, Figure], lift: Lift) -> None:
    (person,) = lift.dense.agents
    figure = figures["grasp_forces"]
    for own, hand in enumerate(("right", "left")):
        panel = _panel(figure, f"Force of the {hand} hand of the person on the box")
        for i in range(3):
            np.testing.assert_allclose(panel.lines[i].get_ydata(), person.grasp_force[:, own, i], atol=1e-12)
    share = _panel(figure, "Load share")
    parts = [share.lines[own].get_ydata() for own in (0, 1)]
    np.testing.assert_allclose(parts[0] + parts[1], 100.0, atol=1e-9)
    np.testing.assert_allclose(parts[0], 100 * person.grasp_force[:, 0, 2] / person.load[:, 2], atol=1e-9)
    assert [line.get_label() for line in share.lines[:2]] == ["human_right", "human_left"]


def test_strength_is_told_by_the_joint_it_is_of(figures: dict[str, Figure], lift: Lift) -> None:
    (person,) = lift.dense.agents
    axes = _panel(figures["strength_used"], "Strength used")
    names = [label.get_text() for label in axes.get_yticklabels()]
    peaks = [text.get_text() for text in axes.texts if text.get_text().endswith("%")]
    uses = {use.joint: use.peak for use in ergonomics_of(lift.dense, person).strength}
    assert dict(zip(names, peaks, strict=True))["Hip flexion"] == f"{100 * uses['hip']:.0f} %"
    assert names[13] == "Left shoulder abduction (\N{MINUS SIGN}Q4)"


def test_one_who_does_not_stand_on_soles_has_no_centre_of_pressure(people: Any) -> None:
    assert not any("pressure" in plot.name for plot in plots_of(Lift.of(people)))


def test_the_snapshots_have_a_path_for_each_hand(figures: dict[str, Figure]) -> None:
    figure = figures["snapshots"]
    arrows = [patch for patch in figure.axes[0].patches if hasattr(patch, "get_arrowstyle")]
    assert len(arrows) == 2
    assert "Lines: paths of the hands" in figure.get_supxlabel()


def test_the_report_tells_of_legs_and_both_hands(pages: dict[str, str]) -> None:
    page, text = pages["squat"], _words(pages["squat"])
    assert re.findall(r'<tr class="part"><th colspan="6">([^<]*)</th>', page) == [
        "Legs", "Trunk", "Right arm", "Left arm",
    ]  # fmt: skip
    assert (
        "lifts a box of 8 kg from 0.25 to 0.9 m (height of the edges they hold) in 2 s: the person with both hands"
        in text
    )
    assert "The person is a tree of 20 joints on feet that stay on the floor" in text
    assert "The box is one rigid body, held at 2 points" in text
    assert "person, right hand" in text and "person, left hand" in text
    assert 'id="plot-centre_of_pressure"' in page
    ids = re.findall(r'\bid="([^"]*)"', page)
    assert len(ids) == len(set(ids))


def test_the_report_of_two_says_who_holds_with_which_hand(pages: dict[str, str]) -> None:
    page, text = pages["two_whole"], _words(pages["two_whole"])
    assert "anna with the right hand, ben with both hands" in text
    assert "Each person is a tree of 20 joints" in text
    assert "held at 3 points" in text
    for name in ("anna", "ben"):
        assert f'id="plot-{name}_centre_of_pressure"' in page
    assert page.count('<tr class="part">') == 8
