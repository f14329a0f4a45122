"""Standing on two soles: Pinocchio's centre of mass and a person turned on the spot are the oracles."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from liftopt.multibody.agent import Agent
from liftopt.multibody.person.human import human_agent
from liftopt.multibody.person.subject import Subject
from liftopt.multibody.person.whole_body import whole_human_agent
from liftopt.multibody.placement import Placement
from liftopt.multibody.standing import ground_in_base, pressure_in_base, support_margin
from liftopt.multibody.trajectory import AgentTrajectory, agent_trajectory

SUBJECT = Subject(1.6, 60.0, "female")


def _still(agent: Agent, posture: np.ndarray, force: np.ndarray) -> AgentTrajectory:
    none = np.zeros((1, len(posture)))
    return agent_trajectory(agent, posture[None], none, none, force[None])


def _placed(place: Placement) -> tuple[Agent, AgentTrajectory]:
    """Return a person who stands there and pushes the object up, and ahead as she sees it."""
    agent = whole_human_agent(SUBJECT, place=place)
    push = agent.T_world_base[:3, :3] @ np.array([12.0, 0.0, 30.0])
    return agent, _still(agent, agent.posture, np.stack([push, push]))


def test_where_one_stands_and_faces_does_not_matter() -> None:
    here, there = _placed(Placement()), _placed(Placement(1.3, -0.4, np.radians(130.0)))
    np.testing.assert_allclose(ground_in_base(*there), ground_in_base(*here), atol=1e-9)
    np.testing.assert_allclose(pressure_in_base(*there), pressure_in_base(*here), atol=1e-12)
    assert support_margin(*there) == pytest.approx(support_margin(*here))


def test_the_margin_is_that_of_the_nearest_edge() -> None:
    agent = whole_human_agent(SUBJECT)
    assert agent.stance is not None
    back, ahead, aside = agent.stance.support
    for knee in (0.0, 0.3):  # bent at the knees alone one sits back
        posture = np.zeros(20)
        posture[1] = knee
        still = _still(agent, posture, np.zeros((2, 3)))
        moving = pin.centerOfMass(agent.model, agent.model.createData(), posture)
        mass, feet = pin.computeTotalMass(agent.model), agent.stance
        x = (mass * moving[0] + feet.mass * feet.p_base_com[0]) / (mass + feet.mass)
        assert support_margin(agent, still)[0] == pytest.approx(min(x - back, ahead - x, aside), abs=1e-9)


def test_one_who_would_have_to_be_pulled_down_has_no_margin() -> None:
    agent = whole_human_agent(SUBJECT)
    hanging = _still(agent, agent.posture, np.tile([0.0, 0.0, -400.0], (2, 1)))
    assert np.isnan(hanging.centre_of_pressure).all()
    assert support_margin(agent, hanging)[0] == -np.inf


def test_one_who_is_bolted_down_has_no_soles() -> None:
    arm = human_agent(SUBJECT)
    still = _still(arm, arm.posture, np.zeros((1, 3)))
    with pytest.raises(ValueError, match="does not stand on soles"):
        support_margin(arm, still)
    with pytest.raises(ValueError, match="does not stand on soles"):
        pressure_in_base(arm, still)
