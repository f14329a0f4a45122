"""Gaps, filter, rigid bodies and the subject's bodies: against functions and motions that are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from liftopt.errors import InputError
from liftopt.lab.mocap.filtering import low_pass
from liftopt.lab.mocap.gaps import fill_gaps
from liftopt.lab.mocap.recording import Recording
from liftopt.lab.mocap.rigid import common_point, fit_poses, mean_shape
from liftopt.lab.mocap.scaling import ScaledSubject, measured_chain
from liftopt.multibody.dh import DHChain
from liftopt.multibody.person.anthropometry import LinkLengths, link_lengths
from liftopt.multibody.person.human import human_chain, human_root
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.urdf import FixedLink, JointBounds, chain_robot, load_model, urdf_text

RATE = 100.0
SHAPE = np.array([[0.1, 0.0, 0.0], [-0.1, 0.05, 0.0], [0.0, -0.1, 0.02], [0.0, 0.02, 0.12]])


def _moving(frames: int = 150, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return smooth rotations (F, 3, 3) and translations (F, 3)."""
    rng, phase = np.random.default_rng(seed), np.arange(frames)[:, None] / frames
    waves = np.sin(2 * np.pi * phase + rng.uniform(0, 6, 6)) * rng.uniform(0.3, 0.8, 6)
    return Rotation.from_rotvec(waves[:, :3]).as_matrix(), waves[:, 3:]


def _world(rotation: np.ndarray, translation: np.ndarray, shape: np.ndarray = SHAPE) -> np.ndarray:
    return np.einsum("fij,mj->fmi", rotation, shape) + translation[:, None]


def test_poses_and_shape_of_a_rigid_body() -> None:
    rotation, translation = _moving()
    points = _world(rotation, translation)
    poses = fit_poses(SHAPE, points)
    np.testing.assert_allclose(poses.rotation, rotation, atol=1e-12)
    np.testing.assert_allclose(poses.translation, translation, atol=1e-12)
    points[::2, 0], points[5:20, 3] = np.nan, np.nan
    points[40, :2] = np.nan  # two are left
    poses = fit_poses(SHAPE, points)
    known = np.isfinite(points).all(axis=2).sum(axis=1) >= 3
    assert not known[40]
    np.testing.assert_allclose(poses.rotation[known], rotation[known], atol=1e-12)
    assert np.isnan(poses.translation[~known]).all()
    shape = mean_shape(points)
    np.testing.assert_allclose(
        np.linalg.norm(shape - shape[0], axis=1), np.linalg.norm(SHAPE - SHAPE[0], axis=1), atol=1e-9
    )
    assert np.linalg.det(fit_poses(shape, points).rotation[0]) == pytest.approx(1.0)  # no mirror image


def test_markers_on_a_line_make_no_pose() -> None:
    line = np.outer([-1.0, 0.0, 1.0, 2.0], [0.1, 0.0, 0.0])
    assert np.isnan(fit_poses(line, _world(*_moving(), line)).translation).all()


def test_the_centre_of_rotation_of_two_bodies() -> None:
    """A ball joint at a place known in both."""
    rotation, translation = _moving()
    turn, _ = _moving(seed=1)
    first, second = np.array([0.1, -0.2, 0.3]), np.array([0.0, 0.05, 0.25])
    other = rotation @ turn
    carried = _world(rotation, translation, first[None])[:, 0] - other @ second
    point = common_point(fit_poses(SHAPE, _world(rotation, translation)), fit_poses(SHAPE, _world(other, carried)))
    np.testing.assert_allclose(point.first, first, atol=1e-9)
    np.testing.assert_allclose(point.second, second, atol=1e-9)
    assert point.motion > 0.1
    fixed = common_point(
        fit_poses(SHAPE, _world(rotation, translation)), fit_poses(SHAPE, _world(rotation, translation))
    )
    assert fixed.motion < 1e-6


def test_a_short_gap_is_closed_by_a_spline_and_a_long_one_from_the_segment() -> None:
    rotation, translation = _moving()
    truth = _world(rotation, translation)
    seen = truth.copy()
    seen[30:38, 0] = np.nan
    seen[60:100, 1] = np.nan
    seen[:15, 2] = np.nan  # at the start: there is only one end
    seen[110:125, 3], seen[112:120, 0] = np.nan, np.nan  # beside a short gap of another marker
    labels = ("A", "B", "C", "D")
    filled, gaps = fill_gaps(Recording("test", RATE, np.arange(150) / RATE, labels, seen), {"body": labels})
    assert [(g.marker, g.first, g.last, g.filled) for g in gaps] == [
        ("A", 30, 37, "spline"), ("A", 112, 119, "spline"), ("B", 60, 99, "segment"), ("C", 0, 14, "segment"),
        ("D", 110, 124, "segment"),
    ]  # fmt: skip
    assert np.abs(filled.points - truth).max() < 1e-4
    alone, gaps = fill_gaps(Recording("test", RATE, np.arange(150) / RATE, labels, seen), {})
    assert {g.filled for g in gaps} == {"spline", "open"}
    assert np.isnan(alone.points[60:100, 1]).all()


@pytest.mark.parametrize("rate", [60.0, 100.0, 200.0])
def test_noise_beside_a_gap_is_not_drawn_out_into_it(rate: float) -> None:
    """0.5 mm of noise; the curve in a gap of 0.1 s is known. One through the noisy frames is off by up to 30 mm."""
    time = np.arange(round(2 * rate)) / rate
    truth = 0.3 * np.stack([np.sin(2 * time), np.cos(3 * time), np.sin(4 * time + 1.0)], axis=1)[:, None]
    worst = []
    for seed in range(20):
        points = truth + np.random.default_rng(seed).normal(0.0, 0.0005, truth.shape)
        gap = slice(first := round(rate) - 3 + seed % 7, first + int(0.1 * rate))
        points[gap] = np.nan
        filled, _ = fill_gaps(Recording("test", rate, time, ("A",), points), {})
        worst.append(np.linalg.norm(filled.points[gap] - truth[gap], axis=2).max())
    assert max(worst) < 0.004


@pytest.mark.parametrize("filters", [1, 2])
def test_the_filter_has_no_lag_and_the_cutoff_asked_for(filters: int) -> None:
    """Sines: 1 / sqrt 2 at the cut-off after all passes, unchanged far below, gone far above; the phase stays."""
    time = np.arange(1000) / RATE
    for frequency, gain in ((6.0, np.sqrt(0.5)), (0.5, 1.0), (30.0, 0.0)):
        wave = np.sin(2 * np.pi * frequency * time)
        out = wave
        for _ in range(filters):
            out = low_pass(out[:, None], RATE, 6.0, filters)[:, 0]
        inside = slice(200, 800)
        assert np.abs(out - gain * wave)[inside].max() < 2e-3, frequency


def test_the_filter_works_between_gaps_and_leaves_short_stretches() -> None:
    values = np.random.default_rng(0).normal(size=(100, 2))
    values[40:50, 0], values[55, 0] = np.nan, np.nan
    out = low_pass(values, RATE, 6.0)
    np.testing.assert_array_equal(np.isnan(out), np.isnan(values))
    np.testing.assert_array_equal(out[50:55, 0], values[50:55, 0])
    np.testing.assert_allclose(out[:40, 0], low_pass(values[:40, :1], RATE, 6.0)[:, 0])
    for cutoff in (0.0, 50.0, float("nan")):
        with pytest.raises(InputError, match="below half the rate"):
            low_pass(values, RATE, cutoff)


def test_measured_lengths_keep_masses_and_the_shares_of_the_centres_of_mass() -> None:
    subject = Subject(1.7, 65.0, "female")
    standard = link_lengths(subject)
    same = measured_chain(_scaled(subject, standard))
    for new, old in zip(same.inertias, human_chain(subject).inertias, strict=True):
        np.testing.assert_allclose(new.com, old.com, atol=1e-15)
        np.testing.assert_allclose(new.inertia, old.inertia, atol=1e-15)
    other = replace(standard, l2=standard.l2 + 0.05, l3=standard.l3 - 0.02, l4=1.1 * standard.l4, l5=0.9 * standard.l5)
    before, after = _model(human_chain(subject)), _model(measured_chain(_scaled(subject, other)))
    assert pin.computeTotalMass(after) == pytest.approx(65.0)
    shares = []
    for model, lengths in ((before, standard), (after, other)):
        data = model.createData()
        pin.forwardKinematics(model, data, np.zeros(13))
        com = {n: data.oMi[i].act(model.inertias[i].lever) for i, n in enumerate(model.names)}
        shoulder = np.array([0.0, -lengths.l3, lengths.l1 + lengths.l2])
        elbow = shoulder - [0.0, 0.0, lengths.l4]
        shares.append(
            [*com["human_Q3"], (shoulder - com["human_Q6"])[2] / lengths.l4, (elbow - com["human_Q8"])[2] / lengths.l5]
        )
    np.testing.assert_allclose(shares[1], shares[0], atol=1e-9)


def _scaled(subject: Subject, lengths: LinkLengths) -> ScaledSubject:
    return ScaledSubject(subject, lengths, {}, False, np.zeros(3))


def _model(chain: DHChain) -> pin.Model:
    bounds = {row.name: JointBounds(-4.0, 4.0, 1e5, 10.0) for row in chain.rows}
    root = FixedLink("human_base", "world", human_root())
    return load_model(urdf_text(chain_robot(chain, root=root, bounds=bounds, shapes={}, grasp="human_grasp")))
