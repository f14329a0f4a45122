"""What the entries of a scenario must agree on."""

from __future__ import annotations

from collections import Counter

from liftopt.errors import NO_VALUE, InputError
from liftopt.files.entries import FREE, OFF
from liftopt.scenario.agent_fields import NAME, NAMES
from liftopt.scenario.agents import Person
from liftopt.scenario.fields import ScenarioFields
from liftopt.scenario.grasp_checks import check_grasps
from liftopt.scenario.grasps import middle_of_hands
from liftopt.scenario.placement import DISTANCE, distance_key, lead, stand_of
from liftopt.scenario.robot_checks import check_robots
from liftopt.scenario.task import GraspPlace, ObjectPlace
from liftopt.scenario.urdf_files import urdf_files

OWN_PLACE = "give the object's own x, y and z"
# Names that results have for something else: attributes objective_<agent>, variables grasp_<...>.
TAKEN = ("acceleration", "force", "range", "tilt", "spine", "limit", "error", "bar", "grasp", "schema", "table")
ELSEWHERE = "is the name of something else"


def check(scenario: ScenarioFields) -> None:
    """Raise ``InputError`` where two entries of a scenario contradict each other, or one is missing for another."""
    if not scenario.agents:
        raise InputError("agents", NO_VALUE, "is empty; must hold a table [agents.NAME] for everybody who lifts")
    _check_names(scenario)
    _check_weights(scenario)
    check_robots(scenario)
    for name in scenario.agents:
        stand_of(scenario, name)
    _check_obstacles(scenario)
    _check_spine(scenario)
    check_grasps(scenario)
    for end in ("start", "end"):
        _check_place(scenario, end)


def _check_names(scenario: ScenarioFields) -> None:
    taken = {*TAKEN, *type(scenario).model_fields, scenario.object.name}
    for name in scenario.agents:
        if not NAME.fullmatch(name):
            raise InputError("agents", name[:60], f"the name of an agent must be {NAMES}")
        if name in taken:
            raise InputError("agents", name, f"{ELSEWHERE}; give the agent another one")
    if scenario.object.name in {*TAKEN} - {"table"}:
        raise InputError("object.name", scenario.object.name, f"{ELSEWHERE}; give the object another one")
    files = Counter(urdf_files(scenario).values())
    for name, file in urdf_files(scenario).items():
        if files[file] > 1 and name == file.removesuffix(".urdf"):
            key = "agents" if name in scenario.agents else "object.name"
            raise InputError(key, name, f"the file {file} is another one's; give another name")


def _check_obstacles(scenario: ScenarioFields) -> None:
    if not scenario.obstacles:
        return
    from liftopt.multibody.solids import FLOOR  # with NumPy, which most entries are checked without

    seen = {*scenario.agents, scenario.object.name, FLOOR.owner}
    for obstacle in scenario.obstacles:
        if obstacle.name in seen:
            raise InputError("obstacles.name", obstacle.name, f"{ELSEWHERE}; give the obstacle another one")
        seen.add(str(obstacle.name))


def _check_spine(scenario: ScenarioFields) -> None:
    key, most = "limits.spine_compression", scenario.limits.spine_compression
    if most is None:
        return
    people = [(name, agent) for name, agent in scenario.agents.items() if isinstance(agent, Person)]
    if not people:
        raise InputError(key, most, f'must be "{OFF}" where no person lifts')
    for name, person in people:
        if person.body != "whole":
            raise InputError(key, most, f'takes people with body = "whole"; set {name}.body = "whole", or "{OFF}" here')


def _check_weights(scenario: ScenarioFields) -> None:
    weights = {f"{name}.weight": agent.weight for name, agent in scenario.agents.items()}
    objective = scenario.objective
    weights |= {
        "acceleration_weight": objective.acceleration_weight,
        "force_weight": objective.force_weight,
        "range_weight": objective.range_weight,
        "tilt_weight": objective.tilt_weight,
        "spine_weight": objective.spine_weight,
    }
    if not any(weights.values()):
        raise InputError("objective", weights, "at least one weight must be above 0")


def _check_place(scenario: ScenarioFields, end: str) -> None:
    place: GraspPlace | ObjectPlace = getattr(scenario.task, end)
    most = scenario.limits.table_pitch_deg
    if abs(place.pitch_deg) > most:
        allowed = f"must be from {-most:g} to {most:g} deg, or raise limits.table_pitch_deg"
        raise InputError(f"task.{end}.pitch_deg", place.pitch_deg, allowed)
    if isinstance(place, GraspPlace):
        _check_distance(scenario, f"task.{end}.human_distance", place.human_distance)


def _check_distance(scenario: ScenarioFields, key: str, distance: float | None) -> None:
    ahead, first = scenario.task.standing_distance, lead(scenario)
    if distance is not None and (scenario.agents[first].kind != "person" or stand_of(scenario, first).yaw_deg % 360.0):
        raise InputError(key, distance, f"counts from the feet of a person who faces along X, not {first}; {OWN_PLACE}")
    if ahead is None or distance_key(scenario) != DISTANCE:
        return
    room = ahead - (scenario.object.depth / 2.0 - middle_of_hands(scenario, first)[0])
    if (distance or 0.0) >= room:
        where = f"standing_distance {ahead:g} m, object.depth {scenario.object.depth:g} m"
        raise InputError(
            key,
            FREE if distance is None else distance,
            f"must be below {room:g} m, or the object reaches behind the robot's base ({where})",
        )
