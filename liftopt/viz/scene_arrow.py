"""An arrow that grows and turns with a force."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from liftopt.viz.playback import ForceTrack, continuous
from liftopt.viz.scene_part import Colour

Array = npt.NDArray[np.float64]
SHAFT_RADIUS, HEAD_RADIUS, HEAD_LENGTH = 0.011, 0.028, 0.07  # [m]
SMALLEST = 1e-4  # of a scale: three.js cannot invert a node of size zero
