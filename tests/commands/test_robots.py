"""``liftopt robots``. Oracle: exit statuses and streams of the contract, and an arm written here by hand."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("yourdfpy")

from liftopt.collocation.solvers.deadline import Deadline
from liftopt.commands.cli import main
from liftopt.multibody.robots.catalogue import known_robots
from liftopt.scenario.build import motions_of
from liftopt.scenario.model import load_scenario
from liftopt.search.cache import SolverCache
from liftopt.search.feasibility_screen import screen_ends

ROOT = Path(__file__).parents[2]
BODY = '<inertial><mass value="2"/><inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    parents = ("base", "l1", "l2")
    joints = "".join(
        f'<link name="l{n}">{BODY}</link><joint name="j{n}" type="revolute"><parent link="{parents[n - 1]}"/>'
        f'<child link="l{n}"/><origin xyz="0 0 0.4"/><axis xyz="0 {n % 2} {(n + 1) % 2}"/>'
        f'<limit lower="-2" upper="2" velocity="2" effort="{60 - n}"/></joint>'
        for n in (1, 2, 3)
    )
    path = tmp_path / "arm.urdf"
    path.write_text(f'<robot name="arm"><link name="base"/>{joints}</robot>')
    return path


def _json(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def test_the_list_has_every_known_robot(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots"]) == 0
    out = capsys.readouterr().out
    assert all(re.search(rf"^{name} ", out, re.MULTILINE) for name in known_robots())
    assert main(["robots", "--json"]) == 0
    listed = _json(capsys)
    assert [robot["name"] for robot in listed["robots"]] == list(known_robots())
    assert listed["robots"][0]["installed"] is True


def test_a_sound_file_ends_with_0(urdf: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots", str(urdf)]) == 0
    out, err = capsys.readouterr()
    assert out.startswith(f"arm, from {urdf}\n")
    assert "Assumed: grasp_frame = l3: proposed, it is the end of 3 joints" in out
    assert out.endswith("It can lift with these data.\n")
    assert err == ""


def test_a_faulty_file_ends_with_3_and_the_fix(urdf: Path, capsys: pytest.CaptureFixture[str]) -> None:
    urdf.write_text(urdf.read_text().replace('effort="58"', 'effort="0"'))
    assert main(["robots", str(urdf)]) == 3
    out = capsys.readouterr().out
    assert "Refused: joint j2: effort = 0.0: must be positive, and at most 1e+06; give limits.j2.effort" in out
    assert out.endswith("It cannot lift with these data.\n")
    assert main(["robots", str(urdf), "--json"]) == 3
    told = _json(capsys)
    assert (told["usable"], told["exit_status"], told["findings"][0]["severity"]) == (False, 3, "refused")


def test_one_line_tells_what_several_joints_lack(urdf: Path, capsys: pytest.CaptureFixture[str]) -> None:
    urdf.write_text(re.sub(r'effort="5\d"', 'effort="0"', urdf.read_text()))
    assert main(["robots", str(urdf)]) == 3
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("Refused")]
    assert len(lines) == 1 and lines[0].endswith("(and joint j2: effort, joint j3: effort)")


def test_options_choose_base_frame_and_locked_joints(urdf: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["robots", str(urdf), "--base", "l1", "--grasp-frame", "l3", "--lock", "j3=0.5", "--json"]
    assert main(words) == 0
    told = _json(capsys)
    assert [joint["name"] for joint in told["joints"]] == ["j2"]
    assert (told["base"], told["grasp_frame"], told["held"]) == ("l1", "l3", {"j3": 0.5})
    assert told["reach_m"] == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["nobody"], "robot = 'nobody': must be a name that `liftopt robots` lists"),
        (["--base", "l1"], "--base = 'l1': needs a ROBOT"),
        (["sawyer", "--grasp-frame", "x"], "--grasp-frame = 'x': goes with a file"),
        (["FILE", "--lock", "j3"], "--lock = 'j3': must be NAME=VALUE"),
        (["FILE", "--lock", "j3=half"], "--lock j3 = 'half': must be a number"),
        (["FILE", "--grasp-frame", "l9"], "it has no link of this name"),
    ],
)
def test_bad_input_is_one_line(words: list[str], told: str, urdf: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots", *(str(urdf) if word == "FILE" else word for word in words)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("liftopt: error: ") and err.count("\n") == 1 and told in err


def test_every_key_of_the_json_is_documented(urdf: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = (ROOT / "docs" / "files" / "json.md").read_text(encoding="utf-8")
    documented = set(re.findall(r"^\| `([^`]+)` \|", page, flags=re.MULTILINE))
    main(["robots", str(urdf), "--json"])
    told = _json(capsys)
    main(["robots", "--json"])
    listed = _json(capsys)
    keys = {key for key in (*told, *listed) if key not in ("joints", "findings", "robots")}
    for many in ("joints", "findings", "robots"):
        keys |= {f"{many}[].{key}" for key in (told | listed)[many][0]}
    assert documented == keys


def test_help_and_the_list_load_no_reader() -> None:
    """The reader of URDFs takes a second to import; a list of names needs none."""
    code = "import sys; from liftopt.commands.cli import main; main(['robots']); print('yourdfpy' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd="/")
    assert run.stdout.splitlines()[-1] == "False"


def test_a_scenario_to_start_from_can_be_held_at_both_ends(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Oracle: the screen of the search, which looks for postures with other seeds here."""
    if not known_robots()["ur5"].is_installed:
        pytest.skip("needs example-robot-data")
    file = tmp_path / "lift.toml"
    assert main(["robots", "ur5", "--scenario", str(file)]) == 0
    assert f"Written to {file}" in capsys.readouterr().out
    scenario = load_scenario(file)
    problem = SolverCache().problem(scenario, motions_of(scenario))
    assert screen_ends(problem, 1, Deadline())[0] == []
    assert main(["robots", "ur5", "--scenario", str(file)]) == 2
    assert "exists already" in capsys.readouterr().err
