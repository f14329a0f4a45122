"""The entries of a scenario, each checked for itself; ``Scenario`` checks what they must agree on."""

from __future__ import annotations

import re
from typing import Annotated, Literal, overload

from pydantic import AfterValidator

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.entries import entry, number
from liftopt.files.section import Section
from liftopt.scenario.agent_fields import Kind
from liftopt.scenario.agents import Agent, Agents, Person
from liftopt.scenario.box import Box
from liftopt.scenario.obstacles import Obstacles
from liftopt.scenario.robot import Robot
from liftopt.scenario.settings import Limits, Objective, Refine, Solver
from liftopt.scenario.task import Lift

NAMES = "1 to 64 letters, digits, spaces or _ . + -, a letter or a digit first"


def safe_name(name: str) -> str:
    """Return the name of a scenario, which can also be that of a folder; raises ``InputError`` for others."""
    if not re.fullmatch(r"[^\W_](?:[\w .+-]{0,62}[\w+-])?", name):
        raise InputError("name", name, f"must be {NAMES} (name of the scenario)")
    return name


class ScenarioFields(Section):
    """Who lifts what, from where to where, how fast, and what is asked of the solver."""

    name: Annotated[str, AfterValidator(safe_name), entry("name of the scenario", NAMES)] = "scenario"
    duration: Annotated[float, number("time from start to end", "s", 0.2, 30.0)] = 2.0
    agents: Annotated[Agents, entry("who lifts", "a section with a table [agents.NAME] for everybody who lifts")]
    object: Box
    task: Lift
    obstacles: Annotated[
        Obstacles,
        entry("what stands in the way", "tables [[obstacles]] of box, position, yaw_deg and name"),
    ] = ()
    objective: Objective = Objective()
    limits: Limits = Limits()
    solver: Solver = Solver()
    refine: Refine = Refine()

    @overload
    def first(self, kind: Literal["person"]) -> Person: ...
    @overload
    def first(self, kind: Literal["robot"]) -> Robot: ...
    def first(self, kind: Kind) -> Agent:
        """Return the first agent of a kind.

        Raises:
            InputError: there is none.
        """
        for agent in self.agents.values():
            if agent.kind == kind:
                return agent
        raise InputError("agents", NO_VALUE, f"hold no {kind}")
