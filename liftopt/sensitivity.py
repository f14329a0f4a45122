"""What a solved lift depends on: derivatives of effort, peak torques and load share by what the scenario says.

The optimum's own derivative (``collocation.parametric``) carries the whole motion along: everybody re-plans as the
parameter changes. Of every figure the total derivative is the central difference along that tangent.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from liftopt.collocation.motion import motion_at, objective_terms, objective_weights
from liftopt.collocation.parametric import Optimum
from liftopt.collocation.problem import Problem
from liftopt.collocation.spline import RestToRestSpline
from liftopt.errors import InputError
from liftopt.plan import Plan
from liftopt.scenario import Scenario, scenario_to_dict, with_overrides
from liftopt.summary import shares
from liftopt.workshop import Workshop

Array = npt.NDArray[np.float64]
# Of central differences, times the value: their error is its square, and models are written with enough digits.
STEP = 1e-4
SMALLEST = 0.1  # what counts as the value of a parameter that is smaller


@dataclass(frozen=True)
class Parameter:
    """Something that a lift depends on.

    Attributes:
        name: in words.
        keys: of the scenario; several move together.
        change: that a reader thinks in, in ``unit``.
        unit: SI unit of both.
    """

    name: str
    keys: tuple[str, ...]
    change: float
    unit: str


PARAMETERS = (
    Parameter("stature", ("human.stature",), 0.01, "m"),
    Parameter("body mass", ("human.mass",), 1.0, "kg"),
    Parameter("object mass", ("table.mass",), 0.1, "kg"),
    Parameter("object depth", ("table.depth",), 0.01, "m"),
    Parameter("start height", ("task.start.height",), 0.01, "m"),
    Parameter("end height", ("task.end.height",), 0.01, "m"),
    Parameter("grasp from feet", ("task.start.human_distance", "task.end.human_distance"), 0.01, "m"),
    Parameter("feet to robot", ("task.standing_distance",), 0.01, "m"),
    Parameter("robot base height", ("robot.base_height",), 0.01, "m"),
    Parameter("duration", ("duration",), 0.1, "s"),
)


@dataclass(frozen=True)
class Sensitivity:
    """What one parameter does.

    Attributes:
        parameter: which.
        value: of the scenario, in its unit; the first where several keys move together.
        slopes: derivative of each of ``Study.figures`` by the parameter, in the figure's unit over the parameter's.
        envelope: derivative of the objective by the envelope theorem, found without the motion's own derivative.
        reach: change of the parameter at which a limit becomes active or ceases to be; slopes change there.
        limit: which one.
    """

    parameter: Parameter
    value: float
    slopes: dict[str, float]
    envelope: float
    reach: float
    limit: str

    @property
    def holds(self) -> bool:
        """Whether no limit changes sides within the change that a reader thinks in."""
        return self.reach >= self.parameter.change


@dataclass(frozen=True)
class Study:
    """What a lift depends on.

    Attributes:
        plan: the lift.
        figures: their values: ``"objective"``, ``"effort <agent>"`` [N^2 m^2 s], ``"peak <joint>"`` [Nm], the size of
            a joint's largest torque at the knots, ``"share <agent>"``, the mean part of the vertical grasp force.
        sensitivities: one a parameter.
        left_out: parameter and why, of those that the scenario does not let change.
    """

    plan: Plan
    figures: dict[str, float]
    sensitivities: tuple[Sensitivity, ...]
    left_out: tuple[tuple[Parameter, str], ...]


def study(
    plan: Plan,
    workshop: Workshop,
    parameters: Sequence[Parameter] = PARAMETERS,
    say: Callable[[str], None] | None = None,
) -> Study:
    """Return what a plan depends on.

    Args:
        plan: solved.
        workshop: that it comes from.
        parameters: to look at.
        say: hears one line at a time.

    Raises:
        SolverError: kernels cannot be had.
    """
    optimum = Optimum(plan.problem, plan.result.x, plan.result.multipliers)
    peaks = peak_knots(plan)
    found, left_out = [], []
    for parameter in parameters:
        if say:
            say(f"sensitivity to {parameter.name}")
        value = _value(plan.scenario, parameter.keys[0])
        if not isinstance(value, float):
            left_out.append((parameter, f"{parameter.keys[0]} is {value}"))
            continue
        step = STEP * max(abs(value), SMALLEST)
        try:
            before, after = (
                workshop.problem(changed(plan.scenario, parameter, change), plan.spline) for change in (-step, step)
            )
        except InputError as error:
            left_out.append((parameter, str(error)))
            continue
        tangent = optimum.tangent(before, after, step)
        low = figures(before, plan.spline, plan.result.x - step * tangent.x, peaks)
        high = figures(after, plan.spline, plan.result.x + step * tangent.x, peaks)
        slopes = {name: (high[name] - low[name]) / (2 * step) for name in high}
        found.append(Sensitivity(parameter, value, slopes, tangent.objective, tangent.reach, tangent.limit))
    now = figures(plan.problem, plan.spline, plan.result.x, peaks)
    return Study(plan, now, tuple(found), tuple(left_out))


def changed(scenario: Scenario, parameter: Parameter, change: float) -> Scenario:
    """Return the scenario with all keys of a parameter changed by as much.

    Raises:
        InputError: the change leads out of what a scenario may say.
    """
    values = {key: _value(scenario, key) for key in parameter.keys}
    free = [key for key, value in values.items() if not isinstance(value, float)]
    if free:
        raise InputError(free[0], values[free[0]], "is no number that could change")
    return with_overrides(scenario, [f"{key}={value + change!r}" for key, value in values.items()])


def peak_knots(plan: Plan) -> dict[str, tuple[int, float]]:
    """Return where each moving joint's torque is largest: its knot and its sign."""
    peaks = {}
    for agent in motion_at(plan.problem, plan.spline, plan.result.x, plan.spline.phase).agents:
        for j in np.flatnonzero(agent.moving):
            at = int(np.argmax(np.abs(agent.tau[:, j])))
            peaks[agent.joint_names[j]] = (at, float(np.sign(agent.tau[at, j])))
    return peaks


def figures(
    problem: Problem, spline: RestToRestSpline, x: Array, peaks: dict[str, tuple[int, float]]
) -> dict[str, float]:
    """Return ``Study.figures`` of a motion, with the torques' peaks at given knots and signs."""
    motion = motion_at(problem, spline, x, spline.phase)
    terms, weights = objective_terms(motion), objective_weights(problem)
    found = {"objective": sum(weights[name] * value for name, value in terms.items())}
    for agent, share in zip(motion.agents, shares(motion.agents), strict=True):
        found[f"effort {agent.name}"] = terms[agent.name]
        found[f"share {agent.name}"] = float(np.nanmean(share))
        for j, name in enumerate(agent.joint_names):
            if name in peaks:
                knot, sign = peaks[name]
                found[f"peak {name}"] = float(sign * agent.tau[knot, j])
    return found


def _value(scenario: Scenario, key: str) -> Any:
    value: Any = scenario_to_dict(scenario)
    for part in key.split("."):
        value = value[part]
    return value
