"""A robot from outside as an agent, made of the URDF that liftopt wrote of it, which results keep."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
import pinocchio as pin

from liftopt.errors import InputError
from liftopt.multibody.agent import Agent, Grasp, JointLimits, slides
from liftopt.multibody.robots.resting_posture import resting_posture
from liftopt.multibody.robots.robot_urdf import own_joint
from liftopt.multibody.urdf import load_model
from liftopt.types import Array


def written_robot(
    text: str,
    *,
    name: str,
    posture: Mapping[str, float] | None = None,
    joint_weights: Mapping[str, float] | None = None,
    sliding: float = 1.0,
    ahead: Array | None = None,
) -> Agent:
    """Return the agent of a URDF that ``robot_urdf`` wrote; its base is bolted down, it holds at ``<name>_grasp``.

    Args:
        text: of the URDF.
        name: that begins the names of its joints.
        posture: comfortable positions of its joints by the robot's own names.
        joint_weights: factors of joints' squared torques in the objective by those names, by default 1.
        sliding: that factor of joints that slide, beside their own.
        ahead: (3,) which way is ahead, level, in the world, for joints of which ``posture`` says nothing: they are
            where ``resting_posture`` finds them; without it, for what needs no search, in the middle of their ranges.

    Raises:
        InputError: there is no such joint, or it cannot be there; keys are ``<name>.posture.<joint>`` and
            ``<name>.joint_weights.<joint>``.
    """
    model = load_model(text)
    limits = JointLimits(
        q_lower=np.array(model.lowerPositionLimit),
        q_upper=np.array(model.upperPositionLimit),
        velocity=np.array(model.velocityLimit),
        tau_lower=-np.array(model.effortLimit),
        tau_upper=np.array(model.effortLimit),
    )
    chosen = np.full(model.nq, np.nan)
    for i, value in _placed(model, name, "posture", posture or {}):
        low, high = limits.q_lower[i], limits.q_upper[i]
        if not low <= value <= high:
            joint = next(own for own in posture or {} if own_joint(name, own) == model.names[i + 1])
            raise InputError(f"{name}.posture.{joint}", value, f"must be from {low:.4g} to {high:.4g} rad or m")
        chosen[i] = value
    resting = np.where(np.isfinite(chosen), chosen, (limits.q_lower + limits.q_upper) / 2.0)
    if ahead is not None and not np.isfinite(chosen).all():
        resting = resting_posture(model, f"{name}_grasp", limits, ahead, chosen)
    return Agent(
        name=name,
        kind="robot",
        urdf=text,
        model=model,
        locked_joints=(),
        grasps=(Grasp(name, f"{name}_grasp"),),
        hands=(f"{name}_grasp",),
        limits=limits,
        posture=resting,
        shares_kernels=True,
        joint_weights=_weights(model, name, joint_weights or {}, sliding),
    )


def with_joint_weights(agent: Agent, joint_weights: Mapping[str, float]) -> Agent:
    """Return an agent whose joints' squared torques have these factors, by the names without the agent's."""
    if not joint_weights:
        return agent
    return replace(agent, joint_weights=_weights(agent.reduced(), agent.name, joint_weights, 1.0))


def _weights(model: pin.Model, name: str, given: Mapping[str, float], sliding: float) -> Array | None:
    factors = np.where(slides(model), sliding, 1.0)
    for i, value in _placed(model, name, "joint_weights", given):
        factors[i] *= value
    return None if (factors == 1.0).all() else factors


def _placed(model: pin.Model, name: str, key: str, given: Mapping[str, float]) -> Iterable[tuple[int, float]]:
    """Give the number of each joint that is spoken of, and its value."""
    names = list(model.names)[1:]
    for own, value in given.items():
        if own_joint(name, own) not in names:
            known = ", ".join(joint.removeprefix(f"{name}_") for joint in names)
            raise InputError(f"{name}.{key}", own, f"must be a joint that moves: {known}")
        yield names.index(own_joint(name, own)), float(value)
