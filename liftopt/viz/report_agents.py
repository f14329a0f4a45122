"""Everybody in a lift as the report tells of them: words, joints, ergonomics and the names of their figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from liftopt.assessment.who import hand_of, listed, who_is
from liftopt.ergonomics.lift import subject_in
from liftopt.ergonomics.limbs import has_legs, holding_arms
from liftopt.ergonomics.measures import Ergonomics, ergonomics_of
from liftopt.multibody.joint_curves import human_curves, robot_curves
from liftopt.multibody.trajectory import GRAVITY, AgentTrajectory, grasps_of
from liftopt.scenario.build import agents_of
from liftopt.solution.finding import MATHEMATICS, Finding
from liftopt.solution.solution import Solution
from liftopt.viz.base import base_of
from liftopt.viz.plots import figure_names
from liftopt.viz.plots_data import Lift
from liftopt.viz.report_tables import joint_rows
from liftopt.viz.robot_words import a_robot, table_words
from liftopt.viz.who import robot_of

# Without legs that move, and with them.
BODIES = {
    False: "a chain of 13 joints: three that stand for the ground contact and carry the body weight, three of the "
    "trunk, seven of the right arm; legs, pelvis, head and left arm have their mass but do not move on their own.",
    True: "a tree of 20 joints on feet that stay on the floor: ankle, knee and hip, at which both legs bend as one, "
    "three of the trunk, and seven of each arm.",
}


@dataclass(frozen=True)
class Reported:
    """One agent.

    Attributes:
        address: what the addresses of its sections in the page end with; empty where it is the only one of its kind.
        heading: what their headings end with.
        joints_are: of a robot, what the names in its table are.
        joints: rows of its table of joints.
        figures: names of its figures by what they show, ``"angles"``.
        labels: of the joints.
        sex: of a person.
        ergonomics: of a person.
    """

    address: str
    heading: str
    joints: list[dict[str, Any]]
    figures: dict[str, str]
    labels: dict[str, str]
    joints_are: str = ""
    sex: str = ""
    ergonomics: Ergonomics | None = None


def reported(lift: Lift, agent: AgentTrajectory) -> Reported:
    """Return what the report tells of one agent."""
    solution = lift.dense
    agents, alone, person = solution.agents, who_is(agent, solution.agents).is_alone, agent.kind == "person"
    curves = human_curves(agent) if person else robot_curves(agent, robot_of(solution.scenario, agent).model)
    return Reported(
        address="" if alone else f"-{agent.name}",
        heading="" if alone else f": {agent.name}",
        joints=joint_rows(curves, solution),
        figures=figure_names(agents, agent),
        labels={curve.joint: curve.label for curve in curves},
        joints_are="" if person else table_words(solution.scenario, agent),
        sex=subject_in(solution, agent.name).sex if person else "",
        ergonomics=ergonomics_of(solution, agent) if person else None,
    )


def force_rows(lift: Lift, summary: dict[str, Any]) -> list[dict[str, str]]:
    """Return a row for each hand, for the squeeze between two, and for what the ground does to each person."""
    agents, forces, rows = lift.dense.agents, summary["grasp_force"], []
    for _, agent, own, grasp in grasps_of(agents):
        share, force = summary["load_share"]["agents"][agent.name], forces["agents"][grasp.name]
        part = "\N{EM DASH}" if share["min"] is None else f"{100 * share['min']:.0f} to {100 * share['max']:.0f} %"
        size = f"{force['peak_N']:.1f} N (cap {forces['limit_N']:g} N)"
        called = who_is(agent, agents).called.removeprefix("the ")
        if len(agent.grasps) > 1:
            called += f", {hand_of(grasp.name, who_is(agent, agents))}"
        rows.append(_row(called, "" if own else part, size, force["at_s"]))
    if "squeeze" in forces:
        squeeze = forces["squeeze"]
        rows.append(_row("squeeze between the grasps (+ presses)", "", f"{squeeze['peak_N']:+.1f} N", squeeze["at_s"]))
    solution = lift.dense if summary["solved"] else lift.knots
    for person in solution.persons:
        title, weight = (
            f"ground reaction on {who_is(person, agents).called}",
            subject_in(solution, person.name).mass * GRAVITY,
        )
        vertical, horizontal = person.ground_force[:, 2], np.linalg.norm(person.ground_force[:, :2], axis=1)
        at = int(np.argmax(np.abs(vertical)))
        size = f"{vertical[at]:.0f} N ({vertical[at] / weight:.2f} body weights)"
        rows.append(_row(f"{title}, vertical", "", size, float(solution.time[at])))
        at = int(np.argmax(horizontal))
        rows.append(_row(f"{title}, horizontal", "", f"{horizontal[at]:.0f} N", float(solution.time[at])))
    return rows


def _row(name: str, share: str, force: str, at: float) -> dict[str, str]:
    return {"name": name, "share": share, "force": force, "at": f"{at:.2f} s"}


def subject_words(finding: Finding, agents: Sequence[AgentTrajectory]) -> str:
    """Return what a finding is about: ``"person"``, ``"solve"``, or a name where there are several of a kind."""
    for agent in agents:
        if agent.name == finding.agent and not who_is(agent, agents).is_alone:
            return agent.name
    return "solve" if finding.subject == MATHEMATICS else finding.subject


def team_words(solution: Solution) -> str:
    """Return who lifts: "A man of 1.75 m and 75 kg and a Sawyer robot, 1.9 m apart,"."""
    words = []
    for agent in solution.agents:
        named = "" if who_is(agent, solution.agents).is_alone else f" ({agent.name})"
        if agent.kind == "person":
            body = subject_in(solution, agent.name)
            kind = "man" if body.sex == "male" else "woman"
            words.append(f"a {kind} of {body.stature:.2f} m and {body.mass:g} kg{named}")
        else:
            words.append(f"{a_robot(robot_of(solution.scenario, agent))}{named}")
    text = listed(words)
    if len(solution.agents) == 2:
        first, second = (base_of(agent)[:2, 3] for agent in agents_of(solution.scenario, solution.urdfs))
        text += f", {round(float(np.hypot(*(second - first))), 3):g} m apart,"
    return text[0].upper() + text[1:]


def means_words(agents: Sequence[AgentTrajectory]) -> str:
    """Return with what they hold: "the person with the right hand, the robot with its gripper"."""
    told = {}
    for agent in agents:
        if agent.kind == "person":
            arms = [arm.side for arm in holding_arms(agent)]
            word = "both hands" if len(arms) > 1 else f"the {arms[0]} hand"
        else:
            word = "its gripper"
        told[agent.name] = agent, word
    words = []
    for kind in dict.fromkeys(agent.kind for agent in agents):
        same = [(agent, word) for agent, word in told.values() if agent.kind == kind]
        if len({word for _, word in same}) == 1:
            words.append(f"{'the' if len(same) == 1 else 'each'} {kind} with {same[0][1]}")
        else:
            words += [f"{agent.name} with {word}" for agent, word in same]
    return ", ".join(words)


def bodies_words(persons: Sequence[AgentTrajectory]) -> str:
    """Return how people are modelled, a sentence for each kind of body; nothing where there are none."""
    words = []
    for legs, text in BODIES.items():
        same = [person.name for person in persons if has_legs(person) == legs]
        if same:
            alone = "The person is" if len(persons) == 1 else "Each person is"
            who = alone if len(same) == len(persons) else f"{listed(same)} {'is' if len(same) == 1 else 'are each'}"
            words.append(f"{who} {text} ")
    return "".join(words)
