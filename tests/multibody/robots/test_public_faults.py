"""Robots with faults of public threads: each ends as the table in the documentation says, and not in silence."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("yourdfpy")

from liftopt.errors import InputError
from liftopt.multibody.robots.examination import examined
from liftopt.multibody.robots.given_limits import GivenLimits
from liftopt.multibody.robots.read_robot import read_robot
from liftopt.multibody.robots.robot_agent import robot_agent
from liftopt.storage.urdf_check import check_urdf

HERE = Path(__file__).parent / "public_faults"
TABLE = Path(__file__).parents[3] / "docs/tables/faulty_robots.csv"
ROWS = {row["file"]: row for row in csv.DictReader(TABLE.read_text(encoding="utf-8").splitlines())}
OF_ALL = ("grasp.proposed", "solids.tubes")  # these files are without shapes
WORST = ("refused", "warned", "assumed")


def _text(name):
    return (HERE / f"{name}.urdf").read_text(encoding="utf-8")


def _ends(text):
    """Return the outcome and what is found, as the table has it."""
    try:
        findings = [one for one in examined(read_robot(text)).findings if one.code not in OF_ALL]
    except InputError as error:
        return "refused", str(error)
    seen: dict[str, list[str]] = {}
    for one in findings:
        place = re.match(r"(?:link|joint) (\w+)", one.where)
        seen.setdefault(one.code, []).append(place[1] if place else "")
    found = "; ".join(f"{code} {', '.join(where)}".strip() for code, where in seen.items())
    return next((worst for worst in WORST if any(one.severity == worst for one in findings)), "right"), found


def test_every_file_has_its_line_and_its_thread():
    assert sorted(ROWS) == sorted(path.stem for path in HERE.glob("*.urdf"))
    assert all(row["thread"].startswith("https://github.com/") for row in ROWS.values())


@pytest.mark.parametrize("name", ROWS)
def test_a_fault_ends_as_the_table_says(name):
    row, text = ROWS[name], _text(name)
    assert _ends(text) == (row["outcome"], row["found"])
    if row["outcome"] == "refused":
        with pytest.raises(InputError):
            robot_agent(read_robot(text), name="robot", T_world_base=np.eye(4))
    else:
        check_urdf(robot_agent(read_robot(text), name="robot", T_world_base=np.eye(4)).urdf)


@pytest.mark.parametrize("name", [name for name, row in ROWS.items() if row["then"]])
def test_what_the_scenario_may_mend_lifts_then(name):
    then = json.loads(ROWS[name]["then"])
    then["limits"] = {joint: GivenLimits(**given) for joint, given in then.get("limits", {}).items()}
    agent = robot_agent(read_robot(_text(name)), name="robot", T_world_base=np.eye(4), **then)
    check_urdf(agent.urdf)
    assert agent.model.nq == 4 - len(then.get("locked", {}))


def test_moments_of_no_body_are_left_out_where_they_do_not_move():
    """Oracle: the same arm without that link's inertial."""
    text = _text("rows_in_a_triangle")
    start, end = text.index("<inertial>"), text.index("</inertial>") + len("</inertial>")
    without = text[:start] + text[end:]
    agents = [robot_agent(read_robot(one), name="robot", T_world_base=np.eye(4)) for one in (text, without)]
    assert agents[0].urdf == agents[1].urdf


def test_a_thousandfold_mass_or_moment_is_told_of(arm):
    """Masses in grams cannot be held by the arm's motors, moments in g m^2 are those of a body of metres."""
    grams = arm(*((f'<mass value="{n}.0"/>', f'<mass value="{n}000.0"/>') for n in (1, 2, 3, 4)))
    assert "weight.effort" in {one.code for one in examined(read_robot(grams)).findings}
    moments = arm(*((f'ixx="0.02{n}" iyy="0.02" izz="0.01"', f'ixx="2{n}" iyy="20" izz="10"') for n in (1, 2, 3, 4)))
    large = [one.where for one in examined(read_robot(moments)).findings if one.code == "inertia.large"]
    assert large == [f"link l{n}: principal moments" for n in (1, 2, 3, 4)]
