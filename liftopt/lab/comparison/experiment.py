"""The experiment beside the prediction: recordings of a person, the hand's force and a robot, curve by curve."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.comparison.comparison import SAMPLES, SHARE, Comparison
from liftopt.lab.comparison.motion_start import lift_start
from liftopt.lab.forces.force_record import ForceRecord
from liftopt.lab.meant import the_person, the_robot
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.lab.robot.robot_record import RobotRecord
from liftopt.multibody.joint_curves import ANATOMY, human_curves, robot_curves
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.agents import Person, Robot
from liftopt.scenario.build import agent_of
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.types import Array

FACTOR = 10  # as the plots
NO_FORCE = "none given"  # how a recorded lift says that its hand was taken as empty
ELSEWHERE = 5.0  # deg; a robot that starts farther from where it should may have run another lift
CLEARLY = 0.7  # of the misfit: another reading of the efforts that leaves less than this is worth a word


@dataclass(frozen=True)
class Experiment:
    """What was recorded, against what was predicted.

    Attributes:
        comparisons: one each quantity.
        duration: of the predicted lift [s].
        notes: what a reader must know of the recordings and of what was taken for granted, one sentence each.
    """

    comparisons: tuple[Comparison, ...]
    duration: float
    notes: tuple[str, ...]

    def group(self, *names: str) -> tuple[Comparison, ...]:
        """Return the comparisons of some groups."""
        return tuple(one for one in self.comparisons if one.group in names)


def experiment(
    solution: Solution,
    mocap: Sequence[RecordedLift] = (),
    forces: Sequence[ForceRecord] = (),
    robot: Sequence[RobotRecord] = (),
    forces_lift: tuple[float, float] | None = None,
    person: str | None = None,
    robot_name: str | None = None,
) -> Experiment:
    """Return the comparison of a predicted lift with recordings of it, each in normalised time: 0 to 100 % of the lift.

    Args:
        solution: a solved lift.
        mocap: recorded lifts, one a trial; each lift is the time in which the object is carried.
        forces: of the hand, one a trial.
        robot: one a trial; each lift lasts as long as the predicted one from its beginning, see ``lift_start``.
        forces_lift: start and end of the lift in ``forces``, after each trial's first sample [s]; None takes the whole.
        person: whom ``mocap`` and ``forces`` are of; None where only one lifts.
        robot_name: whose ``robot`` is; None where there is only one.

    Raises:
        InputError: the lift is not solved, there is nothing to compare with, a recording does not hold the lift, or
            nobody is the one that is meant.
    """
    if not solution.solved:
        raise InputError("RESULT", solution.status, "must be a solved and verified lift to be compared")
    if not (mocap or forces or robot):
        raise InputError("compare", NO_VALUE, "needs recordings: --mocap, --forces or --robot")
    dense = resample(solution, FACTOR)
    notes: list[str] = []
    found = [
        *_person(dense, person, mocap, notes),
        *_hand(dense, person, forces, forces_lift, notes),
        *_robot(dense, robot_name, robot, notes),
    ]
    return Experiment(tuple(found), float(solution.time[-1]), tuple(notes))


def _person(
    dense: Solution, person: str | None, records: Sequence[RecordedLift], notes: list[str]
) -> Iterator[Comparison]:
    if not records:
        return
    human = the_person(dense, person)
    for curve, joint in zip(human_curves(human), ANATOMY, strict=True):
        columns = [(record, record.joint_names.index(f"human_{joint.joint}")) for record in records]
        angles = [record.over_lift(np.degrees(joint.sign * record.q[:, i]), SAMPLES) for record, i in columns]
        torques = [record.over_lift(joint.sign * record.tau[:, i], SAMPLES) for record, i in columns]
        yield _compared("human_angle", joint.joint, curve.label, "deg", dense, curve.q, angles)
        yield _compared("human_torque", joint.joint, curve.label, "Nm", dense, curve.tau, torques)
    for axis, name, label in ((0, "x", "Hand, forward of its start"), (2, "z", "Hand, above its start")):
        paths = [record.over_lift(record.hand_position[:, axis], SAMPLES) for record in records]
        predicted = human.p_world_hold[:, axis] - human.p_world_hold[0, axis]
        yield _compared("hand_path", name, label, "m", dense, predicted, [path - path[0] for path in paths])
    loaded = [record for record in records if not record.force_from.startswith(NO_FORCE)]
    if loaded:
        vertical = [record.over_lift(record.hand_force[:, 2], SAMPLES) for record in loaded]
        label = "Vertical force (mocap)"
        yield _compared("hand_force", "mocap", label, "N", dense, human.load[:, 2], vertical)
    asked = dense.scenario.agents[human.name]
    assert isinstance(asked, Person)
    for record in records:
        subject, start = record.subject, record.carried or (record.time[0], record.time[-1])
        what = "while the object is carried" if record.carried else "all of the recording, which shows no object"
        notes.append(
            f"{record.source}: lift from {start[0]:.2f} to {start[1]:.2f} s ({what}), {start[1] - start[0]:.2f} s; "
            f"predicted {dense.time[-1]:.2f} s"
        )
        notes.append(f"{record.source}: force of the hand behind the joint torques: {record.force_from}")
        if (subject.stature, subject.mass, subject.sex) != (asked.stature, asked.mass, asked.sex):
            notes.append(
                f"{record.source}: the person recorded is {subject.stature:.3f} m, {subject.mass:g} kg, {subject.sex}; "
                f"predicted is one of {asked.stature:.3f} m, {asked.mass:g} kg, {asked.sex}"
            )


def _hand(
    dense: Solution,
    person: str | None,
    records: Sequence[ForceRecord],
    span: tuple[float, float] | None,
    notes: list[str],
) -> Iterator[Comparison]:
    if not records:
        return
    trials = []
    for record in records:
        first = float(record.time[0])
        start, end = (None, None) if span is None else (first + span[0], first + span[1])
        trials.append(record.over_share(SHARE, start, end))
        within = (record.time >= (start if start is not None else first)) & (
            record.time <= (end if end is not None else record.time[-1])
        )
        doubtful = int(np.count_nonzero(record.doubtful & within))
        if doubtful:
            notes.append(
                f"{record.source}, trial {record.trial}: {doubtful} of {int(within.sum())} samples are flagged: the "
                "true force is at least what is shown, or is missing"
            )
    if span is None:
        notes.append("force sensors: each trial's first and last sample are taken for the lift's start and end")
    notes.append("force sensors: fingers minus thumb is compared with the vertical force, as if the object stays level")
    label = "Vertical force (sensors)"
    yield _compared("hand_force", "sensors", label, "N", dense, the_person(dense, person).load[:, 2], trials)


def _robot(dense: Solution, name: str | None, records: Sequence[RobotRecord], notes: list[str]) -> Iterator[Comparison]:
    if not records:
        return
    duration, agent = float(dense.time[-1]), the_robot(dense, name, "--robot-name")
    asked = dense.scenario.agents[agent.name]
    assert isinstance(asked, Robot)
    curves = robot_curves(agent, asked.model)
    starts = [lift_start(record, dense.time, agent.q[:, agent.moving]) for record in records]
    angles = np.stack(
        [record.over_share(record.q, SHARE, at, duration) for record, (at, *_) in zip(records, starts, strict=True)]
    )
    for i, curve in enumerate(curves):
        yield _compared("robot_angle", curve.joint, curve.label, "deg", dense, curve.q, np.degrees(angles[:, :, i]))
    planned = np.array([curve.q[0] for curve in curves])
    for record, (_, how, known), own in zip(records, starts, np.degrees(angles), strict=True):
        notes.append(f"{record.source}: the lift begins {how} and lasts {duration:g} s")
        if known:
            notes.append(f"{record.source}: {known}")
        off = float(np.abs(own[0] - planned).max())
        if off > ELSEWHERE:
            notes.append(f"{record.source}: the robot starts {off:.0f} deg off the prediction: is it this lift?")
        if record.tau is None:
            notes.append(f"{record.source}: not every message holds efforts: left out of the torques")
    felt = [
        (record, record.tau, at) for record, (at, *_) in zip(records, starts, strict=True) if record.tau is not None
    ]
    if not felt:
        return
    torques = np.stack([record.over_share(tau, SHARE, at, duration) for record, tau, at in felt])
    for i, curve in enumerate(curves):
        yield _compared("robot_torque", curve.joint, curve.label, "Nm", dense, curve.tau, torques[:, :, i])
    notes.append(
        "efforts are taken for the joints' torques with gravity's part in them, positive as the joint's angle; "
        "JointState does not say which a robot means"
    )
    notes += _other_reading(dense, agent, angles.mean(axis=0), torques.mean(axis=0))


def _other_reading(dense: Solution, agent: AgentTrajectory, q: Array, effort: Array) -> list[str]:
    """Return a note if efforts (S, 7) at angles q (S, 7) fit better with another sign, or as torques beyond gravity."""
    robot, moving = agent_of(dense.scenario, agent.name, dense.urdfs), agent.moving
    full, data = np.zeros((len(q), robot.model.nq)), robot.model.createData()
    full[:, moving] = q
    gravity = np.array([pin.computeGeneralizedGravity(robot.model, data, row)[moving] for row in full])
    predicted = np.stack([_over_lift(dense, column) for column in agent.tau[:, moving].T], axis=1)
    readings = {
        "as they are": effort,
        "with the other sign": -effort,
        "as torques beyond the arm's own weight": effort + gravity,
        "as torques beyond the arm's own weight, with the other sign": gravity - effort,
    }
    misfit = {name: float(np.sqrt(np.mean((torque - predicted) ** 2))) for name, torque in readings.items()}
    best, plain = min(misfit, key=lambda name: misfit[name]), misfit["as they are"]
    if misfit[best] >= CLEARLY * plain:
        return []
    return [
        f"the efforts fit the prediction better {best}: {misfit[best]:.2f} Nm (rms of all joints) against {plain:.2f} "
        "as they are; find out what the robot means before reading the torques"
    ]


def _compared(
    group: str, name: str, label: str, unit: str, dense: Solution, predicted: Array, trials: Sequence[Array] | Array
) -> Comparison:
    return Comparison(group, name, label, unit, _over_lift(dense, predicted), np.stack(list(trials)))


def _over_lift(dense: Solution, values: Array) -> Array:
    return np.asarray(np.interp(SHARE * dense.time[-1], dense.time, values), float)
