"""The one place where a solution is judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from liftopt.assessment.grasp import tilt_findings
from liftopt.assessment.mathematics import failure_findings, mathematics_findings, verdict
from liftopt.assessment.person import person_findings
from liftopt.assessment.robot import robot_findings
from liftopt.solution.finding import ERROR, INFO, PERSON, ROBOT, VERDICT, WARNING, Assessment, Finding, graver
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution

# What a verdict quotes where nothing is wrong: codes by subject.
TELLING = {PERSON: ("strength", "posture", "acgih", "squeeze"), ROBOT: ("torque", "payload", "speed")}
CLEARANCE = Finding(
    "clearance.not_checked",
    INFO,
    "not checked: clearance",
    "Not checked: clearance. Person, robot and object may touch or overlap on the way; contact between robot and "
    "person (ISO/TS 15066) is not assessed.",
)


def assess(solution: Solution) -> Assessment:
    """Return what is to be said of a solution, its peaks taken between the knots too.

    What is no solution has no person's and no robot's findings: there is no motion to judge.
    """
    mathematics = verdict(solution)
    if not solution.solved:
        nothing = [
            Finding(f"{VERDICT}.{subject}", ERROR, "not assessed", f"The {subject} is not assessed: there is no lift.")
            for subject in (PERSON, ROBOT)
        ]
        return Assessment.of([mathematics, *nothing, *failure_findings(solution)])
    fine = between_knots(solution)
    person, robot = list(person_findings(fine)), list(robot_findings(fine))
    names = dict(zip((PERSON, ROBOT), (agent.name for agent in fine.agents), strict=True))
    verdicts = [
        mathematics,
        replace(_verdict(PERSON, person), agent=names[PERSON]),
        replace(_verdict(ROBOT, robot), agent=names[ROBOT]),
    ]
    others = [*tilt_findings(fine), *mathematics_findings(solution), CLEARANCE]
    return Assessment.of([*verdicts, *person, *robot, *others])


def assessed(solution: Solution) -> Solution:
    """Return a solution with its assessment."""
    return replace(solution, assessment=assess(solution))


def _verdict(subject: str, findings: Sequence[Finding]) -> Finding:
    """Return the verdict on a subject: as grave as the gravest finding, and what that is."""
    worst = INFO
    for finding in findings:
        worst = graver(worst, finding.severity)
    if worst == INFO:
        codes = [f"{subject}.{code}" for code in TELLING[subject]]
        told = [next(finding.title for finding in findings if finding.code == code) for code in codes]
        return Finding(
            f"{VERDICT}.{subject}", INFO, "within limits", f"The {subject} is within limits: {_listed(told)}."
        )
    told = [finding.title for finding in findings if finding.severity == worst]
    title = "warning" if worst == WARNING else worst
    return Finding(f"{VERDICT}.{subject}", worst, title, f"{title.capitalize()} for the {subject}: {_listed(told)}.")


def _listed(titles: Sequence[str]) -> str:
    return "; ".join(titles)
