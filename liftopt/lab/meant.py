"""Which of those who lift is meant: the only one of its kind, or that of a name."""

from __future__ import annotations

from collections.abc import Sequence

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.suggestions import did_you_mean, nearest
from liftopt.multibody.agent import Kind
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.solution.solution import Solution


def the_robot(solution: Solution, name: str | None, option: str = "--robot") -> AgentTrajectory:
    """Return the robot that is meant.

    Args:
        solution: whose.
        name: of the robot; None where there is only one.
        option: that says the name, for messages.

    Raises:
        InputError: there is none, or none of that name, or several and no name; the message lists them.
    """
    return _meant(solution.robots, "robot", name, option)


def the_person(solution: Solution, name: str | None, option: str = "--person") -> AgentTrajectory:
    """Return the person that is meant, as ``the_robot`` does."""
    return _meant(solution.persons, "person", name, option)


def _meant(agents: Sequence[AgentTrajectory], kind: Kind, name: str | None, option: str) -> AgentTrajectory:
    names = [agent.name for agent in agents]
    if not names:
        raise InputError("RESULT", NO_VALUE, f"has no {kind}")
    if name is None:
        if len(names) > 1:
            raise InputError(option, NO_VALUE, f"is missing; this lift has more than one {kind}: {', '.join(names)}")
        return agents[0]
    if name not in names:
        allowed = f"must be the name of a {kind} of this lift: {', '.join(names)}"
        raise InputError(option, name, allowed + did_you_mean(nearest(name, names)))
    return agents[names.index(name)]
