"""A person with legs in pictures: parts ride on Pinocchio's joints, bend without a gap, and two hands hold (coal)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial import cKDTree

from liftopt.ergonomics.lift import subject_in
from liftopt.multibody.person.anthropometry import link_lengths
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.poses import joint_placements
from liftopt.multibody.solids import solids_of
from liftopt.scenario.build import agents_of
from liftopt.types import Array
from liftopt.viz.digits import distance_to_box
from liftopt.viz.person_bodies import PersonBodies, bodies_between, half_way
from liftopt.viz.picture import bodies_at, picture_of
from liftopt.viz.playback import playback_at
from liftopt.viz.scene import Cast, parts_of
from liftopt.viz.scene_hand import FINGERS, LEFT, PALM, RIGHT, hand_digits
from liftopt.viz.scene_mesh import Mesh
from liftopt.viz.scene_person import person_parts
from liftopt.viz.viewer_views import views_of

SUBJECT = Subject(1.75, 75.0, "male")


@pytest.fixture(scope="module")
def squat(team_solution: Callable[[str], Any]) -> Any:
    return team_solution("squat").solution


@pytest.fixture(scope="module")
def cast(squat: Any) -> Cast:
    return Cast(squat, playback_at(squat, squat.time[[0, -1]]), "/lift")


def _posed(**degrees: float) -> dict[str, Mesh]:
    """Return the mesh of each part by its name, of a person whose joints are at these angles [deg]."""
    agent = whole_human_agent(SUBJECT)
    names = list(agent.model.names)[1:]
    q = np.radians([degrees.get(name.removeprefix("human_"), 0.0) for name in names])
    bodies = PersonBodies.of(SimpleNamespace(name="human", joint_names=tuple(names), grasps=()))  # type: ignore[arg-type]
    found = joint_placements(agent.model, np.stack([np.zeros(len(q)), q]), range(1, len(names) + 1))
    zero, posed = ({name: found[k, n] for n, name in enumerate(names)} for k in (0, 1))
    carried = {name: posed[name] @ np.linalg.inv(zero[name]) for name in names} | {bodies.feet: np.eye(4)}
    for name, between in bodies_between(bodies, SUBJECT).items():
        (at,) = half_way(between, zero, {joint: place[None] for joint, place in posed.items()})
        carried[name] = at @ np.linalg.inv(between.T_base_joint)
    return {part.name: part.mesh.seen_from(carried[part.body]) for part in person_parts(bodies, SUBJECT)}


def _covered(points: Array, meshes: list[Mesh]) -> Array:
    """Return which points (n, 3) are inside a closed mesh: the solid angle of what is around one is 4 pi."""
    inside = np.zeros(len(points), dtype=bool)
    for mesh in meshes:
        a, b, c = (mesh.vertices[mesh.triangles[:, i]] - points[:, None] for i in range(3))
        x, y, z = (np.linalg.norm(side, axis=-1) for side in (a, b, c))
        triple = np.einsum("ptj,ptj->pt", a, np.cross(b, c))
        dots = x * y * z + sum(
            np.einsum("ptj,ptj->pt", one, other) * size for one, other, size in ((a, b, z), (b, c, x), (c, a, y))
        )
        inside |= np.abs(2.0 * np.arctan2(triple, dots).sum(axis=1)) > 2.0 * np.pi
    return inside


@pytest.mark.parametrize("flexion", [0.0, 60.0, 120.0])
def test_a_leg_bends_without_a_gap(flexion: float) -> None:
    """All around Pinocchio's axis of the knee there is cloth, from the front of the thigh to that of the shank."""
    agent = whole_human_agent(SUBJECT)
    data, q = agent.model.createData(), np.zeros(agent.model.nq)
    q[1] = np.radians(flexion)
    pin.forwardKinematics(agent.model, data, q)
    knee = data.oMi[agent.model.getJointId("human_knee")].translation
    parts = _posed(knee=flexion)
    aside = parts["right_knee"].vertices[:, 1].mean()
    turns = np.radians(np.arange(0.0, 360.0, 15.0))
    around = knee + 0.045 * np.column_stack([np.cos(turns), 0.0 * turns, np.sin(turns)]) + [0.0, aside, 0.0]
    assert _covered(around, [parts[name] for name in ("right_thigh", "right_knee", "right_shank")]).all()


@pytest.mark.parametrize("flexion", [0.0, 60.0, 110.0])
def test_a_hip_bends_without_a_gap(flexion: float) -> None:
    agent = whole_human_agent(SUBJECT)
    height = joint_placements(agent.model, np.zeros((1, 20)), [3])[0, 0, 2, 3]  # the thighs are upright
    parts = _posed(hip=flexion)
    turns = np.radians(np.arange(0.0, 360.0, 15.0))
    around = np.column_stack([0.09 * np.cos(turns), 0.0 * turns, height + 0.09 * np.sin(turns)])
    assert _covered(around, [parts[name] for name in ("pelvis", "seat", "right_thigh", "left_thigh")]).all()


@pytest.mark.parametrize("flexion", [0.0, 40.0, 80.0])
def test_the_shirt_ends_where_the_trousers_are_however_far_the_trunk_bends(flexion: float) -> None:
    """The hem rests on the hips: as far from them as upright, to a nanometre; no gap opens behind above it."""
    upright, bent = _posed(), _posed(Q2=flexion)
    gap, before = (cKDTree(pose["pelvis"].vertices).query(pose["hem"].vertices)[0] for pose in (bent, upright))
    np.testing.assert_allclose(gap, before, atol=1e-9)
    turns = np.radians(np.arange(0.0, flexion + 1.0, 5.0))
    radius = 0.94 * np.abs(upright["waist"].vertices[:, 0]).max()
    back = np.column_stack([-radius * np.cos(turns), 0.0 * turns, link_lengths(SUBJECT).l1 + radius * np.sin(turns)])
    assert _covered(back, [bent[name] for name in ("hem", "waist", "trunk")]).all()


@pytest.mark.parametrize("k", [0, -1])
def test_what_is_drawn_of_a_person_with_legs_is_where_the_models_shapes_are(squat: Any, cast: Cast, k: int) -> None:
    """Pinocchio places the model's collision shapes: no part of the figure is far off them, and none is bare."""
    (agent,) = agents_of(squat.scenario, squat.urdfs)
    data = agent.model.createData()
    pin.forwardKinematics(agent.model, data, squat["human"].q[k])
    parts, solids = [part for part in parts_of(cast) if part.body.startswith("human")], solids_of(agent)
    figure = [body.mesh.vertices for body in bodies_at(cast, parts, k)]
    for part, vertices in zip(parts, figure, strict=True):
        off = np.min([_off(solid, data, vertices) for solid in solids], axis=0)
        assert off.max() < 0.085, (part.name, off.max())
    every = np.vstack(figure)
    for solid in solids:
        assert _off(solid, data, every).min() < 0.015, solid.name


def _off(solid: Any, data: Any, points: Array) -> Array:
    """Return how far points (n, 3) are from a solid, negative inside [m]."""
    placement = data.oMi[solid.joint].homogeneous @ solid.T_joint_solid
    own = (points - placement[:3, 3]) @ placement[:3, :3]
    if solid.kind == "box":
        return distance_to_box(own, np.array(solid.size) / 2)
    along = np.clip(own[:, 2], -solid.size[1] / 2, solid.size[1] / 2)
    return np.asarray(np.hypot(np.hypot(own[:, 0], own[:, 1]), own[:, 2] - along) - solid.size[0])


def test_both_palms_are_at_their_grasps_and_mirror_each_other(squat: Any) -> None:
    """The motion is alike on both sides, so the left hand is the right one's image in the median plane."""
    person = squat["human"]
    q = np.tile(np.concatenate([person.q[-1][:6], *([person.q[-1][6:13]] * 2)]), (len(person.q), 1))
    q[:, [3, 5]] = 0.0  # neither bent nor turned to a side
    alike = replace(squat, agents=(replace(person, q=q, v=0.0 * q, a=0.0 * q),))
    playback = playback_at(alike, alike.time[[0, -1]])
    reach = link_lengths(subject_in(squat, "human")).l6
    palms = {}
    for hand in ("right", "left"):
        track = playback.bodies[f"human_{hand}_palm"]
        turn = pin.Quaternion(track.quaternion[0]).toRotationMatrix()
        knuckles = track.position[0] + reach * turn[:, 0]
        assert np.linalg.norm(knuckles - playback.forces[f"human_{hand}"].point[0]) < PALM + 1e-3
        palms[hand] = np.vstack([np.column_stack([turn, track.position[0]]), [0.0, 0.0, 0.0, 1.0]])
    image = np.diag([1.0, -1.0, 1.0, 1.0]) @ palms["right"] @ np.diag([1.0, -1.0, 1.0, 1.0])
    np.testing.assert_allclose(palms["left"], image, atol=5e-3)  # the box stands still and is not at the hands


@pytest.mark.parametrize("flat", [False, True])
def test_a_left_hand_is_the_mirror_image_of_a_right_one(flat: bool) -> None:
    for right, left in zip(*(hand_digits(SUBJECT, side, flat=flat) for side in (RIGHT, LEFT)), strict=True):
        angles = np.radians([[20.0, 30.0, 10.0]])
        np.testing.assert_allclose(left.points(angles), right.points(angles) * [1.0, -1.0, 1.0], atol=1e-12)


def test_a_hand_that_holds_nothing_rests_on_its_own_arm(team_solution: Callable[[str], Any]) -> None:
    lift = team_solution("two_whole").solution
    cast = Cast(lift, playback_at(lift, lift.time[[0, -1]]), "/lift")
    bodies = {part.name: part.body for part in parts_of(cast) if part.body.startswith("anna")}
    assert bodies["left_hand"] == "anna_left_Q10"
    assert "anna_right_palm" in bodies.values()
    assert not any(body.startswith("anna_left_palm") for body in bodies.values())
    assert {part.body for part in parts_of(cast)} - {"ground"} <= set(cast.playback.bodies)
    feet = cast.playback.bodies["anna_feet"].position
    np.testing.assert_array_equal(feet[0], feet[-1])


def test_a_person_with_legs_is_in_the_picture(squat: Any) -> None:
    """Trousers, shirt and two arrows are where they are; in the squat the head is below where it ends."""
    first, last = (picture_of(squat, t, "side", (240, 240)).astype(int) for t in (0.0, 2.0))
    tops = []
    for image in (first, last):
        shirt = image[..., 2] > 1.6 * image[..., 0]
        assert shirt.sum() > 150
        tops.append(np.nonzero(shirt)[0].min())
    assert tops[0] > tops[1] + 40


def test_a_handle_is_a_slot_where_the_fingers_reach_in(team_solution: Callable[[str], Any]) -> None:
    """Ben, who looks along -X, holds a handle on his right: on the side towards +Y, 5 cm below the top."""
    lift = team_solution("two_whole").solution
    playback = playback_at(lift, lift.time[[0, -1]])
    (slot,) = (part for part in parts_of(Cast(lift, playback, "/lift")) if "handle" in part.name)
    box = lift.scenario.object
    assert (slot.name, slot.body) == ("handle_ben_right", box.name)
    low, high = slot.mesh.vertices.min(axis=0), slot.mesh.vertices.max(axis=0)
    assert low[1] < box.width / 2 < high[1] < box.width / 2 + 0.005
    assert low[2] < box.height / 2 - 0.05 < high[2]
    middle = playback.bodies[box.name].position[0]
    # Fingers curl into the box through it: the ends of the last bones begin inside.
    tips = [playback.bodies[f"ben_right_{finger}_3"].position[0] - middle for finger in FINGERS]
    assert np.all(np.array(tips)[:, 1] < box.width / 2)


def test_the_whole_lift_is_in_view_with_its_object(squat: Any, cast: Cast) -> None:
    """Corners of the box at both ends, by the scenario; and all of the figure that squats, to a centimetre."""
    playback = playback_at(squat, squat.time[[0, -1]])
    low, high = np.array(views_of([Cast(squat, playback, "/lift")])[0].box)
    box = squat.scenario.object
    for pose in squat.object.pose[[0, -1]]:
        half = np.array([box.depth, box.width, box.height]) / 2
        assert np.all(low <= pose[:3] - half + 1e-3) and np.all(pose[:3] + half - 1e-3 <= high)
    figure = [part for part in parts_of(cast) if part.body.startswith("human")]
    for body in bodies_at(cast, figure, 0):
        assert np.all(body.mesh.vertices > low - 0.01)
        assert np.all(body.mesh.vertices < high + 0.01)
