"""The experiment beside the prediction: recordings of a person, the hand's force and a robot, curve by curve."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.comparison.comparison import SHARE, Comparison
from liftopt.lab.comparison.motion_start import lift_start
from liftopt.lab.comparison.normalised import compared, over_lift
from liftopt.lab.comparison.person import person_comparisons
from liftopt.lab.forces.force_record import ForceRecord
from liftopt.lab.meant import the_person, the_robot
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.lab.robot.export_formats import state_and_goal
from liftopt.lab.robot.joint_map import JointMap
from liftopt.lab.robot.robot_record import RobotRecord
from liftopt.multibody.joint_curves import robot_curves
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.build import agent_of
from liftopt.scenario.robot import Robot
from liftopt.solution.interpolation import resample
from liftopt.solution.solution import Solution
from liftopt.types import Array

FACTOR = 10  # as the plots
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
        *person_comparisons(dense, person, mocap, notes),
        *_hand(dense, person, forces, forces_lift, notes),
        *_robot(dense, robot_name, robot, notes),
    ]
    return Experiment(tuple(found), float(solution.time[-1]), tuple(notes))


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
    yield compared("hand_force", "sensors", label, "N", dense, the_person(dense, person).load[:, 2], trials)


def _robot(dense: Solution, name: str | None, records: Sequence[RobotRecord], notes: list[str]) -> Iterator[Comparison]:
    if not records:
        return
    duration, agent = float(dense.time[-1]), the_robot(dense, name, "--robot-name")
    asked = dense.scenario.agents[agent.name]
    assert isinstance(asked, Robot)
    curves = robot_curves(agent, asked.model)
    topics = state_and_goal(JointMap.of(dense, agent.name))
    starts = [lift_start(record, dense.time, agent.q[:, agent.moving], topics) for record in records]
    angles = np.stack(
        [record.over_share(record.q, SHARE, at, duration) for record, (at, *_) in zip(records, starts, strict=True)]
    )
    shown = np.array([curve.units.factor for curve in curves]) * angles
    for i, curve in enumerate(curves):
        yield compared("robot_angle", curve.joint, curve.label, curve.units.shown, dense, curve.q, shown[:, :, i])
    planned, turn = np.array([curve.q[0] for curve in curves]), ~agent.sliding[agent.moving]
    for record, (_, how, known), own in zip(records, starts, shown, strict=True):
        notes.append(f"{record.source}: the lift begins {how} and lasts {duration:g} s")
        if known:
            notes.append(f"{record.source}: {known}")
        off = float(np.abs(own[0] - planned)[turn].max(initial=0.0))
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
        yield compared("robot_torque", curve.joint, curve.label, curve.units.tau, dense, curve.tau, torques[:, :, i])
    notes.append(
        "efforts are taken for the joints' torques with gravity's part in them, positive as the joint's angle; "
        "JointState does not say which a robot means"
    )
    notes += _other_reading(dense, agent, angles.mean(axis=0), torques.mean(axis=0))


def _other_reading(dense: Solution, agent: AgentTrajectory, q: Array, effort: Array) -> list[str]:
    """Return a note if efforts (S, n) at angles q (S, n) fit better with another sign, or as torques beyond gravity."""
    robot, moving = agent_of(dense.scenario, agent.name, dense.urdfs), agent.moving
    full, data = np.zeros((len(q), robot.model.nq)), robot.model.createData()
    full[:, moving] = q
    gravity = np.array([pin.computeGeneralizedGravity(robot.model, data, row)[moving] for row in full])
    predicted = np.stack([over_lift(dense, column) for column in agent.tau[:, moving].T], axis=1)
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
