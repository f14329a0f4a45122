"""The one place where a solution is judged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from liftopt.assessment.clearance import clearance_findings, clearance_verdict
from liftopt.assessment.grasp import tilt_findings
from liftopt.assessment.mathematics import failure_findings, mathematics_findings, verdict
from liftopt.assessment.person import person_findings
from liftopt.assessment.robot import robot_findings
from liftopt.assessment.robot_data import data_findings, robot_data
from liftopt.assessment.who import Who, who_is
from liftopt.scenario.robot import Robot
from liftopt.solution.clearance_of import clearance_of
from liftopt.solution.finding import (
    CLEARANCE,
    ERROR,
    INFO,
    PERSON,
    ROBOT,
    VERDICT,
    WARNING,
    Assessment,
    Finding,
    graver,
)
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution

# What a verdict quotes where nothing is wrong: codes by subject.
TELLING = {PERSON: ("strength", "posture", "acgih", "squeeze"), ROBOT: ("torque", "payload", "speed")}
FINDINGS = {PERSON: person_findings, ROBOT: robot_findings}
NO_CLEARANCE = Finding(f"{VERDICT}.{CLEARANCE}", ERROR, "not assessed", "Clearance is not assessed: there is no lift.")


def assess(solution: Solution) -> Assessment:
    """Return what is to be said of a solution, its peaks taken between the knots too.

    There is a verdict on the mathematics, one on clearance, and one on everybody who lifts. What is no solution has no
    findings of bodies: there is no motion to judge.
    """
    return assessed(solution).assessment


def assessed(solution: Solution) -> Solution:
    """Return a solution with its clearance and its assessment."""
    mathematics = verdict(solution)
    if not solution.solved:
        nothing = [_not_assessed(who_is(agent, solution.agents)) for agent in solution.agents]
        told = [mathematics, *nothing, NO_CLEARANCE, *failure_findings(solution), *_data(solution)]
        return replace(solution, assessment=Assessment.of(told))
    fine = between_knots(solution)
    clearance, verdicts, found = clearance_of(fine), [mathematics], []
    for agent in sorted(fine.agents, key=lambda agent: agent.kind):  # people first
        who = who_is(agent, fine.agents)
        of_agent = list(FINDINGS[who.subject](fine, agent, who))
        verdicts.append(replace(_verdict(who, of_agent), agent=agent.name))
        found += of_agent
    apart = list(clearance_findings(fine, clearance))
    others = [*apart, *tilt_findings(fine), *mathematics_findings(solution)]
    told = [*verdicts, clearance_verdict(apart), *found, *others]
    return replace(solution, assessment=Assessment.of(told), clearance=clearance)


def _data(solution: Solution) -> Iterator[Finding]:
    """Give what is noticed about the data of robots, which may be why there is no lift."""
    for robot in solution.robots:
        asked = solution.scenario.agents[robot.name]
        assert isinstance(asked, Robot)
        yield from data_findings(robot, who_is(robot, solution.agents), robot_data(asked))


def _not_assessed(who: Who) -> Finding:
    text = f"The {who.told} is not assessed: there is no lift."
    return Finding(f"{VERDICT}.{who.subject}", ERROR, "not assessed", text, None if who.is_alone else who.name)


def _verdict(who: Who, findings: Sequence[Finding]) -> Finding:
    """Return the verdict on somebody: as grave as the gravest finding, and what that is."""
    worst = INFO
    for finding in findings:
        worst = graver(worst, finding.severity)
    code = f"{VERDICT}.{who.subject}"
    if worst == INFO:
        first: dict[str, str] = {}
        for finding in findings:
            first.setdefault(finding.code, finding.title)
        codes = [f"{who.subject}.{part}" for part in TELLING[who.subject]]
        told = [first[wanted] for wanted in codes if wanted in first]
        return Finding(code, INFO, "within limits", f"The {who.told} is within limits: {_joined(told)}.")
    told = [finding.title for finding in findings if finding.severity == worst]
    title = "warning" if worst == WARNING else worst
    return Finding(code, worst, title, f"{title.capitalize()} for {who.the}: {_joined(told)}.")


def _joined(titles: Sequence[str]) -> str:
    return "; ".join(titles)
