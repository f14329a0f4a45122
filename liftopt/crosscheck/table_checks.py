"""The checks of the floating base, eq. 6: six virtual joints beside Pinocchio's free-flyer."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from liftopt.crosscheck import oracle
from liftopt.crosscheck.comparison import Comparison, compare
from liftopt.crosscheck.finite_difference import load_differences
from liftopt.crosscheck.floating_base import BodyMotion, body_motion, body_wrench, joint_forces
from liftopt.crosscheck.kinematics import ChainMotion, chain_motion
from liftopt.crosscheck.lagrangian import ExternalLoad, torque_terms
from liftopt.crosscheck.oracle import BodyLoad, frame_attachment
from liftopt.crosscheck.sensitivity import force_sensitivity
from liftopt.crosscheck.systems import CheckedSystem, random_load, random_states
from liftopt.multibody.dh import frame_transforms
from liftopt.types import Array

RNEA = "S^T of Pinocchio RNEA, free-flyer"


def table_checks(system: CheckedSystem, samples: int, rng: np.random.Generator) -> list[Comparison]:
    """Return all comparisons of the floating base over ``samples`` random states."""
    chain, model = system.chain, system.model
    motion = chain_motion(chain, *random_states(system, samples, rng))
    body = body_motion(motion, system.t_world_root, body_in_last_link(system))
    q, last = free_flyer_positions(body), len(chain.rows) - 1
    loads = [random_load(last, point, samples, rng) for point in system.grasp_points]
    attached = [
        BodyLoad(*frame_attachment(model, frame), system.to_world(load.force), system.to_world(load.moment))
        for frame, load in zip(system.grasp_frames, loads, strict=True)
    ]
    wrench_free = oracle.torques(model, q, body.twist, body.twist_rate)
    wrench_held = oracle.torques(model, q, body.twist, body.twist_rate, attached)
    tau_free = torque_terms(chain, motion, system.gravity, []).tau
    tau_held = torque_terms(chain, motion, system.gravity, loads).tau
    balanced = torque_terms(chain, motion, system.gravity, [_balancing_load(system, body, wrench_free)]).tau
    return [
        compare(
            chain.name, "virtual joints, no load (eq. 6)", RNEA, "N, Nm", tau_free, joint_forces(body, wrench_free)
        ),
        compare(
            chain.name, "virtual joints, two grasps (eq. 6)", RNEA, "N, Nm", tau_held, joint_forces(body, wrench_held)
        ),
        compare(
            chain.name,
            "wrench on the body, two grasps",
            "Pinocchio RNEA, free-flyer",
            "N, Nm",
            body_wrench(body, tau_held),
            wrench_held,
        ),
        compare(chain.name, "eq. 6 under Pinocchio's wrench", "zero", "N, Nm", balanced, np.zeros_like(balanced)),
        *_sensitivity_checks(system, motion, body, loads[0], attached[0]),
    ]


def _sensitivity_checks(
    system: CheckedSystem, motion: ChainMotion, body: BodyMotion, load: ExternalLoad, attached: BodyLoad
) -> list[Comparison]:
    chain = system.chain
    positions, jacobians = oracle.point_jacobians(
        system.model, free_flyer_positions(body), attached.joint, attached.point
    )
    sensitivity = force_sensitivity(motion, load.link, load.point)
    transposed = (jacobians[:, :3] @ body.jacobian).swapaxes(1, 2) @ system.rotation
    link = system.t_world_root @ motion.link_placement(load.link)
    reached = link[:, :3, :3] @ load.point + link[:, :3, 3]
    differences, bound = load_differences(chain, motion, system.gravity, load, "force")
    quantity = "force sensitivity (eqs. 7-9)"
    return [
        compare(chain.name, "grasp position (A_n)", "Pinocchio kinematics", "m", reached, positions),
        compare(chain.name, quantity, "Pinocchio -(J S)^T", "m", sensitivity, -transposed),
        compare(chain.name, quantity, "central difference of eq. 1", "m", sensitivity, differences, bound),
    ]


def body_in_last_link(system: CheckedSystem) -> Array:
    """Return T_link_body (4, 4): the body frame is aligned with the world where all virtual joints are at zero."""
    placement = system.t_world_root @ frame_transforms(system.chain, np.zeros(len(system.chain.rows)))[-1]
    turned = np.eye(4)
    turned[:3, :3] = placement[:3, :3].T
    return turned


def free_flyer_positions(body: BodyMotion) -> Array:
    """Return Pinocchio's q (S, 7), position and quaternion x y z w, of the body's placement."""
    return np.array([pin.SE3ToXYZQUAT(pin.SE3(placement)) for placement in body.placement])


def _balancing_load(system: CheckedSystem, body: BodyMotion, wrench: Array) -> ExternalLoad:
    """Return ``wrench`` (S, 6), body axes, as a load at the body frame's origin, root axes."""
    rotation = system.rotation.T @ body.placement[:, :3, :3]
    force, moment = (np.einsum("sij,sj->si", rotation, part) for part in (wrench[:, :3], wrench[:, 3:]))
    return ExternalLoad(len(system.chain.rows) - 1, body_in_last_link(system)[:3, 3], force, moment)
