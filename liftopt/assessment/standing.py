"""How a person stands during the lift: how near the feet come to leaving the floor or to slipping."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from liftopt.assessment.who import Who
from liftopt.ergonomics.lift import model_of
from liftopt.multibody.agent import Agent
from liftopt.multibody.person.stance import FRICTION_SOURCE, FRONT_SOURCE, SWAY
from liftopt.multibody.standing import ground_in_base, pressure_in_base, support_margin
from liftopt.multibody.trajectory import AgentTrajectory
from liftopt.solution.finding import CAUTION, INFO, PERSON, Finding, percent
from liftopt.solution.solution import Solution
from liftopt.types import Array

NEAR_EDGE = SWAY / 2.0  # [m]: between knots less than this is left of the room for a sway
NEAR_SLIP = 0.9  # share of friction from which a caution is due
SIDES = ("heels", "balls of the feet", "outer edge of a foot")


def standing_findings(fine: Solution, person: AgentTrajectory, who: Who) -> Iterator[Finding]:
    """Give what is to be said of a person's stand; nothing of one whom the base holds whatever happens."""
    agent = model_of(fine, person.name)
    if agent.stance is not None:
        yield _balance(fine, agent, person, who)
        yield _slip(fine, agent, person, agent.stance.friction, who)


def _balance(fine: Solution, agent: Agent, person: AgentTrajectory, who: Who) -> Finding:
    margin = support_margin(agent, person)
    k = int(np.argmin(margin))
    least, time = max(float(margin[k]), -1.0), float(fine.time[k])
    edge = SIDES[_nearest(agent, pressure_in_base(agent, person)[k])]
    if least < 0.0:  # between knots, where no row holds it
        title = f"stands {-1000 * least:.0f} mm beyond the {edge} between knots"
        where = f"passes the {edge} by {-1000 * least:.0f} mm"
    else:
        title = f"stands {1000 * least:.0f} mm within the soles at least"
        where = f"comes within {1000 * least:.0f} mm of the {edge}"
    return Finding(
        f"{PERSON}.balance",
        CAUTION if least < NEAR_EDGE else INFO,
        title,
        f"The centre of pressure under the feet{who.of} {where} at {time:.2f} s; beyond it the feet would leave the "
        "floor.",
        who.name, None, time, least, 0.0, "m", FRONT_SOURCE.told,
    )  # fmt: skip


def _nearest(agent: Agent, pressure: Array) -> int:
    """Return which of ``SIDES`` a centre of pressure (2,) is nearest to."""
    assert agent.stance is not None
    back, ahead, aside = agent.stance.support
    return int(np.argmin([pressure[0] - back, ahead - pressure[0], aside - abs(float(pressure[1]))]))


def _slip(fine: Solution, agent: Agent, person: AgentTrajectory, friction: float, who: Who) -> Finding:
    ground = ground_in_base(agent, person)
    needed = np.linalg.norm(ground[:, :2], axis=1) / np.maximum(ground[:, 2], 1.0)
    k = int(np.argmax(needed))
    most, time = float(needed[k]), float(fine.time[k])
    return Finding(
        f"{PERSON}.floor_friction",
        CAUTION if most > NEAR_SLIP * friction else INFO,
        f"feet need {percent(most / friction)} % of the floor's friction",
        f"The feet{who.of} need a coefficient of friction of {most:.2f} at {time:.2f} s; {friction:.2f} is taken to be "
        "there.",
        who.name, None, time, most, friction, "", FRICTION_SOURCE.told,
    )  # fmt: skip
