"""Other teams from end to end: solved, saved, loaded, reported, played and plotted; everybody by name.

Oracles are Pinocchio on the written URDFs, Newton's law, and what was written. Kernels of models that are not shipped
are evaluated by CasADi's virtual machine, which takes less time than compiling them.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import pytest
import xarray as xr
from matplotlib.figure import Figure

import liftopt as lo
from liftopt.commands.cli import main

pytestmark = pytest.mark.long
TEAMS = {
    "two_people": {"anna": "person", "ben": "person"},
    "person_two_sawyers": {"human": "person", "left": "robot", "right": "robot"},
    "two_sawyers": {"near": "robot", "far": "robot"},
    "one_person": {"sam": "person"},
}
KINDS = {"person": "human", "robot": "robot"}  # as figures are called where one of a kind lifts
FILES = Path(__file__).parents[1] / "scenario" / "teams"
CHEAP = {"solver.intervals": 10, "solver.starts": 1, "solver.tries": 4}
# These need more starts than that to be clear.
OVERLAPPING = {"limits.clearance": "off"}
CLEAR = ("two_people", "two_sawyers")
GRAVITY = np.array([0.0, 0.0, -9.81])


class Lifted(NamedTuple):
    """A lift, solved for real, and the folder it was saved in."""

    team: str
    solution: lo.Solution
    folder: Path


@pytest.fixture(scope="module")
def cheaply() -> Iterator[None]:
    """Neither compile kernels nor shade many pixels of snapshots."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("liftopt.viz.plots_snapshots.PANEL", (120, 95))
        patch.setenv("CC", "")
        patch.setenv("LIFTOPT_CACHE", "/dev/null/none")
        yield


@pytest.fixture(scope="module", params=TEAMS)
def lifted(request: pytest.FixtureRequest, cheaply: None, tmp_path_factory: pytest.TempPathFactory) -> Lifted:
    """The lift of one team."""
    changes = CHEAP if request.param in CLEAR else CHEAP | OVERLAPPING
    solution = lo.solve(lo.load_scenario(FILES / f"{request.param}.toml", changes))
    return Lifted(request.param, solution, solution.save(tmp_path_factory.mktemp(request.param)))


def run(capsys: pytest.CaptureFixture[str], *command: str | Path) -> str:
    """Return what a command prints that must do what it is asked."""
    assert main([str(word) for word in command]) == 0
    return capsys.readouterr().out


def test_it_is_solved_and_verified(lifted: Lifted) -> None:
    solution = lifted.solution
    assert solution.status == "solved"
    assert {agent.name: agent.kind for agent in solution.agents} == TEAMS[lifted.team]
    assert set(solution.objective_terms) == {*TEAMS[lifted.team], "acceleration", "force"}
    verdicts = [(verdict.subject, verdict.agent) for verdict in solution.assessment.verdicts]
    assert verdicts == sorted(verdicts, key=lambda verdict: verdict[0] == "mathematics")
    assert {agent for _, agent in verdicts} >= set(TEAMS[lifted.team])


def test_the_forces_of_all_carry_the_object_and_every_hand_holds_it(lifted: Lifted) -> None:
    """Newton's law for the object, and forward kinematics of the models that were written."""
    result = xr.load_dataset(lifted.folder / "solution.nc", engine="h5netcdf")
    scenario = lifted.solution.scenario
    name, files = scenario.object.name, {"human": "human_arm"}
    acceleration = result[f"{name}_acceleration"].values[:, :3]
    carried = result["grasp_force"].sum("grasp").values
    np.testing.assert_allclose(carried, scenario.object.mass * (acceleration - GRAVITY), rtol=0.0, atol=1e-6)
    for agent in scenario.agents:
        model = pin.buildModelFromUrdf(str(lifted.folder / "models" / f"{files.get(agent, agent)}.urdf"))
        assert all(joint.startswith(f"{agent}_") for joint in model.names[1:])
        data, frame = model.createData(), model.getFrameId(f"{agent}_grasp")
        for q, point in zip(result[f"{agent}_q"].values, result["grasp_position"].sel(grasp=agent).values, strict=True):
            pin.framesForwardKinematics(model, data, q)
            np.testing.assert_allclose(data.oMf[frame].translation, point, rtol=0.0, atol=1e-3)


def test_what_is_loaded_is_what_was_saved(lifted: Lifted) -> None:
    again, saved = lo.load(lifted.folder), lifted.solution
    xr.testing.assert_identical(again.to_xarray(), saved.to_xarray())
    assert again.scenario == saved.scenario
    assert again.assessment == saved.assessment
    assert [agent.name for agent in again.persons] == [agent.name for agent in saved.persons]
    assert [agent.name for agent in again.robots] == [agent.name for agent in saved.robots]
    for agent in TEAMS[lifted.team]:
        np.testing.assert_array_equal(again[agent].tau, saved[agent].tau)


def test_the_ground_acts_on_the_first_person_if_there_is_one(lifted: Lifted) -> None:
    solution = lifted.solution
    if solution.persons:
        np.testing.assert_array_equal(solution.ground_reaction_force, solution.persons[0].ground_force)
        np.testing.assert_array_equal(solution.ground_reaction_moment, solution.persons[0].ground_moment)
        return
    for read in ("ground_reaction_force", "ground_reaction_moment"):
        with pytest.raises(lo.InputError, match="by robots alone"):
            getattr(solution, read)


def test_the_report_and_the_playback_tell_everybody_by_name(
    lifted: Lifted, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A name stands where several are of a kind."""
    report, played = tmp_path / "lift.html", tmp_path / "played.html"
    lo.load(lifted.folder).report(report)
    run(capsys, "view", lifted.folder, "--html", played)
    pages = [page.read_text(encoding="utf-8") for page in (report, played)]
    kinds = list(TEAMS[lifted.team].values())
    for name, kind in TEAMS[lifted.team].items():
        if kinds.count(kind) > 1:
            assert f"{kind.capitalize()}: {name}" in pages[0]
            assert f'"{name}"' in pages[1]
        else:
            assert f"<h2>{kind.capitalize()}</h2>" in pages[0]
    lead = re.findall(r'<p class="lead">(.*?)</p>', pages[0], re.DOTALL)[0]
    assert ("together" in lead) == (len(kinds) > 1)
    assert re.search(r"\blifts? a\b", lead)[0] == ("lift a" if len(kinds) > 1 else "lifts a")
    for page in pages:
        assert page.rstrip().endswith("</html>")


def test_mujoco_agrees(lifted: Lifted, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mujoco")
    told = run(capsys, "crosscheck", lifted.folder)
    assert told.endswith("The solved motion holds.\n")
    for name in TEAMS[lifted.team]:
        assert f"MuJoCo inverse dynamics, {name} " in told


def test_plots_are_everybodys(
    lifted: Lifted, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the names of their files; the report has drawn each of them."""
    monkeypatch.setattr("liftopt.viz.plots.drawn", lambda *_: Figure())
    run(capsys, "plot", lifted.folder, "--out", tmp_path, "--format", "svg")
    plots = {file.stem for file in tmp_path.iterdir()}
    team = TEAMS[lifted.team]
    kinds = list(team.values())
    names = [name if kinds.count(kind) > 1 else KINDS[kind] for name, kind in team.items()]
    assert plots >= {f"{name}_{what}" for name in names for what in ("angles", "torques")}
    assert plots >= {"grasp_forces", "object_motion", "snapshots"}
    walked_on = [plot for plot in plots if plot.endswith("ground_reaction")]
    assert len(walked_on) == kinds.count("person")


def test_a_result_solves_again_and_tells_everybody(
    lifted: Lifted, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told = json.loads(run(capsys, "solve", lifted.folder, "--out", tmp_path, "--json"))
    team = TEAMS[lifted.team]
    assert told["solved"]
    assert told["objective"]["total"] == pytest.approx(lifted.solution.objective, rel=1e-12)
    assert list(told["joints"]) == list(told["load_share"]["agents"]) == list(team)
    for name in team:
        assert told["objective"]["terms"][name]["integral"] > 0.0
