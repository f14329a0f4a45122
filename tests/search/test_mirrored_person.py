"""A whole person and the mirror image of one: what one does is the mirror image of what the other does.

The oracle is the reflection in the median plane, which neither the kernels nor the solver know.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from liftopt.collocation.problem import Problem
from liftopt.collocation.solvers.banded import Banded
from liftopt.collocation.solvers.deadline import Deadline
from liftopt.collocation.solvers.result import SolverResult
from liftopt.multibody.person.whole_joints import ARM, JOINTS, LEGS, TRUNK
from liftopt.scenario.model import scenario_from_dict
from liftopt.search.cache import SolverCache
from liftopt.search.initial_guess import posture_starts
from liftopt.search.session import Session

Solved = tuple[Problem, SolverResult]
OPPOSITE = {"right": "left", "left": "right"}
# Of a vector and of a moment or a turn, which components change sign in a reflection of y.
POLAR, AXIAL = np.array([1.0, -1.0, 1.0]), np.array([-1.0, 1.0, -1.0])


def _lift(hands: list[str]) -> Solved:
    """Return the best optimum, from a few starts, of a person who lifts a small box alone."""
    person: dict[str, Any] = {"kind": "person", "stature": 1.7, "mass": 70.0, "sex": "male", "body": "whole"}
    scenario = scenario_from_dict(
        {
            "schema": 2,
            "duration": 2.0,
            "agents": {"human": person | {"hands": hands}},
            "object": {"mass": 2.0, "depth": 0.2, "width": 0.3, "height": 0.1},
            "task": {
                "standing_distance": 1.6,
                "start": {"height": 0.6, "human_distance": 0.4},
                "end": {"height": 1.1, "human_distance": 0.4},
            },
            "solver": {"intervals": 8},
            "limits": {"clearance": "off"},
        }
    )
    session, ample = Session(scenario, SolverCache()), Deadline.after(60.0)
    problem = session.problem(session.spline)
    solver = Banded(problem)
    found = [solver.solve(start.x, deadline=ample) for start in posture_starts(problem, 4, 0, ample)]
    return problem, min((result for result in found if result.converged), key=lambda result: result.objective)


@pytest.fixture(scope="module")
def right() -> Solved:
    return _lift(["right"])


@pytest.fixture(scope="module")
def left() -> Solved:
    return _lift(["left"])


def mirrored(control: np.ndarray) -> np.ndarray:
    """Return the mirror image of control points of a person alone and an object."""
    image = control.copy()
    for i, joint in enumerate(JOINTS):
        side, _, name = joint.rpartition("_")
        source = f"{OPPOSITE[side]}_{name}" if name in ARM else joint
        image[:, i] = (-1.0 if joint in ("Q1", "Q3") else 1.0) * control[:, JOINTS.index(source)]
    image[:, len(JOINTS) :] = control[:, len(JOINTS) :] * np.concatenate([POLAR, AXIAL])
    return image


def test_the_joints_are_those_that_are_mirrored_here() -> None:
    assert len(JOINTS) == len(LEGS) + len(TRUNK) + 2 * len(ARM) == 20


def test_the_other_hand_makes_the_mirrored_motion(right: Solved, left: Solved) -> None:
    (problem, result), (other, best) = right, left
    assert best.objective == pytest.approx(result.objective, rel=1e-6)
    control, force = problem.unpack(result.x)
    image = other.pack(mirrored(control), force * np.concatenate([POLAR, AXIAL]))
    objective, rows = (
        np.asarray(each).ravel()
        for each in (other.nlp.grad_f(image, other.parameters)[0], other.nlp.jac_g(image, other.parameters)[0])
    )
    assert np.maximum(other.constraints.lower - rows, rows - other.constraints.upper).max() < 1e-6
    assert objective[0] == pytest.approx(result.objective, rel=1e-9)
    # It is an optimum of the other's problem too: the solver stays there.
    again = Banded(other).solve(image, deadline=Deadline.after(60.0))
    assert again.converged and again.objective == pytest.approx(result.objective, rel=1e-6)
    np.testing.assert_allclose(other.unpack(again.x)[0], mirrored(control), atol=2e-3)


def test_two_hands_on_a_symmetric_box_carry_alike() -> None:
    problem, result = _lift(["right", "left"])
    control, force = problem.unpack(result.x)
    one, other = (problem.layout.wrenches(force)[:, g] for g in range(2))
    np.testing.assert_allclose(one, other * np.concatenate([POLAR, AXIAL]), atol=1e-2)
    np.testing.assert_allclose(control, mirrored(control), atol=1e-2)
