"""What a reader of the report should be warned of: limits reached or lived on, wasted force, weak data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from liftopt.ergonomics.assessment import Assessment
from liftopt.ergonomics.rula import ACTION
from liftopt.multibody.provenance import subject_quantities
from liftopt.scene import subject_of
from liftopt.solution import Solution
from liftopt.summary import GRAVITY, squeeze
from liftopt.viz.anatomy import JointCurve

Array = npt.NDArray[np.float64]
Level = Literal["stop", "warning", "note"]

NEAR_LIMIT = 0.8  # of a torque limit
AT_LIMIT = 1e-3  # of the range of a limit; closer is "at" it
ALL_ALONG = 0.9  # share of the lift from which a limit is active "all along"
RULA_CHANGE = 5  # grand score from which RULA asks for a change
BETWEEN, EXCEEDED = " between knots", 1e-3  # excess between knots worth a word, in its unit
SPREAD = 0.01  # relative difference of two optima worth a word


@dataclass(frozen=True)
class Finding:
    """One warning.

    Attributes:
        level: ``"stop"`` (the numbers are no prediction), ``"warning"`` (look at it) or ``"note"`` (know it).
        title: in a few words.
        detail: what was found, with numbers.
    """

    level: Level
    title: str
    detail: str


def findings(
    dense: Solution, human: tuple[JointCurve, ...], robot: tuple[JointCurve, ...], ergonomics: Assessment
) -> tuple[Finding, ...]:
    """Return the warnings of a lift, the gravest first.

    Args:
        dense: the solution between its knots too.
        human: joints of the person over the same times.
        robot: joints of the robot.
        ergonomics: of the same times.
    """
    joints = (("Person", human), ("Robot", robot))
    found = [
        *_status(dense),
        *(finding for who, curves in joints for finding in _torques(dense, who, curves)),
        *_grasp(dense),
        *_posture(dense, ergonomics),
        *(finding for who, curves in joints for finding in _positions(who, curves)),
        *(finding for who, curves in joints for finding in _speeds(who, curves)),
        *_tilt(dense),
        *_between(dense),
        *_mesh(dense),
        *_starts(dense),
        *_data(dense),
        *(Finding("note", "From the solver", note) for note in dense.notes),
    ]
    order = ("stop", "warning", "note")
    return tuple(sorted(found, key=lambda finding: order.index(finding.level)))


def _status(dense: Solution) -> Iterator[Finding]:
    if not dense.solved:
        yield Finding("stop", "Not a solution", f"This is the best iterate of a solve that failed: {dense.status}.")
    for remedy in dense.remedies:
        yield Finding("stop", f"Possible with: {remedy.message}", "A lift with this change was solved and verified.")


def _torques(dense: Solution, who: str, curves: tuple[JointCurve, ...]) -> Iterator[Finding]:
    for curve in sorted(curves, key=lambda curve: -float(curve.share.max())):
        k = int(np.argmax(curve.share))
        if curve.share[k] < NEAR_LIMIT:
            continue
        title = f"{who}: {curve.label} uses {100 * curve.share[k]:.0f} % of its torque limit"
        near = 100 * float((curve.share >= NEAR_LIMIT).mean())
        yield Finding(
            "warning", title, f"At {dense.time[k]:.2f} s; above {100 * NEAR_LIMIT:.0f} % for {near:.0f} % of the lift."
        )


def _grasp(dense: Solution) -> Iterator[Finding]:
    cap = dense.scenario.limits.max_grasp_force
    forces = [np.linalg.norm(agent.grasp_force, axis=1) for agent in dense.agents]
    at_cap = np.max(forces, axis=0) >= (1 - AT_LIMIT) * cap
    if at_cap.any():
        yield Finding(
            "warning",
            f"Grasp force at its cap for {100 * at_cap.mean():.0f} % of the lift",
            f"Only limits.max_grasp_force = {cap:g} N holds it back: the motion rests on that choice.",
        )
    squeezed = squeeze(dense.agents)
    k, weight = int(np.argmax(np.abs(squeezed))), dense.scenario.table.mass * GRAVITY
    if abs(squeezed[k]) > weight:
        verb = "press it together" if squeezed[k] > 0 else "pull it apart"
        yield Finding(
            "warning",
            f"The hands work against each other with up to {abs(squeezed[k]):.0f} N",
            f"At {dense.time[k]:.2f} s they {verb}, more than the {dense.held.name}'s weight of {weight:.0f} N. Such a "
            "force lifts nothing; it appears where it unloads joints, and a person would hardly exert it unasked. "
            "A higher objective.force_weight discourages it.",
        )


def _posture(dense: Solution, ergonomics: Assessment) -> Iterator[Finding]:
    scores = ergonomics.rula
    worst = int(scores.grand.max())
    if worst >= RULA_CHANGE:
        parts = scores.at(scores.worst)
        words = ", ".join(
            f"{name.replace('_', ' ')} {parts[name]}" for name in ("upper_arm", "lower_arm", "wrist", "trunk")
        )
        part = 100 * float((scores.grand >= RULA_CHANGE).mean())
        yield Finding(
            "warning",
            f"Posture: RULA {worst} of 7, {ACTION[worst]}",
            f"{RULA_CHANGE} or more for {part:.0f} % of the lift. At {dense.time[scores.worst]:.2f} s: {words}.",
        )


def _positions(who: str, curves: tuple[JointCurve, ...]) -> Iterator[Finding]:
    for curve in curves:
        low, high = curve.q_limits
        margin = AT_LIMIT * (high - low)
        for limit, at in ((low, curve.q <= low + margin), (high, curve.q >= high - margin)):
            if at.any():
                yield _active(
                    f"{who}: {curve.label} at the end of its range ({limit + 0.0:.0f}°)".replace(
                        "(-", "(\N{MINUS SIGN}"
                    ),
                    float(at.mean()),
                )


def _speeds(who: str, curves: tuple[JointCurve, ...]) -> Iterator[Finding]:
    for curve in curves:
        at = np.abs(curve.v) >= (1 - AT_LIMIT) * curve.v_limit
        if at.any():
            yield _active(f"{who}: {curve.label} at its speed limit ({curve.v_limit:.0f}°/s)", float(at.mean()))


def _tilt(dense: Solution) -> Iterator[Finding]:
    limits, pose = dense.scenario.limits, np.degrees(dense.held.pose)
    for column, name, limit in ((4, "pitch", limits.table_pitch_deg), (5, "yaw", limits.table_yaw_deg)):
        share = float((np.abs(pose[:, column]) >= (1 - AT_LIMIT) * limit).mean())
        if share > 0 and limit > 0:
            yield _active(f"The {dense.held.name}'s {name} at its limit ({limit:g}°)", share)


def _active(title: str, share: float) -> Finding:
    if share >= ALL_ALONG:
        return Finding(
            "warning", title, f"Active all along ({100 * share:.0f} % of the lift): it shapes the whole prediction."
        )
    return Finding("note", title, f"For {100 * share:.0f} % of the lift.")


def _between(dense: Solution) -> Iterator[Finding]:
    if not dense.solved:
        return
    for check in dense.verification.checks:
        if check.name.endswith(BETWEEN) and "limits" in check.name and check.value > EXCEEDED:
            what = check.name.removesuffix(BETWEEN).capitalize()
            title = f"{what} exceeded between knots by {check.value:.2g} {check.unit}"
            detail = f"{check.where}. Limits hold at the knots; more solver.intervals bring them closer."
            yield Finding("note", title, detail)


def _mesh(dense: Solution) -> Iterator[Finding]:
    accuracy = dense.accuracy
    if accuracy is None:
        return
    if not accuracy.estimated:
        yield Finding("note", "The objective's error is not known", f"{accuracy.remark.capitalize()}.")
    elif accuracy.objective_error > dense.scenario.refine.objective_error:
        yield Finding(
            "note",
            f"The objective is {100 * accuracy.objective_error:.1f} % above that on ever finer meshes",
            f"On {dense.intervals} intervals, estimated from the optimum on {accuracy.intervals}: it tends to "
            f"{accuracy.objective_limit:.4g}, give or take {accuracy.objective_bar:.2g}. The option --refine "
            "solves on finer ones.",
        )


def _starts(dense: Solution) -> Iterator[Finding]:
    ends = [start.objective for start in dense.starts if start.status == "converged"]
    if len(ends) > 1 and max(ends) > (1 + SPREAD) * min(ends):
        yield Finding(
            "note",
            "More than one local optimum",
            f"{len(ends)} starts ended between {min(ends):.4g} and {max(ends):.4g}; the best is shown.",
        )


def _data(dense: Solution) -> Iterator[Finding]:
    strengths = [item for item in subject_quantities(subject_of(dense.scenario.human)) if item.group == "strength"]
    weak = [item for item in strengths if item.source.confidence in ("unverified", "estimate")]
    if weak:
        yield Finding(
            "note",
            f"{len(weak)} of {len(strengths)} strength limits could not be checked at their source",
            "They are typical values of the 50th percentile, not of one person; shares of strength inherit that. The "
            "sources are listed below.",
        )
