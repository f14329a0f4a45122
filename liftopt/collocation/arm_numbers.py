"""The numbers of a serial arm as parameters of its kernels.

In which order they are, and the arm made of symbols of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from liftopt.collocation.arm_frames import ArmFrames, counts
from liftopt.collocation.spatial_symbols import Mass, Placed
from liftopt.types import Array


def numbers_of(frames: ArmFrames) -> list[float]:
    """Return the numbers of an arm: placement of the base, the steps, the bodies."""
    numbers = placement_numbers(frames.base.rotation, frames.base.translation)
    for j, step in enumerate(frames.steps, start=1):
        numbers += [step.cosine, step.sine]
        numbers += [step.a, step.b] if frames.kinds[j] == "R" else []
        numbers += [step.offset] if j < len(frames.steps) else []
    for j, body in enumerate(frames.bodies):
        counted = counts(frames.kinds, j)
        numbers += [body.mass] if counted.mass else []
        numbers += [*body.first[list(counted.first)], *(body.inertia[at] for at in counted.inertia)]
    return [float(number) for number in numbers]


def placement_numbers(rotation: Array, translation: Array) -> list[float]:
    """Return the numbers (12) of a placement: the rotation by rows, then the translation."""
    return [*rotation.ravel(), *translation]


class Reader:
    """Symbols that are taken one after the other."""

    def __init__(self, symbols: Any) -> None:
        """Begin with the first of the symbols (p,)."""
        self._symbols, self._at = symbols, 0

    def take(self, count: int) -> Any:
        """Return the next ones (count,)."""
        self._at += count
        return self._symbols[self._at - count : self._at]

    def rotation(self) -> Any:
        """Return the next nine as a rotation (3, 3)."""
        import casadi as ca

        return ca.reshape(self.take(9), 3, 3).T

    def placement(self) -> Placed:
        """Return the next twelve as a placement."""
        return Placed(self.rotation(), self.take(3))


@dataclass(frozen=True)
class StepSymbols:
    """From one joint's frame to the next one's, see ``arm_frames``.

    Attributes:
        tilt: (3, 3) rotation by alpha about x.
        apart: (3,) to the next origin, in the tilted axes.
        offset: of the next joint [rad], or None.
    """

    tilt: Any
    apart: Any
    offset: Any

    @staticmethod
    def none() -> StepSymbols:
        """Return what leads to the first joint's frame, from the same place."""
        import casadi as ca

        return StepSymbols(ca.SX.eye(3), ca.SX(3, 1), None)

    def then(self, at: Placed, kind: str, q: Any) -> Placed:
        """Return the next frame, where this one is seen at ``at``, with the next joint at ``q``."""
        import casadi as ca

        tilted, apart, turned = ca.mtimes(at.rotation, self.tilt), self.apart, self.offset
        if kind == "P":
            apart = apart + along_z(q)
        else:
            turned = q if turned is None else q + turned
        rotation = tilted if turned is None else ca.mtimes(tilted, about_z(turned))
        return Placed(rotation, at.origin + ca.mtimes(tilted, apart))


def read_steps(kinds: str, reader: Reader) -> list[StepSymbols]:
    """Return the steps to all joints, to the first one's frame too."""
    import casadi as ca

    steps = [StepSymbols.none()]
    for j in range(1, len(kinds)):
        cosine, sine = ca.vertsplit(reader.take(2))
        tilt, apart = ca.SX(3, 3), ca.SX(3, 1)
        tilt[0, 0], tilt[1, 1], tilt[2, 2], tilt[1, 2], tilt[2, 1] = 1, cosine, cosine, -sine, sine
        if kinds[j] == "R":
            apart[:2] = reader.take(2)
        steps.append(StepSymbols(tilt, apart, reader.take(1) if j < len(kinds) - 1 else None))
    return steps


def read_bodies(kinds: str, reader: Reader, factor: Any) -> list[Mass]:
    """Return the bodies of all links, in their frames, all masses times a factor."""
    import casadi as ca

    bodies = []
    for j in range(len(kinds)):
        counted, mass, first, inertia = counts(kinds, j), ca.SX(1, 1), ca.SX(3, 1), ca.SX(3, 3)
        if counted.mass:
            mass = reader.take(1) * factor
        for axis in counted.first:
            first[axis] = reader.take(1) * factor
        for row, column in counted.inertia:
            inertia[row, column] = inertia[column, row] = reader.take(1) * factor
        bodies.append(Mass(mass, first, inertia))
    return bodies


def about_z(angle: Any) -> Any:
    """Return the rotation (3, 3) about z."""
    import casadi as ca

    turned = ca.SX(3, 3)
    turned[0, 0] = turned[1, 1] = ca.cos(angle)
    turned[1, 0], turned[0, 1], turned[2, 2] = ca.sin(angle), -ca.sin(angle), 1
    return turned


def along_z(distance: Any) -> Any:
    """Return the vector (3,) along z."""
    import casadi as ca

    moved = ca.SX(3, 1)
    moved[2] = distance
    return moved
