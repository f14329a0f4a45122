"""What the measures need to know of a lift and of a person in it; a solution has it all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from liftopt.multibody.agent import Agent
from liftopt.multibody.dh import ROTATION_WORLD_PAPER
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.trajectory import AgentTrajectory, ObjectTrajectory
from liftopt.scenario.build import agents_of, subject_of
from liftopt.scenario.model import Scenario

Array = npt.NDArray[np.float64]


class Lift(Protocol):
    """A solved lift, at its knots or between them too."""

    @property
    def scenario(self) -> Scenario:
        """What was asked."""

    @property
    def urdfs(self) -> Mapping[str, str]:
        """File name -> text of the very models solved."""

    @property
    def time(self) -> Array:
        """(K,) times [s]."""

    @property
    def object(self) -> ObjectTrajectory:
        """What is lifted."""

    @property
    def robots(self) -> tuple[AgentTrajectory, ...]:
        """Those that help."""


@dataclass(frozen=True)
class Stance:
    """Where a person stands, upright.

    Attributes:
        p_world_feet: (3,) between the ankles, on the floor [m].
        heading: from the world's x axis to where the person faces, about the vertical [rad].
    """

    p_world_feet: Array
    heading: float

    @property
    def R_world_person(self) -> Array:
        """(3, 3) the person's axes in the world: forward, left, up."""
        c, s = np.cos(self.heading), np.sin(self.heading)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def model_of(lift: Lift, person: AgentTrajectory) -> Agent:
    """Return the model that a person's trajectory was made with."""
    return next(agent for agent in agents_of(lift.scenario, lift.urdfs) if agent.name == person.name)


def subject_in(lift: Lift, person: AgentTrajectory) -> Subject:
    """Return the body of a person."""
    return subject_of(lift.scenario.human)


def stance_of(agent: Agent) -> Stance:
    """Return where a person stands, as the base of the model says."""
    base = agent.model.frames[agent.model.getFrameId(f"{agent.name}_base")].placement
    forward = base.rotation @ ROTATION_WORLD_PAPER.T[:, 0]
    # The angles of a URDF are off by rounding; nobody stands turned by that.
    return Stance(base.translation, round(float(np.arctan2(forward[1], forward[0])), 12))
