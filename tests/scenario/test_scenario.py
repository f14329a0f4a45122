"""Scenario files: oracle is the contract's list of keys, ranges and refusals."""

from __future__ import annotations

import dataclasses
import math
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from liftopt.errors import InputError
from liftopt.files.toml_text import tomllib
from liftopt.scenario.file import shipped_scenarios
from liftopt.scenario.model import (
    Human,
    Objective,
    Scenario,
    load_scenario,
    scenario_from_dict,
    scenario_to_dict,
    scenario_to_toml,
    with_overrides,
)
from liftopt.scenario.schema import Number, Section, Whole, describe, entries

DEFAULT = load_scenario()


def test_default_is_table_5_as_the_contract_lists_it() -> None:
    assert scenario_to_dict(DEFAULT) == {
        "schema": 1,
        "name": "table5",
        "duration": 2.0,
        "human": {
            "stature": 1.75,
            "mass": 75.0,
            "sex": "male",
            "grasp": "point",
            "max_grasp_moment": 10.0,
            "grasp_turn_deg": 30.0,
            "contact": "grip",
            "friction": 0.5,
        },
        "robot": {
            "model": "sawyer",
            "base_height": 0.915,
            "tool": {"length": 0.15, "mass": 0.4},
            "grasp": "point",
            "max_grasp_moment": 5.0,
            "grasp_turn_deg": 30.0,
        },
        "table": {"mass": 2.0, "depth": 0.45, "width": 0.31, "height": 0.02},
        "task": {
            "standing_distance": 1.9,
            "rest": "velocity",
            "start": {"height": 0.9, "human_distance": 0.40, "pitch_deg": 0.0},
            "end": {"height": 1.4, "human_distance": 0.40, "pitch_deg": 0.0},
        },
        "objective": {"human_weight": 1.0, "robot_weight": 1.0, "acceleration_weight": 0.5, "force_weight": 0.01},
        "limits": {
            "table_roll_deg": 10.0,
            "table_pitch_deg": 10.0,
            "table_yaw_deg": 10.0,
            "max_grasp_force": 200.0,
            "balance_tolerance": 0.0,
        },
        "solver": {
            "name": "banded",
            "intervals": 20,
            "starts": 4,
            "tries": 48,
            "tolerance": 1e-6,
            "seed": 0,
            "workers": 2,
            "time_limit": 50.0,
        },
        "refine": {"on": False, "objective_error": 0.02, "closure": 1e-4, "balance": 0.1, "torque_excess": 0.1},
    }


def test_shipped_scenarios_differ_in_the_reading_of_table_5_only() -> None:
    assert shipped_scenarios() == ("table5", "table5_free", "table5_near")
    near = with_overrides(DEFAULT, ["task.standing_distance=1.70", "name=table5_near"])
    assert load_scenario("table5_near") == near
    free = ["task.start.human_distance=free", "task.end.human_distance=free", "name=table5_free"]
    assert load_scenario("table5_free") == with_overrides(DEFAULT, free)
    assert load_scenario("table5_free").task.start.human_distance is None


def _required_only() -> dict[str, object]:
    data = scenario_to_dict(DEFAULT)
    for section in ("objective", "limits", "solver", "refine", "name"):
        del data[section]
    del data["robot"]["base_height"], data["robot"]["tool"]
    return data


def test_what_the_contract_does_not_require_has_the_values_of_table_5(tmp_path: Path) -> None:
    scenario = scenario_from_dict(_required_only())
    assert dataclasses.replace(scenario, name="table5") == DEFAULT
    assert with_overrides(scenario, ["robot.tool.length=0.2"]).robot.tool.mass == 0.4


@pytest.mark.parametrize(
    "key",
    [
        "schema",
        "duration",
        "human",
        "robot",
        "table",
        "task",
        "human.stature",
        "human.sex",
        "robot.model",
        "table.height",
        "task.standing_distance",
        "task.start",
        "task.end.human_distance",
        "task.start.height",
    ],
)
def test_missing_key_is_named(key: str) -> None:
    data = _required_only()
    *outer, last = key.split(".")
    inner = data
    for part in outer:
        inner = inner[part]  # type: ignore[assignment]
    del inner[last]
    with pytest.raises(InputError, match=f"^{re.escape(key)}: is missing; must be ") as caught:
        scenario_from_dict(data)
    assert caught.value.key == key


def _leaves(of: type, prefix: str = "") -> list[tuple[str, object]]:
    found: list[tuple[str, object]] = []
    for entry in entries(of):
        key = prefix + entry.name
        found += _leaves(entry.kind.of, f"{key}.") if isinstance(entry.kind, Section) else [(key, entry.kind)]
    return found


LEAVES = _leaves(Scenario)
NUMBERS = [(key, kind) for key, kind in LEAVES if isinstance(kind, (Number, Whole))]


@pytest.mark.parametrize(("key", "kind"), NUMBERS, ids=[key for key, _ in NUMBERS])
def test_every_number_refuses_all_but_finite_numbers_in_its_range(key: str, kind: Number | Whole) -> None:
    bad = [
        "nan",
        "inf",
        "-inf",
        "true",
        '"1"',
        "[1.0]",
        "{}",
        "1979-05-27",
        f"{2 * kind.high + 1!r}",
        f"{kind.low - 1e-3!r}",
    ]
    for value in bad:
        with pytest.raises(InputError, match=f"^{re.escape(key)} = .*: must be a (whole )?number") as caught:
            with_overrides(DEFAULT, [f"{key}={value}"])
        assert "\n" not in str(caught.value)
    others = ["task.standing_distance=4", "objective.human_weight=1", "limits.table_pitch_deg=60"]
    with_overrides(DEFAULT, [*others, f"{key}={kind.high!r}"])


@pytest.mark.parametrize("statement", ["human.stature=1.2", "human.stature=2.2", "table.mass=0.05", "table.mass=50"])
def test_ends_of_the_ranges_are_allowed(statement: str) -> None:
    with_overrides(DEFAULT, [statement])


def test_zero_is_no_grasp_force_limit_but_a_bare_flange() -> None:
    with pytest.raises(InputError, match="above 0"):
        with_overrides(DEFAULT, ["limits.max_grasp_force=0"])
    assert with_overrides(DEFAULT, ["robot.tool={length=0, mass=0}"]).robot.tool.length == 0.0


def test_whole_numbers_are_taken_where_numbers_are_and_kept_as_floats() -> None:
    mass = with_overrides(DEFAULT, ["table.mass=3"]).table.mass
    assert mass == 3.0
    assert isinstance(mass, float)
    with pytest.raises(InputError, match=r"solver\.intervals = 20\.0: must be a whole number from 6 to 400"):
        with_overrides(DEFAULT, ["solver.intervals=20.0"])


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("table.mas=3", r"^table\.mas = 3: unknown key; did you mean table\.mass\?"),
        ("tabel.mass=3", r"^tabel\.mass = 3: unknown key; did you mean table\.mass\?"),
        ("foo=3", "^foo = 3: unknown key; known here: schema, name, duration"),
        ("human.sex=femal", r"^human\.sex = 'femal': must be \"male\" or \"female\""),
        ("robot.model=ur5", r"^robot\.model = 'ur5': must be \"sawyer\""),
        ("schema=2", "^schema = 2: must be 1"),
        ("schema=true", "^schema = True: must be 1"),
        ("table=3", "^table = 3: must be a section with the keys mass, depth, width, height"),
        ("table.mass.x=3", r"^table\.mass\.x: table\.mass is a value, not a section"),
        ("name=../up", "^name = '../up': must be 1 to 64 letters"),
        ("name=", "^name = ''"),
        ("table.mass", "^--set = 'table.mass': must be KEY=VALUE"),
        ("table..mass=3", "^--set = "),
        ("table.mass=3kg", r"^table.mass = '3kg': must be a number from 0.05 to 50 kg .*; write 3$"),
        ("table.mass=3\nduration=1", "^table.mass = "),
        ("task.start.human_distance=1.5", "must be below 1.45 m, or the object reaches behind the robot's base"),
        (
            "task.end.pitch_deg=11",
            r"^task\.end\.pitch_deg = 11.0: must be from -10 to 10 deg, or raise ",
        ),
        ("task.start.human_distance=far", 'must be a number from 0 to 2 m, or "free"'),
        ("table.mass=0x" + "f" * 5000, "^table.mass = an integer of thousands of digits: must be"),
    ],
)
def test_wrong_entry_is_named_with_what_is_allowed(statement: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        with_overrides(DEFAULT, [statement])
    assert len(str(caught.value)) < 300


def test_objective_without_any_weight_is_refused() -> None:
    zeros = [f"objective.{entry.name}=0" for entry in entries(Objective)]
    with pytest.raises(InputError, match="at least one weight"):
        with_overrides(DEFAULT, zeros)
    with_overrides(DEFAULT, zeros[1:])


def test_an_invalid_scenario_cannot_be_made_in_python_either() -> None:
    with pytest.raises(InputError, match=r"human\.mass = nan"):
        dataclasses.replace(DEFAULT, human=Human(stature=1.75, mass=math.nan, sex="male"))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\xff\xfe\x00s", "is not UTF-8 text"),
        (b"schema = 1\n\0", "is a binary file"),
        (b"schema = = 1", "is not valid TOML"),
        (b"schema = " + b"[" * 50_000, "is not valid TOML"),
        (b"schema = " + b"9" * 5000, "is not valid TOML"),
        (b"schema = 1\nschema = 1", "is not valid TOML"),
        (b"#" * 100_001, "is larger than 100000 bytes"),
        (b"", "schema: is missing"),
    ],
)
def test_unreadable_content_is_one_clear_error(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "bad.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        load_scenario(path)
    assert "\n" not in str(caught.value)


def test_unreadable_paths_are_one_clear_error(tmp_path: Path) -> None:
    for path, message in [
        (tmp_path, "is not a file"),
        (tmp_path / "none.toml", "no such file, nor a shipped scenario"),
        ("tabel5", r"no such file, nor a shipped scenario \(table5, table5_free, table5_near\)"),
        ("/dev/zero", "is not a file"),
        ("x" * 5000, "cannot be read: File name too long"),
        ("a\0b", "cannot be read"),
    ]:
        with pytest.raises(InputError, match=message):
            load_scenario(path)


def test_a_file_with_windows_line_ends_and_byte_order_mark_is_read_and_named_after_its_file(tmp_path: Path) -> None:
    text = "\n".join(line for line in scenario_to_toml(DEFAULT).splitlines() if not line.startswith("name"))
    path = tmp_path / "our lab.toml"
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert load_scenario(path) == with_overrides(DEFAULT, ["name=our lab"])


def test_overrides_complete_a_file_and_the_later_one_wins(tmp_path: Path) -> None:
    path = tmp_path / "part.toml"
    path.write_text(scenario_to_toml(DEFAULT).replace("mass = 75.0", ""))
    assert load_scenario(path, ["human.mass=60", "human.mass=61.5"]).human.mass == 61.5


def test_overrides_leave_the_scenario_as_it_was() -> None:
    before = scenario_to_dict(DEFAULT)
    with_overrides(DEFAULT, ["task.end.height=1.2", "robot.tool.mass=1"])
    assert scenario_to_dict(DEFAULT) == before


def test_help_lists_every_key_the_contract_has() -> None:
    assert [key for key, _ in describe(Scenario)] == [key for key, _ in LEAVES]
    text = dict(describe(Scenario))
    assert text["limits.max_grasp_force"].endswith("a number above 0 and at most 10000 N; default 200.0")


def _floats(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False, exclude_min=True)


@settings(deadline=None, max_examples=50)
@given(
    mass=_floats(0.05, 50.0),
    height=_floats(0.05, 2.2),
    distance=st.none() | st.floats(0.0, 1.4),
    tolerance=_floats(1e-10, 1e-3),
    seed=st.integers(0, 2**32 - 1),
    name=st.from_regex(r"[A-Za-z0-9][A-Za-z0-9 _.+-]{0,20}[A-Za-z0-9é]", fullmatch=True),
)
def test_toml_round_trip_is_exact(
    mass: float, height: float, distance: float | None, tolerance: float, seed: int, name: str
) -> None:
    task = dataclasses.replace(
        DEFAULT.task, end=dataclasses.replace(DEFAULT.task.end, height=height, human_distance=distance)
    )
    scenario = dataclasses.replace(
        DEFAULT,
        name=name,
        task=task,
        table=dataclasses.replace(DEFAULT.table, mass=mass),
        solver=dataclasses.replace(DEFAULT.solver, tolerance=tolerance, seed=seed),
    )
    assert scenario_from_dict(tomllib.loads(scenario_to_toml(scenario))) == scenario
