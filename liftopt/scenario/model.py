"""What is lifted, by whom, from where to where: a TOML file or mapping becomes a checked ``Scenario``.

SI units; radians unless the key says otherwise. The world frame has Z up and X from the human to the robot.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import tomli_w

from liftopt.errors import InputError
from liftopt.scenario.file import read_scenario_file
from liftopt.scenario.overrides import refuse_unknown_keys, set_entry
from liftopt.scenario.schema import Choice, Name, Number, Switch, Whole, entries, section

GRASPS = ("point", "wrench")
RESTS = ("velocity", "acceleration")


@dataclass(frozen=True, kw_only=True)
class Human:
    """The person who lifts."""

    stature: Annotated[float, Number("height of the person", "m", 1.2, 2.2)]
    mass: Annotated[float, Number("body mass of the person", "kg", 30.0, 200.0)]
    sex: Annotated[str, Choice("whose segment data to use", ("male", "female"))]
    grasp: Annotated[str, Choice("a force at a point, or a hand that also transmits moments", GRASPS)] = "point"
    # Both largest moments are estimates: about what a wrist holds in the weaker directions, and a small gripper.
    max_grasp_moment: Annotated[float, Number("largest moment of a wrench grasp", "Nm", 0.0, 1e3, open_low=True)] = 10.0
    grasp_turn_deg: Annotated[float, Number("largest turn of the hand in a wrench grasp", "deg", 1.0, 180.0)] = 30.0
    contact: Annotated[str, Choice("a hand that grips, or a flat one that only pushes up", ("grip", "flat"))] = "grip"
    friction: Annotated[float, Number("friction coefficient under a flat hand", "", 0.01, 10.0)] = 0.5


@dataclass(frozen=True, kw_only=True)
class Tool:
    """The gripper on the robot's flange; length and mass 0 stand for the bare flange."""

    length: Annotated[float, Number("flange to grasp point, along the flange's axis", "m", 0.0, 0.6)] = 0.15
    mass: Annotated[float, Number("mass of the gripper", "kg", 0.0, 10.0)] = 0.4


@dataclass(frozen=True, kw_only=True)
class Robot:
    """The robot that lifts; it faces the person."""

    model: Annotated[str, Choice("which robot", ("sawyer",))]
    base_height: Annotated[float, Number("height of the robot's base above the floor", "m", 0.0, 2.0)] = 0.915
    tool: Tool = field(default_factory=Tool)
    grasp: Annotated[str, Choice("a force at a point, or a gripper that also transmits moments", GRASPS)] = "point"
    max_grasp_moment: Annotated[float, Number("largest moment of a wrench grasp", "Nm", 0.0, 1e3, open_low=True)] = 5.0
    grasp_turn_deg: Annotated[float, Number("largest turn of the gripper in a wrench grasp", "deg", 1.0, 180.0)] = 30.0


@dataclass(frozen=True, kw_only=True)
class Table:
    """The object: a box of even density, held at the two bottom edges that face the person and the robot."""

    mass: Annotated[float, Number("mass of the object", "kg", 0.05, 50.0)]
    depth: Annotated[float, Number("extent from the human grasp to the robot grasp", "m", 0.1, 2.0)]
    width: Annotated[float, Number("extent to the side", "m", 0.02, 2.0)]
    height: Annotated[float, Number("thickness", "m", 0.001, 1.0)]


@dataclass(frozen=True, kw_only=True)
class GraspPose:
    """Where the object is at one end of the motion; ``human_distance`` None is "free" in a file.

    A tilted object has ``height`` midway between its grasp points; ``human_distance`` is that of the human's.
    """

    height: Annotated[float, Number("height of the held edges, midway if tilted (not of the centre)", "m", 0.05, 2.2)]
    human_distance: Annotated[float | None, Number("human grasp ahead of the feet", "m", 0.0, 2.0, word="free")]
    pitch_deg: Annotated[float, Number("tilt of the object, above 0 with the robot's edge lower", "deg", -60, 60)] = 0.0


@dataclass(frozen=True, kw_only=True)
class Task:
    """From where to where, how far apart the two stand, and what is zero at both ends."""

    standing_distance: Annotated[float, Number("feet to the robot's base", "m", 0.5, 4.0)]
    rest: Annotated[str, Choice("zero at both ends: velocity, or acceleration too as in files without it", RESTS)] = (
        "velocity"
    )
    start: GraspPose
    end: GraspPose


@dataclass(frozen=True, kw_only=True)
class Objective:
    """Weights of the four integrals that are minimised."""

    human_weight: Annotated[float, Number("weight of the human joint torques squared", "", 0.0, 1e6)] = 1.0
    robot_weight: Annotated[float, Number("weight of the robot joint torques squared", "", 0.0, 1e6)] = 1.0
    acceleration_weight: Annotated[float, Number("weight of the accelerations squared", "", 0.0, 1e6)] = 0.5
    force_weight: Annotated[float, Number("weight of the grasp forces squared", "", 0.0, 1e6)] = 0.01


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Limits that belong to the task rather than to an agent."""

    table_roll_deg: Annotated[float, Number("largest roll of the object in a wrench grasp", "deg", 0.0, 60.0)] = 10.0
    table_pitch_deg: Annotated[float, Number("largest pitch of the object", "deg", 0.0, 60.0)] = 10.0
    table_yaw_deg: Annotated[float, Number("largest yaw of the object", "deg", 0.0, 60.0)] = 10.0
    max_grasp_force: Annotated[float, Number("largest grasp force", "N", 0.0, 10_000.0, open_low=True)] = 200.0
    balance_tolerance: Annotated[float, Number("slack in the object's balance", "N, Nm", 0.0, 100.0)] = 0.0


@dataclass(frozen=True, kw_only=True)
class Solver:
    """How the problem is solved."""

    name: Annotated[str, Choice("interior point that solves it", ("banded", "ipopt"))] = "banded"
    intervals: Annotated[int, Whole("spline intervals N", 6, 400)] = 20
    starts: Annotated[int, Whole("starts of which the best is kept", 1, 64)] = 4
    tries: Annotated[int, Whole("starts tried first on a coarser mesh, 0: none", 0, 512)] = 48
    tolerance: Annotated[float, Number("KKT error at which a start has converged", "", 1e-10, 1e-3)] = 1e-6
    workers: Annotated[int, Whole("starts and postures at a time; IPOPT takes one", 1, 64)] = 2
    seed: Annotated[int, Whole("seed of the random starts", 0, 2**32 - 1)] = 0
    time_limit: Annotated[float, Number("wall time of the whole solve", "s", 0.1, 3600.0)] = 50.0


@dataclass(frozen=True, kw_only=True)
class Refine:
    """Whether N is doubled, up to 400 and as long as time is left, until all of these hold."""

    on: Annotated[bool, Switch("refine the mesh")] = False
    objective_error: Annotated[float, Number("estimated error of the objective, share of it", "", 1e-4, 1.0)] = 0.02
    closure: Annotated[float, Number("distance of the grasps between knots", "m", 1e-7, 1e-3)] = 1e-4
    balance: Annotated[float, Number("residual of the object's balance between knots", "N, Nm", 1e-4, 100.0)] = 0.1
    torque_excess: Annotated[float, Number("torque above its limit between knots", "Nm", 1e-4, 100.0)] = 0.1


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """One lift to be solved. An invalid one cannot be made: every value is checked on construction.

    Raises:
        InputError: a value has the wrong type or is out of its range, or two values contradict each other.
    """

    schema: Annotated[int, Choice("version of the scenario format", (1,))]
    name: Annotated[str, Name("name of the scenario")] = "scenario"
    duration: Annotated[float, Number("time from start to end", "s", 0.2, 30.0)]
    human: Human
    robot: Robot
    table: Table
    task: Task
    objective: Objective = field(default_factory=Objective)
    limits: Limits = field(default_factory=Limits)
    solver: Solver = field(default_factory=Solver)
    refine: Refine = field(default_factory=Refine)

    def __post_init__(self) -> None:
        for key, kind, _, _ in entries(Scenario):
            object.__setattr__(self, key, kind.accept(key, getattr(self, key)))
        weights = section(Objective).plain(self.objective)
        if not any(weights.values()):
            raise InputError("objective", weights, "at least one weight must be above 0")
        for end in ("start", "end"):
            pitch, most = getattr(self.task, end).pitch_deg, self.limits.table_pitch_deg
            if abs(pitch) > most:
                allowed = f"must be from {-most:g} to {most:g} deg, or raise limits.table_pitch_deg"
                raise InputError(f"task.{end}.pitch_deg", pitch, allowed)
            distance: float | None = getattr(self.task, end).human_distance
            room = self.task.standing_distance - self.table.depth
            if (distance or 0.0) >= room:
                where = f"standing_distance {self.task.standing_distance:g} m, table.depth {self.table.depth:g} m"
                raise InputError(
                    f"task.{end}.human_distance",
                    "free" if distance is None else distance,
                    f"must be below {room:g} m, or the object reaches behind the robot's base ({where})",
                )


def load_scenario(source: str | Path | None = None, overrides: Iterable[str] = ()) -> Scenario:
    """Return the scenario of a TOML file. One without ``task.rest`` means ``"acceleration"``, as all did before.

    Args:
        source: path of the file, the name of a shipped scenario (a str), or a result folder, which stands for the
            scenario that was solved; None is ``"table5"``.
        overrides: ``"dotted.key=value"`` each, see ``with_overrides``; later ones win.

    Raises:
        InputError: the file cannot be read, is not TOML, or does not describe a scenario.
    """
    path, data = read_scenario_file("table5" if source is None else source)
    with suppress(InputError):  # a file name need not be a name
        data.setdefault("name", Name("file name").accept("name", path.stem))
    task = data.get("task")
    if isinstance(task, dict):  # what files meant before there was a choice
        task.setdefault("rest", "acceleration")
    for override in overrides:
        set_entry(data, override)
    return scenario_from_dict(data)


def scenario_from_dict(data: Mapping[str, Any]) -> Scenario:
    """Return the scenario that a mapping, laid out like the TOML file, describes.

    Raises:
        InputError: naming the key that is missing, unknown or wrong.
    """
    if "schema" in data:  # first: the keys of another version would all be unknown
        entries(Scenario)[0].kind.accept("schema", data["schema"])
    refuse_unknown_keys(data, Scenario)
    scenario: Scenario = section(Scenario).accept("", data)
    return scenario


def with_overrides(scenario: Scenario, overrides: Iterable[str]) -> Scenario:
    """Return the scenario with some entries changed.

    Args:
        scenario: left as it is.
        overrides: ``"table.mass=3"``, ``"task.end.human_distance=free"``: the value is a TOML value, and what is none
            is taken as a string.

    Raises:
        InputError: an override is malformed or its result is not a scenario.
    """
    data = scenario_to_dict(scenario)
    for override in overrides:
        set_entry(data, override)
    return scenario_from_dict(data)


def scenario_to_dict(scenario: Scenario) -> dict[str, Any]:
    """Return the scenario as nested plain values, all defaults filled in."""
    return section(Scenario).plain(scenario)


def scenario_to_toml(scenario: Scenario) -> str:
    """Return the scenario as a TOML file, all defaults filled in; reading it gives an equal scenario."""
    return tomli_w.dumps(scenario_to_dict(scenario))
