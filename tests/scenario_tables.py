"""Random tables of a scenario: any values that its entries allow, each for itself."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from liftopt.files.entries import choices_of, extra_of, kinds_of, range_of
from liftopt.files.section import sections_in
from liftopt.scenario.agents import KINDS
from liftopt.scenario.model import Scenario
from liftopt.scenario.obstacles import Obstacle

TEAM = {"human": "person", "robot": "robot"}
# Of a robot that comes from a file, whose names of joints and links no strategy knows; here all are Sawyer.
OF_FILES = ("arguments", "grasp_frame", "base_link", "locked", "limits", "posture", "joint_weights", "direction")
LEFT_OUT = ("agents", "grasps", "kind", "roll_deg", "pitch_deg", *OF_FILES)


def tables() -> st.SearchStrategy[dict[str, Any]]:
    """Return the tables of a person and a robot with an object, a task and everything else."""
    agents = st.fixed_dictionaries({name: section(KINDS[kind]) for name, kind in TEAM.items()})
    return st.tuples(section(Scenario), agents).map(lambda drawn: {"schema": 2, **drawn[0], "agents": drawn[1]})


def section(of: type[BaseModel]) -> st.SearchStrategy[dict[str, Any]]:
    """Return tables of one section."""
    fields = {name: field for name, field in of.model_fields.items() if name not in LEFT_OUT}
    kind = {"kind": st.just(of.model_fields["kind"].default)} if "kind" in of.model_fields else {}
    given = {name: _entry(name, field) for name, field in fields.items() if not _may_be_left_out(field)}
    left_out = {name: _entry(name, field) for name, field in fields.items() if _may_be_left_out(field)}
    return st.fixed_dictionaries(kind | given, optional=left_out)


def _may_be_left_out(field: FieldInfo) -> bool:
    return not field.is_required() and (field.default is None or field.default_factory is not None)


def _entry(name: str, field: FieldInfo) -> st.SearchStrategy[Any]:
    if name == "model":
        return st.just("sawyer")
    if name == "obstacles":
        return st.lists(section(Obstacle), max_size=2)
    if name == "box" or (name == "position" and field.is_required()):  # of an obstacle
        return st.lists(st.floats(0.001, 10.0), min_size=3, max_size=3)
    if sections := sections_in(field):
        return st.one_of([section(inside) for inside in sections])
    if choices := choices_of(field):
        return st.sampled_from(choices)
    kinds, (low, high, is_open) = kinds_of(field), range_of(field)
    if kinds == (float,):
        numbers = st.floats(low, high, exclude_min=is_open)
        return numbers | st.just(extra_of(field)["word"]) if "word" in extra_of(field) else numbers
    if kinds == (int,):
        return st.integers(int(low), int(high))
    if kinds == (bool,):
        return st.booleans()
    if name == "hands":
        return st.sampled_from((["right"], ["left"], ["right", "left"]))
    if name == "name":
        return st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,30}", fullmatch=True)
    return st.lists(st.floats(-10.0, 10.0), min_size=2, max_size=2)  # a position
