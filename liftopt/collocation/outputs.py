"""Which output of an agent's kernel is what."""

from __future__ import annotations

from dataclasses import dataclass

from liftopt.collocation.layout import FORCE_SIZE
from liftopt.collocation.wrench_dynamics import WRENCH_SIZE
from liftopt.multibody.agent import Agent
from liftopt.multibody.disc import CUT_JOINTS

# Of each hand: the grasp point, its squared force; and, where it is not only a force at a point, its squared moment,
# the cosine of its angle on the object, and its wrench along the object's axes.
AT_A_POINT = FORCE_SIZE + 1
WITH_MOMENT = AT_A_POINT + 2 + WRENCH_SIZE


@dataclass(frozen=True)
class AgentOutputs:
    """Where the outputs of an agent's kernel are: torques, those of each hand, of the ground, and of a disc.

    A hand goes by the name of its frame.

    Attributes:
        joints: number of moving joints.
        hands: all that the kernel has room for.
        of_a_hand: number of outputs of each.
        stands: whether the ground's force and moment come after those.
        leans: whether the trunk's lean comes after the torques.
        pressed: whether what passes a disc comes last.
    """

    joints: int
    hands: tuple[str, ...]
    of_a_hand: int
    stands: bool
    leans: bool = False
    pressed: bool = False

    @property
    def has_moments(self) -> bool:
        """Whether hands have more than the outputs of a force at a point."""
        return self.of_a_hand == WITH_MOMENT

    @property
    def tau(self) -> slice:
        """Joint torques [Nm]."""
        return slice(0, self.joints)

    @property
    def lean(self) -> slice:
        """1 - cos of the trunk's angle from the vertical; like the torques it may be squared in an objective."""
        return slice(self.joints, self.joints + self.leans)

    def position(self, hand: str) -> slice:
        """Return where the grasp point in the world is [m]."""
        return self._part(hand, 0, FORCE_SIZE)

    def force_squared(self, hand: str) -> slice:
        """Return where the squared norm of the force is [N^2]."""
        return self._part(hand, FORCE_SIZE, 1)

    def moment_squared(self, hand: str) -> slice:
        """Return where the squared norm of the moment is [N^2 m^2]."""
        return self._part(hand, FORCE_SIZE + 1, 1)

    def cosine(self, hand: str) -> slice:
        """Return where the cosine of the angle from the grip axes to the object's is."""
        return self._part(hand, FORCE_SIZE + 2, 1)

    def wrench(self, hand: str) -> slice:
        """Return where force and moment along the object's axes are [N, Nm]."""
        return self._part(hand, FORCE_SIZE + 3, WRENCH_SIZE)

    @property
    def ground(self) -> slice:
        """Force and moment of the ground on all that moves, about the feet's origin, axes of the base [N, Nm]."""
        first = self.lean.stop + len(self.hands) * self.of_a_hand
        return slice(first, first + WRENCH_SIZE * self.stands)

    @property
    def disc(self) -> slice:
        """Axial force, lateral moment and moment that extends, through the disc [N, Nm, Nm]."""
        first = self.ground.stop
        return slice(first, first + CUT_JOINTS * self.pressed)

    @property
    def size(self) -> int:
        """Number of all outputs."""
        return int(self.disc.stop)

    def _part(self, hand: str, at: int, size: int) -> slice:
        first = self.lean.stop + self.hands.index(hand) * self.of_a_hand + at
        return slice(first, first + size)


def outputs_of(agent: Agent) -> AgentOutputs:
    """Return where the outputs of an agent's kernel are."""
    of_a_hand = AT_A_POINT if agent.pushes_at_a_point else WITH_MOMENT
    leans = not agent.is_simple and agent.lean is not None
    pressed = agent.disc is not None
    return AgentOutputs(len(agent.posture), agent.hands, of_a_hand, not agent.is_simple, leans, pressed)
