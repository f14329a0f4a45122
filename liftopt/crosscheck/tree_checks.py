"""The checks of the whole person, a tree of links that stands on feet: torques, grasps, ground reaction, energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin

from liftopt.crosscheck import oracle
from liftopt.crosscheck.comparison import Comparison, compare
from liftopt.crosscheck.oracle import BodyLoad, frame_attachment
from liftopt.crosscheck.systems import ACCELERATION, FORCE, MOMENT, VELOCITY
from liftopt.crosscheck.tree_dynamics import GRAVITY, read_tree, tree_forces
from liftopt.multibody.agent import Agent
from liftopt.types import Array

RNEA, BALANCE = "Pinocchio RNEA", "Newton-Euler balance of the whole body"
NODES = 40  # of the Gauss-Legendre rule over the second of a motion


def tree_checks(agent: Agent, samples: int, rng: np.random.Generator) -> list[Comparison]:
    """Return all comparisons of a fixed-base tree over ``samples`` random states; its joints are revolute."""
    model = agent.model
    tree = read_tree(agent.urdf, list(model.names)[1:])
    shape = (samples, model.nv)
    q = rng.uniform(model.lowerPositionLimit, model.upperPositionLimit, shape)
    v, a = rng.uniform(-VELOCITY, VELOCITY, shape), rng.uniform(-ACCELERATION, ACCELERATION, shape)
    loads = {
        name: (rng.uniform(-FORCE, FORCE, (samples, 3)), rng.uniform(-MOMENT, MOMENT, (samples, 3)))
        for name in agent.hands
    }
    held = [BodyLoad(*frame_attachment(model, name), *load) for name, load in loads.items()]
    free, loaded = tree_forces(tree, q, v, a, {}), tree_forces(tree, q, v, a, loads)
    places = [oracle.point_jacobians(model, q, load.joint, load.point)[0] for load in held]
    force, moment = oracle.newton_euler_balance(model, q, v, a, np.zeros((samples, 3)), held)
    # Pinocchio's balance leaves out what rests on the floor.
    resting = model.inertias[0]
    weight = -resting.mass * GRAVITY
    rows = [
        ("torque, no load", RNEA, "Nm", free.tau, oracle.torques(model, q, v, a)),
        ("torque, forces and moments at all hands", RNEA, "Nm", loaded.tau, oracle.torques(model, q, v, a, held)),
        ("grasp positions", "Pinocchio kinematics", "m", np.stack(list(loaded.positions.values())), np.stack(places)),
        ("ground force, feet included", BALANCE, "N", loaded.force, force + weight),
        ("ground moment, feet included", BALANCE, "Nm", loaded.moment, moment + np.cross(resting.lever, weight)),
    ]
    name = f"{agent.name}, whole"
    compared = [compare(name, what, by, unit, ours, theirs) for what, by, unit, ours, theirs in rows]
    return [*(replace(row, samples=samples) for row in compared), _energy(agent, samples, rng)]


def _energy(agent: Agent, motions: int, rng: np.random.Generator) -> Comparison:
    """Compare the work of the recursion's torques along smooth motions with the change of Pinocchio's energy."""
    model, data = agent.model, agent.model.createData()
    tree = read_tree(agent.urdf, list(model.names)[1:])
    middle = (model.lowerPositionLimit + model.upperPositionLimit) / 2.0
    swing = rng.uniform(-0.3, 0.3, (motions, model.nv)) * (model.upperPositionLimit - model.lowerPositionLimit)
    speed, phase = rng.uniform(1.0, 4.0, (motions, model.nv)), rng.uniform(-np.pi, np.pi, (motions, model.nv))

    def state(time: float) -> tuple[Array, Array, Array]:
        angle = speed * time + phase
        return middle + swing * np.sin(angle), swing * speed * np.cos(angle), -swing * speed**2 * np.sin(angle)

    def energy(time: float) -> Array:
        q, v, _ = state(time)
        return np.array([pin.computeMechanicalEnergy(model, data, *each) for each in zip(q, v, strict=True)])

    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    work = np.zeros(motions)
    for node, weight in zip(nodes, weights, strict=True):
        q, v, a = state((node + 1.0) / 2.0)
        work += weight / 2.0 * (tree_forces(tree, q, v, a, {}).tau * v).sum(axis=1)
    change = energy(1.0) - energy(0.0)
    what, by = "work of the torques in 1 s", "Pinocchio's change of energy"
    return compare(f"{agent.name}, whole", what, by, "J", work, change)
