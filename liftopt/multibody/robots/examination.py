"""A robot's data looked through before anything is computed with them: what it is, what is assumed, what is missing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.robots.chain import RobotChain, base_of, robot_chain
from liftopt.multibody.robots.chain_findings import chain_findings, mesh_findings
from liftopt.multibody.robots.data_finding import SEVERITIES, DataFinding
from liftopt.multibody.robots.description import RobotDescription
from liftopt.multibody.robots.given_limits import GivenLimits, with_limits
from liftopt.multibody.robots.grasp_frames import grasp_candidates, rivals
from liftopt.multibody.robots.limit_findings import limit_findings
from liftopt.multibody.robots.mass_findings import mass_findings
from liftopt.multibody.robots.solid_findings import solid_findings
from liftopt.multibody.robots.weight_findings import WEIGHT, weight_findings

AMBIGUOUS = "grasp.ambiguous"  # which of several hands it holds with is for the user to say


@dataclass(frozen=True)
class Examination:
    """What a robot is, and what is noticed about its data.

    Attributes:
        chain: from its base to its grasp frame.
        findings: the gravest first.
    """

    chain: RobotChain
    findings: tuple[DataFinding, ...]

    @property
    def refused(self) -> tuple[DataFinding, ...]:
        """The findings for which it cannot lift."""
        return tuple(found for found in self.findings if found.severity == "refused")

    def plain(self) -> dict[str, Any]:
        """Return it as JSON has it; lengths in m, angles in rad, masses in kg, efforts in Nm or N."""
        chain = self.chain
        return {
            "name": chain.description.name,
            "source": chain.description.source,
            "usable": not self.refused,
            "base": chain.base,
            "grasp_frame": chain.grasp_frame,
            "degrees_of_freedom": len(chain.links),
            "reach_m": round(chain.reach, 6),
            "moving_mass_kg": _number(chain.moving_mass),
            "joints": [
                {
                    "name": joint.name,
                    "kind": joint.kind,
                    "lower": _number(ends.lower),
                    "upper": _number(ends.upper),
                    "velocity": _number(joint.velocity),
                    "effort": _number(joint.effort),
                }
                for joint, ends in zip(chain.joints, chain.ranges, strict=True)
            ],
            "held": dict(chain.held),
            "findings": [found.plain() for found in self.findings],
        }


def examined(
    description: RobotDescription,
    *,
    grasp_frame: str | None = None,
    base: str | None = None,
    locked: Mapping[str, float] | None = None,
    limits: Mapping[str, GivenLimits] | None = None,
) -> Examination:
    """Return what a robot is, and what is noticed about its data.

    Args:
        description: of the robot.
        grasp_frame: name of the link that it holds with; None proposes one.
        base: name of the link that is bolted down, by default the root.
        locked: positions of joints that are held [rad, m].
        limits: of joints whose URDF has none or wrong ones.

    Raises:
        InputError: a name or a number that was given is wrong, or there is no chain to look at.
    """
    description = with_limits(description, limits or {})
    base = base_of(description, base)
    choice: list[DataFinding] = []
    if grasp_frame is None:
        grasp_frame, proposal = _proposed(description, base)
        choice.append(proposal)
    chain = robot_chain(description, grasp_frame, base=base, locked=locked)
    found = [
        *choice,
        *mass_findings(chain),
        *limit_findings(chain),
        *chain_findings(chain),
        *mesh_findings(description),
        *solid_findings(chain),
    ]
    if not any(one.severity == "refused" for one in found):
        found.extend(weight_findings(chain))
    return Examination(chain, tuple(sorted(found, key=lambda one: SEVERITIES.index(one.severity))))


def with_springs(found: Examination, springs: str) -> Examination:
    """Return what is noticed about a robot with springs, told in words, in place of motors too weak for its weight."""
    fix = "the torques of its motors are smaller than those that are computed"
    told = DataFinding("weight.springs", "warned", "weight", NO_VALUE, springs, fix)
    order = [*(one for one in found.findings if one.code != WEIGHT), told]
    return replace(found, findings=tuple(sorted(order, key=lambda one: SEVERITIES.index(one.severity))))


def refuse(found: Examination, source: str) -> None:
    """Raise ``InputError`` for the gravest finding for which a robot cannot lift, if there is one."""
    for finding in found.findings:
        if finding.severity == "refused" or finding.code == AMBIGUOUS:
            raise finding.refusal(source)


def _proposed(description: RobotDescription, base: str) -> tuple[str, DataFinding]:
    """Return the likeliest grasp frame, and the finding that says why."""
    candidates = grasp_candidates(description, base)
    if not candidates:
        leaves = ", ".join(description.leaves[:8])
        message = f"no link looks like a hand; say which: the tree ends in {leaves}"
        raise InputError(f"{description.source}: grasp_frame", NO_VALUE, message)
    first, others = candidates[0], rivals(candidates)
    if others:
        names = " and ".join(other.frame for other in others)
        message = f"proposed, {first.why}, and as much speaks for {names}"
        finding = DataFinding(AMBIGUOUS, "warned", "grasp_frame", first.frame, message, "say grasp_frame")
    else:
        also = ", ".join(other.frame for other in candidates[1:5])
        fix = "say grasp_frame for another one" + (f", such as {also}" if also else "")
        message = f"proposed, {first.why}"
        finding = DataFinding("grasp.proposed", "assumed", "grasp_frame", first.frame, message, fix)
    return first.frame, finding


def _number(value: float | None) -> float | None:
    """Return a number that JSON knows."""
    return value if value is not None and abs(value) < float("inf") else None
