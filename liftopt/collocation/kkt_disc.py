"""Outputs and slopes of the kernel of an agent with a disc, recomputed with Pinocchio on the tree that is cut there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from liftopt.collocation.disc_dynamics import CutOrder
from liftopt.collocation.kkt_agent import agent_knots
from liftopt.collocation.outputs import outputs_of
from liftopt.multibody.agent import Agent
from liftopt.multibody.disc import at_the_cut, cut_model
from liftopt.types import Array


def disc_agent_knots(agent: Agent, y: Array, period: float) -> tuple[Array, Array]:
    """Return what ``agent_knots`` does, and of an agent with a disc what passes it; arguments as there."""
    if agent.disc is None:
        return agent_knots(agent, y, period)
    model = cut_model(agent.reduced(), agent.disc)
    tree = replace(agent, model=model, locked_joints=(), posture=np.zeros(model.nv), disc=None)
    more = 3 * (model.nv - len(agent.posture))
    own, first = outputs_of(tree), at_the_cut(model, agent.disc.joint).start
    order = CutOrder.of(y.shape[1] + more, own.size, model.nv, first)
    at_rest = np.zeros((len(y), y.shape[1] + more))
    at_rest[:, order.variables] = y
    outputs, jacobian = agent_knots(tree, at_rest, period)
    return outputs[:, order.outputs], jacobian[:, order.outputs][:, :, order.variables]
