"""A saved result against the contract, from its files alone: the oracle is xarray, Pinocchio and Newton's laws.

Nothing of liftopt but ``load_scenario`` is used to check: this is what an outside reader of the folder sees.
"""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import xarray as xr

from liftopt.scenario.model import Scenario, load_scenario

GRAVITY = np.array([0.0, 0.0, -9.81])
ARMS = {"human": ("human_arm.urdf", 10), "robot": ("sawyer.urdf", 7)}
ONE_START = "solver.starts=1"
PAPER = ("objective.preset=paper", "limits.clearance=off")
CASES = {
    "paper": ("table5_paper",),
    "near": ("table5_near", *PAPER, "solver.starts=2"),
    "free": ("table5_free", *PAPER, "solver.starts=2"),
    "fine": ("table5_paper", "solver.intervals=40", ONE_START),
    "coarse": ("table5_paper", "solver.intervals=10", ONE_START),
    "no human weight": ("table5_paper", "human.weight=0", ONE_START),
    "no robot weight": ("table5_paper", "robot.weight=0", ONE_START),
    "woman lowers": (
        "table5_paper", "task.start.height=1.3", "task.end.height=0.95", "human.sex=female", "human.stature=1.62",
        "human.mass=60", "object.width=0.4", "robot.tool.mass=0.8", "duration=2.5", ONE_START,
    ),
    "no acceleration": ("table5_paper", "task.rest=acceleration", ONE_START),
    "bare": ("table5_bare", "solver.intervals=40", ONE_START),
}  # fmt: skip


@dataclass(frozen=True)
class Result:
    """One result folder, read from disk."""

    folder: Path
    data: xr.Dataset
    scenario: Scenario
    models: dict[str, pin.Model]

    def __getitem__(self, name: str) -> np.ndarray:
        return self.data[name].values

    @property
    def step(self) -> float:
        """Time between two knots [s]."""
        return self.scenario.duration / (len(self["time"]) - 1)

    def force(self, who: str) -> np.ndarray:
        """Return the force (K, 3) of one agent on the table."""
        return self.data.grasp_force.sel(grasp=who).values

    def table_coordinates(self) -> np.ndarray:
        """Return position and roll, pitch, yaw of R = Rx Ry Rz with both derivatives, (3, K, 6), by hand."""
        quaternions = self["table_quaternion"]
        out = np.zeros((3, len(quaternions), 6))
        out[0, :, :3] = self["table_position"]
        out[1, :, :3], out[2, :, :3] = self["table_velocity"][:, :3], self["table_acceleration"][:, :3]
        for k, quaternion in enumerate(quaternions):
            r = pin.Quaternion(quaternion).matrix()
            roll, pitch, yaw = np.arctan2(-r[1, 2], r[2, 2]), np.arcsin(r[0, 2]), np.arctan2(-r[0, 1], r[0, 0])
            axes = np.array([[1, 0, 0], [0, np.cos(roll), np.sin(roll)], r[:, 2]]).T
            rates = np.linalg.solve(axes, self["table_velocity"][k, 3:])
            # Each axis turns with the rotations before it: roll's not at all, pitch's with roll, yaw's with both.
            turn = np.array([np.zeros(3), axes[:, 0] * rates[0], axes[:, 0] * rates[0] + axes[:, 1] * rates[1]])
            drift = np.cross(turn, axes.T).T @ rates
            out[:, k, 3:] = (
                (roll, pitch, yaw), rates, np.linalg.solve(axes, self["table_acceleration"][k, 3:] - drift)
            )  # fmt: skip
        return out


@pytest.fixture(scope="module", params=CASES, ids=str)
def result(request: pytest.FixtureRequest, solved: Callable[..., Any]) -> Result:
    solution, folder = solved(*CASES[request.param])
    assert solution.solved, solution.status
    with xr.open_dataset(folder / "solution.nc", engine="h5netcdf") as file:
        data = file.load()
    models = {who: pin.buildModelFromUrdf(str(folder / "models" / name)) for who, (name, _) in ARMS.items()}
    models["table"] = pin.buildModelFromUrdf(str(folder / "models" / "table.urdf"), pin.JointModelFreeFlyer())
    return Result(folder, data, load_scenario(str(folder / "scenario.toml")), models)


def test_variables_have_the_contracts_dimensions_units_and_names(result: Result) -> None:
    dimensions = {
        "time": ("time",), "table_position": ("time", "xyz"), "table_quaternion": ("time", "quat"),
        "table_velocity": ("time", "twist"), "table_acceleration": ("time", "twist"),
        "grasp_force": ("time", "grasp", "xyz"), "grasp_position": ("time", "grasp", "xyz"),
        "ground_reaction_force": ("time", "xyz"), "ground_reaction_moment": ("time", "xyz"),
    }  # fmt: skip
    for who in ARMS:
        dimensions |= {f"{who}_{kind}": ("time", f"{who}_joint") for kind in ("q", "v", "a", "tau")}
    for name, dims in dimensions.items():
        variable = result.data[name]
        assert variable.dims == dims
        assert variable.dtype == np.float64
        assert np.isfinite(variable.values).all()
    for variable in result.data.variables.values():
        if variable.dtype == np.float64:
            assert variable.attrs["units"]
            assert variable.attrs["long_name"]
    for who, (_, joints) in ARMS.items():
        names = [f"{who}_GT{i}" for i in (1, 2, 3)] + [f"{who}_Q{i}" for i in range(1, joints + 1)]
        assert result[f"{who}_joint"].tolist() == names
    for name, labels in {"xyz": "xyz", "quat": "xyzw"}.items():
        assert result[name].tolist() == list(labels)
    assert result["grasp"].tolist() == ["human", "robot"]
    assert len(result["twist"]) == 6
    texts = [result[name] for name in ("human_joint", "robot_joint", "xyz", "quat", "twist", "grasp")]
    assert all(type(label) is str for text in texts for label in text.tolist())


def test_attributes_say_how_it_was_found(result: Result) -> None:
    attributes = result.data.attrs
    assert attributes["status"] == "solved"
    assert attributes["verified"] == 1
    assert attributes["iterations"] > 0
    assert 0 < attributes["evaluation_seconds"] < attributes["solve_seconds"] < attributes["total_seconds"] < 50
    assert 0 < attributes["setup_seconds"] < attributes["total_seconds"]
    assert attributes["max_violation"] <= 1e-6
    assert attributes["kkt_error"] <= 1e-6
    assert {"liftopt", "casadi", "pin", "numpy"} <= set(json.loads(attributes["versions"]))


def test_knots_are_uniform_and_both_ends_at_rest(result: Result) -> None:
    time = result["time"]
    assert (time[0], time[-1]) == (0.0, result.scenario.duration)
    assert np.allclose(np.diff(time), result.step, rtol=0, atol=1e-12)
    assert len(time) == result.data.attrs["intervals"] + 1
    speeds, accelerations = ("human_v", "robot_v", "table_velocity"), ("human_a", "robot_a", "table_acceleration")
    for name in speeds:
        assert np.abs(result[name][[0, -1]]).max() <= 1e-9
    still = [bool(np.abs(result[name][[0, -1]]).max() <= 1e-9) for name in accelerations]
    assert still == [result.scenario.task.rest == "acceleration"] * 3


def test_acceleration_is_linear_between_knots(result: Result) -> None:
    """A piecewise-linear acceleration integrated twice from knot to knot gives the next velocity and position."""
    h = result.step
    motions = [np.stack([result[f"{who}_{kind}"] for kind in "qva"]) for who in ARMS]
    for q, v, a in [*motions, result.table_coordinates()]:
        assert np.abs(v[:-1] + h * (a[:-1] + a[1:]) / 2 - v[1:]).max() < 1e-8
        assert np.abs(q[:-1] + h * v[:-1] + h**2 * (2 * a[:-1] + a[1:]) / 6 - q[1:]).max() < 1e-9


def test_pose_variables_are_the_tables_motion_in_six_coordinates(result: Result) -> None:
    names = ("table_pose", "table_pose_velocity", "table_pose_acceleration")
    for name, expected in zip(names, result.table_coordinates(), strict=True):
        assert np.abs(result[name] - expected).max() < 1e-9


def _gaps(result: Result, arms: dict[str, np.ndarray], table: np.ndarray) -> np.ndarray:
    """Return the distance (K, 2) of the hands from the table's grasp points, by the URDFs."""
    frames, data = result.models["table"], result.models["table"].createData()
    gaps = np.zeros((len(table), 2))
    for k, x in enumerate(table):
        turn = pin.AngleAxis(x[3], np.eye(3)[0]).matrix() @ pin.AngleAxis(x[4], np.eye(3)[1]).matrix()
        turn = turn @ pin.AngleAxis(x[5], np.eye(3)[2]).matrix()
        pin.framesForwardKinematics(frames, data, np.concatenate([x[:3], pin.Quaternion(turn).coeffs()]))
        for i, who in enumerate(ARMS):
            model = result.models[who]
            arm = model.createData()
            pin.framesForwardKinematics(model, arm, arms[who][k])
            hand = arm.oMf[model.getFrameId(f"{who}_grasp")].translation
            gaps[k, i] = np.linalg.norm(hand - data.oMf[frames.getFrameId(f"grasp_{who}")].translation)
    return gaps


def test_hands_stay_on_the_table_at_and_between_knots(result: Result) -> None:
    h, table = result.step, result.table_coordinates()
    at_knots = _gaps(result, {who: result[f"{who}_q"] for who in ARMS}, table[0])
    left_out = [1, -2] if result.scenario.task.rest == "acceleration" else []  # over-determined with all
    assert np.delete(at_knots, left_out, axis=0).max() <= 1e-6

    def finer(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        s = np.linspace(0.0, h, 10, endpoint=False)[:, None, None]
        return (q[:-1] + s * v[:-1] + s**2 / 2 * a[:-1] + s**3 / (6 * h) * (a[1:] - a[:-1])).reshape(-1, q.shape[1])

    # The order is time within an interval first: one interval's points lie len(q) - 1 rows apart.
    arms = {who: finer(*(result[f"{who}_{kind}"] for kind in "qva")) for who in ARMS}
    between = _gaps(result, arms, finer(*table)).max()
    # Prototype of this transcription: 0.77 mm at N = 20 and 0.03 mm at N = 40.
    smooth = len(result["time"]) > 40 and result.scenario.objective.acceleration_weight > 0
    assert between <= (1e-4 if smooth else 1e-3)


def test_grasp_positions_are_the_tables_grasp_points(result: Result) -> None:
    model, table = result.models["table"], result.scenario.object
    data = model.createData()
    for i, (who, ahead) in enumerate({"human": -0.5, "robot": 0.5}.items()):
        frame = model.getFrameId(f"grasp_{who}")
        for position, quaternion, expected in zip(
            result["table_position"], result["table_quaternion"], result["grasp_position"][:, i], strict=True
        ):
            pin.framesForwardKinematics(model, data, np.concatenate([position, quaternion]))
            assert np.abs(data.oMf[frame].translation - expected).max() < 1e-9
            edge = pin.Quaternion(quaternion).matrix() @ [ahead * table.depth, 0.0, -table.height / 2]
            assert np.abs(position + edge - expected).max() < 1e-9


@pytest.mark.parametrize("who", ARMS)
def test_torques_are_rnea_with_the_grasp_reaction(result: Result, who: str) -> None:
    """The reaction enters as an external force on the joint that carries the hand."""
    model = result.models[who]
    data, frame = model.createData(), model.frames[model.getFrameId(f"{who}_grasp")]
    motion = (result[f"{who}_{kind}"] for kind in "qva")
    for q, v, a, force, tau in zip(*motion, result.force(who), result[f"{who}_tau"], strict=True):
        pin.framesForwardKinematics(model, data, q)
        joint, hand = data.oMi[frame.parentJoint], data.oMi[frame.parentJoint] * frame.placement
        loads = pin.StdVec_Force()
        loads.extend([pin.Force.Zero() for _ in range(model.njoints)])
        loads[frame.parentJoint] = joint.actInv(pin.Force(-force, np.cross(hand.translation, -force)))
        assert np.abs(pin.rnea(model, data, q, v, a, loads) - tau).max() < 1e-8


def test_forces_balance_the_table(result: Result) -> None:
    """Newton and Euler for one body: force along world axes, moment about the body's y and z."""
    inertia, tolerance = result.models["table"].inertias[1], result.scenario.limits.balance_tolerance
    for k in range(len(result["time"])):
        turn = pin.Quaternion(result["table_quaternion"][k]).matrix()
        acceleration, omega = result["table_acceleration"][k], turn.T @ result["table_velocity"][k, 3:]
        forces = result["grasp_force"][k]
        force = inertia.mass * (acceleration[:3] - GRAVITY) - forces.sum(axis=0)
        spin = inertia.inertia @ (turn.T @ acceleration[3:]) + np.cross(omega, inertia.inertia @ omega)
        arms = result["grasp_position"][k] - result["table_position"][k]
        moment = spin - turn.T @ np.cross(arms, forces).sum(axis=0)
        assert np.abs(force).max() <= tolerance + 1e-6
        assert np.abs(moment[1:]).max() <= tolerance + 1e-6


def test_ground_carries_the_persons_momentum_weight_and_load(result: Result) -> None:
    """The rate of the whole body's momentum about its centre of mass, moved to the feet."""
    model = result.models["human"]
    data, weight = model.createData(), pin.computeTotalMass(model) * GRAVITY
    for k, force in enumerate(result.force("human")):
        state = [result[f"human_{kind}"][k] for kind in "qva"]
        pin.computeCentroidalMomentumTimeVariation(model, data, *state)
        ground = data.dhg.linear - weight + force
        moment = data.dhg.angular + np.cross(data.com[0], data.dhg.linear - weight)
        pin.framesForwardKinematics(model, data, state[0])
        moment += np.cross(data.oMf[model.getFrameId("human_grasp")].translation, force)
        assert np.abs(result["ground_reaction_force"][k] - ground).max() < 1e-8
        assert np.abs(result["ground_reaction_moment"][k] - moment).max() < 1e-8


def test_limits_hold_at_every_knot(result: Result) -> None:
    """Position, speed and the larger directional effort from the URDFs, the task's own from the scenario."""
    for who, (name, _) in ARMS.items():
        robot = ET.parse(result.folder / "models" / name).getroot()
        limits = {joint.get("name"): joint.find("limit") for joint in robot.iter("joint")}
        for i, joint in enumerate(result[f"{who}_joint"].tolist()):
            if "_GT" in joint:
                continue
            q, v, tau = (result[f"{who}_{kind}"][:, i] for kind in ("q", "v", "tau"))
            assert float(limits[joint].get("lower")) - 1e-6 <= q.min()
            assert q.max() <= float(limits[joint].get("upper")) + 1e-6
            assert np.abs(v).max() <= float(limits[joint].get("velocity")) + 1e-6
            assert np.abs(tau).max() <= float(limits[joint].get("effort")) + 1e-6
        assert np.linalg.norm(result.force(who), axis=1).max() <= result.scenario.limits.max_grasp_force + 1e-6
    pose, rate, _ = result.table_coordinates()
    task = result.scenario.limits
    assert np.abs(pose[:, 3]).max() <= 1e-6
    assert np.abs(pose[:, 4]).max() <= np.radians(task.table_pitch_deg) + 1e-6
    assert np.abs(pose[:, 5]).max() <= np.radians(task.table_yaw_deg) + 1e-6
    assert np.abs(rate).max() <= 2.0 + 1e-6


def test_objective_is_the_weighted_sum_of_its_trapezoid_integrals(result: Result) -> None:
    moving = {who: result.data[f"{who}_joint"].str.contains("_Q").values for who in ARMS}
    accelerations = [result[f"{who}_a"][:, moving[who]] for who in ARMS] + [result.table_coordinates()[2]]
    squares = {who: (result[f"{who}_tau"][:, moving[who]] ** 2).sum(axis=1) for who in ARMS}
    squares["acceleration"] = sum((a**2).sum(axis=1) for a in accelerations)
    squares["force"] = (result["grasp_force"] ** 2).sum(axis=(1, 2))
    objective, total = result.scenario.objective, 0.0
    weights = {who: agent.weight for who, agent in result.scenario.agents.items()}
    weights |= {"acceleration": objective.acceleration_weight, "force": objective.force_weight}
    for term, values in squares.items():
        integral = result.step * (values.sum() - (values[0] + values[-1]) / 2)
        assert result.data.attrs[f"objective_{term}"] == pytest.approx(integral, rel=1e-9)
        total += weights[term] * integral
    assert result.data.attrs["objective"] == pytest.approx(total, rel=1e-9)


def test_table_is_level_and_where_the_scenario_wants_it_at_both_ends(result: Result) -> None:
    task = result.scenario.task
    for k, end in ((0, task.start), (-1, task.end)):
        human, robot = result["grasp_position"][k]
        assert human[2] == pytest.approx(end.height, abs=1e-6)
        assert robot[2] == pytest.approx(end.height, abs=1e-6)
        assert abs(result["table_quaternion"][k, 3]) == pytest.approx(1.0, abs=1e-9)
        assert robot - human == pytest.approx([result.scenario.object.depth, 0.0, 0.0], abs=1e-6)
        if end.human_distance is not None:
            assert human[0] == pytest.approx(end.human_distance, abs=1e-6)


def test_virtual_joints_rest_at_zero_and_bases_stand_where_they_should(result: Result) -> None:
    for who in ARMS:
        for kind in "qva":
            assert not result[f"{who}_{kind}"][:, :3].any()
        model = result.models[who]
        base = model.jointPlacements[1].translation
        feet = [0.0, 0.0, 0.0] if who == "human" else [result.scenario.task.standing_distance, 0.0, 0.0]
        assert base[:2] == pytest.approx(feet[:2], abs=1e-12)


def test_urdfs_have_the_contracts_links_and_joints(result: Result) -> None:
    for who, (name, joints) in ARMS.items():
        model, robot = result.models[who], ET.parse(result.folder / "models" / name).getroot()
        assert list(model.names)[1:] == result[f"{who}_joint"].tolist()
        assert model.nv == joints + 3
        kinds = {joint.get("name"): joint.get("type") for joint in robot.iter("joint")}
        assert all(kinds[f"{who}_Q{i}"] == "revolute" for i in range(1, joints + 1))
        children = {joint.find("child").get("link") for joint in robot.iter("joint")}
        assert {link.get("name") for link in robot.iter("link")} - children == {"world"}
        grasps = {f"{who}_grasp"}
        _check_grasps(robot, grasps)
    robot = ET.parse(result.folder / "models" / "table.urdf").getroot()
    _check_grasps(robot, {"grasp_human", "grasp_robot"})
    assert result.models["table"].njoints == 2
    assert result.models["table"].inertias[1].mass == pytest.approx(result.scenario.object.mass, rel=1e-12)


def _check_grasps(robot: ET.Element, names: set[str]) -> None:
    links = {link.get("name"): link for link in robot.iter("link")}
    carriers = {joint.find("child").get("link"): joint for joint in robot.iter("joint")}
    for name in names:
        assert links[name].find("inertial") is None
        assert carriers[name].get("type") == "fixed"
        assert carriers[name].get("name") not in links


def test_scenario_beside_the_result_is_the_one_solved(result: Result, request: pytest.FixtureRequest) -> None:
    name, *overrides = CASES[request.node.callspec.params["result"]]
    assert result.scenario == load_scenario(name, overrides)
