"""A problem at many vectors of unknowns at once: the assembled NLP is the oracle."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from liftopt.collocation.batch import CHUNK, Batch
from liftopt.collocation.problem import Problem, Team
from liftopt.collocation.spline import Mesh
from liftopt.collocation.task import LiftTask


def test_objective_rows_and_slopes_are_the_nlps(
    problem: Problem, random_unknowns: Callable[[Problem, np.random.Generator], np.ndarray], rng: np.random.Generator
) -> None:
    """More vectors than fit one call, on a mesh, all rows."""
    x, batch, nlp = np.array([random_unknowns(problem, rng) for _ in range(3)]), Batch(problem), problem.nlp
    assert x.shape[0] * len(problem.mesh.phase) > CHUNK
    values = ca.Function("values", [nlp.x, nlp.p], [nlp.f, nlp.g])
    objective, rows, slopes = batch.objective(x), batch.rows(x), batch.slopes(x)
    for i, one in enumerate(x):
        f, g = values(one, problem.parameters)
        np.testing.assert_allclose(objective[i], float(f), rtol=1e-12)
        np.testing.assert_allclose(rows[i], g.full().ravel(), rtol=0, atol=1e-9)
        jacobian = nlp.jac_g(one, problem.parameters)[1].full()
        np.testing.assert_allclose(slopes[i], jacobian, rtol=0, atol=1e-9 * np.abs(jacobian).max())


def test_chosen_rows_of_a_posture(
    team: Team,
    make_task: Callable[..., LiftTask],
    random_unknowns: Callable[[Problem, np.random.Generator], np.ndarray],
    rng: np.random.Generator,
) -> None:
    """On one knot, rows in another order than the problem's, with all-row values as the oracle."""
    problem = Problem(team, make_task(agent_weights=(1.0, 1.0)), Mesh.at_rest())
    x, wanted = np.array([random_unknowns(problem, rng) for _ in range(CHUNK + 3)]), np.array([7, 2, 11])
    some, every = Batch(problem, wanted), Batch(problem)
    np.testing.assert_allclose(some.rows(x), every.rows(x)[:, wanted], rtol=0, atol=1e-12)
    np.testing.assert_allclose(some.slopes(x), every.slopes(x)[:, wanted], rtol=0, atol=1e-12)
