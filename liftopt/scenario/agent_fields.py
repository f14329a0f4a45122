"""What entries of persons and robots have in common: kinds, names, and checks of single entries."""

from __future__ import annotations

import re
from typing import Annotated, Literal

from pydantic import BeforeValidator

from liftopt.files.entries import number

Kind = Literal["person", "robot"]
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}")
NAMES = "1 to 32 letters, digits or _, a letter first"
FARTHEST = 10.0  # [m] from the origin
GRASPS = Literal["point", "wrench"]
Weight = Annotated[float, number("weight of squared torques, as shares of strength in preset natural", "", 0.0, 1e6)]
Length = Annotated[float, number("", "m", -FARTHEST, FARTHEST)]


def _as_tuple(value: object) -> object:
    return tuple(value) if isinstance(value, list) else value


Listed = BeforeValidator(_as_tuple)  # TOML and JSON have lists where a model has a tuple
