"""Sawyer as a figure: rounded primitives with the sections of the manufacturer's own meshes.

Every radius and extent was measured on the STL files of RethinkRobotics, sawyer_robot, commit d1ef3d0,
sawyer_description/meshes/sawyer_pv (Apache-2.0), in the frames of its sawyer_base.urdf.xacro.
"""

from __future__ import annotations

import numpy as np

from liftopt.multibody.robots.sawyer_description import (
    HEAD_IN_FIRST_LINK,
    JOINTS,
    described_frames,
)
from liftopt.types import Array
from liftopt.viz.scene_mesh import Mesh, Ring, ball, block, capsule, cylinder, merged, tube
from liftopt.viz.scene_part import GROUND, Colour, Part

RED: Colour = (0.62, 0.07, 0.08)
GREY: Colour = (0.29, 0.29, 0.30)
BLACK: Colour = (0.07, 0.07, 0.08)
SCREEN: Colour = (0.13, 0.30, 0.42)
WHITE: Colour = (0.95, 0.96, 0.97)
TO_X = (1.0, 0.0, 0.0)
ORIGIN = (0.0, 0.0, 0.0)


def sawyer_parts(name: str, world_base: Array) -> list[Part]:
    """Return the robot of that name with all joints at zero.

    Args:
        name: that its joints begin with.
        world_base: (4, 4) T_world_base of the manufacturer's base frame; the pedestal reaches from it to the floor.
    """
    parts = [part.placed(world_base) for part in _stand(float(world_base[2, 3]))]
    frames = described_frames(np.zeros(len(JOINTS)))
    for i, (frame, link) in enumerate(zip(frames, _links(), strict=True), start=1):
        parts += [
            Part(f"{name}_Q{i}", f"l{i - 1}_{piece}", colour, mesh).placed(world_base @ frame)
            for piece, colour, mesh in link
        ]
    return parts


def _stand(base_height: float) -> list[Part]:
    floor = -base_height
    legs = []
    for x, y in ((0.22, 0.30), (0.22, -0.30), (-0.47, 0.30), (-0.47, -0.30)):
        legs += [capsule((-0.12, 0.5 * y, floor + 0.20), (x, y, floor + 0.16), 0.040, 0.030)]
        legs += [
            cylinder((x, y, floor), (x, y, floor + 0.03), 0.045),
            cylinder((x, y, floor), (x, y, floor + 0.19), 0.017),
        ]
    frame = block((-0.12, 0.0, floor + 0.20), (0.52, 0.40, 0.07), edge=0.02)
    column = cylinder((0.0, 0.0, floor + 0.20), (0.0, 0.0, 0.0), 0.104)
    box = block((-0.325, 0.0, 0.5 * (floor + 0.24) - 0.05), (0.21, 0.35, max(-floor - 0.34, 0.05)), edge=0.02)
    base = merged([cylinder(ORIGIN, (0.0, 0.0, 0.014), 0.105), cylinder((0.0, 0.0, 0.01), (0.0, 0.0, 0.08), 0.075)])
    return [
        Part(GROUND, "pedestal_legs", BLACK, merged([*legs, frame])),
        Part(GROUND, "pedestal_column", GREY, column),
        Part(GROUND, "controller", BLACK, box),
        Part(GROUND, "arm_base", GREY, base),
    ]


def _links() -> list[list[tuple[str, Colour, Mesh]]]:
    """Return the shapes of right_l0 to right_l6 in the manufacturer's link frames."""
    shoulder = [
        Ring((0.0, 0.0, 0.0), 0.068, 0.068),
        Ring((0.0, -0.002, 0.06), 0.068, 0.069),
        Ring((0.015, -0.012, 0.134), 0.071, 0.066, 2.2),
        Ring((0.031, -0.010, 0.176), 0.084, 0.070, 2.4),
        Ring((0.047, -0.006, 0.225), 0.099, 0.067, 2.6),
        Ring((0.050, 0.002, 0.260), 0.094, 0.058, 2.6),
        Ring((0.033, 0.010, 0.296), 0.072, 0.050, 2.4),
    ]
    hub = cylinder((0.081, -0.075, 0.237), (0.081, 0.050, 0.237), 0.068, edge=0.012)
    upper_tube = [
        Ring((0.0, 0.0, 0.0), 0.053, 0.053),
        Ring((0.0, 0.001, 0.07), 0.052, 0.050),
        Ring((0.0, 0.004, 0.155), 0.052, 0.041, 2.3),
        Ring((0.0, 0.004, 0.205), 0.052, 0.037, 2.5),
        Ring((0.0, -0.006, 0.26), 0.051, 0.038, 2.6),
        Ring((0.0, -0.010, 0.295), 0.040, 0.031, 2.4),
    ]
    lower_tube = [
        Ring((0.0, 0.0, 0.005), 0.046, 0.046),
        Ring((0.0, 0.0, 0.082), 0.048, 0.045),
        Ring((0.002, -0.002, 0.165), 0.047, 0.039, 2.3),
        Ring((0.0, -0.002, 0.215), 0.044, 0.033, 2.5),
        Ring((0.0, 0.005, 0.270), 0.043, 0.034, 2.6),
        Ring((0.0, 0.009, 0.300), 0.033, 0.029, 2.4),
    ]
    wrist = [Ring((0.0, 0.012, -0.030), 0.036, 0.048), Ring((0.0, 0.013, -0.02), 0.041, 0.054)]
    wrist += [Ring((0.0, 0.013, 0.010), 0.040, 0.053), Ring((0.0, 0.012, 0.018), 0.036, 0.048)]
    return [
        [("shoulder", RED, tube(shoulder, TO_X, round_end=0.014)), ("hub", RED, hub), *_head()],
        _elbow(0.068, 0.193, 0.1425, -0.14, 0.054),
        [("tube", RED, tube(upper_tube, TO_X, round_end=0.02)), _hub((0.0, -0.042, 0.26), 0.043, 0.05)],
        _elbow(0.052, -0.174, -0.1265, -0.125, 0.045),
        [("tube", RED, tube(lower_tube, TO_X, round_end=0.02)), _hub((0.0, 0.031, 0.275), -0.040, 0.042)],
        _elbow(0.044, 0.152, 0.1053, -0.086, 0.043),
        [("wrist", GREY, tube(wrist, TO_X))],
    ]


def _elbow(radius: float, top: float, tip_z: float, tip_y: float, tube_radius: float) -> list[tuple[str, Colour, Mesh]]:
    """Return a bent link: a drum about its own joint, and the stub that carries the next one, along -y."""
    step = float(np.sign(top))
    drum = [Ring((0.0, 0.0, 0.012 * step), radius, radius), Ring((0.0, 0.0, tip_z), radius, radius)]
    drum.append(Ring((0.0, 0.0, top - 0.022 * step), 0.88 * radius, 0.88 * radius))
    stub = capsule((0.0, 0.0, tip_z), (0.0, 0.75 * tip_y, tip_z), 1.05 * tube_radius, tube_radius)
    collar = cylinder((0.0, 0.75 * tip_y, tip_z), (0.0, tip_y, tip_z), tube_radius)
    band = cylinder(ORIGIN, (0.0, 0.0, 0.014 * step), 0.97 * radius, edge=0.003)
    cap = cylinder((0.0, 0.0, top - 0.03 * step), (0.0, 0.0, top), 0.74 * radius, end_radius=0.62 * radius, edge=0.005)
    return [
        ("drum", RED, merged([tube(drum, TO_X, round_end=0.012), stub])),
        ("collar", GREY, merged([collar, band])),
        ("cap", GREY, cap),
    ]


def _hub(end: tuple[float, float, float], length: float, radius: float) -> tuple[str, Colour, Mesh]:
    x, y, z = end
    return ("hub", RED, cylinder((x, y + 2.0 * length, z), end, radius, edge=0.008))


def _head() -> list[tuple[str, Colour, Mesh]]:
    """Return the head that looks forward: the screen with the robot's well-known eyes, and the camera on top."""
    x, y, z = HEAD_IN_FIRST_LINK
    case = block((x - 0.006, y, z + 0.100), (0.068, 0.256, 0.185), edge=0.02)
    neck = cylinder((x, y, z - 0.01), (x, y, z + 0.03), 0.045)
    camera = block((x - 0.004, y, z + 0.205), (0.075, 0.082, 0.05), edge=0.015)
    glass = block((x + 0.028, y, z + 0.100), (0.006, 0.225, 0.145), edge=0.002)
    eyes = [ball((x + 0.032, y + side * 0.052, z + 0.10), (0.004, 0.034, 0.028)) for side in (-1.0, 1.0)]
    pupils = [ball((x + 0.036, y + side * 0.052, z + 0.092), (0.003, 0.015, 0.015)) for side in (-1.0, 1.0)]
    return [
        ("head", RED, merged([case, camera])),
        ("neck", GREY, neck),
        ("screen", SCREEN, glass),
        ("eyes", WHITE, merged(eyes)),
        ("pupils", BLACK, merged(pupils)),
    ]
