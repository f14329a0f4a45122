"""The verdict on a terminal: oracle is the contract (25 lines, 80 columns, a warning first) and figures put in."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from liftopt.assessment.failure_text import MOST_LINES as MOST_OF_FAILURE
from liftopt.assessment.failure_text import failure_text
from liftopt.assessment.text import MOST_LINES, details_text, verdict_text
from liftopt.solution.finding import Assessment, Finding, percent
from liftopt.solution.infeasibility_report import InfeasibilityReason, SuggestedChange


def test_it_opens_with_the_verdict_and_says_who_lifts_what_where(solution: SimpleNamespace) -> None:
    lines = verdict_text(solution, Path("results/table5")).splitlines()
    assert lines[0] == "table5: WARNING for the person"
    assert lines[1].startswith("male 1.75 m, 75 kg and sawyer lift 2 kg (0.45 x 0.31 x 0.02 m) from 0.9 to 1.4 m")
    assert "height of the" in " ".join(lines[1:3])
    assert [line for line in lines if line.startswith(("Person", "Robot", "Solve"))] == [
        "Person: WARNING",
        "Robot: within limits",
        "Solve: solved and verified",
    ]
    assert "  ! The posture scores RULA 6 of 7." in lines
    assert "Written to results/table5: solution.nc, scenario.toml, models/*.urdf" in lines


def test_the_command_it_names_can_be_pasted(solution: SimpleNamespace) -> None:
    folder = "results/first try"
    assert f"liftopt report '{folder}' --html FILE" in verdict_text(solution, Path(folder))


def test_another_scenario_is_described_by_its_own_numbers(solution: SimpleNamespace) -> None:
    changes = {"human.sex": "female", "human.stature": 1.6, "human.mass": 55.0, "name": "nurse"}
    solution.scenario = solution.scenario.replace(changes)
    text = verdict_text(solution, None)
    assert text.startswith("nurse: WARNING for the person\nfemale 1.6 m, 55 kg")
    assert "Written to" not in text


@pytest.mark.parametrize("many", [0, 3, 10, 60])
def test_it_never_takes_more_lines_nor_columns_and_keeps_verdicts_and_the_gravest(
    solution: SimpleNamespace, many: int
) -> None:
    message = "A very long explanation of what is wrong with this joint, " * 3
    more = [
        Finding(f"{subject}.torque", severity, f"{severity} {i} of the {subject}", message)
        for i in range(many)
        for subject in ("person", "robot")
        for severity in ("warning", "caution", "info")
    ]
    solution.assessment = Assessment.of([*solution.assessment, *more])
    lines = verdict_text(solution, Path("results/table5")).splitlines()
    assert len(lines) <= MOST_LINES == 25
    assert max(map(len, lines)) <= 80
    assert sum(line.startswith(("Person:", "Robot:", "Solve:")) for line in lines) == 3
    assert any("RULA" in line for line in lines)
    if many == 60:
        assert not any("caution 0" in line for line in lines)
        assert any("more findings with --details" in line for line in lines)


@pytest.mark.parametrize(
    ("share", "told"),
    [(0.0, "0"), (0.271, "27"), (0.994, "99"), (0.9960, "99.6"), (0.99999, "100"), (1.0004, "100"), (1.004, "100.4"),
     (1.32, "132")],
)  # fmt: skip
def test_100_percent_is_what_is_at_its_limit(share: float, told: str) -> None:
    """By hand: 99.6 % is a caution and 100 % a warning, so they are not told alike."""
    assert percent(share) == told


def test_details_hold_every_finding_in_full(solution: SimpleNamespace) -> None:
    text = details_text(solution.assessment)
    assert all(finding.message in text for finding in solution.assessment)


def _failed(solution: SimpleNamespace, reasons: int, suggested_changes: int) -> SimpleNamespace:
    solution.solved, solution.status = False, "infeasible: the robot's grasp stays 1.43 m short"
    solution.reasons = tuple(
        InfeasibilityReason("torque", "human_Q5", 3.0, "Nm", f"reason {i}") for i in range(reasons)
    )
    solution.suggested_changes = (
        SuggestedChange(("task.standing_distance",), (1.8,), "robot base 0.10 m nearer", 1.0),
        *(
            SuggestedChange(("object.mass",), (float(i),), f"object at most {i} kg", 2.0)
            for i in range(suggested_changes)
        ),
    )
    return solution


def test_a_failure_names_the_reason_and_the_keys_to_change(solution: SimpleNamespace) -> None:
    out = Path("results/table5")
    lines = failure_text(_failed(solution, 1, 0), out, out / "unsolved").splitlines()
    assert lines[0] == "no verified solution: infeasible: the robot's grasp stays 1.43 m short"
    assert "  in the way: reason 0" in lines
    assert "  task.standing_distance = 1.80  (robot base 0.10 m nearer)" in lines
    assert lines[-1] == (
        "The best iterate, which is no lift, is in results/table5/unsolved; "
        "the solved result in results/table5 is as it was"
    )
    assert failure_text(solution, out, out).splitlines()[-1].endswith("is in results/table5, marked as such")


def test_a_failure_takes_twelve_lines_at_most(solution: SimpleNamespace) -> None:
    out = Path("results/table5")
    text = failure_text(_failed(solution, 9, 20), out, out)
    assert text.count("\n") == MOST_OF_FAILURE == 12
    assert "is in results/table5" in text
