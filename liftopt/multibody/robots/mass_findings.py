"""What is wrong with the masses and inertias of all that a robot's chain moves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from liftopt.errors import NO_VALUE
from liftopt.multibody.dh import BodyInertia
from liftopt.multibody.robots.chain import RobotChain
from liftopt.multibody.robots.data_finding import DataFinding, Severity
from liftopt.multibody.robots.description import LARGEST_NUMBER
from liftopt.types import Array

# Moments of a rigid body: the largest is at most the sum of the others; files round theirs.
TRIANGLE_TOLERANCE = 1e-3
ROUNDING = 1e-12  # [kg m^2]
# A body is about as large as what it reaches to, and this share of the chain's reach thick. The bodies of the arms of
# example-robot-data have radii of gyration of 0.2 to 0.8 times that, but for those of two files; one that is larger
# than so many times it is no body of that size.
THICK, FATTEST = 0.15, 1.2
SHEET = "take mass properties from the maker's data sheet or CAD model"


def mass_findings(chain: RobotChain) -> Iterator[DataFinding]:
    """Give what is wrong; massless links that are one body with others are frames, and pass."""
    for name in chain.base_links:
        body = chain.description.link(name).body
        for found in (*_of_link(name, body), *_of_base(name, body)):
            if found.severity == "refused":
                fix = "it does not move, so its mass is left out with that of all that is one with the base"
                yield replace(found, code="mass.base", severity="warned", fix=fix)
    broken = False
    for link in chain.links:
        for name in link.links:
            for found in _of_link(name, chain.description.link(name).body):
                broken = broken or found.severity == "refused"
                yield found
    if broken:
        return
    for number, link in enumerate(chain.links):
        beyond = sum(other.body.mass for other in chain.links[number + 1 :])
        yield from _of_body(f"link {link.joint.child}", link.body, beyond)
        size = max(float(chain.lengths[number]), float(np.linalg.norm(link.body.com))) + THICK * chain.reach
        yield from _too_large(f"link {link.joint.child}", link.body, size)


def _of_link(name: str, body: BodyInertia) -> Iterator[DataFinding]:
    where = f"link {name}"
    if not 0.0 <= body.mass <= LARGEST_NUMBER:
        message = f"must be a number of kg from 0 to {LARGEST_NUMBER:g}"
        yield DataFinding("mass.value", "refused", f"{where}: mass", body.mass, message, SHEET)
    elif body.mass > 0.0 and not np.isfinite(body.com).all():
        message = "its centre of mass is no point"
        yield DataFinding("mass.centre", "refused", f"{where}: origin", NO_VALUE, message, SHEET)
    elif body.mass > 0.0 and not (np.abs(body.inertia) <= LARGEST_NUMBER).all():
        message = "it has a mass, but moments of inertia are missing, no numbers, or beyond all"
        yield DataFinding("inertia.value", "refused", f"{where}: inertia", NO_VALUE, message, SHEET)
    elif body.mass == 0.0 and np.any(body.inertia != 0.0):
        message = "it has moments of inertia and no mass: they are left out"
        yield DataFinding("inertia.massless", "warned", f"{where}: inertia", NO_VALUE, message, SHEET)
    elif body.mass > 0.0:
        moments = principal_moments(body)
        excess = moments[2] - moments[0] - moments[1]
        if moments[0] > 0.0 and excess > TRIANGLE_TOLERANCE * moments[2]:
            message = f"no body has it: the largest is more than the other two together, {_shown(moments)} kg m^2"
            yield DataFinding("inertia.triangle", "warned", f"{where}: principal moments", NO_VALUE, message, SHEET)


def _of_body(where: str, body: BodyInertia, beyond: float) -> Iterator[DataFinding]:
    """Give what is wrong with a body that a joint moves, ``beyond`` [kg] being what hangs on it further out."""
    if body.mass == 0.0:
        severity: Severity = "warned" if beyond > 0.0 else "refused"
        message = "a joint moves it, and it has no mass" + (", only what it carries has" if beyond > 0.0 else "")
        yield DataFinding("mass.zero", severity, f"{where}: mass", 0.0, message, SHEET)
        return
    moments = principal_moments(body)
    if moments[0] < 0.0 or (moments[0] == 0.0 and beyond == 0.0):
        yield _not_positive(where, moments)
    elif moments[0] == 0.0:
        message = f"one is zero, {_shown(moments)} kg m^2: a point or a rod turns without effort"
        yield DataFinding("inertia.zero", "warned", f"{where}: principal moments", NO_VALUE, message, SHEET)


def _of_base(name: str, body: BodyInertia) -> Iterator[DataFinding]:
    """Give what is wrong with the moments of a link that does not move, if they are numbers."""
    if 0.0 < body.mass <= LARGEST_NUMBER and (np.abs(body.inertia) <= LARGEST_NUMBER).all():
        moments = principal_moments(body)
        if moments[0] < -ROUNDING:
            yield _not_positive(f"link {name}", moments)


def _not_positive(where: str, moments: Array) -> DataFinding:
    message = f"must be positive, and are {_shown(moments)} kg m^2"
    return DataFinding("inertia.positive", "refused", f"{where}: principal moments", NO_VALUE, message, SHEET)


def _too_large(where: str, body: BodyInertia, size: float) -> Iterator[DataFinding]:
    """Give a body whose moments are those of a much larger one than a link of this ``size`` [m]."""
    if body.mass == 0.0 or not size:
        return
    radius = float(np.sqrt(max(principal_moments(body)[2], 0.0) / body.mass))
    if radius > FATTEST * size:
        message = (
            f"they are as if its {body.mass:.3g} kg were {radius:.2g} m from its centre of mass: are they in kg m^2?"
        )
        yield DataFinding("inertia.large", "warned", f"{where}: principal moments", NO_VALUE, message, SHEET)


def principal_moments(body: BodyInertia) -> Array:
    """Return the principal moments of inertia (3,), the smallest first [kg m^2]; what is rounding is zero."""
    moments = np.linalg.eigvalsh((body.inertia + body.inertia.T) / 2.0)
    rounding = 1e-12 * np.abs(moments).max() + 1e-15 * body.mass * float(body.com @ body.com)
    return np.where(np.abs(moments) <= rounding, 0.0, moments)


def _shown(moments: Array) -> str:
    return ", ".join(f"{moment:.3g}" for moment in moments)
