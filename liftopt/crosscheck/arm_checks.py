"""The checks of a fixed-base chain, human or robot: torques, sensitivities and ground reaction."""

from __future__ import annotations

import numpy as np

from liftopt.crosscheck import oracle
from liftopt.crosscheck.comparison import Comparison, compare
from liftopt.crosscheck.finite_difference import load_differences
from liftopt.crosscheck.ground_reaction import ground_reaction
from liftopt.crosscheck.kinematics import chain_motion
from liftopt.crosscheck.lagrangian import ExternalLoad, torque_terms
from liftopt.crosscheck.oracle import BodyLoad, frame_attachment
from liftopt.crosscheck.sensitivity import force_sensitivity, moment_sensitivity
from liftopt.crosscheck.systems import CheckedSystem, States, random_load, random_states

RNEA, JACOBIAN, DIFFERENCE = "Pinocchio RNEA", "Pinocchio -J^T", "central difference of eq. 1"
BALANCE = "Newton-Euler balance of the whole body"


def arm_checks(system: CheckedSystem, samples: int, rng: np.random.Generator) -> list[Comparison]:
    """Return all comparisons of one fixed-base chain over ``samples`` random states."""
    state = random_states(system, samples, rng)
    last = len(system.chain.rows) - 1
    held = random_load(last, system.grasp_points[0], samples, rng)
    joint, point = frame_attachment(system.model, system.grasp_frames[0])
    grasp = BodyLoad(joint, point, system.to_world(held.force), system.to_world(held.moment))
    return [
        *_torque_checks(system, state, held, grasp, rng),
        *_sensitivity_checks(system, state, held, grasp),
        *_ground_checks(system, state, held, grasp),
    ]


def _torque_checks(
    system: CheckedSystem,
    state: States,
    held: ExternalLoad,
    grasp: BodyLoad,
    rng: np.random.Generator,
) -> list[Comparison]:
    chain, model = system.chain, system.model
    motion = chain_motion(chain, *state)
    everywhere = [random_load(link, rng.uniform(-0.3, 0.3, 3), len(held.force), rng) for link in range(len(chain.rows))]
    cases: tuple[tuple[str, list[ExternalLoad], list[BodyLoad]], ...] = (
        ("torque, no load (eqs. 1-3)", [], []),
        ("torque, grasp force and moment (eqs. 1-5)", [held], [grasp]),
        ("torque, loads on all links (eqs. 1-5)", everywhere, [system.body_load(load) for load in everywhere]),
    )
    return [
        compare(
            chain.name,
            quantity,
            RNEA,
            "N, Nm",
            torque_terms(chain, motion, system.gravity, ours).tau,
            oracle.torques(model, *state, theirs),
        )
        for quantity, ours, theirs in cases
    ]


def _sensitivity_checks(system: CheckedSystem, state: States, held: ExternalLoad, grasp: BodyLoad) -> list[Comparison]:
    chain = system.chain
    motion = chain_motion(chain, *state)
    by_force = force_sensitivity(motion, held.link, held.point)
    by_moment = moment_sensitivity(chain, motion, held.link)
    positions, jacobians = oracle.point_jacobians(system.model, state[0], grasp.joint, grasp.point)
    # A force in root axes is R_world_root times itself in world axes: J^T R.
    transposed = jacobians.reshape(len(positions), 2, 3, -1).swapaxes(-1, -2) @ system.rotation
    root = motion.link_placement(held.link)
    reached = system.to_world(root[:, :3, :3] @ held.point + root[:, :3, 3]) + system.t_world_root[:3, 3]
    return [
        compare(chain.name, "grasp position (A_n)", "Pinocchio kinematics", "m", reached, positions),
        compare(chain.name, "force sensitivity (eqs. 7-9)", JACOBIAN, "m", by_force, -transposed[:, 0]),
        compare(
            chain.name,
            "force sensitivity (eqs. 7-9)",
            DIFFERENCE,
            "m",
            by_force,
            *load_differences(chain, motion, system.gravity, held, "force"),
        ),
        compare(chain.name, "moment sensitivity", JACOBIAN, "-", by_moment, -transposed[:, 1]),
        compare(
            chain.name,
            "moment sensitivity",
            DIFFERENCE,
            "-",
            by_moment,
            *load_differences(chain, motion, system.gravity, held, "moment"),
        ),
    ]


def _ground_checks(system: CheckedSystem, state: States, held: ExternalLoad, grasp: BodyLoad) -> list[Comparison]:
    chain = system.chain
    ground = ground_reaction(chain, *state, system.gravity, [held])
    foot = system.to_world(ground.foot) + system.t_world_root[:3, 3]
    force, moment = oracle.newton_euler_balance(system.model, *state, foot, [grasp])
    tau = oracle.torques(system.model, *state, [grasp])
    virtual = ground.residual.shape[1] // 2
    return [
        compare(chain.name, "ground force (Fig. 2)", BALANCE, "N", system.to_world(ground.force), force),
        compare(chain.name, "ground moment (Fig. 2)", BALANCE, "Nm", system.to_world(ground.moment), moment),
        compare(
            chain.name, "global joints, second pass", "zero", "N, Nm", ground.residual, np.zeros_like(ground.residual)
        ),
        compare(chain.name, "torque, second pass", RNEA, "Nm", ground.tau[:, virtual:], tau[:, virtual:]),
    ]
