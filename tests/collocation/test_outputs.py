"""Where the outputs of an agent's kernel are: against the kernels themselves and Pinocchio."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.outputs import outputs_of
from liftopt.collocation.problem import kernel_requests
from liftopt.multibody.agent import Agent, Grasp, LiftedObject, Stance

WRENCH = Grasp("arm", "tip", moments=True, max_moment=10.0)


@pytest.mark.parametrize("grasp", [Grasp("arm", "tip"), WRENCH])
def test_every_output_of_a_kernel_has_its_place(
    make_arm: Callable[..., Agent], make_box: Callable[..., LiftedObject], grasp: Grasp, rng: np.random.Generator
) -> None:
    """Pinocchio has the grasp point; the squares are those of the forces that went in."""
    agent = replace(make_arm(1), grasps=(grasp,))
    build, topology = kernel_requests((agent,), make_box(np.zeros((1, 3))))[0]
    value, own = build(topology).value, outputs_of(agent)
    y = rng.normal(size=value.size1_in(0))
    c = np.asarray(value(y, ca.vertcat(1.0, topology.parameters))).ravel()
    assert own.size == len(c) and own.tau == slice(0, 4)
    data = agent.model.createData()
    pin.framesForwardKinematics(agent.model, data, y[:4])
    np.testing.assert_allclose(c[own.position("tip")], data.oMf[agent.model.getFrameId("tip")].translation, atol=1e-12)
    assert c[own.force_squared("tip")] == pytest.approx(y[12:15] @ y[12:15])
    if grasp.moments:
        assert c[own.moment_squared("tip")] == pytest.approx(y[15:18] @ y[15:18])
        assert np.linalg.norm(c[own.wrench("tip")]) == pytest.approx(np.linalg.norm(y[12:18]))
        assert -0.5 <= float(c[own.cosine("tip")][0]) <= 1.0


def test_hands_follow_each_other_and_the_ground_comes_last(make_arm: Callable[..., Agent]) -> None:
    """By hand: 12 outputs a hand, used or not, and 6 of the ground."""
    stance = Stance(((-0.1, 0.2, 0.1),), 0.5, 2.0, np.zeros(3))
    both = replace(make_arm(1), hands=("right", "left"), grasps=(replace(WRENCH, frame="left"),), stance=stance)
    own = outputs_of(both)
    assert (own.position("right"), own.position("left")) == (slice(4, 7), slice(16, 19))
    assert (own.cosine("left"), own.wrench("left")) == (slice(21, 22), slice(22, 28))
    assert (own.ground, own.size) == (slice(28, 34), 34)
