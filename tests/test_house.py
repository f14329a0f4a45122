"""How the package is laid out: few doors, no circles, and arrows that only lead down. The imports are the oracle."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[1]
MOST_DOORS = 8
# Rooms that a room never imports, at whatever depth the import stands.
OUTPUTS = {"storage", "viz", "studies", "control", "lab", "commands", "face"}
NEVER = {
    "multibody": {"collocation", "scenario", "solution", "assessment", "search", *OUTPUTS},
    "ergonomics": {"collocation", "solution", "assessment", "search", *OUTPUTS},
    "collocation": {"scenario", "solution", "assessment", "search", *OUTPUTS},
    "scenario": {"solution", "assessment", "search", *OUTPUTS},
    "solution": {"assessment", "search", *OUTPUTS},
    "assessment": {"search", *OUTPUTS},
    "search": OUTPUTS,
    "storage": {"search", *OUTPUTS} - {"storage"},
    "viz": {"search", *OUTPUTS} - {"viz", "storage"},
    "control": OUTPUTS - {"control"},
    "studies": {"lab", "commands", "face"},
    "lab": {"search", "studies", "control", "commands", "face"},
    "files": {"multibody", "collocation", "scenario", "solution", "assessment", "search", *OUTPUTS},
}
ONLY_FROM = {"crosscheck": {"commands"}, "commands": {"__main__"}}  # no solve imports what checks it
# Their text is part of the key under which compiled kernels are kept: they name these types themselves.
OWN_TYPES = {"collocation/dynamics.py", "collocation/codegen/kernels.py"}
# Where dotted keys of a scenario are taken apart; the others hold no such keys, but a code, a version, words.
DOTTED = {"scenario", "solution/finding.py", "multibody/mujoco_model.py"}


@pytest.fixture(scope="module")
def graph() -> ModuleType:
    spec = importlib.util.spec_from_file_location("import_graph", ROOT / "scripts" / "import_graph.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def files(graph: ModuleType) -> dict[str, set[str]]:
    """Return which file imports which."""
    found: dict[str, set[str]] = graph.file_graph(ROOT)
    return found


def test_few_files_stand_at_the_top() -> None:
    doors = sorted(path.name for path in (ROOT / "liftopt").glob("*.py"))
    assert len(doors) <= MOST_DOORS, doors


def test_no_circle_of_files(graph: ModuleType, files: dict[str, set[str]]) -> None:
    assert graph.circles(files) == []


def test_no_circle_of_rooms(graph: ModuleType, files: dict[str, set[str]]) -> None:
    assert graph.circles(graph.room_graph(files)) == []


@pytest.mark.parametrize("name", NEVER)
def test_arrows_lead_down(name: str, graph: ModuleType, files: dict[str, set[str]]) -> None:
    assert graph.room_graph(files)[name] & NEVER[name] == set()


@pytest.mark.parametrize("name", ONLY_FROM)
def test_few_come_in(name: str, graph: ModuleType, files: dict[str, set[str]]) -> None:
    rooms = graph.room_graph(files)
    assert {who for who, targets in rooms.items() if name in targets} <= ONLY_FROM[name]


def _where(pattern: str) -> set[str]:
    """Return the files of the package with a line that a pattern finds, by their paths within it."""
    package, line = ROOT / "liftopt", re.compile(pattern, re.MULTILINE)
    return {
        str(path.relative_to(package))
        for path in package.rglob("*.py")
        if line.search(path.read_text(encoding="utf-8"))
    }


def test_types_of_all_rooms_have_one_home() -> None:
    assert _where(r"^(Array|Progress)\b.*=") - OWN_TYPES == {"types.py"}


def test_dotted_keys_are_taken_apart_in_one_room() -> None:
    found = _where(r"""\.r?(split|partition)\(["']\.["']""")
    assert "scenario/keys.py" in found
    assert {path for path in found if not DOTTED & {path, path.split("/")[0]}} == set()


def test_the_core_knows_no_human_robot_or_table() -> None:
    """The word in quotes would be a name or a kind that the equations ask for."""
    assert {
        path for path in _where(r"""["'](human|person|robot|sawyer|table)["']""") if path.startswith("colloc")
    } == set()


def test_nobody_counts_on_a_second_agent() -> None:
    """Who is meant has a name or a kind; the first of those there are may stand for all."""
    assert _where(r"\bagents\[1\]") == set()


def test_circles_are_found(graph: ModuleType, tmp_path: Path) -> None:
    """One circle by an import inside a function, one for type checking alone; one of the imports is relative."""
    package = tmp_path / "liftopt"
    for room in ("a", "b", "c", "d"):
        (package / room).mkdir(parents=True)
        (package / room / "__init__.py").write_text("")
    (package / "__init__.py").write_text("")
    (package / "a" / "one.py").write_text("from liftopt.b import two\n")
    (package / "b" / "two.py").write_text("def f():\n    from ..a.one import g\n")
    (package / "c" / "three.py").write_text("if TYPE_CHECKING:\n    import liftopt.d.four\n")
    (package / "d" / "four.py").write_text("from liftopt.c.three import x\n")
    files = graph.file_graph(tmp_path)
    assert graph.circles(files) == [["liftopt.a.one", "liftopt.b.two"], ["liftopt.c.three", "liftopt.d.four"]]
    assert graph.circles(graph.room_graph(files)) == [["a", "b"], ["c", "d"]]
