"""What the measures need to know of a lift and of a person in it; a solution has it all."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Protocol

import numpy as np

from liftopt.multibody.agent import Agent
from liftopt.multibody.dh import rotation_z
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.trajectory import AgentTrajectory, ObjectTrajectory
from liftopt.scenario.agents import Person
from liftopt.scenario.build import agent_of, subject_of
from liftopt.scenario.model import Scenario
from liftopt.scenario.placement import stand_of
from liftopt.types import Array


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
    def agents(self) -> tuple[AgentTrajectory, ...]:
        """All who lift."""

    @property
    def robots(self) -> tuple[AgentTrajectory, ...]:
        """Those of them that are robots."""


def model_of(lift: Lift, name: str) -> Agent:
    """Return the model that the trajectory of the person of that name was made with."""
    return agent_of(lift.scenario, name, lift.urdfs)


def subject_in(lift: Lift, name: str) -> Subject:
    """Return the body of the person of that name."""
    person = lift.scenario.agents[name]
    assert isinstance(person, Person)
    return subject_of(person)


def R_world_person(lift: Lift, name: str) -> Array:
    """Return the (3, 3) axes of a person who stands upright: forward, left, up."""
    return rotation_z(math.radians(stand_of(lift.scenario, name).yaw_deg))[:3, :3]


def p_world_feet(lift: Lift, name: str) -> Array:
    """Return the point (3,) between a person's ankles, on the floor [m]."""
    stand = stand_of(lift.scenario, name)
    return np.array([stand.x, stand.y, 0.0])
