"""How a solution was found and verified, as the JSON text in solution.nc: every entry of the type that it must have."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, asdict, dataclass, fields
from typing import Any, TypeVar, get_args, get_type_hints

from liftopt.solution.accuracy import Accuracy
from liftopt.solution.checks import Check
from liftopt.solution.finding import MATHEMATICS, Assessment, Finding
from liftopt.solution.infeasibility_report import InfeasibilityReason, SuggestedChange
from liftopt.solution.solution import Solution, StartRecord

T = TypeVar("T")
TERMS, SECONDS = ("acceleration", "force"), ("solve", "evaluation", "setup", "total")


@dataclass(frozen=True)
class Record:
    """What is neither trajectory nor scenario; see ``Solution``, which has the same attributes."""

    outcome: str
    objective_weights: dict[str, float]
    seconds: dict[str, float]
    starts: tuple[StartRecord, ...]
    kept_start: str
    checks: tuple[Check, ...]
    kkt_tolerance: float
    notes: tuple[str, ...]
    accuracy: Accuracy | None
    reasons: tuple[InfeasibilityReason, ...]
    suggested_changes: tuple[SuggestedChange, ...]


def record(solution: Solution) -> dict[str, Any]:
    """Return what is neither trajectory nor scenario, ready for JSON: how it was found and verified."""
    return {
        "outcome": solution.outcome,
        "objective_weights": solution.objective_weights,
        "seconds": solution.seconds,
        "starts": [asdict(start) | {"objective": _finite(start.objective)} for start in solution.starts],
        "kept_start": solution.kept_start,
        # JSON knows no infinity: a check that is only reported has no limit.
        "checks": [
            asdict(check) | {"value": _finite(check.value), "limit": _finite(check.limit)}
            for check in solution.verification.checks
        ],
        "kkt_tolerance": solution.verification.kkt_tolerance,
        "notes": solution.notes,
        "accuracy": None if solution.accuracy is None else _accuracy(solution.accuracy),
        "reasons": [asdict(reason) | {"amount": _finite(reason.amount)} for reason in solution.reasons],
        "suggested_changes": [asdict(change) for change in solution.suggested_changes],
    }


def _accuracy(accuracy: Accuracy) -> dict[str, Any]:
    return {key: _finite(value) if isinstance(value, float) else value for key, value in asdict(accuracy).items()}


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def read_record(text: str, agents: Sequence[str]) -> Record:
    """Return the record of a JSON text on a lift of ``agents``. What older versions did not write is absent.

    Raises:
        ValueError, KeyError: it is no JSON, or an entry is missing or of another type.
        RecursionError: it is nested too deep.
    """
    read = _of("record", json.loads(text), dict)
    accuracy = read.get("accuracy")
    found = Record(
        outcome=_of("outcome", read["outcome"], str),
        objective_weights=_numbers("objective_weights", read["objective_weights"], (*agents, *TERMS)),
        seconds=_numbers("seconds", read["seconds"], SECONDS),
        starts=_entries(StartRecord, read["starts"]),
        kept_start=_of("kept_start", read["kept_start"], str),
        # JSON knows no infinity: a check that is only reported has no limit.
        checks=_entries(Check, read["checks"], {"limit": math.inf}),
        kkt_tolerance=_of("kkt_tolerance", read["kkt_tolerance"], float),
        notes=tuple(_of("notes", note, str) for note in _of("notes", read["notes"], list)),
        accuracy=None if accuracy is None else _entry(Accuracy, accuracy),
        reasons=_entries(InfeasibilityReason, read.get("reasons", [])),
        suggested_changes=_entries(SuggestedChange, read.get("suggested_changes", read.get("remedies", []))),
    )
    if not found.checks:
        raise ValueError("no check is recorded")
    return found


def read_assessment(text: str, kinds: Iterable[str]) -> Assessment:
    """Return the assessment of a JSON text on a lift of agents of some kinds.

    Raises:
        ValueError, KeyError: it is no JSON, an entry is missing or of another type, or there is no verdict.
        RecursionError: it is nested too deep.
    """
    assessment = Assessment(_entries(Finding, json.loads(text)))
    for subject in (MATHEMATICS, *kinds):
        assessment.verdict(subject)
    return assessment


def _entries(of: type[T], given: Any, absent: Mapping[str, float] | None = None) -> tuple[T, ...]:
    return tuple(_entry(of, entry, absent) for entry in _of(of.__name__, given, list))


def _entry(of: type[T], given: Any, absent: Mapping[str, float] | None = None) -> T:
    """Return a dataclass from its entries; a number that is null is the one of ``absent``, otherwise NaN."""
    name, kinds, values = of.__name__, get_type_hints(of), dict(_of(of.__name__, given, dict))
    for field in fields(of):  # type: ignore[arg-type]
        if field.name not in values and field.default is not MISSING:
            continue
        value = values[field.name]
        if value is None and kinds[field.name] is float:
            value = (absent or {}).get(field.name, math.nan)
        values[field.name] = _of(f"{name}.{field.name}", value, kinds[field.name])
    return of(**values)


def _numbers(key: str, given: Any, names: tuple[str, ...]) -> dict[str, float]:
    numbers = {name: _of(f"{key}.{name}", value, float) for name, value in _of(key, given, dict).items()}
    if missing := set(names) - set(numbers):
        raise ValueError(f"{key} lacks {', '.join(sorted(missing))}")
    return numbers


def _of(key: str, value: Any, kind: Any) -> Any:
    """Return a value that must be of a kind: a plain type, ``X | None`` or ``tuple[X, ...]``."""
    inner = get_args(kind)
    if type(None) in inner:
        return None if value is None else _of(key, value, inner[0])
    if inner:
        return tuple(_of(key, item, inner[0]) for item in _of(key, value, list))
    if kind is float and type(value) is int:
        return float(value)
    if type(value) is not kind:
        raise ValueError(f"{key} is {value!r:.60}, which is no {kind.__name__}")
    return value
