"""What several test modules share."""

from __future__ import annotations

import signal
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.solvers.deadline import NEVER
from liftopt.collocation.spline import RestToRestSpline
from liftopt.collocation.task import LiftTask
from liftopt.multibody.agent import Agent, Grasp, LiftedObject
from liftopt.multibody.joint_units import TURNS
from liftopt.multibody.person.human import Subject, human_agent
from liftopt.multibody.placement import facing
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.multibody.robots.example_robot_data import share_folder
from liftopt.multibody.robots.robot_agent import robot_agent
from liftopt.multibody.robots.sawyer import sawyer_agent
from liftopt.multibody.table import lifted_table
from liftopt.scenario.model import load_scenario
from liftopt.search.initial_guess import InitialGuess, posture_starts
from liftopt.solution.finding import Assessment, Finding
from liftopt.solution.solution import Solution

ALONE = """
schema = 2
name = "alone"
duration = 2.0
agents.human = { kind = "person", body = "whole", stature = 1.75, mass = 75.0, sex = "male" }
object = { name = "box", mass = 8.0, depth = 0.3, width = 0.4, height = 0.3 }
solver = { intervals = 10, starts = 2 }

[task]
standing_distance = 1.9
start = { height = 0.5, human_distance = 0.35 }
end = { height = 1.0, human_distance = 0.35 }
"""
TEN_DEGREES = np.radians(10.0)


def pytest_configure() -> None:
    """Let Ctrl-C reach the commands that tests run, where the tests themselves run in the background of a shell."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let long files start first: one that starts last keeps one process busy and the others idle."""
    items.sort(key=lambda item: item.get_closest_marker("long") is None)


class Solved(NamedTuple):
    """A real solution and the folder it was saved in; neither is to be changed."""

    solution: Solution
    folder: Path


def _module(name: str) -> Any:
    """Return what stands beside this file, which pytest imports by its path."""
    spec = spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def make_two_handed() -> Callable[..., Agent]:
    """Return a function that makes a small agent with two arms."""
    found: Callable[..., Agent] = _module("two_hands").two_handed
    return found


@pytest.fixture(scope="session")
def scenario_tables() -> Any:
    """Return a hypothesis strategy: tables of a scenario whose entries are allowed, each for itself."""
    return _module("scenario_tables").tables()


@pytest.fixture(scope="session")
def coal_distance() -> Any:
    """Return the module that measures distances of solids by coal."""
    return _module("coal_distance")


@pytest.fixture(scope="session")
def known_agent() -> Callable[..., Agent]:
    """Return a function that makes an agent of a robot that is known by name; its base is at the origin by default."""

    def made(model: str, **entries: Any) -> Agent:
        known = known_robots()[model]
        own = {"base": known.base, "grasp_frame": known.grasp_frame, "locked": known.locked}
        return robot_agent(known.description(), **{"name": "robot", "T_world_base": np.eye(4), **own, **entries})

    return made


@pytest.fixture(scope="session")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Solved]:
    """Return a function that solves a shipped scenario with overrides, each once a session."""
    from liftopt.search.solve import solve
    from liftopt.storage.writer import save

    @cache
    def solve_once(name: str, *overrides: str) -> Solved:
        folder = tmp_path_factory.mktemp("result")
        solution = solve(load_scenario(name, overrides))
        save(solution, folder)
        return Solved(solution, folder)

    return solve_once


@pytest.fixture(scope="session")
def alone(solved: Callable[..., Solved], tmp_path_factory: pytest.TempPathFactory) -> Solved:
    """A whole person who lifts a box with both hands and nobody else."""
    file = tmp_path_factory.mktemp("scenario") / "alone.toml"
    file.write_text(ALONE, encoding="utf-8")
    return solved(str(file))


@pytest.fixture(scope="session")
def ur10(solved: Callable[..., Solved], tmp_path_factory: pytest.TempPathFactory) -> Solved:
    """A person and a UR10, which example-robot-data describes, lift a box."""
    pytest.importorskip("yourdfpy", reason="yourdfpy is in the extra 'robots'")
    if share_folder() is None:
        pytest.skip("example-robot-data is not installed (it is in 'test')")
    file = tmp_path_factory.mktemp("scenario") / "ur10.toml"
    file.write_text(_module("robot_lift").UR10, encoding="utf-8")
    return solved(str(file))


@pytest.fixture(scope="session")
def column_urdf() -> str:
    """Return the URDF of an arm on a lifting column, which holds at ``tool0``."""
    return str(_module("robot_lift").column_robot())


@pytest.fixture(scope="session")
def on_a_column(solved: Callable[..., Solved], tmp_path_factory: pytest.TempPathFactory) -> Solved:
    """A person and an arm on a lifting column, which a URDF describes, lift a box."""
    pytest.importorskip("yourdfpy", reason="yourdfpy is in the extra 'robots'")
    module, folder = _module("robot_lift"), tmp_path_factory.mktemp("scenario")
    (folder / "column.urdf").write_text(module.column_robot(), encoding="utf-8")
    file = folder / "column.toml"
    file.write_text(module.on_a_column("column.urdf"), encoding="utf-8")
    return solved(str(file))


@pytest.fixture(scope="session")
def team_solution(solved: Callable[..., Solved]) -> Callable[[str], Any]:
    """Return a function that gives a lift and its models by other teams, made without a solver.

    They are ``"two_people"``, anna and ben, ``"two_robots"``, a human with the Sawyers near and far, ``"squat"``, a
    human with legs, and ``"two_whole"``, anna and ben with legs.
    """
    module, pattern = _module("teams"), solved("table5", "solver.intervals=10", "solver.starts=1").solution
    return cache(lambda name: module.made(name, pattern))


@pytest.fixture(scope="session")
def people(team_solution: Callable[[str], Any]) -> Solution:
    """Return the lift of anna and ben, by ``team_solution``."""
    solution: Solution = team_solution("two_people").solution
    return solution


@pytest.fixture(scope="session")
def robots(team_solution: Callable[[str], Any]) -> Solution:
    """Return the lift of a human with the Sawyers near and far."""
    solution: Solution = team_solution("two_robots").solution
    return solution


def level_task(agents: int = 2, x: float = 0.625, **changes: object) -> LiftTask:
    """Return a lift of a level object from a centre at 0.91 m to 1.41 m, as in Table 5."""
    task = LiftTask(
        duration=2.0,
        start=np.array([x, np.nan, 0.91, 0.0, 0.0, 0.0]),
        end=np.array([x, np.nan, 1.41, 0.0, 0.0, 0.0]),
        pose_lower=np.array([-5.0, -5.0, 0.0, 0.0, -TEN_DEGREES, -TEN_DEGREES]),
        pose_upper=np.array([5.0, 5.0, 3.0, 0.0, TEN_DEGREES, TEN_DEGREES]),
        pose_velocity=np.full(6, 2.0),
        agent_weights=(1.0, 0.7, 1.3)[:agents],
        acceleration_weight=0.5,
        force_weight=0.01,
        max_grasp_force=200.0,
        balance_tolerance=0.0,
    )
    return replace(task, **changes)  # type: ignore[arg-type]


@pytest.fixture(scope="session")
def make_task() -> Callable[..., LiftTask]:
    return level_task


@pytest.fixture(scope="session")
def human() -> Agent:
    return human_agent(Subject(1.75, 75.0, "male"))


@pytest.fixture(scope="session")
def sawyer() -> Agent:
    return sawyer_agent(place=facing(1.9), base_height=0.915, tool_length=0.15, tool_mass=0.4)


@pytest.fixture(scope="session")
def table() -> LiftedObject:
    return lifted_table(mass=2.0, depth=0.45, width=0.31, height=0.02)


@pytest.fixture(scope="session")
def team(human: Agent, sawyer: Agent, table: LiftedObject) -> Team:
    return Team.of((human, sawyer), table)


@pytest.fixture(scope="session")
def small_lift(team: Team) -> Problem:
    """Return the lift of Table 5 on 10 intervals, which the tests solve."""
    return Problem(team, level_task(agent_weights=(1.0, 1.0)), RestToRestSpline(10).mesh())


@pytest.fixture(scope="session")
def starts(small_lift: Problem) -> list[InitialGuess]:
    return posture_starts(small_lift, 2, 0, NEVER)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave the figures of reports empty, which take most of the time of a page."""
    from matplotlib.figure import Figure

    monkeypatch.setattr("liftopt.viz.report_figures.drawn", lambda *_: Figure())


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(7)


class _Track(SimpleNamespace):
    """A stand-in for an agent's trajectory."""

    @property
    def load(self) -> np.ndarray:
        return self.grasp_force.sum(axis=1)


def _agent(name: str, kind: str, joints: int, force: np.ndarray, grasp: tuple[float, float, float]) -> SimpleNamespace:
    knots, n = 5, joints + 3
    names = tuple(f"{name}_GT{i}" for i in (1, 2, 3)) + tuple(f"{name}_Q{i}" for i in range(1, joints + 1))
    tau = np.zeros((knots, n))
    tau[:, :3] = 1000.0  # body weight in the locked joints: must not turn up among the joints
    tau[:, 4] = [0.0, 20.0, -30.0, 10.0, 0.0]
    limits = SimpleNamespace(tau_lower=np.full(joints, -100.0), tau_upper=np.full(joints, 40.0))
    q = np.zeros((knots, n))
    q[:, 4] = np.radians([0.0, 10.0, 20.0, 30.0, 45.0])
    return _Track(
        name=name,
        kind=kind,
        joint_names=names,
        moving=np.array([False] * 3 + [True] * joints),
        sliding=np.array([True] * 3 + [False] * joints),
        units=(TURNS,) * joints,
        q=q,
        tau=tau,
        limits=limits,
        grasp_force=force[:, None],
        grasp_moment=np.zeros((knots, 1, 3)),
        grasps=(Grasp(name, f"{name}_grasp"),),
        grasp_position=np.tile(grasp, (knots, 1, 1)),
        ground_force=np.zeros((knots, 3)),
        ground_moment=np.zeros((knots, 3)),
    )


@pytest.fixture
def solution() -> SimpleNamespace:
    """Return a stand-in for a solution whose every figure can be checked by hand: 5 knots in 2 s, 12 N + 8 N up."""
    scenario = load_scenario()
    human_force = np.tile([5.0, 0.0, 12.0], (5, 1))
    robot_force = np.tile([-3.0, 0.0, 8.0], (5, 1))
    human_force[2] = [9.0, 0.0, 40.0]
    ground = np.tile([0.0, 0.0, 75.0 * 9.81], (5, 1))
    ground[3, 2] *= 1.1
    moment = np.zeros((5, 3))
    moment[1] = [3.0, -4.0, 0.0]
    human = _agent("human", "person", 10, human_force, (0.4, 0.0, 0.9))
    human.ground_force, human.ground_moment = ground, moment
    robot = _agent("robot", "robot", 7, robot_force, (0.85, 0.0, 0.9))
    check = SimpleNamespace(name="closure", value=2e-9, limit=1e-6, unit="m", where="human at t = 0.40 s", passed=True)
    return SimpleNamespace(
        scenario=scenario,
        status="solved",
        solved=True,
        time=np.linspace(0.0, 2.0, 5),
        agents=(human, robot),
        persons=(human,),
        robots=(robot,),
        objective=350.0,
        objective_terms={"human": 200.0, "robot": 100.0, "acceleration": 90.0, "force": 500.0},
        objective_weights={"human": 1.0, "robot": 1.0, "acceleration": 0.5, "force": 0.01},
        iterations=31,
        intervals=20,
        seconds={"solve": 0.31, "evaluation": 0.05, "setup": 1.2, "total": 1.7},
        starts=(
            SimpleNamespace(name="naive", status="solved", objective=350.0, iterations=31, seconds=0.31),
            SimpleNamespace(name="ik 1", status="iteration limit", objective=np.nan, iterations=300, seconds=2.0),
        ),
        kept_start="naive",
        verification=SimpleNamespace(checks=(check,), passed=True, worst=check, kkt_error=4e-7),
        notes=("mesh refined to N = 40",),
        accuracy=None,
        reasons=(),
        suggested_changes=(),
        clearance=None,
        assessment=Assessment.of(
            [
                Finding("verdict.mathematics", "info", "solved and verified", "Solved and verified."),
                Finding("verdict.robot", "info", "within limits", "The robot is within limits."),
                Finding("verdict.person", "warning", "warning", "Warning for the person: posture RULA 6 of 7."),
                Finding("person.posture", "warning", "posture RULA 6 of 7", "The posture scores RULA 6 of 7.", "human"),
            ]
        ),
    )
