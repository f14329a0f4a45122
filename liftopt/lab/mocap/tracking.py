"""Inverse kinematics over a whole record: the joint angles that bring the model's markers nearest to the measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from liftopt.types import Array

# Levenberg-Marquardt: damping in m^2/rad^2. The least one keeps directions that no marker determines (a singular
# shoulder) where they were; of the others it takes less than a thousandth off a step.
DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e-6, 1e6
CONVERGED = 1e-6  # rad or m, largest component of a step
# lever (3,) @ TURNS is the (3, 3) matrix, row by row, that maps omega to omega x lever.
TURNS: Array = np.array(
    [[0, 0, 0, 0, 0, 1, 0, -1, 0], [0, 0, -1, 0, 0, 0, 1, 0, 0], [0, 1, 0, -1, 0, 0, 0, 0, 0]], dtype=float
)
ITERATIONS, FIRST_ITERATIONS = 50, 300
FIRST_ROUNDS = 20


@dataclass(frozen=True)
class TrackedMarker:
    """One marker on the model.

    Attributes:
        label: its name.
        joint: index of the joint of the model that moves it.
        local: (3,) place in that joint's frame [m].
    """

    label: str
    joint: int
    local: Array


@dataclass(frozen=True)
class TrackedMotion:
    """Joint positions over F frames.

    Attributes:
        q: (F, nq) [rad or m].
        residual: (F, M) distance of each measured marker from the model's, NaN where it was not seen [m].
        at_limit: (F, nq) True where a joint stands at a limit of its range.
    """

    q: Array
    residual: Array
    at_limit: npt.NDArray[np.bool_]


def track(
    model: pin.Model,
    markers: Sequence[TrackedMarker],
    targets: Array,
    *,
    lower: Array,
    upper: Array,
    start: Array,
    ease: tuple[Array, Array] | None = None,
) -> TrackedMotion:
    """Return the joint positions within their limits that minimise the sum of squared marker distances, frame by frame.

    Every frame starts from the one before, the first one from ``start``. Each step is a Levenberg-Marquardt step on the
    markers' Jacobians in which joints that a limit holds do not take part. A frame in which no marker was seen keeps
    the position before it.

    Args:
        model: with one-dimensional joints only.
        markers: on the model.
        targets: (F, M, 3) where they were seen in the world [m], NaN where not.
        lower: (nq,) lower limits; one that equals the upper limit holds its joint.
        upper: (nq,) upper limits.
        start: (nq,) first guess.
        ease: weights (nq,) of squared steps from where the frames before lead, beside the squared distances
            [m^2/rad^2], and (nq,) how far from zero a joint is left in peace: what goes beyond is drawn back [rad].
            None for none. Far below what markers weigh, this decides what these do not: a shoulder with the arm ahead
            can be bent over or turned round.
    """
    q = np.clip(start, lower, upper)
    before = q
    count, data = len(targets), model.createData()
    positions, residual = np.zeros((count, model.nq)), np.full(targets.shape[:2], np.nan)
    for frame in range(count):
        seen = np.isfinite(targets[frame]).all(axis=1)
        if seen.any():
            there = [marker for marker, shown in zip(markers, seen, strict=True) if shown]
            cluster = _Markers.of(model, data, there)
            most = ITERATIONS if frame else FIRST_ITERATIONS
            if ease is None:
                q = _solve(cluster, targets[frame, seen], lower, upper, q, most)
            else:
                # The first guess is no frame before: what it holds is let go in rounds.
                for _ in range(1 if frame else FIRST_ROUNDS):
                    eased = replace(cluster, ease=(np.sqrt(ease[0]), np.clip(2.0 * q - before, -ease[1], ease[1])))
                    last, q = q, _solve(eased, targets[frame, seen], lower, upper, q, most)
                    before = last if frame else q
            residual[frame, seen] = np.linalg.norm(cluster.places(q) - targets[frame, seen], axis=1)
        positions[frame] = q
    at_limit = ((positions <= lower + 1e-9) | (positions >= upper - 1e-9)) & (lower < upper)
    return TrackedMotion(positions, residual, at_limit)


@dataclass(frozen=True)
class _Markers:
    """Markers gathered by the joint that moves them; ``rows`` are their numbers."""

    model: pin.Model
    data: pin.Data
    count: int
    by_joint: tuple[tuple[int, npt.NDArray[np.int_], Array], ...]
    ease: tuple[Array, Array] | None = None  # roots of the weights, and the angles towards which

    @staticmethod
    def of(model: pin.Model, data: pin.Data, markers: Sequence[TrackedMarker]) -> _Markers:
        joints = np.array([marker.joint for marker in markers])
        local = np.array([marker.local for marker in markers])
        groups = [(int(joint), np.flatnonzero(joints == joint)) for joint in np.unique(joints)]
        by_joint = tuple((joint, rows, local[rows]) for joint, rows in groups)
        return _Markers(model, data, len(markers), by_joint)

    def error(self, q: Array, targets: Array) -> Array:
        """Return (3 M,) how far they are from where they should be, then (nq,) what angles cost if they do."""
        away = (self.places(q) - targets).ravel()
        return away if self.ease is None else np.concatenate([away, self.ease[0] * (q - self.ease[1])])

    def slopes(self, q: Array) -> Array:
        """Return the derivative of ``error``."""
        jacobian = self.jacobian(q)
        return jacobian if self.ease is None else np.concatenate([jacobian, np.diag(self.ease[0])])

    def places(self, q: Array) -> Array:
        """Return (M, 3) where they are in the world [m]."""
        pin.forwardKinematics(self.model, self.data, q)
        world = np.empty((self.count, 3))
        for joint, rows, local in self.by_joint:
            placement = self.data.oMi[joint]
            world[rows] = local @ placement.rotation.T + placement.translation
        return world

    def jacobian(self, q: Array) -> Array:
        """Return (3 M, nv) of their places."""
        slopes = np.empty((self.count, 3, self.model.nv))
        pin.computeJointJacobians(self.model, self.data, q)
        for joint, rows, local in self.by_joint:
            world = pin.getJointJacobian(self.model, self.data, joint, pin.LOCAL_WORLD_ALIGNED)
            lever = local @ self.data.oMi[joint].rotation.T
            # The velocity of a point is that of the joint's origin plus omega x lever.
            slopes[rows] = world[:3] + (lever @ TURNS).reshape(-1, 3, 3) @ world[3:]
        return slopes.reshape(-1, self.model.nv)


def _solve(markers: _Markers, targets: Array, lower: Array, upper: Array, q: Array, most: int) -> Array:
    damping = LEAST_DAMPING
    error = markers.error(q, targets)
    for _ in range(most):
        slopes = markers.slopes(q)
        gradient = slopes.T @ error
        free = ~(((q <= lower) & (gradient > 0.0)) | ((q >= upper) & (gradient < 0.0)) | (lower == upper))
        normal = slopes[:, free].T @ slopes[:, free]
        while True:
            step = np.zeros_like(q)
            step[free] = -np.linalg.solve(normal + damping * np.eye(free.sum()), gradient[free])
            trial = np.clip(q + step, lower, upper)
            trial_error = markers.error(trial, targets)
            better = trial_error @ trial_error <= error @ error
            if better or damping >= MOST_DAMPING:
                break
            damping = max(10.0 * damping, DAMPING)
        moved = float(np.abs(trial - q).max())
        if better:
            q, error = trial, trial_error
        if moved < CONVERGED or not better:
            break
        damping = max(damping / 10.0, LEAST_DAMPING)
    return q
