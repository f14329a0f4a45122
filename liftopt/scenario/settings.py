"""What a scenario weighs, limits and asks of the solver; all of it has defaults."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import model_validator

from liftopt.files.entries import OFF, OrOff, entry, free_number, number, whole
from liftopt.files.section import Section
from liftopt.scenario.presets import DEFAULT, NATURAL, OBJECTIVE, Preset, objective_with_defaults

OWN = NATURAL[OBJECTIVE]


class Objective(Section):
    """What is minimised: the preset names the terms, each weighted; an agent's weight stands with the agent."""

    preset: Annotated[Preset, entry("a natural motion, or the terms of the paper's eq. 10")] = DEFAULT
    acceleration_weight: Annotated[
        float, number("weight of the accelerations squared (of a 2 s lift in natural)", "", 0.0, 1e6)
    ] = OWN["acceleration_weight"]
    force_weight: Annotated[float, number("weight of the grasp forces squared", "", 0.0, 1e6)] = OWN["force_weight"]
    range_weight: Annotated[float, number("weight of joints away from ease", "", 0.0, 1e6)] = OWN["range_weight"]
    tilt_weight: Annotated[float, number("weight of (tilt / 10 deg) squared", "", 0.0, 1e6)] = OWN["tilt_weight"]

    spine_weight: Annotated[float, number("weight of the load on people's lumbar spines squared", "", 0.0, 1e6)] = 0.0

    @model_validator(mode="before")
    @classmethod
    def _by_preset(cls, values: object) -> object:
        return objective_with_defaults(values)


class Limits(Section):
    """Limits that belong to the task rather than to an agent."""

    table_roll_deg: Annotated[float, number("largest roll of the object in a wrench grasp", "deg", 0.0, 60.0)] = 10.0
    table_pitch_deg: Annotated[float, number("largest pitch of the object", "deg", 0.0, 60.0)] = 10.0
    table_yaw_deg: Annotated[float, number("largest yaw of the object", "deg", 0.0, 60.0)] = 10.0
    max_grasp_force: Annotated[float, number("largest grasp force", "N", 0.0, 10_000.0, open_low=True)] = 200.0
    balance_tolerance: Annotated[float, number("slack in the object's balance", "N, Nm", 0.0, 100.0)] = 0.0
    clearance: Annotated[
        float | None, free_number("least distance between bodies that do not touch", "m", 0.0, 1.0, OFF), OrOff
    ] = 0.0
    spine_compression: Annotated[
        float | None, free_number("largest compression of a whole person's spine at L5/S1", "N", 500.0, 2e4, OFF), OrOff
    ] = None


class Solver(Section):
    """How the problem is solved."""

    name: Annotated[Literal["banded", "ipopt"], entry("interior point that solves it")] = "banded"
    intervals: Annotated[int, whole("spline intervals N", 6, 400)] = 20
    starts: Annotated[int, whole("starts of which the best is kept", 1, 64)] = 4
    tries: Annotated[int, whole("starts tried first on a coarser mesh, 0: none", 0, 512)] = 48
    tolerance: Annotated[float, number("KKT error at which a start has converged", "", 1e-10, 1e-3)] = 1e-6
    workers: Annotated[int, whole("starts and postures at a time; IPOPT takes one", 1, 64)] = 2
    seed: Annotated[int, whole("seed of the random starts", 0, 2**32 - 1)] = 0
    time_limit: Annotated[float, number("wall time of the whole solve", "s", 0.1, 3600.0)] = 50.0


class Refine(Section):
    """Whether N is doubled, up to 400 and as long as time is left, until all of these hold."""

    on: Annotated[bool, entry("refine the mesh")] = False
    objective_error: Annotated[float, number("estimated error of the objective, share of it", "", 1e-4, 1.0)] = 0.02
    closure: Annotated[float, number("distance of the grasps between knots", "m", 1e-7, 1e-3)] = 1e-4
    balance: Annotated[float, number("residual of the object's balance between knots", "N, Nm", 1e-4, 100.0)] = 0.1
    torque_excess: Annotated[float, number("torque above its limit between knots", "Nm", 1e-4, 100.0)] = 0.1
    compression_excess: Annotated[
        float, number("compression of a spine above its limit between knots", "N", 1e-3, 1000.0)
    ] = 10.0
