"""An assessment on a terminal: the verdicts first, 80 columns wide, at most ``MOST_LINES`` lines."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from shlex import quote
from textwrap import wrap
from typing import NamedTuple

from liftopt.assessment.who import listed
from liftopt.scenario.agents import Person
from liftopt.scenario.grasps import grasp_heights, height_words
from liftopt.scenario.model import Scenario
from liftopt.scenario.placement import lead, partner, stand_of
from liftopt.scenario.robot_defaults import is_file
from liftopt.solution.finding import CAUTION, CLEARANCE, INFO, MATHEMATICS, PERSON, ROBOT, WARNING, Assessment, Finding
from liftopt.solution.solution import Solution

WIDTH, MOST_LINES = 80, 25
AFTER_NUMBER, HARD_SPACE = re.compile(r"(?<=\d) "), "\N{NO-BREAK SPACE}"
HEAD = -1
MARKS = {WARNING: "! ", CAUTION: "- ", INFO: ""}
WORDS = {WARNING: "WARNING", CAUTION: "caution", INFO: "within limits"}
# Told in any case.
ALWAYS = {
    PERSON: ("strength", "posture", "spine_compression", "lifting_style", "acgih", "grasp_force", "load_share"),
    ROBOT: ("torque", "payload"),
    MATHEMATICS: ("mesh", "objective_error"),
    CLEARANCE: ("person_robot",),
}


class Part(NamedTuple):
    """Lines that belong together, and the rank of their severity; ``HEAD`` is never left out."""

    rank: int
    lines: list[str]


def verdict_text(solution: Solution, folder: Path | None) -> str:
    """Return the verdicts on a solved lift, for those who plan the station.

    Args:
        solution: solved.
        folder: that it was written to, if any.
    """
    assessment = solution.assessment
    head = [*_wrapped(f"{solution.scenario.name}: {_headline(assessment)}"), *_scenario(solution.scenario), ""]
    foot = ["", *_caveats(assessment), *_where(folder)]
    room = MOST_LINES - len(head) - len(foot)
    parts = list(_verdicts(assessment, _explained))
    if _lines(parts) > room:
        parts = list(_verdicts(assessment, _titled))
    body = _fitted(parts, room)
    return "\n".join([*head, *body, *foot]) + "\n"


def details_text(assessment: Assessment) -> str:
    """Return all findings in full."""
    lines = ["All findings", *(line for finding in assessment for line in _full(finding))]
    return "\n".join(lines) + "\n"


def _headline(assessment: Assessment) -> str:
    judged = [verdict for verdict in assessment.verdicts if verdict.subject != MATHEMATICS]
    told = [f"{WORDS[verdict.severity]} for {_whom(verdict, judged)}" for verdict in judged if verdict.severity != INFO]
    subjects = sorted(verdict.subject for verdict in judged if verdict.subject != CLEARANCE)
    return ", ".join(told) or f"{'person and robot' if subjects == [PERSON, ROBOT] else 'everybody'} within limits"


def _whom(verdict: Finding, verdicts: Sequence[Finding]) -> str:
    """Return who or what a verdict is on, ``"the person"``, ``"clearance"``."""
    told = _told(verdict, verdicts)
    return told if verdict.subject == CLEARANCE else f"the {told}"


def _told(verdict: Finding, verdicts: Sequence[Finding]) -> str:
    """Return who a verdict is on: a subject, and the name where there are several of the kind."""
    several = sum(other.subject == verdict.subject for other in verdicts) > 1
    return f"{verdict.subject} {verdict.agent}" if several else verdict.subject


def _scenario(scenario: Scenario) -> list[str]:
    box = scenario.object
    start, end = grasp_heights(scenario)
    lift = "lift" if len(scenario.agents) > 1 else "lifts"
    return _wrapped(
        f"{listed(_described(scenario))} {lift} {box.mass:g} kg ({box.depth:g} x {box.width:g} x {box.height:g} m) "
        f"from {start:g} to {end:g} m (height of {height_words(scenario)}) in {scenario.duration:g} s{_apart(scenario)}"
    )


def _described(scenario: Scenario) -> Iterator[str]:
    """Give everybody who lifts in a few words, by name where there are several of the kind."""
    kinds = [agent.kind for agent in scenario.agents.values()]
    for name, agent in scenario.agents.items():
        if isinstance(agent, Person):
            what = f"{agent.sex} {agent.stature:g} m, {agent.mass:g} kg"
        else:
            what = Path(agent.model).name if is_file(agent.model) else agent.model
        yield what if kinds.count(agent.kind) == 1 else f"{name} ({what})"


def _apart(scenario: Scenario) -> str:
    """Return how far the two who face each other stand apart; by name where more than two lift."""
    first, other = lead(scenario), partner(scenario)
    if other is None:
        return ""
    one, two = stand_of(scenario, first), stand_of(scenario, other)
    whose = f"{first} and {other} " if len(scenario.agents) > 2 else ""
    return f", {whose}standing {round(math.hypot(two.x - one.x, two.y - one.y), 3):g} m apart"


def _verdicts(assessment: Assessment, told: Callable[[Finding], list[str]]) -> Iterator[Part]:
    """Give the verdicts, each with what it rests on, the gravest first."""
    for verdict in assessment.verdicts:
        subject, found = verdict.subject, assessment.about(verdict.subject, verdict.agent)
        who = _told(verdict, assessment.verdicts)
        yield Part(HEAD, [f"{'Solve' if subject == MATHEMATICS else who[0].upper() + who[1:]}: {_word(verdict)}"])
        always = [f"{subject}.{code}" for code in ALWAYS[subject]]
        for finding in found:
            if finding.severity != INFO:
                yield Part(finding.rank, told(finding))
            elif finding.code in always:
                yield Part(finding.rank, _titled(finding))


def _fitted(parts: list[Part], room: int) -> list[str]:
    """Return the lines of parts, without the last of the least grave ones if there are too many."""
    kept, left = list(parts), 0
    while _lines(kept) + bool(left) > room:
        least = max(part.rank for part in kept)
        last = max(i for i, part in enumerate(kept) if part.rank == least)
        del kept[last]
        left += 1
    lines = [line for part in kept for line in part.lines]
    word = "finding" if left == 1 else "findings"
    return [*lines, f"... and {left} more {word} with --details and in the report"] if left else lines


def _lines(parts: list[Part]) -> int:
    return sum(len(part.lines) for part in parts)


def _word(verdict: Finding) -> str:
    own = verdict.subject == MATHEMATICS or (verdict.subject == CLEARANCE and verdict.severity == INFO)
    return verdict.title if own else WORDS[verdict.severity]


def _explained(finding: Finding) -> list[str]:
    return _item(finding, finding.message) if finding.severity == WARNING else _titled(finding)


def _titled(finding: Finding) -> list[str]:
    when = "" if finding.time is None else f", at {finding.time:.2f} s"
    return _item(finding, f"{finding.title}{when}")


def _full(finding: Finding) -> list[str]:
    source = f" [{finding.source}]" if finding.source else ""
    return _wrapped(f"{finding.code} ({finding.severity}): {finding.message}{source}", "  ", "    ")


def _item(finding: Finding, text: str) -> list[str]:
    mark = MARKS[finding.severity]
    return _wrapped(f"{mark}{text}", "  ", f"  {' ' * len(mark)}")


def _caveats(assessment: Assessment) -> list[str]:
    told = [finding.title for finding in assessment if finding.code == f"{PERSON}.strength_data"]
    return _wrapped("; ".join(dict.fromkeys(told)).capitalize()) if told else []


def _where(folder: Path | None) -> Iterable[str]:
    if folder is None:
        return
    # Paths are not broken up, so that they can be copied.
    yield f"Written to {folder}: solution.nc, scenario.toml, models/*.urdf"
    yield f"More: solve with --details, or liftopt report {quote(str(folder))} --html FILE"


def _wrapped(text: str, first: str = "", then: str = "") -> list[str]:
    """Return lines of a text; a number and its unit stay together."""
    whole = AFTER_NUMBER.sub(HARD_SPACE, text)
    lines = wrap(whole, WIDTH, initial_indent=first, subsequent_indent=then, break_on_hyphens=False)
    return [line.replace(HARD_SPACE, " ") for line in lines]
