"""What is compared: a DH chain beside the Pinocchio model of the same mechanism, and random states of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.crosscheck.lagrangian import ExternalLoad
from liftopt.crosscheck.oracle import BodyLoad
from liftopt.multibody.dh import DHChain, row_tail
from liftopt.types import Array

States = tuple[Array, Array, Array]  # q, v, a, each (S, n)

GLOBAL_RANGE = 0.5  # m, either side: the global translations have no anatomical limit
TILT_RANGE = 1.0  # rad, either side: Table 4's three rotations are singular at pi / 2
VELOCITY, ACCELERATION = 4.0, 20.0  # rad/s and rad/s^2 (m at a prismatic joint)
FORCE, MOMENT = 100.0, 20.0  # N and Nm, each component


@dataclass(frozen=True)
class CheckedSystem:
    """One mechanism, described twice.

    Attributes:
        chain: DH rows with one inertia a row.
        model: Pinocchio model; joint i + 1 is row i, but for the floating base, whose one joint is a free-flyer.
        t_world_root: (4, 4) placement of the chain's root frame in the world.
        grasp_frames: names of the model's frames where it is loaded.
        grasp_points: (k, 3) the same points in the DH frame of the last link [m].
    """

    chain: DHChain
    model: pin.Model
    t_world_root: Array
    grasp_frames: tuple[str, ...]
    grasp_points: Array

    @property
    def rotation(self) -> Array:
        """R_world_root (3, 3)."""
        return self.t_world_root[:3, :3]

    @property
    def gravity(self) -> Array:
        """Gravity (3,) in root axes [m/s^2]."""
        gravity: Array = self.rotation.T @ self.model.gravity.linear
        return gravity

    def to_world(self, vectors: Array) -> Array:
        """Return vectors (..., 3), given in root axes, in world axes."""
        turned: Array = vectors @ self.rotation.T
        return turned

    def body_load(self, load: ExternalLoad) -> BodyLoad:
        """Return the same load for Pinocchio: a row's fixed tail leads from the joint's frame to the DH frame."""
        tail = row_tail(self.chain.rows[load.link])
        point = load.point @ tail[:3, :3].T + tail[:3, 3]
        return BodyLoad(load.link + 1, point, self.to_world(load.force), self.to_world(load.moment))


def random_states(system: CheckedSystem, samples: int, rng: np.random.Generator) -> States:
    """Return q, v, a (S, n): joints within their limits, at velocities and accelerations beyond those of a lift."""
    rows = system.chain.rows
    span = np.array([GLOBAL_RANGE if row.kind == "prismatic" else TILT_RANGE for row in rows])
    lower, upper = -span, span
    if system.model.nq == len(rows):
        revolute = np.array([row.kind == "revolute" for row in rows])
        lower = np.where(revolute, np.maximum(system.model.lowerPositionLimit, -np.pi), lower)
        upper = np.where(revolute, np.minimum(system.model.upperPositionLimit, np.pi), upper)
    shape = (samples, len(rows))
    return (
        rng.uniform(lower, upper, shape),
        rng.uniform(-VELOCITY, VELOCITY, shape),
        rng.uniform(-ACCELERATION, ACCELERATION, shape),
    )


def random_load(link: int, point: Array, samples: int, rng: np.random.Generator) -> ExternalLoad:
    """Return a random force and moment, (S, 3) each, at ``point`` (3,) of ``link``'s DH frame."""
    return ExternalLoad(
        link, point, rng.uniform(-FORCE, FORCE, (samples, 3)), rng.uniform(-MOMENT, MOMENT, (samples, 3))
    )
