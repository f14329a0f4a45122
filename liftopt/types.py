"""Types that all rooms share."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:  # what only names a type starts without NumPy
    import numpy as np
    import numpy.typing as npt

Array: TypeAlias = "npt.NDArray[np.float64]"
Progress: TypeAlias = Callable[[str], None]  # called with one line at a time about what is going on
