"""The one place where a solution is judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from liftopt.assessment.grasp import tilt_findings
from liftopt.assessment.mathematics import failure_findings, mathematics_findings, verdict
from liftopt.assessment.person import person_findings
from liftopt.assessment.robot import robot_findings
from liftopt.assessment.who import Who, listed, who_is
from liftopt.solution.finding import ERROR, INFO, PERSON, ROBOT, VERDICT, WARNING, Assessment, Finding, graver
from liftopt.solution.interpolation import between_knots
from liftopt.solution.solution import Solution

# What a verdict quotes where nothing is wrong: codes by subject.
TELLING = {PERSON: ("strength", "posture", "acgih", "squeeze"), ROBOT: ("torque", "payload", "speed")}
FINDINGS = {PERSON: person_findings, ROBOT: robot_findings}


def assess(solution: Solution) -> Assessment:
    """Return what is to be said of a solution, its peaks taken between the knots too.

    There is a verdict on the mathematics, and one on everybody who lifts. What is no solution has no findings of
    people and robots: there is no motion to judge.
    """
    mathematics = verdict(solution)
    if not solution.solved:
        nothing = [_not_assessed(who_is(agent, solution.agents)) for agent in solution.agents]
        return Assessment.of([mathematics, *nothing, *failure_findings(solution)])
    fine = between_knots(solution)
    verdicts, found = [mathematics], []
    for agent in sorted(fine.agents, key=lambda agent: agent.kind):  # people first
        who = who_is(agent, fine.agents)
        of_agent = list(FINDINGS[who.subject](fine, agent, who))
        verdicts.append(replace(_verdict(who, of_agent), agent=agent.name))
        found += of_agent
    others = [*tilt_findings(fine), *mathematics_findings(solution), _clearance(fine)]
    return Assessment.of([*verdicts, *found, *others])


def assessed(solution: Solution) -> Solution:
    """Return a solution with its assessment."""
    return replace(solution, assessment=assess(solution))


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


def _clearance(fine: Solution) -> Finding:
    people, robots = _counted(len(fine.persons), "person", "people"), _counted(len(fine.robots), "robot", "robots")
    who = listed([*people, *robots, "object"]).capitalize()
    text = f"Not checked: clearance. {who} may touch or overlap on the way"
    if people and robots:
        text += f"; contact between {robots[0]} and {people[0]} (ISO/TS 15066) is not assessed"
    return Finding("clearance.not_checked", INFO, "not checked: clearance", f"{text}.")


def _counted(count: int, one: str, several: str) -> list[str]:
    return [one if count == 1 else several] if count else []


def _joined(titles: Sequence[str]) -> str:
    return "; ".join(titles)
