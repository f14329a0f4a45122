"""How well an object can be held, as NIOSH and REBA tell it: good, fair or poor."""

from __future__ import annotations

from typing import Literal

from liftopt.ergonomics.lift import Lift
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.scenario.grasps import placed_grasps

Coupling = Literal["good", "fair", "poor"]
# NIOSH's multiplier below 75 cm and from there on (Applications Manual, Table 7).
COUPLED: dict[Coupling, tuple[float, float]] = {"good": (1.0, 1.0), "fair": (0.95, 1.0), "poor": (0.90, 0.90)}
# Of a box that fingers hold fairly from below: frontal length and height at most (Applications Manual), and the height
# from which it is a box and no plate with an edge, chosen for this model [m].
LONGEST, HIGHEST, LOWEST = 0.40, 0.30, 0.10
UNDER = ("edge", "bottom")  # holds with the fingers below the box
BELOW = 1e-3  # [m] off the underside; a hand that is nearer holds the object from below


def coupling_of(lift: Lift, person: AgentTrajectory) -> Coupling:
    """Return how well a person holds the object.

    Good are handles. Fair is a grip with the fingers bent under a box that is at most 0.40 m wide, as the person sees
    it, and 0.10 to 0.30 m high. All else is poor: a larger box, a plate, a flat hand, a hand at a side or a corner.
    """
    box, holds = lift.scenario.object, [hold for hold in placed_grasps(lift.scenario) if hold.agent == person.name]
    if any(grasp.friction is not None for grasp in person.grasps):
        return "poor"
    if all(hold.hold == "handle" for hold in holds):
        return "good"
    width = box.depth if holds[0].quarters % 2 else box.width
    below = [hold.hold in UNDER and abs(hold.point[2] + box.height / 2.0) <= BELOW for hold in holds]
    return "fair" if all(below) and width <= LONGEST and LOWEST <= box.height <= HIGHEST else "poor"
