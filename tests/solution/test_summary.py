"""The summary: oracle is arithmetic by hand on the stand-in solution of conftest.py, and DH for the joints' names."""

from __future__ import annotations

import io
import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from liftopt.commands.summary_text import print_details
from liftopt.multibody.dh import ROTATION_WORLD_PAPER, BodyInertia, DHChain, frame_transforms, human_rows
from liftopt.multibody.joint_meanings import HUMAN_JOINTS, SAWYER_JOINTS
from liftopt.solution.summary import summary_dict


@pytest.fixture(autouse=True)
def no_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    """The stand-in has no models to be evaluated between its knots."""
    monkeypatch.setattr("liftopt.solution.summary.between_knots", lambda solution: solution)


def _text(solution: SimpleNamespace, encoding: str = "utf-8") -> str:
    raw = io.BytesIO()
    console = Console(file=io.TextIOWrapper(raw, encoding=encoding), width=200, force_terminal=False)
    print_details(summary_dict(solution), console)
    console.file.flush()
    return raw.getvalue().decode(encoding)


def test_joint_rows_hold_peak_torque_and_largest_share_and_leave_out_pinned_joints(solution: SimpleNamespace) -> None:
    joints = summary_dict(solution)["joints"]
    assert [row["joint"] for row in joints["human"]] == [f"Q{i}" for i in range(1, 11)]
    assert [row["joint"] for row in joints["robot"]] == [f"Q{i}" for i in range(1, 8)]
    # tau of Q2 is 0, 20, -30, 10, 0 Nm; its limits are +40 and -100 Nm: the peak is -30 at 1 s, 30 % of its limit,
    # while the 20 Nm at 0.5 s are 50 % of theirs.
    assert joints["human"][1] == {
        "joint": "Q2",
        "meaning": "trunk flexion",
        "peak_torque_Nm": -30.0,
        "peak_torque_at_s": 1.0,
        "share_of_limit": 0.3,
        "largest_share_of_limit": 0.5,
        "largest_share_at_s": 0.5,
        "q_min_deg": 0.0,
        "q_max_deg": pytest.approx(45.0, abs=1e-12),
    }
    assert joints["robot"][3]["meaning"] == "-right_j3"


def test_load_share_is_the_part_of_the_vertical_force(solution: SimpleNamespace) -> None:
    share = summary_dict(solution)["load_share"]["agents"]
    assert share["human"]["share"] == pytest.approx([0.6, 0.6, 40 / 48, 0.6, 0.6], abs=1e-15)
    assert (share["robot"]["min"], share["robot"]["max"]) == pytest.approx((8 / 48, 0.4), abs=1e-15)


def test_load_share_in_free_fall_is_none(solution: SimpleNamespace) -> None:
    for agent in solution.agents:
        agent.grasp_force[2, 0, 2] = 0.0
    share = summary_dict(solution)["load_share"]["agents"]
    assert share["human"]["share"][2] is None
    assert share["human"]["max"] == pytest.approx(0.6, abs=1e-15)
    assert "Load share" in _text(solution)


def test_grasp_forces_and_squeeze(solution: SimpleNamespace) -> None:
    grasp = summary_dict(solution)["grasp_force"]
    assert grasp["limit_N"] == 200.0
    assert grasp["agents"]["human"] == {"peak_N": 41.0, "at_s": 1.0}  # 9, 40, 41
    # The grasps lie along X: half of 9 - (-3) N.
    assert grasp["squeeze"] == {"peak_N": 6.0, "at_s": 1.0}


def test_ground_reaction(solution: SimpleNamespace) -> None:
    ground = summary_dict(solution)["ground_reaction"]
    assert ground["vertical_over_body_weight"] == pytest.approx(1.1, abs=1e-12)
    assert ground["vertical"]["at_s"] == 1.5
    assert ground["moment"] == {"peak_Nm": 5.0, "at_s": 0.5}
    assert ground["moment_sagittal"]["peak_Nm"] == -4.0


def test_objective_terms_sum_to_the_objective(solution: SimpleNamespace) -> None:
    objective = summary_dict(solution)["objective"]
    assert objective["terms"]["acceleration"] == {
        "integral": 90.0,
        "unit": "rad^2/s^3, m^2/s^3",
        "weight": 0.5,
        "weighted": 45.0,
    }
    assert sum(term["weighted"] for term in objective["terms"].values()) == objective["total"] == 350.0


def test_it_is_json_without_nan_and_a_failed_start_has_no_objective(solution: SimpleNamespace) -> None:
    text = json.dumps(summary_dict(solution, Path("results/table5")), allow_nan=False)
    assert json.loads(text)["solver"]["starts"][1]["objective"] is None


def test_what_is_not_solved_says_why(solution: SimpleNamespace) -> None:
    solution.solved, solution.status = False, "not converged: time limit"
    summary = summary_dict(solution)
    assert (summary["solved"], summary["exit_status"], summary["reason"]) == (False, 3, "not converged: time limit")


def test_tables_of_an_iterate_tell_how_the_solver_fared_and_no_peaks(solution: SimpleNamespace) -> None:
    solution.solved, solution.status = False, "not converged: time limit"
    text = _text(solution)
    assert "iteration limit" in text
    assert "Verification" in text
    for absent in ("joint torques", "Load share", "Forces", "Objective"):
        assert absent not in text


def test_a_value_without_a_limit_is_never_ok(solution: SimpleNamespace) -> None:
    """JSON knows no infinite limit; what is only told has no verdict."""
    told = SimpleNamespace(name="moment", value=0.3, limit=np.inf, unit="Nm", where="at 0.40 s", passed=True)
    solution.verification.checks = (*solution.verification.checks, told)
    rows = {line.split()[0]: line for line in _text(solution).splitlines() if line.startswith(("closure", "moment"))}
    assert rows["closure"].split()[4] == "ok"
    assert "no limit" in rows["moment"]
    assert "ok" not in rows["moment"]


def test_assessment_and_files_are_told(solution: SimpleNamespace) -> None:
    summary = summary_dict(solution, Path("results/table5"), ["scenario.toml", "solution.nc"])
    assert [finding["code"] for finding in summary["assessment"][:2]] == ["verdict.person", "verdict.robot"]
    assert summary["files"] == ["results/table5/scenario.toml", "results/table5/solution.nc"]


@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_text_fits_80_columns_and_shows_what_users_look_for(solution: SimpleNamespace, encoding: str) -> None:
    human = solution.agents[0]
    human.tau[1, 12], human.tau[2, 12], human.q[:, 12] = 39.5, -60.0, np.radians(-123.4)  # the widest row
    text = _text(solution, encoding)
    assert "! at 0.50" in text
    assert max(map(len, text.splitlines())) <= 80
    for figure in [
        "Q5 shoulder flexion",
        "Q4 -right_j3",
        "-30.00",
        "50.0",
        "83.3",
        "squeeze between the grasps",
        "1.10 x body weight",
        "20% of 200 N",
        "rad^2/s^3",
        "350",
        "iteration limit",
        "31 iterations",
        "solve 0.31 s",
        "peak [Nm]",
        "closure",
        "human at t = 0.40 s",
        "KKT error",
    ]:
        assert figure in text, figure


def test_a_load_share_of_many_knots_and_wide_figures_fits_80_columns(solution: SimpleNamespace) -> None:
    solution.time = np.linspace(0.0, 2.0, 41)
    for agent, force in zip(solution.agents, (-0.5, 1.5), strict=True):
        agent.q, agent.tau = np.zeros((41, agent.q.shape[1])), np.zeros((41, agent.q.shape[1]))
        agent.grasp_position = np.repeat(agent.grasp_position[:1], 41, axis=0)
        agent.grasp_force = np.tile([0.0, 0.0, 20.0 * force], (41, 1, 1))
        agent.ground_force = agent.ground_moment = np.zeros((41, 3))
    text = _text(solution)
    assert max(map(len, text.splitlines())) <= 80
    assert "-50.0  -50.0  -50.0  -50.0  -50.0   -50.0    -50.0  ▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁" in text
    assert "150.0  150.0  150.0  150.0  150.0   150.0    150.0  █████████████████" in text


def test_named_motions_are_the_positive_directions_of_the_dh_chain() -> None:
    """World X is ahead, Y to the left, Z up; the arm is the right one and hangs in the anatomical position."""
    rows = human_rows(1.0, 0.5, 0.2, 0.3, 0.25, 0.1)
    chain = DHChain("human", rows, tuple(BodyInertia.zero() for _ in rows))

    def moved(joint: str, frame: int) -> np.ndarray:
        q = np.zeros(13)
        at_zero = frame_transforms(chain, q)[frame][:3, 3]
        q[[row.name for row in rows].index(joint)] = 0.3
        step: np.ndarray = ROTATION_WORLD_PAPER @ (frame_transforms(chain, q)[frame][:3, 3] - at_zero)
        return step

    shoulder, hand = 5, 12
    assert HUMAN_JOINTS["Q1"] == "trunk bend right"
    assert moved("Q1", shoulder)[1] < -0.05
    assert HUMAN_JOINTS["Q2"] == "trunk flexion"
    assert moved("Q2", shoulder)[0] > 0.05
    assert HUMAN_JOINTS["Q3"] == "trunk turn left"
    assert moved("Q3", shoulder)[0] > 0.05
    assert HUMAN_JOINTS["Q4"] == "shoulder adduction"
    assert moved("Q4", hand)[1] > 0.05
    assert HUMAN_JOINTS["Q5"] == "shoulder flexion"
    assert moved("Q5", hand)[0] > 0.05
    assert HUMAN_JOINTS["Q7"] == "elbow flexion (-)"
    assert moved("Q7", hand)[0] < -0.05
    assert HUMAN_JOINTS["Q9"] == "wrist extension"
    assert moved("Q9", hand)[0] < -0.01
    assert HUMAN_JOINTS["Q10"] == "wrist ulnar deviation"
    assert moved("Q10", hand)[1] > 0.01
    assert len(SAWYER_JOINTS) == 7
