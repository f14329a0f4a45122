"""Scenario files: oracle is the contract's list of keys, ranges and refusals."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic.fields import FieldInfo

from liftopt.errors import InputError
from liftopt.files.entries import kinds_of, range_of
from liftopt.files.toml_text import toml
from liftopt.scenario.agents import Person
from liftopt.scenario.file import shipped_scenarios
from liftopt.scenario.listing import DEFAULT_TEAM, describe, fields_of
from liftopt.scenario.model import Scenario, load_scenario, scenario_from_dict
from liftopt.scenario.presets import NATURAL

DEFAULT = load_scenario()


def changed(*statements: str) -> Scenario:
    """Return table5 with entries changed as on the command line."""
    return load_scenario("table5", statements)


def test_default_is_table_5_as_the_contract_lists_it() -> None:
    assert DEFAULT.to_dict() == {
        "schema": 2,
        "name": "table5",
        "duration": 2.0,
        "agents": {
            "human": {
                "kind": "person",
                "stature": 1.75,
                "mass": 75.0,
                "sex": "male",
                "body": "arm",
                "hands": ["right"],
                "max_grasp_moment": 10.0,
                "contact": "grip",
                "friction": 0.5,
                **NATURAL["person"],
            },
            "robot": {
                "kind": "robot",
                "model": "sawyer",
                "base_height": 0.915,
                "base": {"y": 0.0, "roll_deg": 0.0, "pitch_deg": 0.0, "yaw_deg": 180.0},
                "tool": {"length": 0.15, "mass": 0.4, "turn_deg": 0.0},
                "max_grasp_moment": 5.0,
                "grasp_turn_deg": 30.0,
                **NATURAL["robot"],
            },
        },
        "object": {"name": "table", "mass": 2.0, "depth": 0.45, "width": 0.31, "height": 0.02},
        "task": {
            "standing_distance": 1.9,
            "rest": "velocity",
            "start": {"height": 0.9, "human_distance": 0.40, "pitch_deg": 0.0},
            "end": {"height": 1.4, "human_distance": 0.40, "pitch_deg": 0.0},
        },
        "objective": {"preset": "natural", "spine_weight": 0.0, **NATURAL["objective"]},
        "limits": {
            "table_roll_deg": 10.0,
            "table_pitch_deg": 10.0,
            "table_yaw_deg": 10.0,
            "max_grasp_force": 200.0,
            "balance_tolerance": 0.0,
            "clearance": 0.0,
            "spine_compression": "off",
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
        "refine": {
            "on": False,
            "objective_error": 0.02,
            "closure": 1e-4,
            "balance": 0.1,
            "torque_excess": 0.1,
            "compression_excess": 10.0,
        },
    }


def test_shipped_scenarios_of_table_5_differ_in_its_reading_and_in_the_objective_only() -> None:
    readings = ("table5", "table5_bare", "table5_free", "table5_near", "table5_paper")
    assert shipped_scenarios() == ("floor_box", "pallet", *readings, "two_people")
    assert load_scenario("table5_near") == changed("task.standing_distance=1.70", "name=table5_near")
    free = ["task.start.human_distance=free", "task.end.human_distance=free", "name=table5_free"]
    assert load_scenario("table5_free") == changed(*free)
    assert load_scenario("table5_free").task.start.human_distance is None
    paper = changed("objective.preset=paper", "limits.clearance=off", "name=table5_paper")
    assert load_scenario("table5_paper") == paper
    bare = {"objective.acceleration_weight": 0.0, "objective.force_weight": 0.0, "limits.balance_tolerance": 1.0}
    assert load_scenario("table5_bare") == paper.replace({**bare, "name": "table5_bare"})


def _required_only() -> dict[str, Any]:
    data = DEFAULT.to_dict()
    for section in ("objective", "limits", "solver", "refine", "name"):
        del data[section]
    for agent in data["agents"].values():
        del agent["weight"], agent["grasp"], agent["grasp_turn_deg"]
    del data["agents"]["robot"]["base_height"], data["agents"]["robot"]["tool"], data["agents"]["robot"]["base"]
    return data


def test_what_the_contract_does_not_require_has_the_values_of_table_5(tmp_path: Path) -> None:
    scenario = scenario_from_dict(_required_only())
    assert scenario.replace({"name": "table5"}) == DEFAULT
    assert scenario.replace({"robot.tool.length": 0.2}).value("robot.tool.mass") == 0.4


@pytest.mark.parametrize(
    "key",
    [
        "schema",
        "duration",
        "agents",
        "object",
        "task",
        "human.kind",
        "human.stature",
        "human.sex",
        "robot.model",
        "object.height",
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
    for part in ["agents", *outer] if outer and outer[0] in DEFAULT.agents else outer:
        inner = inner[part]
    del inner[last]
    with pytest.raises(InputError, match=f"^{re.escape(key)}: is missing; must be ") as caught:
        scenario_from_dict(data)
    assert caught.value.key == key


NUMBERS = [(key, field) for key, field in fields_of(Scenario, DEFAULT_TEAM) if kinds_of(field) in ((float,), (int,))]


@pytest.mark.parametrize(("key", "field"), NUMBERS, ids=[key for key, _ in NUMBERS])
def test_every_number_refuses_all_but_finite_numbers_in_its_range(key: str, field: FieldInfo) -> None:
    low, high, _ = range_of(field)
    own = [f"{key[:-2]}={{x=0.6, z=0.9}}"] if key.startswith("task.") and key[-2:] in (".x", ".y", ".z") else []
    own += ["robot.model=arm.urdf"] if key in ("robot.base.roll_deg", "robot.base.pitch_deg") else []
    own += ["human.body=whole"] if key == "limits.spine_compression" else []
    bad = [
        "nan",
        "inf",
        "-inf",
        "true",
        '"1"',
        "[1.0]",
        "{}",
        "1979-05-27",
        f"{2 * high + 1!r}",
        f"{low - 1e-3!r}",
    ]
    for value in bad:
        with pytest.raises(InputError, match=f"^{re.escape(key)} = .*: must be a (whole )?number") as caught:
            changed(*own, f"{key}={value}")
        assert "\n" not in str(caught.value)
    others = ["task.standing_distance=4", "human.weight=1", "limits.table_pitch_deg=60"]
    changed(*others, *own, f"{key}={high!r}")


@pytest.mark.parametrize("statement", ["human.stature=1.2", "human.stature=2.2", "object.mass=0.05", "object.mass=50"])
def test_ends_of_the_ranges_are_allowed(statement: str) -> None:
    changed(statement)


def test_zero_is_no_grasp_force_limit_but_a_bare_flange() -> None:
    with pytest.raises(InputError, match="above 0"):
        changed("limits.max_grasp_force=0")
    assert changed("robot.tool={length=0, mass=0}").value("robot.tool.length") == 0.0


def test_whole_numbers_are_taken_where_numbers_are_and_kept_as_floats() -> None:
    mass = changed("object.mass=3").object.mass
    assert mass == 3.0
    assert isinstance(mass, float)
    with pytest.raises(InputError, match=r"solver\.intervals = 20\.0: must be a whole number from 6 to 400"):
        changed("solver.intervals=20.0")


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("table.mas=3", r"^object\.mas = 3: unknown key; did you mean object\.mass\?"),
        ("tabel.mass=3", r"^tabel\.mass = 3: unknown key; did you mean object\.mass\?"),
        ("foo=3", "^foo = 3: unknown key; known here: schema, name, duration"),
        ("human.sex=femal", r"^human\.sex = 'femal': must be \"male\" or \"female\""),
        (
            "robot.model=ur55",
            r"^robot\.model = 'ur55': must be a name that \"liftopt robots\" lists, .* mean ur5",
        ),
        ("robot.locked.right_j0=1.0", r"^robot\.locked = 'right_j0': goes with other models than sawyer"),
        ("robot.base.pitch_deg=90.0", r"^robot\.base\.pitch_deg = 90\.0: must be 0 for sawyer"),
        ("schema=1", "^schema = 1: must be 2"),
        ("schema=true", "^schema = True: must be 2"),
        ("table=3", "^object = 3: must be a section with the keys name, mass, depth, width, height"),
        ("object.mass.x=3", r"^object\.mass\.x: object\.mass is a value, not a section"),
        ("name=../up", "^name = '../up': must be 1 to 64 letters"),
        ("name=", "^name = ''"),
        ("object.mass", "^--set = 'object.mass': must be KEY=VALUE"),
        ("table..mass=3", "^--set = "),
        ("object.mass=3kg", r"^object.mass = '3kg': must be a number from 0.05 to 50 kg .*; write 3$"),
        ("object.mass=3\nduration=1", "^object.mass = "),
        ("task.start.human_distance=1.5", "must be below 1.45 m, or the object reaches behind the robot's base"),
        (
            "task.end.pitch_deg=11",
            r"^task\.end\.pitch_deg = 11.0: must be from -10 to 10 deg, or raise ",
        ),
        ("task.start.human_distance=far", 'must be a number from 0 to 2 m, or "free"'),
        ("object.mass=0x" + "f" * 5000, "^object.mass = an integer of thousands of digits: must be"),
    ],
)
def test_wrong_entry_is_named_with_what_is_allowed(statement: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        changed(statement)
    assert len(str(caught.value)) < 300


def test_objective_without_any_weight_is_refused() -> None:
    zeros = [f"{key}=0" for key, _ in fields_of(Scenario, DEFAULT_TEAM) if key.endswith("weight")]
    with pytest.raises(InputError, match="at least one weight"):
        changed(*zeros)
    changed(*zeros[1:])


def test_an_invalid_scenario_cannot_be_made_in_python_either() -> None:
    with pytest.raises(InputError, match=r"^mass = nan: must be a number from 30 to 200 kg"):
        Person(stature=1.75, mass=math.nan, sex="male")
    with pytest.raises(InputError, match=r"^human\.mass = nan"):
        DEFAULT.replace({"human.mass": math.nan})


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\xff\xfe\x00s", "is not UTF-8 text"),
        (b"schema = 2\n\0", "is a binary file"),
        (b"schema = = 1", "is not valid TOML"),
        (b"schema = " + b"[" * 50_000, "is not valid TOML"),
        (b"schema = " + b"9" * 5000, "is not valid TOML"),
        (b"schema = 2\nschema = 2", "is not valid TOML"),
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
        (
            "tabel5",
            r"no such file, nor a shipped scenario \(floor_box, pallet, table5, .*, table5_paper, two_people\)",
        ),
        ("/dev/zero", "is not a file"),
        ("x" * 5000, "cannot be read: File name too long"),
        ("a\0b", "cannot be read"),
    ]:
        with pytest.raises(InputError, match=message):
            load_scenario(path)


def test_a_file_with_windows_line_ends_and_byte_order_mark_is_read_and_named_after_its_file(tmp_path: Path) -> None:
    text = "\n".join(line for line in DEFAULT.to_toml().splitlines() if not line.startswith("name"))
    path = tmp_path / "our lab.toml"
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert load_scenario(path) == changed("name=our lab")


def test_overrides_complete_a_file_and_the_later_one_wins(tmp_path: Path) -> None:
    path = tmp_path / "part.toml"
    path.write_text(DEFAULT.to_toml().replace("mass = 75.0", ""))
    assert load_scenario(path, ["human.mass=60", "human.mass=61.5"]).value("human.mass") == 61.5


def test_overrides_leave_the_scenario_as_it_was() -> None:
    before = DEFAULT.to_dict()
    changed("task.end.height=1.2", "robot.tool.mass=1")
    assert DEFAULT.to_dict() == before


def test_help_lists_every_key_the_contract_has() -> None:
    text = dict(DEFAULT.describe())
    assert ["schema", *(key for key, _ in describe(Scenario, DEFAULT_TEAM))] == list(text)
    assert {"human.stature", "robot.tool.length", "object.mass", "task.end.pitch_deg", "refine.on"} <= set(text)
    assert text["limits.max_grasp_force"].endswith("a number above 0 and at most 10000 N; default 200.0")


@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much])
@given(data=st.data())
def test_tables_of_allowed_entries_make_a_scenario_or_a_reason_and_toml_gives_it_back(
    data: st.DataObject, scenario_tables: st.SearchStrategy[dict[str, Any]]
) -> None:
    try:
        scenario = scenario_from_dict(data.draw(scenario_tables))
    except InputError as error:
        assert "\n" not in str(error)
        assert error.key.split(".")[0] in {*DEFAULT.to_dict(), *DEFAULT.agents, "obstacles"}
        return
    again = scenario_from_dict(toml(scenario.to_toml()))
    assert again == scenario
    assert hash(again) == hash(scenario)
    assert again.to_toml() == scenario.to_toml()
