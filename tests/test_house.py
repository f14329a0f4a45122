"""How the package is laid out: few doors, no circles, and arrows that only lead down. The imports are the oracle."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[1]
MOST_DOORS, LONGEST = 8, 400
# Rooms that a room never imports, at whatever depth the import stands.
NEVER = {
    "viz": {"lab"},
    "search": {"storage", "viz", "commands"},
    "solution": {"storage", "viz", "search", "commands"},
    "collocation": {"scenario", "solution", "search", "storage", "viz", "assessment", "commands"},
    "multibody": {"collocation", "scenario", "solution", "search", "storage", "viz", "commands"},
    "scenario": {"solution", "search", "storage", "viz", "commands"},
    "storage": {"search", "viz", "commands"},
    "control": {"storage", "viz", "commands"},
}
ONLY_FROM = {"crosscheck": {"commands"}}  # no solve imports what checks it


@pytest.fixture(scope="module")
def graph() -> ModuleType:
    spec = importlib.util.spec_from_file_location("import_graph", ROOT / "scripts" / "import_graph.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_few_files_stand_at_the_top() -> None:
    doors = sorted(path.name for path in (ROOT / "liftopt").glob("*.py"))
    assert len(doors) <= MOST_DOORS, doors


def test_no_file_is_too_long() -> None:
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in (ROOT / "liftopt").rglob("*.py")}
    assert {str(path): n for path, n in lengths.items() if n > LONGEST} == {}


def test_no_file_is_a_bag_of_helpers() -> None:
    assert not [path for path in ROOT.rglob("liftopt/**/*.py") if path.stem in ("utils", "util", "helpers", "misc")]


def test_no_circle_of_files(graph: ModuleType) -> None:
    assert graph.circles(graph.file_graph(ROOT)) == []


def test_no_circle_of_rooms(graph: ModuleType) -> None:
    assert graph.circles(graph.room_graph(graph.file_graph(ROOT))) == []


@pytest.mark.parametrize("name", NEVER)
def test_arrows_lead_down(name: str, graph: ModuleType) -> None:
    assert graph.room_graph(graph.file_graph(ROOT))[name] & NEVER[name] == set()


@pytest.mark.parametrize("name", ONLY_FROM)
def test_checks_stay_apart(name: str, graph: ModuleType) -> None:
    rooms = graph.room_graph(graph.file_graph(ROOT))
    assert {who for who, targets in rooms.items() if name in targets} <= ONLY_FROM[name]


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
