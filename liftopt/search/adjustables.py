"""What may be changed in a scenario to make its lift possible, and how large a change its obstacles seem to ask for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from liftopt.assessment.who import who_in
from liftopt.errors import InputError
from liftopt.scenario.model import Scenario
from liftopt.scenario.placement import distance_key, lead, partner, stand_of
from liftopt.solution.infeasibility_report import InfeasibilityReason

LEAST_MOVE = 0.05  # [m], tried first where nothing says how far to move


@dataclass(frozen=True)
class Adjustable:
    """Values of a scenario that may be changed together.

    Attributes:
        keys: dotted keys; all move by the same amount.
        step: resolution of the change.
        usual: a change as large as this ranks as 1; of the value itself if ``relative``.
        less, more: what a change is called; may hold {change} and {value}, and {was}.
        against: constraints it may help with.
        most: largest change tried, in steps.
        relative: ``usual`` is a share of the value.
        unit: of the values, where they are not relative.
    """

    keys: tuple[str, ...]
    step: float
    usual: float
    less: str
    more: str
    against: frozenset[str]
    most: int = 64
    relative: bool = False
    unit: str = "m"

    @property
    def signs(self) -> tuple[int, ...]:
        """Which ways it may change: -1, 1 or both."""
        return tuple(sign for sign, words in ((-1, self.less), (1, self.more)) if words)

    def values(self, scenario: Scenario) -> tuple[float, ...]:
        """Return its values in a scenario, in the order of ``keys``."""
        return tuple(scenario.value(key) for key in self.keys)

    def changed(self, scenario: Scenario, steps: int) -> Scenario | None:
        """Return the scenario with its values so many steps on, on the grid of steps; None if it would be none."""
        grid = {key: round(round(scenario.value(key) / self.step + steps) * self.step, 6) for key in self.keys}
        try:
            return scenario.replace(grid)
        except InputError:
            return None

    def hint(self, scenario: Scenario, reasons: Sequence[InfeasibilityReason]) -> int:
        """Return how many steps the reasons seem to ask for; 0 if it cannot help against them."""
        most, (was, *_) = 0.0, self.values(scenario)
        for reason in reasons:
            if reason.constraint not in self.against:
                continue
            if reason.static and reason.time is not None and self._elsewhere(reason.time):
                return 0
            if reason.static and self.keys == ("duration",):
                continue
            if not self.relative:
                change = reason.amount if reason.unit == self.unit else 0.0
            elif self.keys == ("object.mass",):
                change = was * reason.share / (1.0 + reason.share)
            else:
                change = was * reason.share
            most = max(most, change, LEAST_MOVE if self.unit == "m" and not self.relative else self.step)
        return int(np.ceil(most / self.step - 1e-9))

    def _elsewhere(self, when: float) -> bool:
        """Whether it moves only the other end of the lift than the one at a time."""
        return all(key.startswith("task.end." if when == 0.0 else "task.start.") for key in self.keys)


_REACH, _MOTION = (
    frozenset({"grasp_closure", "workspace", "clearance"}),
    frozenset({"grasp_closure", "workspace", "clearance", "torque", "velocity", "compression"}),
)
_TURN = frozenset({"grasp_turn"})
_STRENGTH = frozenset({"torque", "grasp_force", "compression"})
_POSTURE = _REACH | {"torque", "compression"}
_CLEARANCE = frozenset({"clearance"})


def adjustables(scenario: Scenario) -> list[Adjustable]:
    """Return what may be changed in a scenario, the simplest first."""
    found = [
        Adjustable(("duration",), 0.01, 0.25, "", "at least {value:.2f} s",
                   _STRENGTH | {"velocity", "grasp_closure"}, 600, relative=True),
        Adjustable(("object.mass",), 0.1, 0.25, "object at most {value:.1f} kg", "", _STRENGTH, 512, relative=True),
        Adjustable(("limits.max_grasp_force",), 1.0, 0.1, "", "grasp force of up to {value:.0f} N",
                   frozenset({"grasp_force"}), 512, relative=True),
    ]  # fmt: skip
    if scenario.limits.spine_compression is not None:
        more = "compression of the spine of up to {value:.0f} N"
        of_spine = frozenset({"compression"})
        found.append(Adjustable(("limits.spine_compression",), 50.0, 0.1, "", more, of_spine, 512, relative=True))
    if (away := distance_key(scenario)) is not None:
        who = _base(scenario, partner(scenario) or "")
        nearer, farther = f"{who} {{change:.2f}} m nearer", f"{who} {{change:.2f}} m farther away"
        found.append(Adjustable((away,), 0.01, 0.1, nearer, farther, _MOTION, 256))
    for keys, where in (*_ends(scenario, "height"), *_ends(scenario, "z")):
        lower, higher = where + " at most {value:.2f} m", where + " at least {value:.2f} m"
        found.append(Adjustable(keys, 0.01, 0.1, lower, higher, _MOTION))
    found += _of_others(scenario)
    less, more = _along_x(scenario)
    for keys, where in (*_ends(scenario, "human_distance"), *_ends(scenario, "x")):
        nearer, farther = f"{where} {{change:.2f}} m {less}", f"{where} {{change:.2f}} m {more}"
        found.append(Adjustable(keys, 0.01, 0.1, nearer, farther, _POSTURE))
    for name, agent in scenario.agents.items():
        if agent.kind == "robot":
            lower, higher = f"{name} base {{change:.2f}} m lower", f"{name} base {{change:.2f}} m higher"
            found.append(Adjustable((f"{name}.{agent.height_key}",), 0.01, 0.1, lower, higher, _POSTURE))
    shallower, deeper = "object at most {value:.2f} m deep", "object at least {value:.2f} m deep"
    found.append(Adjustable(("object.depth",), 0.01, 0.1, shallower, deeper, _POSTURE))
    for name, agent in scenario.agents.items():
        if agent.grasp == "wrench":
            more = f"{name} may turn by up to {{value:.0f}} deg on the object"
            found.append(Adjustable((f"{name}.grasp_turn_deg",), 1.0, 10.0, "", more, _TURN, 150, unit="deg"))
    for key, size in (("object.width", "wide"), ("object.height", "high")):
        found.append(Adjustable((key,), 0.01, 0.1, f"object at most {{value:.2f}} m {size}", "", _CLEARANCE))
    return found


def _ends(scenario: Scenario, name: str) -> Iterator[tuple[tuple[str, ...], str]]:
    given = [end for end in ("start", "end") if getattr(getattr(scenario.task, end), name, None) is not None]
    upright = name in ("height", "z")
    for end in given:
        yield (f"task.{end}.{name}",), f"{end} height" if upright else f"object at the {end}"
    if len(given) == 2 and not upright:
        yield tuple(f"task.{end}.{name}" for end in given), "object at both ends"


def _of_others(scenario: Scenario) -> Iterator[Adjustable]:
    """Yield where the robots stand that are none of the two who face each other."""
    facing = (lead(scenario), partner(scenario))
    for name, agent in scenario.agents.items():
        if agent.kind == "robot" and name not in facing:
            for axis in ("x", "y"):
                back, on = (f"{name} base {{change:.2f}} m towards {sign}{axis.upper()}" for sign in "-+")
                yield Adjustable((f"{name}.base.{axis}",), 0.01, 0.1, back, on, _MOTION, 256)


def _along_x(scenario: Scenario) -> tuple[str, str]:
    """Return what it is called that the object moves towards -X and towards +X: nearer to the lead, farther from it."""
    name = lead(scenario)
    if stand_of(scenario, name).yaw_deg % 360.0:
        return "towards -X", "towards +X"
    called = who_in(scenario.agents, name).called
    return f"nearer to {called}", f"farther from {called}"


def _base(scenario: Scenario, name: str) -> str:
    """Return what of an agent is moved to move it, in words."""
    return f"{name} base" if scenario.agents[name].kind == "robot" else name
