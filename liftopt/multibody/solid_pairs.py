"""Which solids must keep apart, and which are exempt, by rule.

- What an agent grasps with (the solids on the joint that carries its grasp frame) is exempt against the object.
- The floor is there for the object and for hands, whether they grasp or not; feet and pedestals stand on it.
- Within a body, solids on one joint do not move against each other. Of two bodies next to each other along the chain
  those of a robot are exempt, and the one that stands against the first that moves; of a person's, those that are at
  the joint between them. A person's thighs and belly meet where the hip bends: soft tissue gives way there.
- Two solids of a robot that overlap in most of its postures are too coarse to be kept apart.
- What stands (an obstacle, a foot, a pedestal) is checked against what stands of others too: it may be placed wrong.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
import pinocchio as pin

from liftopt.multibody.agent import Agent, LiftedObject
from liftopt.multibody.coarse_pairs import coarse_pairs
from liftopt.multibody.solids import FLOOR, Solid, solids_of, solids_of_object
from liftopt.types import Array

PERSON = "person"
OBJECT, OBSTACLE, FLOOR_KIND = "object", "obstacle", "floor"
KINDS = (PERSON, "robot", OBJECT, OBSTACLE, FLOOR_KIND)
# A solid is at a joint that is within it, or no farther from it than this share of the other solid's radius.
AT_JOINT = 1.25
SOFT = ("thigh", "abdomen")  # end the names of a person's solids that give way to each other


@dataclass(frozen=True, eq=False)
class SolidPair:
    """Two solids that must keep apart.

    Attributes:
        one, other: the solids.
        kind: what their owners are, ``"person-robot"``, ``"person-object"``, ``"object-floor"``; ``"person"`` where
            both are one person's.
    """

    one: Solid
    other: Solid
    kind: str

    @property
    def told(self) -> str:
        """The pair in words: ``"right forearm of human and table"``."""
        return f"{self.one.told} and {self.other.told}"

    @property
    def within_body(self) -> bool:
        """Whether both solids are of one body."""
        return self.one.owner == self.other.owner

    def asked(self, clearance: float) -> float:
        """Return how far the two must keep apart [m] where bodies must keep ``clearance``: parts of one may touch."""
        return 0.0 if self.within_body else clearance


def solid_pairs(
    agents: Sequence[Agent], lifted: LiftedObject, obstacles: Sequence[Solid] = ()
) -> tuple[SolidPair, ...]:
    """Return all pairs of solids that must keep apart.

    Args:
        agents: everybody who lifts.
        lifted: the object.
        obstacles: solids that stand in the world.
    """
    pairs: list[SolidPair] = []
    bodies = [(agent, solids_of(agent)) for agent in agents]
    for agent, solids in bodies:
        own = list(_within(agent, solids))
        coarse = coarse_pairs(agent, [(pair.one, pair.other) for pair in own]) if agent.kind == "robot" else set()
        pairs += [pair for pair in own if (id(pair.one), id(pair.other)) not in coarse]
    for (agent, solids), (other, others) in combinations(bodies, 2):
        pairs += _between(agent.kind, solids, other.kind, others)
    box = solids_of_object(lifted)
    for agent, solids in bodies:
        holds = grasping_joints(agent)
        pairs += _between(agent.kind, [solid for solid in solids if solid.joint not in holds], OBJECT, box)
        pairs += _between(agent.kind, solids, OBSTACLE, obstacles)
        hands = _carriers(agent, agent.hands)
        pairs += _between(agent.kind, [solid for solid in solids if solid.joint in hands], FLOOR_KIND, [FLOOR])
    pairs += _between(OBJECT, box, OBSTACLE, obstacles)
    pairs += _between(OBJECT, box, FLOOR_KIND, [FLOOR])
    return tuple(pairs)


def grasping_joints(agent: Agent) -> frozenset[int]:
    """Return the joints of the reduced model that carry the frames an agent grasps with."""
    return _carriers(agent, [grasp.frame for grasp in agent.grasps])


def _carriers(agent: Agent, frames: Sequence[str]) -> frozenset[int]:
    model = agent.reduced()
    return frozenset(int(model.frames[model.getFrameId(frame)].parentJoint) for frame in frames)


def _between(kind: str, solids: Sequence[Solid], other: str, others: Sequence[Solid]) -> Iterator[SolidPair]:
    name = "-".join(sorted((kind, other), key=KINDS.index))
    return (SolidPair(one, two, name) for one, two in product(solids, others))


def _within(agent: Agent, solids: Sequence[Solid]) -> Iterator[SolidPair]:
    """Give the pairs within one body."""
    model = agent.reduced()
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    bearing = {solid.joint for solid in solids}
    supports = {joint: model.supports[joint].tolist() for joint in bearing}
    paths = {two: _path(supports[two[0]], supports[two[1]]) for two in combinations(sorted(bearing), 2)}
    for one, other in combinations(solids, 2):
        if one.joint == other.joint:
            continue
        path = paths[min(one.joint, other.joint), max(one.joint, other.joint)]
        neighbours = not bearing & set(path[1:-1])
        if agent.kind == PERSON and _give_way(one, other):
            continue
        if neighbours and (agent.kind == "robot" or 0 in path or _at_joint(data, one, other, path)):
            continue
        yield SolidPair(one, other, agent.kind)


def _give_way(one: Solid, other: Solid) -> bool:
    """Return whether two solids of a person are soft where they meet: the range of the joints is what limits them."""
    return any(one.name.endswith(a) and other.name.endswith(b) for a, b in (SOFT, SOFT[::-1]))


def _path(up: Sequence[int], down: Sequence[int]) -> list[int]:
    """Return the joints from the end of one chain to that of another, both included; both begin at the world."""
    shared = sum(1 for a, b in zip(up, down, strict=False) if a == b)
    return [*reversed(up[shared:]), *down[shared - 1 :]]


def _at_joint(data: pin.Data, one: Solid, other: Solid, path: Sequence[int]) -> bool:
    """Return whether both solids are at the first joint of a path down the tree, in the model's neutral posture."""
    centre = data.oMi[sorted(path)[1]].translation
    gap, other_gap = (_gap(solid, data.oMi[solid.joint].homogeneous, centre) for solid in (one, other))
    return gap <= AT_JOINT * other.radius and other_gap <= AT_JOINT * one.radius


def _gap(solid: Solid, T_world_joint: Array, point: Array) -> float:
    """Return how far a point in the world is from a capsule or box [m], 0 within it."""
    T_world_solid = T_world_joint @ solid.T_joint_solid
    own = T_world_solid[:3, :3].T @ (point - T_world_solid[:3, 3])
    half = np.array(solid.size) / 2.0 if solid.kind == "box" else np.array([0.0, 0.0, solid.size[1] / 2.0])
    return max(float(np.linalg.norm(own - np.clip(own, -half, half))) - solid.radius, 0.0)
