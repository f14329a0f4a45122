"""Draw the imports between the rooms of liftopt, and name every circle: ``python scripts/import_graph.py``.

Every import counts: at the top of a file, inside a function, and for type checking alone. Only the standard library is
needed. With ``--from ROOM --to ROOM`` it lists the imports behind one arrow; with ``--root FOLDER`` it reads another
copy of the package. The exit status is 1 where there is a circle of files or of rooms.
"""

from __future__ import annotations

import argparse
import ast
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

Graph = dict[str, set[str]]
HERE = Path(__file__).resolve().parents[1]


def modules(root: Path) -> dict[str, Path]:
    """Return the modules of the package ``liftopt`` below ``root``: dotted name -> file."""
    found = {}
    for path in sorted((root / "liftopt").rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def file_graph(root: Path) -> Graph:
    """Return which module imports which others of the package."""
    known = modules(root)
    return {name: set(_imported(name, path, known)) - {name} for name, path in known.items()}


def _imported(name: str, path: Path, known: Mapping[str, Path]) -> Iterator[str]:
    package = name.split(".") if path.stem == "__init__" else name.split(".")[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            source = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                whole = f"{source}.{alias.name}"
                yield from (found for found in (whole if whole in known else source,) if found in known)


def room(module: str) -> str:
    """Return the room that a module is in: the folder in the package, or the name of a file at the top."""
    return module.split(".")[1] if "." in module else module


def room_graph(files: Graph) -> Graph:
    """Return which room imports which others."""
    rooms: Graph = defaultdict(set)
    for name, targets in files.items():
        rooms[room(name)] |= {room(target) for target in targets} - {room(name)}
    return dict(rooms)


def circles(graph: Graph) -> list[list[str]]:
    """Return the groups of nodes that reach each other, each sorted (strongly connected, Tarjan 1972)."""
    order: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    found = []

    def visit(node: str) -> None:
        order[node] = lowest[node] = len(order)
        stack.append(node)
        for target in sorted(graph.get(node, ())):
            if target not in order:
                visit(target)
                lowest[node] = min(lowest[node], lowest[target])
            elif target in stack:
                lowest[node] = min(lowest[node], order[target])
        if lowest[node] == order[node]:
            group = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(group) > 1:
                found.append(sorted(group))

    for node in sorted(graph):
        if node not in order:
            visit(node)
    return sorted(found)


def _lines(files: Graph) -> Iterable[str]:
    rooms = room_graph(files)
    for name in sorted(rooms):
        yield f"{name:18} -> {', '.join(sorted(rooms[name])) or '-'}"
    yield f"{len(files)} files, {len(rooms)} rooms, {sum(map(len, rooms.values()))} arrows between rooms"
    yield from (f"circle of {what}: {', '.join(circle)}" for what, circle in _circles(files))


def _circles(files: Graph) -> list[tuple[str, list[str]]]:
    return [("files", c) for c in circles(files)] + [("rooms", c) for c in circles(room_graph(files))]


def main(arguments: list[str] | None = None) -> int:
    """Print the graph, or the imports behind one arrow."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=Path, default=HERE, help="folder that holds the package")
    parser.add_argument("--from", dest="source", metavar="ROOM", help="with --to: whose imports to list")
    parser.add_argument("--to", dest="target", metavar="ROOM", help="with --from: what they lead to")
    args = parser.parse_args(arguments)
    files = file_graph(args.root)
    if args.source and args.target:
        arrow = [(a, b) for a in files for b in files[a] if (room(a), room(b)) == (args.source, args.target)]
        print(*(f"{a} imports {b}" for a, b in sorted(arrow)), sep="\n")
        return 0
    print(*_lines(files), sep="\n")
    return 1 if _circles(files) else 0


if __name__ == "__main__":
    sys.exit(main())
