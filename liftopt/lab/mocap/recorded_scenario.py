"""A recorded lift as a scenario: the same person, object, start, end and duration, to be predicted and compared.

A whole person lifts alone, with both hands (``recorded_whole_scenario``). Of trunk and right arm it is as follows. Who
records a lift has a person with two hands on a box; who predicts one has a person's right arm and a robot on
either edge of an object. Common to both is that the object hangs on two carriers. So the robot stands for the left arm:

- The object has its whole mass, and the robot's grasp is the recorded hand mirrored through the object's centre. At two
  points of a level object each carrier bears half of the weight, as each hand of a symmetric lift does; the object is
  therefore kept level.
- The robot's torques are not weighted. A mirrored left arm would take as much effort as the right one, which changes
  no optimum; the robot's effort would.
- Grasp forces are weighted so heavily that each carrier gives half of the horizontal force too. The two hands of a
  symmetric lift can press against each other sideways only, never forward, so that what a robot opposite the person
  could hold against them has no counterpart.

Left out are the left arm's load on the trunk (as in a recorded lift of ``liftopt mocap``), that a second hand on the
box keeps the trunk from turning, shelves and other obstacles, and that the feet may move or the arm start in motion.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.errors import NO_VALUE, InputError
from liftopt.lab.mocap.recorded_lift import RecordedLift
from liftopt.lab.mocap.recorded_whole_scenario import to_thousandths, whole_scenario
from liftopt.multibody.bounds import checked_number
from liftopt.multibody.person.human import NAME, VIRTUAL
from liftopt.multibody.urdf import joint_name, load_model
from liftopt.scenario.model import Scenario, scenario_from_dict
from liftopt.types import Array

REACH = 0.85  # m from the robot's base to its grasp: comfortable for Sawyer
LEVEL = 1.0  # deg that the object may tilt
FORCE_WEIGHT = 1.0  # leaves a squeeze of 3 N of 30 N in the recorded box lift; the default leaves 55 N
WIDTH, HEIGHT = 0.3, 0.3  # m of the object: they move the centre of mass, which markers do not show


def recorded_scenario(lift: RecordedLift, object_mass: float, name: str = "recorded") -> Scenario:
    """Return the scenario of a recorded lift.

    Without a whole person places are those of the hand against the base of the spine, at the start and the end of the
    time in which the object is carried; heights are above the ground that the stature implies.

    Args:
        lift: with an object.
        object_mass: of all that is lifted [kg].
        name: of the scenario.

    Raises:
        InputError: the recording shows no object that moves, or a value is out of a scenario's range.
    """
    mass = checked_number("--object-mass", object_mass, 0.05, 50.0, "kg")
    if lift.carried is None and len(lift.lifts) > 1:
        shows = f"{lift.source} shows {len(lift.lifts)} lifts, {lift.lift_times()}; choose one by its number"
        raise InputError("--lift", NO_VALUE, shows)
    if lift.carried is None or lift.object_position is None or lift.carried[0] >= lift.carried[1]:
        raise InputError(lift.source, NO_VALUE, "shows no object that is carried: start and end are not known")
    if lift.whole is not None:
        return whole_scenario(lift, lift.whole, mass, name)
    hand, lifted = lift.over_lift(lift.hand_position, 2), lift.over_lift(lift.object_position, 2)
    place = hand - lift.over_lift(_base_travel(lift), 2)
    # The hand, mirrored through the object's centre, seen from above: between the two carriers lies this.
    depth = 2.0 * float(np.linalg.norm((lifted - hand)[:, :2], axis=1).mean())
    start, end = ({"height": to_thousandths(z), "human_distance": to_thousandths(x)} for x, _, z in place)
    person = lift.subject
    return scenario_from_dict(
        {
            "schema": 2,
            "name": name,
            "duration": to_thousandths(lift.carried[1] - lift.carried[0]),
            "agents": {
                "human": {
                    "kind": "person",
                    "stature": to_thousandths(person.stature),
                    "mass": person.mass,
                    "sex": person.sex,
                },
                "robot": {"kind": "robot", "model": "sawyer", "weight": 0.0},
            },
            "object": {"mass": mass, "depth": to_thousandths(depth), "width": WIDTH, "height": HEIGHT},
            "task": {
                "standing_distance": to_thousandths(float(place[:, 0].mean()) + depth + REACH),
                "start": start,
                "end": end,
            },
            "objective": {"preset": "paper", "force_weight": FORCE_WEIGHT},
            "limits": {"table_pitch_deg": LEVEL, "table_yaw_deg": LEVEL},
        }
    )


def _base_travel(lift: RecordedLift) -> Array:
    """Return (K, 3) how far the base of the spine is from over the feet, in the world [m]; predicted ones stand."""
    model = load_model(lift.urdf)
    data, joint = model.createData(), model.getJointId(joint_name(NAME, VIRTUAL[-1]))
    places = []
    for q in (np.zeros(model.nq), *lift.q):
        pin.forwardKinematics(model, data, q)
        places.append(data.oMi[joint].translation.copy())
    return np.asarray(np.stack(places[1:]) - places[0], float)
