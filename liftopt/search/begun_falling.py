"""Lifts that begin or end falling, where holding still there takes a little more strength than there is."""

from __future__ import annotations

from collections.abc import Sequence

from liftopt.collocation.spline import RestToRestSpline
from liftopt.search.coarse_search import coarse_search
from liftopt.search.feasibility_screen import RELIEF, stronger
from liftopt.search.found import Found
from liftopt.search.initial_guess import initial_guesses
from liftopt.search.mesh_refinement import refine_mesh
from liftopt.search.session import Session
from liftopt.solution.infeasibility_report import InfeasibilityReason

STRENGTHS = ("torque", "grasp_force", "grasp_moment")


def begun_falling(
    session: Session, spline: RestToRestSpline, reasons: Sequence[InfeasibilityReason], tries: int, seeds: int
) -> Found | None:
    """Return the best lift from postures that somewhat more strength would hold still; None if there is none.

    Args:
        session: of the search.
        spline: the mesh that was asked for.
        reasons: why there are no postures at the ends; nothing is tried where more than a little strength is missing.
        tries: starts to be tried on a coarse mesh.
        seeds: of postures.
    """
    if any(reason.constraint not in STRENGTHS or reason.share > RELIEF - 1.0 for reason in reasons):
        return None
    problem, seed = session.problem(spline), session.scenario.solver.seed
    postures = stronger(session.postures.problem, RELIEF)
    guesses = initial_guesses(problem, tries, seed, session.deadline, session.progress, postures, seeds)
    if guesses is None:
        return None
    session.begin_solving()
    optima = coarse_search(session, spline, guesses, tries)
    session.finish()
    return refine_mesh(session, optima, spline.intervals) if optima else None
