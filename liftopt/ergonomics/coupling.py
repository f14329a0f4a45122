"""How well an object can be held, as NIOSH and REBA tell it: good, fair or poor."""

from __future__ import annotations

from typing import Literal

from liftopt.ergonomics.lift import Lift
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.placement import grasp_points

Coupling = Literal["good", "fair", "poor"]
# NIOSH's multiplier below 75 cm and from there on (Applications Manual, Table 7).
COUPLED: dict[Coupling, tuple[float, float]] = {"good": (1.0, 1.0), "fair": (0.95, 1.0), "poor": (0.90, 0.90)}
# Of a box whose fingers' hold below it is fair: frontal length and height (Applications Manual) [m].
LONGEST, HIGHEST = 0.40, 0.30
BELOW = 1e-3  # [m] off the underside; a hand that is nearer holds the object from below


def coupling_of(lift: Lift, person: AgentTrajectory) -> Coupling:
    """Return how well a person holds the object.

    Fair is a grip with the fingers bent under a box that is at most 0.40 m wide and 0.30 m high. All else is poor: a
    larger box, a flat hand, a hand at a side.
    """
    box, points = lift.scenario.object, grasp_points(lift.scenario)
    if box.width > LONGEST or box.height > HIGHEST or any(grasp.friction is not None for grasp in person.grasps):
        return "poor"
    below = [abs(points[grasp.name][2] + box.height / 2.0) <= BELOW for grasp in person.grasps]
    return "fair" if all(below) else "poor"
