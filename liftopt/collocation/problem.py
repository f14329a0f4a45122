"""The lift as a nonlinear programme: agents that hold one object, on a mesh, for a task.

It knows no human, robot or table: another robot, a second person or a third agent needs a model and no change here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from liftopt.collocation.arm_dynamics import ArmTopology, arm_functions
from liftopt.collocation.assembly import Nlp, Part, PartParameters, assemble, pack
from liftopt.collocation.codegen.kernels import Builder, Kernel, load_kernels
from liftopt.collocation.constraints import Constraints, build_constraints
from liftopt.collocation.disc_dynamics import DiscTopology, disc_agent_functions
from liftopt.collocation.dynamics import STRUCTURAL_ZERO, Topology, agent_functions, object_functions
from liftopt.collocation.layout import FORCE_SIZE, Layout
from liftopt.collocation.objective import Weights, agent_weights, object_weights
from liftopt.collocation.separating_planes import PosePart, SeparatingPlanes
from liftopt.collocation.spline import Mesh
from liftopt.collocation.standing_dynamics import StandingTopology, standing_agent_functions
from liftopt.collocation.standing_place import held_anywhere
from liftopt.collocation.task import LiftTask
from liftopt.collocation.wrench_dynamics import (
    WrenchTopology,
    wrench_agent_functions,
    wrench_object_functions,
)
from liftopt.errors import ModelError
from liftopt.multibody.agent import Agent, Grasp, LiftedObject
from liftopt.types import Array, Progress


@dataclass(frozen=True, eq=False)
class Team:
    """Agents, the object they hold, and the kernels of their dynamics.

    Attributes:
        agents: their grasps in the order of the object's grasp frames.
        object: the object.
        topologies: of the agents and then of the object, with the values of their parameters.
        kernels: in the same order.
    """

    agents: tuple[Agent, ...]
    object: LiftedObject
    topologies: tuple[Topology, ...]
    kernels: tuple[Kernel, ...]

    @staticmethod
    def of(
        agents: tuple[Agent, ...],
        lifted: LiftedObject,
        progress: Progress | None = None,
        like: Team | None = None,
    ) -> Team:
        """Load or compile the kernels.

        Args:
            agents: their grasps in the order of the object's grasp frames.
            lifted: the object.
            progress: called with a line of text when that takes long.
            like: a team whose kernels are used again if they fit.
        """
        _check(agents, lifted)
        requests = kernel_requests(agents, lifted)
        topologies = tuple(topology for _, topology in requests)
        signatures = tuple(topology.signature() for topology in topologies)
        kernels = (
            like.kernels if like is not None and like.signatures == signatures else load_kernels(requests, progress)
        )
        return Team(agents, lifted, topologies, tuple(kernels))

    @cached_property
    def signatures(self) -> tuple[str, ...]:
        """Digests of what each kernel is generated from."""
        return tuple(topology.signature() for topology in self.topologies)

    @property
    def grasps(self) -> tuple[Grasp, ...]:
        """All grasps, in the order of the agents and of each agent's own."""
        return tuple(grasp for agent in self.agents for grasp in agent.grasps)


@dataclass(frozen=True, eq=False)
class Problem:
    """A team's task on a mesh.

    Attributes:
        team: who lifts what.
        task: what is to be done.
        mesh: where it is collocated.
        posture_weight: weight of the squared joint angles in the objective; only to choose among static postures.
        planes: what keeps bodies apart; None: nothing does.
    """

    team: Team
    task: LiftTask
    mesh: Mesh
    posture_weight: float = 0.0
    planes: SeparatingPlanes | None = None

    @property
    def poses(self) -> tuple[PosePart, ...]:
        """The parts that come after the agents and the object: poses of bodies that are kept apart."""
        return self.planes.parts if self.planes else ()

    @property
    def topologies(self) -> tuple[Topology, ...]:
        """Of every part."""
        return (*self.team.topologies, *(pose.topology for pose in self.poses))

    @property
    def requests(self) -> list[tuple[Builder, Topology]]:
        """What the kernel of every part is generated from."""
        poses = [(pose.builder, pose.topology) for pose in self.poses]
        return kernel_requests(self.team.agents, self.team.object) + poses

    @cached_property
    def layout(self) -> Layout:
        """Positions of the unknowns."""
        return Layout.on(self.mesh, self.team.agents)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The agents, the object and the poses of bodies that are kept apart, as the assembly takes them."""
        return (*self._own_parts, *(Part(pose.kernel, self.layout.select_values(pose.part)) for pose in self.poses))

    @cached_property
    def _own_parts(self) -> tuple[Part, ...]:
        kernels = enumerate(self.team.kernels)
        return tuple(Part(kernel, self.layout.select(i), self.weights(i).range.shape[1]) for i, kernel in kernels)

    @cached_property
    def constraints(self) -> Constraints:
        """The named rows and their bounds."""
        outputs = tuple(part.kernel.n_c for part in self.parts)
        return build_constraints(self.team.agents, self.team.object, self.task, self.layout, outputs, self.planes)

    @cached_property
    def nlp(self) -> Nlp:
        """The functions a solver calls."""
        return assemble(self.parts, self.mesh.weights, self.constraints.combine, self.constraints.linear)

    @cached_property
    def parameters(self) -> Array:
        """Parameter vector of the NLP: T, the models' entries and the weights of the objective."""
        packed = []
        for i in range(len(self.parts)):
            kernel = np.concatenate([[self.task.duration], self.topologies[i].parameters])
            packed.append(PartParameters(kernel, self.weights(i)))
        return pack(packed)

    def same_structure(self, other: Problem) -> bool:
        """Whether unknowns and rows of both mean the same, so that an optimum of one is a start for the other."""
        rows = ([(block.name, block.who, block.rows) for block in p.constraints.blocks] for p in (self, other))
        planes = [p.planes.structure if p.planes else None for p in (self, other)]
        return planes[0] == planes[1] and self.same_unknowns(other) and next(rows) == next(rows)

    def same_unknowns(self, other: Problem) -> bool:
        """Whether unknowns and what the objective holds of them mean the same in both."""
        kernels = zip(self.team.kernels, other.team.kernels, strict=True)
        ranged = [[part.n_range for part in p._own_parts] for p in (self, other)]
        return self.mesh is other.mesh and ranged[0] == ranged[1] and all(a is b for a, b in kernels)

    def interchangeable(self, other: Problem) -> bool:
        """Whether a solver made for one takes the other: only bounds and parameters may differ."""
        return self.same_structure(other) and self.constraints.same_rows(other.constraints)

    def differs_in_factors(self, other: Problem) -> bool:
        """Whether at most planes differ beside bounds and parameters."""
        return self.same_structure(other) and self.constraints.same_but_factors(other.constraints)

    def apart(self, planes: SeparatingPlanes | None) -> Problem:
        """Return the same problem with other planes."""
        other = replace(self, planes=planes)
        vars(other).update(layout=self.layout, _bounds=self._bounds, _own_parts=self._own_parts)
        return other

    def weights(self, part: int) -> Weights:
        """Return what the objective weighs of a part."""
        agents = self.team.agents
        if part > len(agents):  # a pose
            return Weights.none(self.parts[part].kernel.n_y)
        n_y = self.team.kernels[part].n_y
        if part < len(agents):
            return agent_weights(self.task, part, agents[part], n_y, self.posture_weight)
        return object_weights(self.task, n_y, self.posture_weight)

    def bounds(self) -> tuple[Array, Array]:
        """Return lower and upper bounds (n_x,) of the unknowns.

        A cubic B-spline lies in the hull of its control points, so limits on these hold at all times (eqs. 11, 15).
        The object's pose at both ends is fixed where the task fixes it (eq. 18).
        """
        lower, upper = self._bounds
        return lower.copy(), upper.copy()

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        layout, task = self.layout, self.task
        lower, upper = np.full(layout.n_x, -task.max_grasp_force), np.full(layout.n_x, task.max_grasp_force)
        for i, agent in enumerate(self.team.agents):
            lower[layout.control[:, layout.columns(i)]] = agent.limits.q_lower
            upper[layout.control[:, layout.columns(i)]] = agent.limits.q_upper
        for g, grasp in enumerate(layout.grasps):
            moment = layout.force[:, layout.force_columns(g)][:, FORCE_SIZE:]
            lower[moment], upper[moment] = -grasp.max_moment, grasp.max_moment
        pose = layout.control[:, layout.columns(layout.n_agents)]
        lower[pose], upper[pose] = task.pose_lower, task.pose_upper
        for block, fixed in ((0, task.start), (-1, task.end)):
            given = np.flatnonzero(~np.isnan(fixed))
            lower[pose[block, given]] = upper[pose[block, given]] = fixed[given]
        return lower, upper

    def at_pose(self, pose: Array) -> Problem:
        """Return the same problem with the object's pose (6,) at both ends, NaN where it is free: its bounds differ."""
        other = replace(self, task=replace(self.task, start=pose, end=pose))
        # Nothing else depends on where the object is.
        vars(other).update(layout=self.layout, parts=self.parts, constraints=self.constraints)
        return other

    def unpack(self, x: Array) -> tuple[Array, Array]:
        """Return control points (n_free, coordinates + 6) and grasp forces, as laid out, of a vector of unknowns."""
        return x[self.layout.control], x[self.layout.force]

    def pack(self, control: Array, force: Array) -> Array:
        """Return the vector of unknowns, clipped to its bounds."""
        x = np.empty(self.layout.n_x)
        x[self.layout.control], x[self.layout.force] = control, force
        return np.clip(x, *self._bounds)


def kernel_requests(agents: tuple[Agent, ...], lifted: LiftedObject) -> list[tuple[Builder, Topology]]:
    """Return what to generate the kernels of the agents and then of the object from."""
    requests: list[tuple[Any, Topology]] = []
    for agent in agents:
        model = agent.reduced()
        if agent.shares_kernels:
            requests.append((arm_functions, ArmTopology.holding(model, agent.hands[0], agent.grasps[0].R_hand_object)))
        elif agent.pushes_at_a_point:
            requests.append((agent_functions, Topology.of(model, agent.hands)))
        elif agent.is_simple:
            grips = [grasp.R_hand_measured for grasp in agent.grasps]
            requests.append((wrench_agent_functions, WrenchTopology.holding(model, agent.hands, *grips)))
        else:
            own = {grasp.frame: grasp.R_hand_measured for grasp in agent.grasps}
            base = np.eye(4) if agent.stance is None else agent.T_world_base
            grips = [own.get(hand, np.eye(3)) for hand in agent.hands]
            trunk = agent.lean.joint if agent.lean else ""
            if agent.disc is None:
                standing = StandingTopology.standing(model, agent.hands, base, *grips, trunk=trunk)
                requests.append((standing_agent_functions, standing))
            else:
                pressed = DiscTopology.pressed(model, agent.hands, base, *grips, disc=agent.disc, trunk=trunk)
                requests.append((disc_agent_functions, pressed))
    held = Topology.of(lifted.model, lifted.grasp_frames)
    if all(grasp.is_point_contact for agent in agents for grasp in agent.grasps):
        builder = object_functions
    else:
        builder, held = wrench_object_functions, WrenchTopology.holding(lifted.model, lifted.grasp_frames)
    at_usual_places = all(agent.is_simple and not agent.shares_kernels for agent in agents)
    requests.append((builder, held if at_usual_places else held_anywhere(held)))
    return requests


def _check(agents: tuple[Agent, ...], lifted: LiftedObject) -> None:
    """Refuse models that the equations do not hold for."""
    grasps = [grasp for agent in agents for grasp in agent.grasps]
    if len(grasps) != len(lifted.grasp_frames):
        raise ModelError(
            f"{lifted.name}: {len(lifted.grasp_frames)} grasp frames for {len(grasps)} grasps; give one each"
        )
    if not any(grasp.moments for grasp in grasps):
        lifted.unserved_row()  # refuses grasps at one point, which could hold nothing
    if np.abs(lifted.model.inertias[1].lever).max() > STRUCTURAL_ZERO:
        raise ModelError(f"{lifted.name}: its body frame must be at its centre of mass")
    for agent in agents:
        frames = [grasp.frame for grasp in agent.grasps]
        if not frames or len({*frames} & {*agent.hands}) < len(frames):
            raise ModelError(
                f"{agent.name}: holds with {', '.join(frames) or 'nothing'}; each grasp takes one of its hands, "
                f"{', '.join(agent.hands)}, and no two the same"
            )
        if agent.disc is not None and agent.is_simple:
            raise ModelError(f"{agent.name}: a limit on its disc takes one who stands, or has several hands")
        weak = (agent.limits.tau_lower >= 0) | (agent.limits.tau_upper <= 0)
        for joint in np.array(agent.moving_joints)[weak]:
            raise ModelError(f"{joint}: torque limits must allow some torque in both directions")
