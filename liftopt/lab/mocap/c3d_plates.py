"""Force plates of a C3D file: what its analog channels say, in the recording's axes (C3D User Guide, types 1 to 4)."""

from __future__ import annotations

import numpy as np

from liftopt.lab.mocap.c3d_parameters import C3dParameters
from liftopt.lab.mocap.length_units import metres_of
from liftopt.lab.mocap.recording import AnalogChannels, ForcePlate
from liftopt.types import Array

CHANNELS = {1: 6, 2: 6, 3: 8, 4: 6}  # of a plate of each type


def force_plates(parameters: C3dParameters, analog: AnalogChannels, unit: str) -> tuple[ForcePlate, ...]:
    """Return the force plates.

    Args:
        parameters: of the file.
        analog: its channels.
        unit: of length of the file.

    Raises:
        ValueError: a plate is stated incompletely or is of another type; the message says which.
    """
    metres = metres_of(unit)
    used = parameters.count("FORCE_PLATFORM", "USED") or 0
    if not 0 <= used <= 255:
        raise ValueError(f"USED is {used}")
    if used and metres is None:
        raise ValueError(f"the unit of length {unit!r} is not known")
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # a plate that nobody stands on has no centre
        return tuple(_plate(parameters, analog, k, metres or 1.0) for k in range(used))


def _plate(parameters: C3dParameters, analog: AnalogChannels, k: int, metres: float) -> ForcePlate:
    kind = int(_of(parameters, "TYPE", k, 1)[0])
    if kind not in CHANNELS:
        raise ValueError(f"type {kind} of plate {k + 1} is not among {', '.join(map(str, CHANNELS))}")
    values = analog.values[:, _channels(parameters, k, CHANNELS[kind], analog.values.shape[1])]
    corners = _of(parameters, "CORNERS", k, 12).reshape(4, 3)
    axes = _axes(corners, k)
    origin = _of(parameters, "ORIGIN", k, 3)
    # From the transducer to the middle of the surface, against the plate's Z; some makers state the way back.
    origin = -origin if origin[2] > 0.0 else origin
    middle = corners.mean(axis=0)
    if kind == 4:
        matrix = _of(parameters, "CAL_MATRIX", k, 36).reshape(6, 6).T
        values = values @ matrix.T
    if kind == 1:
        force = values[:, :3]
        place = np.concatenate([values[:, 3:5], np.zeros((len(values), 1))], axis=1)
        moment = np.cross(place, force)
        moment[:, 2] += values[:, 5]
    else:
        if kind == 3:
            force, moment = _of_four_feet(values, origin)
        else:
            # About the middle of the surface, from that about the transducer.
            force, moment = values[:, :3], values[:, 3:] + np.cross(values[:, :3], origin)
        flat = np.stack([-moment[:, 1] / force[:, 2], moment[:, 0] / force[:, 2]], axis=1)
        place = np.concatenate([flat, np.zeros((len(values), 1))], axis=1)
    return ForcePlate(
        rate=analog.rate,
        force=force @ axes.T,
        moment=metres * moment @ axes.T,
        centre_of_pressure=metres * (place @ axes.T + middle),
        corners=metres * corners,
    )


def _of_four_feet(values: Array, origin: Array) -> tuple[Array, Array]:
    """Return force and moment about the surface's middle (S, 3) of a plate on four transducers (Kistler).

    Channels: Fx12, Fx34, Fy14, Fy23, Fz1 to Fz4; the transducers stand at (a, b), (-a, b), (-a, -b), (a, -b).
    """
    x12, x34, y14, y23, z1, z2, z3, z4 = values.T
    a, b = origin[0], origin[1]
    force = np.stack([x12 + x34, y14 + y23, z1 + z2 + z3 + z4], axis=1)
    moment = np.stack([b * (z1 + z2 - z3 - z4), a * (z2 + z3 - z1 - z4), b * (x34 - x12) + a * (y14 - y23)], axis=1)
    return force, moment + np.cross(force, np.array([0.0, 0.0, origin[2]]))


def _axes(corners: Array, k: int) -> Array:
    """Return R_recording_plate: corners 1 to 4 stand at (+, +), (-, +), (-, -), (+, -) of the plate's axes."""
    x, y = corners[0] - corners[1], corners[0] - corners[3]
    z = np.cross(x, y)
    lengths = [float(np.linalg.norm(axis)) for axis in (x, z)]
    if not min(lengths) > 0.0:
        raise ValueError(f"the corners of plate {k + 1} are no rectangle")
    x, z = x / lengths[0], z / lengths[1]
    return np.stack([x, np.cross(z, x), z], axis=1)


def _channels(parameters: C3dParameters, k: int, count: int, there: int) -> list[int]:
    stated = parameters.get("FORCE_PLATFORM", "CHANNEL")
    rows = stated.dimensions[0] if stated and stated.dimensions else 0
    channels = [int(value) - 1 for value in stated.values[k * rows : k * rows + count]] if stated else []
    if len(channels) < count or rows < count or not all(0 <= channel < there for channel in channels):
        raise ValueError(f"CHANNEL does not name {count} of the {there} channels for plate {k + 1}")
    return channels


def _of(parameters: C3dParameters, name: str, k: int, count: int) -> Array:
    values = parameters.numbers("FORCE_PLATFORM", name)
    if values is None or len(values) < (k + 1) * count or not np.isfinite(values[k * count : (k + 1) * count]).all():
        raise ValueError(f"{name} is missing or incomplete for plate {k + 1}")
    return values[k * count : (k + 1) * count]
