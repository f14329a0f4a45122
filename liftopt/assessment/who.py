"""How texts call one who lifts: by the kind, and by name where there are several of the kind."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

from liftopt.multibody.agent import Agent
from liftopt.scenario.agents import Person
from liftopt.scenario.meant import KINDS
from liftopt.scenario.robot import Robot
from liftopt.solution.finding import PERSON, ROBOT

SUBJECTS = {"person": PERSON, "robot": ROBOT}
HANDS = {PERSON: "hand", ROBOT: "gripper"}
NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")


class Named(Protocol):
    """Anything that has a name and a kind: an agent, or its trajectory."""

    @property
    def name(self) -> str:
        """Of the agent."""

    @property
    def kind(self) -> str:
        """``"person"`` or ``"robot"``."""


@dataclass(frozen=True)
class Who:
    """One who lifts, in words.

    Attributes:
        subject: of the codes, ``"person"`` or ``"robot"``.
        name: of the agent.
        is_alone: whether nobody else is of the kind.
    """

    subject: str
    name: str
    is_alone: bool

    @property
    def the(self) -> str:
        """``"the person"``, ``"the person anna"``."""
        return f"the {self.told}"

    @property
    def told(self) -> str:
        """``"person"``, ``"person anna"``."""
        return self.subject if self.is_alone else f"{self.subject} {self.name}"

    @property
    def called(self) -> str:
        """``"the person"``, ``"anna"``."""
        return self.the if self.is_alone else self.name

    @property
    def label(self) -> str:
        """Of a column: ``"person"``, ``"anna"``."""
        return self.subject if self.is_alone else self.name

    @property
    def of(self) -> str:
        """What follows a word that does not say whose it is: nothing, or ``" of anna"``."""
        return "" if self.is_alone else f" of {self.name}"

    @property
    def hand(self) -> str:
        """``"hand"`` or ``"gripper"``."""
        return HANDS[self.subject]


def who_is(agent: Named, agents: Iterable[Named]) -> Who:
    """Return how texts call an agent among ``agents``."""
    same = sum(other.kind == agent.kind for other in agents)
    return Who(SUBJECTS[agent.kind], agent.name, same == 1)


def who_in(agents: Mapping[str, Person | Robot], name: str) -> Who:
    """Return how an agent of a scenario is told."""
    kind = agents[name].kind
    return Who(SUBJECTS[kind], name, sum(agent.kind == kind for agent in agents.values()) == 1)


def hand_of(grasp: str, who: Who) -> str:
    """Return the hand of a grasp by its name: ``"hand"``; ``"right hand"`` of one who has several."""
    return f"{grasp.removeprefix(who.name).removeprefix('_')} {who.hand}".strip()


def whose(name: str) -> str:
    """Return ``"anna's"``; ``"the robot's"`` where the name is a word for what the agent is."""
    return f"the {name}'s" if name in KINDS else f"{name}'s"


def whose_hold(grasp: str, agents: Iterable[Agent]) -> str:
    """Return whose grasp one is by its name, ``"the human's"``; ``"the human's right"`` of one who has several."""
    holder = next(agent for agent in agents if grasp in [each.name for each in agent.grasps])
    side = grasp.removeprefix(holder.name).removeprefix("_")
    return f"{whose(holder.name)} {side}".rstrip()


def listed(names: Iterable[str]) -> str:
    """Return ``"anna"``, ``"anna and ben"``, ``"anna, ben and left"``."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def in_words(count: int) -> str:
    """Return a small count as a word, ``"six"``, and a larger one in digits."""
    return NUMBERS[count] if count < len(NUMBERS) else str(count)
