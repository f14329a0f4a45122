"""Pictures of a lift: everybody is where the camera puts Pinocchio's joints, and wrong words are refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from matplotlib.image import imread

import liftopt as lo
from liftopt.errors import InputError
from liftopt.multibody.solids import solids_of
from liftopt.scenario.build import agents_of
from liftopt.viz.camera import in_perspective
from liftopt.viz.digits import distance_to_box
from liftopt.viz.person_bodies import FREE_ARM
from liftopt.viz.picture import MARGIN, PANEL, bodies_at, picture_of
from liftopt.viz.playback import playback_at
from liftopt.viz.scene import CONCRETE, SEE_THROUGH, Cast, parts_of
from liftopt.viz.viewer_views import views_of

CHEAP = ("solver.intervals=10", "solver.starts=1")
SMALL = (300, 270)
ARM = ("left upper arm", "left forearm", "left hand")


@pytest.fixture(scope="module")
def solution(solved: Callable[..., Any]) -> Any:
    return solved("table5", *CHEAP).solution


def test_bodies_are_at_their_joints(solution: Any) -> None:
    """The middle of each forearm, by its ends in the model, is inside what is drawn of it, at start and end."""
    cast = Cast(solution, playback_at(solution, solution.time[[0, -1]]), "/lift")
    parts = parts_of(cast)
    for k in (0, 1):
        named = {f"{p.body}/{p.name}": b.mesh.vertices for p, b in zip(parts, bodies_at(cast, parts, k), strict=True)}
        forearm = named["human_Q8/right_forearm"]
        # Table 2: Q8's origin is the wrist, Q7's the elbow.
        for joint in ("human_Q7", "human_Q8"):
            end = cast.playback.bodies[joint].position[k]
            assert np.linalg.norm(forearm - end, axis=1).min() < 0.06, joint
        table = named[f"{solution.object.name}/top"]
        np.testing.assert_allclose(table.mean(axis=0), cast.playback.bodies["table"].position[k], atol=1e-9)


@pytest.mark.parametrize("view", ["three-quarter", "side", "top"])
def test_the_shirt_is_blue_and_the_robot_red_where_they_stand(solution: Any, view: str) -> None:
    image = picture_of(solution, 0.0, view, SMALL).astype(int)
    assert image.shape == (*SMALL[::-1], 3)
    cast = Cast(solution, playback_at(solution, solution.time[:1]), "/lift")
    (chosen,) = (one for one in views_of([cast]) if one.name == view)
    # The view is that of the whole lift.
    whole = Cast(solution, playback_at(solution, np.linspace(0.0, solution.time[-1], 61)), "/lift")
    (chosen,) = (one for one in views_of([whole]) if one.name == view)
    low, high = np.array(chosen.box)
    camera = in_perspective(chosen.side, low - MARGIN, high + MARGIN, SMALL)
    shirt = image[..., 2] > 1.5 * image[..., 0]
    red = image[..., 0] > 2.0 * np.maximum(image[..., 1], image[..., 2])
    spots = {
        "human_Q3": (shirt, 25.0),
        "robot_Q2": (red, 25.0),
    }
    for joint, (colour, within) in spots.items():
        at = camera.project(cast.playback.bodies[joint].position[0])[:2]
        rows, columns = np.nonzero(colour)
        assert len(rows) > 80, joint
        assert np.hypot(columns - at[0], rows - at[1]).min() < within, joint


def test_three_moments_stand_side_by_side_and_differ(solution: Any) -> None:
    image = picture_of(solution, panel=SMALL)
    assert image.shape == (SMALL[1], 3 * SMALL[0], 3)
    first, second, third = np.split(image.astype(int), 3, axis=1)
    for one, other in ((first, second), (second, third)):
        assert np.mean(np.abs(one - other).max(axis=2) > 30) > 0.002


def test_obstacles_are_drawn_where_they_stand_and_see_through(solution: Any) -> None:
    pallet = {"name": "pallet", "box": [0.8, 0.6, 0.2], "position": [0.6, 0.1, 0.1], "yaw_deg": 90.0}
    scenario = lo.load_scenario("table5").replace({"obstacles": [pallet]})
    cast = Cast(replace(solution, scenario=scenario), playback_at(solution, solution.time[:1]), "/lift")
    (part,) = (part for part in parts_of(cast) if part.name == "obstacle_pallet")
    assert (part.body, part.colour, part.opacity) == ("ground", CONCRETE, SEE_THROUGH)
    np.testing.assert_allclose(part.mesh.vertices.min(axis=0), [0.3, -0.3, 0.0], atol=1e-9)
    np.testing.assert_allclose(part.mesh.vertices.max(axis=0), [0.9, 0.5, 0.2], atol=1e-9)


def test_an_obstacle_is_in_view_as_far_as_it_is_near(solution: Any) -> None:
    """A wall 10 m long beside the lift, of which half a metre around everybody is shown."""
    playback = playback_at(solution, solution.time[:1])
    bare, walled = (
        np.array(views_of([Cast(replace(solution, scenario=scenario), playback, "/lift")])[0].box)
        for scenario in (
            solution.scenario,
            solution.scenario.replace({"obstacles": [{"box": [10.0, 0.1, 2.0], "position": [0.0, 0.7, 1.0]}]}),
        )
    )
    np.testing.assert_allclose(walled[:, 0], bare[:, 0] + [-0.5, 0.5], atol=2e-3)
    assert walled[1, 1] == pytest.approx(0.75, abs=2e-3)


def test_a_picture_is_written_and_wrong_words_are_refused(solution: Any, tmp_path: Path) -> None:
    lift = lo.Solution.of(solution)
    lift.picture(tmp_path / "new" / "lift.png", time=1.0, view="side")
    assert imread(tmp_path / "new" / "lift.png").shape[:2] == PANEL[::-1]
    for words, arguments in (
        ("three-quarter, side, front, top, person, robot, hands", {"view": "sied"}),
        ("did you mean side", {"view": "sied"}),
        ("from 0 to 2 s", {"time": 2.5}),
        ("from 0 to 2 s", {"time": (0.0, float("nan"))}),
    ):
        with pytest.raises(InputError, match=words):
            lift.picture(tmp_path / "lift.png", **arguments)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"must end with one of \.png"):
        lift.picture(tmp_path / "lift.gif")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        lift.picture(tmp_path / "file" / "lift.png", time=0.0)


@pytest.mark.parametrize("k", [0, -1])
def test_what_is_drawn_of_a_person_is_where_the_models_shapes_are(solution: Any, k: int) -> None:
    """Pinocchio places the model's collision shapes: no part of the figure is far off them, and none is bare."""
    cast = Cast(solution, playback_at(solution, solution.time[[0, -1]]), "/lift")
    parts = parts_of(cast)
    (agent,) = (one for one in agents_of(solution.scenario, solution.urdfs) if one.kind == "person")
    model = agent.reduced()
    data = model.createData()
    # The first three of Table 2 are locked at zero.
    pin.forwardKinematics(model, data, solution["human"].q[k, 3:])
    solids = [solid for solid in solids_of(agent) if solid.name not in ARM]
    # The free arm is drawn hanging, and is a part of the trunk in the model.
    own = [part for part in parts if part.body.startswith("human") and not part.body.endswith(FREE_ARM)]
    figure = [body.mesh.vertices for body in bodies_at(cast, own, k)]
    off = [np.min([_off(solid, data, vertices) for solid in solids], axis=0) for vertices in figure]
    for part, far in zip(own, off, strict=True):
        assert far.max() < 0.075, (part.body, part.name, far.max())
    every = np.vstack(figure)
    for solid in solids:
        assert _off(solid, data, every).min() < 0.01, solid.name


def _off(solid: Any, data: Any, points: np.ndarray) -> np.ndarray:
    """Return how far points (n, 3) are from a solid, negative inside [m]."""
    placement = data.oMi[solid.joint].homogeneous @ solid.T_joint_solid
    own = (points - placement[:3, 3]) @ placement[:3, :3]
    if solid.kind == "box":
        return distance_to_box(own, np.array(solid.size) / 2)
    along = np.clip(own[:, 2], -solid.size[1] / 2, solid.size[1] / 2)
    return np.asarray(np.hypot(np.hypot(own[:, 0], own[:, 1]), own[:, 2] - along) - solid.size[0])
