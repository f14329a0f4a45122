"""The elastic mode: which limits a lift would have to break, where, when and by how much.

Every row but the balance may be violated, at a price that is linear in the violation. So few rows are violated, and a
lift that is possible is found with none broken (an exact penalty). A little of the objective is kept, to choose among
motions. Ranges of motion, poses at the ends and the object's balance always hold.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from liftopt.collocation.assembly import Nlp, constant
from liftopt.collocation.batch import Batch
from liftopt.collocation.constraints import Block
from liftopt.collocation.problem import Problem
from liftopt.collocation.soles import FRICTION, PRESSURE, weight_of
from liftopt.collocation.solvers.banded_nlp import kernels_for_simd
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.ipopt import Ipopt, IpoptOptions
from liftopt.collocation.solvers.simd_nlp import simd_nlp
from liftopt.collocation.task import OBJECT_COORDINATES
from liftopt.types import Array

# Price of a gap of 1 m, of a share of a limit, and of 1 m outside a half-space, too near to another body or off the
# soles: a broken limit can be put right by someone stronger or slower, a grasp that does not hold cannot.
CLOSURE_PRICE, SHARE_PRICE, WORKSPACE_PRICE, CLEARANCE_PRICE, PRESSURE_PRICE = 1000.0, 10.0, 100.0, 100.0, 100.0
LINEAR = OBJECT_COORDINATES[:3]
# Weight of the objective beside the prices; its multipliers stay far below them.
OBJECTIVE = 1e-4
TOLERANCE, MAX_ITERATIONS = 1e-3, 250
# Forces may exceed their cap by this factor; the rows say by how much they do.
FORCE_ROOM = 10.0
# Violations below these are none [m, share of the limit].
NO_GAP, NO_SHARE = 1e-4, 1e-3


@dataclass(frozen=True)
class Violation:
    """One limit of one joint, agent or grasp that is broken.

    Attributes:
        constraint: name of the block of rows, see ``Block``.
        who: joint, agent, grasp or coordinate of the object.
        time: where it is broken most [s].
        amount: by how much there, in ``unit``.
        share: ``amount`` as a share of the limit; of a gap, in metres.
        unit: of ``amount``.
        price: what all of it costs, to rank by.
    """

    constraint: str
    who: str
    time: float
    amount: float
    share: float
    unit: str
    price: float


@dataclass(frozen=True)
class ElasticMotion:
    """A motion that breaks as little as possible.

    Attributes:
        x: (n_x,) unknowns of the problem.
        violations: what it breaks, the costliest first; empty if nothing.
        converged: whether that is a local optimum.
        iterations: that it took to find.
    """

    x: Array
    violations: tuple[Violation, ...]
    converged: bool
    iterations: int

    @property
    def possible(self) -> bool:
        """Whether nothing is broken: there is a lift at ``x`` or near it."""
        return self.converged and not self.violations


def solve_elastic(problem: Problem, x0: Array, deadline: Deadline, most: int = MAX_ITERATIONS) -> ElasticMotion:
    """Return the motion near ``x0`` (n_x,) that breaks as little as possible, after ``most`` iterations at the latest.

    Raises:
        SolverError: IPOPT cannot run.
    """
    soft = SoftProblem(problem.team, problem.task, problem.mesh, problem.posture_weight, problem.planes)
    start = soft.start(x0)
    result = Ipopt(soft, IpoptOptions(TOLERANCE, MAX_ITERATIONS, 1.0)).solve(start, deadline=deadline, most=most)
    x, slack = np.split(result.x, [problem.layout.n_x])
    lower, upper = problem.bounds()
    return ElasticMotion(np.clip(x, lower, upper), soft.violations(slack), result.converged, result.iterations)


@dataclass(frozen=True, eq=False)
class SoftProblem(Problem):
    """A problem whose rows may be violated at a price.

    Its unknowns are those of the problem, then what is missing below each of ``soft`` rows, then above.
    """

    @cached_property
    def plain(self) -> Problem:
        """The problem itself."""
        return Problem(self.team, self.task, self.mesh, self.posture_weight, self.planes)

    @cached_property
    def soft(self) -> npt.NDArray[np.int64]:
        """The rows that may be violated."""
        return np.concatenate(
            [np.arange(b.rows.start, b.rows.stop) for b in self.constraints.blocks if b.name != "balance"]
        )

    @cached_property
    def prices(self) -> Array:
        """Price of each soft row, per unit of the row."""
        return np.concatenate([self._price(b) for b in self.constraints.blocks if b.name != "balance"])

    @cached_property
    def hard(self) -> Nlp:
        """The functions of the plain problem; callbacks among them must outlive what calls them."""
        kernels = kernels_for_simd(self.plain)
        return simd_nlp(self.plain, kernels) if kernels else self.plain.nlp

    @cached_property
    def nlp(self) -> Nlp:
        """The functions a solver calls."""
        hard, n, m = self.hard, self.layout.n_x, len(self.soft)
        z = ca.MX.sym("z", n + 2 * m)
        x, slack = z[:n], z[n:]
        rows, count = self.constraints.linear.shape[0], 2 * m
        signs = np.repeat([1.0, -1.0], m)
        signed = constant(sp.csc_matrix((signs, (np.tile(self.soft, 2), np.arange(count))), shape=(rows, count)))
        prices = ca.DM(np.concatenate([self.prices, self.prices]))
        p, sigma, lam = hard.p, ca.MX.sym("lam_f"), ca.MX.sym("lam_g", rows)
        f, gradient = hard.grad_f(x, p)
        g, jacobian = hard.jac_g(x, p)
        values = ca.Function("nlp_fg", [hard.x, hard.p], [hard.f, hard.g])(x, p)
        paid, curved = ca.dot(prices, slack), hard.hess_lag(x, p, OBJECTIVE * sigma, lam)
        taken = ca.mtimes(signed, slack)
        return Nlp(
            z, p, OBJECTIVE * values[0] + paid, values[1] + taken,
            grad_f=ca.Function("nlp_grad_f", [z, p], [OBJECTIVE * f + paid, ca.vertcat(OBJECTIVE * gradient, prices)],
                               ["x", "p"], ["f", "grad_f_x"]),
            jac_g=ca.Function("nlp_jac_g", [z, p], [g + taken, ca.horzcat(jacobian, ca.MX(signed))],
                              ["x", "p"], ["g", "jac_g_x"]),
            hess_lag=ca.Function("nlp_hess_l", [z, p, sigma, lam], [ca.diagcat(curved, ca.MX(count, count))],
                                 ["x", "p", "lam_f", "lam_g"], ["triu_hess_gamma_x_x"]),
        )  # fmt: skip

    def bounds(self) -> tuple[Array, Array]:
        """Return lower and upper bounds of the unknowns and of what is missing."""
        task = replace(self.task, max_grasp_force=FORCE_ROOM * self.task.max_grasp_force)
        lower, upper = replace(self.plain, task=task).bounds()
        none = np.zeros(2 * len(self.soft))
        return np.concatenate([lower, none]), np.concatenate([upper, none + np.inf])

    def start(self, x: Array) -> Array:
        """Return a vector of unknowns that meets every soft row from ``x`` (n_x,)."""
        g = Batch(self, self.soft).rows(x[None])[0]
        lower, upper = self.constraints.lower[self.soft], self.constraints.upper[self.soft]
        return np.concatenate([x, np.maximum(0.0, lower - g), np.maximum(0.0, g - upper)])

    def violations(self, slack: Array) -> tuple[Violation, ...]:
        """Return what is violated, joint by joint, the costliest first."""
        below, above = np.split(slack, 2)
        missing, found, at = np.maximum(below, above), [], 0
        for block in self.constraints.blocks:
            if block.name == "balance":
                continue
            n = block.rows.stop - block.rows.start
            amounts = missing[at : at + n].reshape(-1, len(block.labels))
            prices = self.prices[at : at + n].reshape(amounts.shape)
            at += n
            found += (self._near if block.name == "clearance" else self._of)(block, amounts, prices)
        return tuple(sorted(found, key=lambda violation: -violation.price))

    def _near(self, block: Block, amounts: Array, prices: Array) -> list[Violation]:
        """Return what comes too near what, of the rows between two bodies (knots, rows)."""
        assert self.planes is not None
        separation = next(s for s in self.planes.separations if block.who == f"{s.one} and {s.other}")
        names, found = np.array(separation.names), []
        for name in sorted(set(names[amounts > NO_GAP].tolist()) - {""}):
            own = np.where(names == name, amounts, 0.0)
            k, j = np.unravel_index(int(own.argmax()), own.shape)
            most, time = float(own[k, j]), float(self.mesh.phase[k]) * self.task.duration
            found.append(Violation(block.name, name, time, most, most, "m", float((own * prices).sum())))
        return found

    def _of(self, block: Block, amounts: Array, prices: Array) -> list[Violation]:
        """Return the violations of one block of rows (knots, labels)."""
        task, names = self.task, [agent.name for agent in self.team.agents]
        grasps = {grasp.name: grasp for grasp in self.team.grasps}
        phase, who, unit = self.mesh.phase, list(block.labels), "m"
        share = amounts
        if block.name == "grasp_closure":
            phase = phase[self.mesh.closure_knots]
            amounts, prices = np.linalg.norm(amounts, axis=1)[:, None], prices[:, :1]
            share, who = amounts, [block.who]
        elif block.name == "workspace":
            who = [block.who]
        elif block.name == "torque":
            limits, unit = self.team.agents[names.index(block.who)].limits, "Nm"
            amounts = amounts * np.maximum(np.abs(limits.tau_lower), np.abs(limits.tau_upper))
        elif block.name == "grasp_force":
            # The row is the squared norm as a share of the squared cap.
            share, who, unit = np.sqrt(1.0 + amounts) - 1.0, [block.who], "N"
            amounts = share * task.max_grasp_force
        elif block.name == "grasp_moment":
            share, who, unit = np.sqrt(1.0 + amounts) - 1.0, [block.who], "Nm"
            amounts = share * grasps[block.who].max_moment
        elif block.name == "grasp_turn":
            # The row is the angle's cosine.
            who, unit = [block.who], "deg"
            amounts = np.degrees(grasps[block.who].turn_beyond(amounts))
        elif block.name in ("friction", "pressure"):
            unit = "N" if block.name == "friction" else "Nm"
            who = [f"{block.who} {label}" for label in block.labels]
        elif block.name == FRICTION:
            who, unit = [f"{block.who} {label}" for label in block.labels], "N"
            amounts = amounts * weight_of(self.team.agents[names.index(block.who)])
        elif block.name == "lean":
            who, unit = [f"{block.who} {label}" for label in block.labels], "deg"
            most = np.arccos(1.0 - block.upper[0])
            amounts = np.degrees(np.arccos(np.clip(np.cos(most) - amounts, -1.0, 1.0)) - most)
        elif block.name == "compression":
            disc = self.team.agents[names.index(block.who)].disc
            assert disc is not None
            # Several rows tell the same compression, each with other muscles.
            prices, amounts, who, unit = prices[:, :1], disc.unit * amounts.max(axis=1)[:, None], [block.who], "N"
            share = amounts / disc.most
        elif block.name == PRESSURE:
            who = [f"{block.who} {label}" for label in block.labels]
        elif block.name == "velocity":
            phase = self.mesh.slope_phase
            share, amounts = amounts / block.upper.reshape(amounts.shape), amounts / task.duration
            unit = "rad/s"
            if block.who not in names:
                who = [f"{block.who} {label}" for label in block.labels]
        worst = np.argmax(amounts, axis=0)
        least = NO_GAP if unit == "m" else NO_SHARE
        linear = block.name == "velocity" and block.who not in names
        units = ["m/s" if linear and label in LINEAR else unit for label in block.labels]
        if block.name in ("torque", "velocity") and block.who in names:
            of_joints = self.team.agents[names.index(block.who)].units
            own = [of_joints[label] for label in block.labels]
            units = [each.tau if block.name == "torque" else each.v for each in own]
        return [
            Violation(
                block.name, who[j], float(phase[k]) * task.duration, float(amounts[k, j]), float(share[k, j]), units[j],
                float((prices * share if block.name == "grasp_closure" else share * SHARE_PRICE)[:, j].sum()),
            )
            for j, k in enumerate(worst)
            if share[k, j] > least
        ]  # fmt: skip

    def _price(self, block: Block) -> Array:
        """Return the price of each row of a block, by the share of time it stands for: half at both ends.

        Otherwise it would pay to start and end with a jerk: the accelerations of a motion from rest to rest sum to
        nothing only where those at the ends count half.
        """
        if len(block.lower) == len(self.mesh.weights) * len(block.labels):
            share = np.repeat(self.mesh.weights / self.mesh.weights.max(), len(block.labels))
            return np.asarray(share * self._unit_price(block))
        return self._unit_price(block)

    def _unit_price(self, block: Block) -> Array:
        if block.name == "grasp_closure":
            return np.full(len(block.lower), CLOSURE_PRICE)
        if block.name == "workspace":
            return np.full(len(block.lower), WORKSPACE_PRICE)
        if block.name == PRESSURE:
            return np.full(len(block.lower), PRESSURE_PRICE)
        if block.name == "clearance":
            return np.full(len(block.lower), CLEARANCE_PRICE)
        if block.name == "velocity":
            return SHARE_PRICE / block.upper
        # The squared share of a force grows twice as fast as the share.
        squared = block.name in ("grasp_force", "grasp_moment")
        return np.full(len(block.lower), SHARE_PRICE / 2 if squared else SHARE_PRICE)
