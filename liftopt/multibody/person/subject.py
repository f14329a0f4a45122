"""The person who lifts, as a user describes them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from liftopt.errors import InputError
from liftopt.multibody.bounds import checked_number

Sex = Literal["male", "female"]


@dataclass(frozen=True)
class Subject:
    """A person, from whom segment lengths, masses, inertias and strength follow.

    Attributes:
        stature: standing height [m], 1.2 to 2.2.
        mass: body mass [kg], 30 to 200.
        sex: ``"male"`` or ``"female"``, which selects the anthropometric tables.

    Raises:
        InputError: a value is out of range; its key is ``human.stature``, ``human.mass`` or ``human.sex``.
    """

    stature: float
    mass: float
    sex: Sex

    def __post_init__(self) -> None:
        checked_number("human.stature", self.stature, 1.2, 2.2, "m")
        checked_number("human.mass", self.mass, 30.0, 200.0, "kg")
        if self.sex not in ("male", "female"):
            raise InputError("human.sex", self.sex, 'must be "male" or "female"')
