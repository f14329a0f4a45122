"""How far bodies keep apart in a solution."""

from __future__ import annotations

from liftopt.multibody.solid_pairs import solid_pairs
from liftopt.scenario.build import agents_of, object_of, obstacles_of
from liftopt.solution.clearance import Clearance
from liftopt.solution.clearance_measure import NEAR, measure_clearance
from liftopt.solution.solution import Solution

MOST_TIMES = 4001  # 400 mesh intervals, ten times finer; of a longer solution every other time, or every third...


def clearance_of(fine: Solution) -> Clearance:
    """Return how far bodies keep apart at the times of a solution; give it between its knots.

    Raises:
        ModelError: a model of the solution has a collision shape that is no box, cylinder or sphere.
    """
    scenario, step = fine.scenario, -(-len(fine.time) // MOST_TIMES)
    models, lifted = agents_of(scenario, fine.urdfs), object_of(scenario, fine.urdfs)
    agents = [(model, motion.every(step)) for model, motion in zip(models, fine.agents, strict=True)]
    pairs = solid_pairs(models, lifted, obstacles_of(scenario))
    near = NEAR + (scenario.limits.clearance or 0.0)
    return measure_clearance(fine.time[::step], agents, (lifted, fine.object.every(step)), pairs, near)
