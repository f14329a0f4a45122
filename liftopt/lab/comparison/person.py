"""What motion capture recorded of a person beside the prediction: joints, hands, and what the ground bears."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from liftopt.errors import InputError
from liftopt.lab.comparison.by_height import first_passes
from liftopt.lab.comparison.comparison import SAMPLES, Comparison
from liftopt.lab.comparison.normalised import compared
from liftopt.lab.meant import the_person
from liftopt.lab.mocap.recorded_lift import RecordedLift, RecordedWhole
from liftopt.multibody.joint_curves import ANATOMY, human_curves
from liftopt.multibody.person.whole_joints import HANDS, TRUNK, table_joint
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.agents import Person
from liftopt.scenario.build import agent_of
from liftopt.solution.solution import Solution
from liftopt.types import Array

NO_FORCE = "none given"  # how a recorded lift says that its hand was taken as empty
SIGNS = {joint.joint: joint.sign for joint in ANATOMY}  # those of the legs are anatomy's own
LEAST_RISE, HEIGHTS = 0.05, 21  # m that both hands pass, and heights at which angles are compared
PATHS = ((0, "x", "forward of its start"), (2, "z", "above its start"))


def person_comparisons(
    dense: Solution, person: str | None, records: Sequence[RecordedLift], notes: list[str]
) -> Iterator[Comparison]:
    """Give the comparisons of a person with recorded lifts, one a trial.

    Of a whole person against a record of trunk and right arm, or the other way round, only the joints of the right arm
    are the same: the trunk of one is against the pelvis, that of the other against the upright.

    Args:
        dense: the prediction on a fine grid.
        person: whom the records are of; None where only one lifts.
        records: of one body, arm or whole.
        notes: that what a reader must know is added to.

    Raises:
        InputError: nobody is the one that is meant, or records are of both bodies.
    """
    if not records:
        return
    human, body = the_person(dense, person), records[0].body
    if other := next((record for record in records if record.body != body), None):
        raise InputError("--mocap", other.source, f"is of body {other.body!r}, but {records[0].source} of {body!r}")
    yield from _joints(dense, human, records, notes)
    sides = _sides(human)
    hold, load = human.p_world_hold, human.load
    if body == "arm" and "right" in sides[:1]:  # a record of trunk and right arm has no other hand
        hold, load, sides = human.grasp_position[:, 0], human.grasp_force[:, 0], sides[:1]
    for axis, name, label in PATHS:
        paths = [record.over_lift(_hold(record, sides)[:, axis], SAMPLES) for record in records]
        predicted = hold[:, axis] - hold[0, axis]
        label = f"{'Hand' if len(sides) == 1 else 'Middle of the hands'}, {label}"
        yield compared("hand_path", name, label, "m", dense, predicted, [path - path[0] for path in paths])
    loaded = [record for record in records if not record.force_from.startswith(NO_FORCE)]
    if loaded:
        vertical = [record.over_lift(_load(record, sides)[:, 2], SAMPLES) for record in loaded]
        label = "Vertical force (mocap)"
        yield compared("hand_force", "mocap", label, "N", dense, load[:, 2], vertical)
    wholes = [(record, record.whole) for record in records if record.whole is not None]
    if wholes:
        yield from _hands(dense, human, sides, wholes)
        yield from _ground(dense, human, wholes, notes)
    notes += [text for record in records for text in _about(dense, human, record)]


def _sides(human: AgentTrajectory) -> tuple[str, ...]:
    """Return the sides of the hands that hold in the prediction; of trunk and right arm the right one."""
    if human.stance is None:
        return ("right",)
    return tuple(grasp.frame.removeprefix(f"{human.name}_").removesuffix("_grasp") for grasp in human.grasps)


def _hold(record: RecordedLift, sides: Sequence[str]) -> Array:
    """Return (K, 3) the middle of the recorded hands of these sides [m]."""
    if record.whole is None:
        return record.hand_position
    return np.asarray(record.whole.grasp_position[:, [HANDS.index(side) for side in sides]].mean(axis=1))


def _load(record: RecordedLift, sides: Sequence[str]) -> Array:
    """Return (K, 3) the force of the recorded hands of these sides together [N]."""
    if record.whole is None:
        return record.hand_force
    return np.asarray(record.whole.grasp_force[:, [HANDS.index(side) for side in sides]].sum(axis=1))


def _joints(
    dense: Solution, human: AgentTrajectory, records: Sequence[RecordedLift], notes: list[str]
) -> Iterator[Comparison]:
    recorded = set(records[0].joint_names)
    same_body = (f"{human.name}_ankle" in human.joint_names) == ("human_ankle" in recorded)
    columns_of: dict[str, tuple[str, int, Array]] = {}
    for curve in human_curves(human):
        name = _recorded_name(curve.joint, recorded, same_body=same_body)
        if name is None:
            continue
        sign = SIGNS.get(table_joint(curve.joint), 1)
        columns_of[curve.joint] = name, sign, curve.q
        columns = [(record, record.joint_names.index(name)) for record in records]
        angles = [record.over_lift(np.degrees(sign * record.q[:, i]), SAMPLES) for record, i in columns]
        torques = [record.over_lift(sign * record.tau[:, i], SAMPLES) for record, i in columns]
        yield compared("human_angle", curve.joint, curve.label, "deg", dense, curve.q, angles)
        yield compared("human_torque", curve.joint, curve.label, "Nm", dense, curve.tau, torques)
    _tell_by_height(human, records, columns_of, notes)
    if not same_body:
        notes.append(
            "one of prediction and record is of a whole person, the other of trunk and right arm: only the right arm's "
            "joints are compared"
        )


def _tell_by_height(
    human: AgentTrajectory,
    records: Sequence[RecordedLift],
    joints: dict[str, tuple[str, int, Array]],
    notes: list[str],
) -> None:
    """Tell how far angles are apart where the hand is as high, whatever the time: pace and waiting do not count.

    Args:
        human: predicted.
        records: one a trial.
        joints: recorded name, sign and predicted angles (T,) [deg] by joint.
        notes: that it is added to.
    """
    above = human.p_world_hold[:, 2]
    sides = _sides(human)
    recorded = [record.over_lift(_hold(record, sides)[:, 2], SAMPLES) for record in records]
    low, high = max(above.min(), *map(np.min, recorded)), min(above.max(), *map(np.max, recorded))
    if high - low < LEAST_RISE:
        notes.append("prediction and records have no heights of the hand in common: no comparison by height")
        return
    heights, found = np.linspace(low, high, HEIGHTS + 2)[1:-1], []
    for joint, (name, sign, predicted) in joints.items():
        passed = [
            first_passes(
                rise, record.over_lift(np.degrees(sign * record.q[:, record.joint_names.index(name)]), SAMPLES), heights
            )
            for rise, record in zip(recorded, records, strict=True)
        ]
        off = first_passes(above, predicted, heights) - np.mean(passed, axis=0)
        if np.isfinite(off).any():
            found.append(f"{joint} {np.sqrt(np.nanmean(off**2)):.1f}")
    notes.append(
        f"angles by the height of the hand, {low:.2f} to {high:.2f} m, instead of by time: RMSE of "
        f"{', '.join(found)} deg"
    )


def _recorded_name(joint: str, recorded: set[str], *, same_body: bool) -> str | None:
    """Return the joint of a record that is a joint of the prediction; None if it has none."""
    if f"human_{joint}" in recorded and (joint not in TRUNK or same_body):
        return f"human_{joint}"
    twin = joint.removeprefix("right_") if joint.startswith("right_") else f"right_{joint}"
    return f"human_{twin}" if f"human_{twin}" in recorded else None


def _hands(
    dense: Solution,
    human: AgentTrajectory,
    sides: Sequence[str],
    wholes: Sequence[tuple[RecordedLift, RecordedWhole]],
) -> Iterator[Comparison]:
    """Give path and force of each hand where several hold in the prediction."""
    for column, side in enumerate(sides if len(sides) > 1 else ()):
        row = HANDS.index(side)
        for axis, name, label in PATHS:
            paths = [record.over_lift(whole.grasp_position[:, row, axis], SAMPLES) for record, whole in wholes]
            predicted = human.grasp_position[:, column, axis] - human.grasp_position[0, column, axis]
            label, shown = f"{side.capitalize()} hand, {label}", [path - path[0] for path in paths]
            yield compared("hand_path", f"{side}_{name}", label, "m", dense, predicted, shown)
        loaded = [(record, whole) for record, whole in wholes if not record.force_from.startswith(NO_FORCE)]
        if loaded:
            forces = [record.over_lift(whole.grasp_force[:, row, 2], SAMPLES) for record, whole in loaded]
            label = f"Vertical force of the {side} hand (mocap)"
            predicted = human.grasp_force[:, column, 2]
            yield compared("hand_force", f"{side}_mocap", label, "N", dense, predicted, forces)


def _ground(
    dense: Solution,
    human: AgentTrajectory,
    wholes: Sequence[tuple[RecordedLift, RecordedWhole]],
    notes: list[str],
) -> Iterator[Comparison]:
    """Give what the ground bears of one who stands, measured by plates where all trials have them."""
    pressure = human.centre_of_pressure
    if pressure is None:
        return
    plates = all(record.plate_force is not None and whole.plate_centre is not None for record, whole in wholes)
    forces: list[Array] = []
    centres: list[Array] = []
    for record, whole in wholes:
        force = record.plate_force if plates and record.plate_force is not None else record.ground_force
        centre = whole.plate_centre if plates and whole.plate_centre is not None else whole.centre_of_pressure
        forces.append(record.over_lift(force[:, 2], SAMPLES))
        centres.append(record.over_lift(centre[:, 0], SAMPLES))
    notes.append(
        "what the ground bears is measured by force plates"
        if plates
        else "what the ground bears is what the recorded motion asks for: no force plates in all trials"
    )
    yield compared("ground", "vertical", "Ground, vertical force", "N", dense, human.ground_force[:, 2], forces)
    ahead = (pressure - human.p_world_base) @ _facing(dense, human)
    yield compared("ground", "pressure", "Centre of pressure, ahead of the ankles", "m", dense, ahead, centres)


def _facing(dense: Solution, human: AgentTrajectory) -> Array:
    """Return (3,) the direction in which a person stands in the world."""
    return np.asarray(agent_of(dense.scenario, human.name, dense.urdfs).T_world_base[:3, 0])


def _about(dense: Solution, human: AgentTrajectory, record: RecordedLift) -> Iterator[str]:
    asked, subject = dense.scenario.agents[human.name], record.subject
    assert isinstance(asked, Person)
    start = record.carried or (record.time[0], record.time[-1])
    what = "while the object is carried" if record.carried else "all of the recording, which shows no object"
    yield (
        f"{record.source}: lift from {start[0]:.2f} to {start[1]:.2f} s ({what}), {start[1] - start[0]:.2f} s; "
        f"predicted {dense.time[-1]:.2f} s"
    )
    yield f"{record.source}: force of the hand behind the joint torques: {record.force_from}"
    if (subject.stature, subject.mass, subject.sex) != (asked.stature, asked.mass, asked.sex):
        yield (
            f"{record.source}: the person recorded is {subject.stature:.3f} m, {subject.mass:g} kg, {subject.sex}; "
            f"predicted is one of {asked.stature:.3f} m, {asked.mass:g} kg, {asked.sex}"
        )
