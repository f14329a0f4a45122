"""Why a lift has no solution, and what would give it one, as a solution keeps them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class InfeasibilityReason:
    """What is in the way.

    Attributes:
        constraint: ``"grasp_closure"``, ``"torque"``, ``"velocity"``...; see ``Block``.
        who: agent, joint or object.
        amount: how far it is from being met, in ``unit``.
        unit: of ``amount``; ``"times the limit"`` for strength.
        message: one sentence.
        time: when [s]; None where it is not at one moment.
        static: no motion helps: it is in the way of standing still at one end.
        share: by how much a limit would have to be larger, as a share of it; 0 where that has no meaning.
    """

    constraint: str
    who: str
    amount: float
    unit: str
    message: str
    time: float | None = None
    static: bool = False
    share: float = 0.0


@dataclass(frozen=True)
class SuggestedChange:
    """A change that makes the lift possible; it was solved and verified with it.

    Attributes:
        keys: of the scenario.
        values: what they are to be, in the order of ``keys``.
        message: the change in words.
        size: how large it is beside other changes, to rank by.
    """

    keys: tuple[str, ...]
    values: tuple[float, ...]
    message: str
    size: float
