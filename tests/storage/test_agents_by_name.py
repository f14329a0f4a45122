"""Any team on one object, saved and read back: every agent under its own name. The motion is random: it solves nothing.

The oracle is what was written.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from liftopt.multibody.trajectory import agent_trajectory, object_trajectory
from liftopt.scenario.build import agents_of, object_of
from liftopt.scenario.model import Scenario, scenario_from_dict
from liftopt.solution.finding import Assessment, Finding
from liftopt.solution.solution import Solution
from liftopt.solution.summary import summary_dict
from liftopt.storage.dataset import to_xarray
from liftopt.storage.reader import load_result
from liftopt.storage.writer import files_of, save

ANNA = {"kind": "person", "stature": 1.62, "mass": 58.0, "sex": "female"}
BEN = {"kind": "person", "stature": 1.85, "mass": 90.0, "sex": "male", "weight": 0.5}
SAWYER = {"kind": "robot", "model": "sawyer"}
BESIDE = {**SAWYER, "base": {"x": 0.6, "y": -1.4, "yaw_deg": 90.0}}
SIDE = {"grasps": {"second": [0.0, -0.2, -0.05]}}
TEAMS: dict[str, tuple[dict[str, Any], dict[str, Any], list[str]]] = {
    "two people": ({"anna": ANNA, "ben": BEN}, {}, ["anna", "ben", "crate"]),
    "a person and two Sawyers": (
        {"human": ANNA, "robot": SAWYER, "second": BESIDE},
        SIDE,
        ["human_arm", "sawyer", "second", "crate"],
    ),
    "a robot named first, two people": (
        {"arm": SAWYER, "anna": ANNA, "second": {**BEN, "position": [0.6, -1.0], "heading_deg": 90.0}},
        SIDE,
        ["arm", "anna", "second", "crate"],
    ),
}


def scenario_of(agents: dict[str, Any], lifted: dict[str, Any]) -> Scenario:
    """Return Table 5's lift of a crate by others."""
    place = {"human_distance": 0.4, "height": 0.9}
    return scenario_from_dict(
        {
            "schema": 2,
            "duration": 2.0,
            "agents": agents,
            "object": {"name": "crate", "mass": 4.0, "depth": 0.45, "width": 0.4, "height": 0.1, **lifted},
            "task": {"standing_distance": 1.9, "start": place, "end": {**place, "height": 1.3}},
            "objective": {"preset": "paper"},
        }
    )


@pytest.fixture(params=TEAMS)
def written(request: pytest.FixtureRequest, kept: Any) -> Solution:
    """A motion of one team, whose other figures are borrowed."""
    scenario, rng = scenario_of(*TEAMS[request.param][:2]), np.random.default_rng(1)
    agents, lifted, knots = agents_of(scenario), object_of(scenario), len(kept.solution.time)
    forces = rng.normal(size=(knots, len(agents), 3)) * 50.0
    moves = [rng.normal(size=(3, knots, len(agent.moving_joints))) for agent in agents]
    names = [*scenario.agents, "acceleration", "force"]
    return dataclasses.replace(
        kept.solution,
        scenario=scenario,
        agents=tuple(agent_trajectory(a, *m, forces[:, i]) for i, (a, m) in enumerate(zip(agents, moves, strict=True))),
        object=object_trajectory(lifted, *rng.normal(size=(3, knots, 6)), forces.reshape(knots, -1)),
        urdfs={agent.name: agent.urdf for agent in agents} | {lifted.name: lifted.urdf},
        objective_terms={name: float(k) for k, name in enumerate(names)},
        objective_weights=dict.fromkeys(names, 0.5),
        assessment=Assessment.of(
            [Finding(f"verdict.{kind}", "info", "", "") for kind in ("mathematics", *(a.kind for a in agents))]
        ),
    )


def test_what_is_read_is_what_was_written(written: Solution, tmp_path: Path) -> None:
    save(written, tmp_path)
    read = load_result(tmp_path)
    assert read.scenario == written.scenario
    assert read.urdfs == written.urdfs
    assert read.objective_terms == written.objective_terms
    assert read.assessment == written.assessment
    for one, other in ((read.object, written.object), *zip(read.agents, written.agents, strict=True)):
        for field in dataclasses.fields(one):
            if isinstance(value := getattr(other, field.name), np.ndarray):
                np.testing.assert_array_equal(getattr(one, field.name), value, err_msg=field.name)
            elif isinstance(value, str):
                assert getattr(one, field.name) == value


def test_every_agent_stands_in_the_file_under_its_name(written: Solution, tmp_path: Path) -> None:
    save(written, tmp_path)
    file = xr.load_dataset(tmp_path / "solution.nc", engine="h5netcdf")
    xr.testing.assert_identical(file, to_xarray(written))
    assert file["grasp"].values.tolist() == list(written.scenario.agents)
    assert {"crate_position", "crate_quaternion", "crate_velocity", "crate_acceleration"} <= set(file.variables)
    for k, agent in enumerate(written.agents):
        for kind in ("q", "v", "a", "tau"):
            assert file[f"{agent.name}_{kind}"].dims == ("time", f"{agent.name}_joint")
            np.testing.assert_array_equal(file[f"{agent.name}_{kind}"], getattr(agent, kind))
        assert file[f"{agent.name}_joint"].values.tolist() == list(agent.joint_names)
        np.testing.assert_array_equal(file["grasp_force"].sel(grasp=agent.name), agent.grasp_force[:, 0])
        assert file.attrs[f"objective_{agent.name}"] == float(k)
        assert file.attrs[f"urdf_{agent.name}"] == written.urdfs[agent.name]
    first, *others = written.persons
    np.testing.assert_array_equal(file["ground_reaction_force"], first.ground_force)
    for person in others:
        np.testing.assert_array_equal(file[f"{person.name}_ground_reaction_moment"], person.ground_moment)
    reactions = [name for name in file.variables if str(name).endswith("ground_reaction_force")]
    assert len(reactions) == len(written.persons)


def test_models_are_written_under_the_names_that_users_know(
    written: Solution, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    team = request.node.callspec.params["written"]
    save(written, tmp_path)
    files = [f"models/{name}.urdf" for name in TEAMS[team][2]]
    assert sorted(files_of(written)) == sorted([*files, "scenario.toml", "solution.nc"])
    for file, text in zip(files, written.urdfs.values(), strict=True):
        assert (tmp_path / file).read_text() == text


def test_models_of_the_result_before_go_with_it(written: Solution, folder: Path) -> None:
    (folder / "models" / "own.urdf").write_text("the user's")
    save(written, folder)
    there = {f"models/{path.name}" for path in (folder / "models").iterdir()}
    assert there == {name for name in files_of(written) if name.startswith("models/")} | {"models/own.urdf"}


def test_the_summary_tells_everybody_by_name(written: Solution) -> None:
    summary = summary_dict(written)
    assert list(summary["joints"]) == list(summary["load_share"]["agents"]) == list(written.scenario.agents)
    meanings = {agent.name: {row["meaning"] for row in summary["joints"][agent.name]} for agent in written.agents}
    for agent in written.agents:
        assert ("elbow flexion (-)" in meanings[agent.name]) == (agent.kind == "person")
        assert ("right_j0" in meanings[agent.name]) == (agent.kind == "robot")
        assert summary["objective"]["terms"][agent.name]["unit"] == "N^2 m^2 s"
    first, *others = written.persons
    weight = written.scenario.agents[first.name].mass * 9.81
    assert summary["ground_reaction"]["vertical_over_body_weight"] == pytest.approx(
        summary["ground_reaction"]["vertical"]["peak_N"] / weight
    )
    for person in others:
        assert summary[f"{person.name}_ground_reaction"]["vertical"]["peak_N"] != 0.0
