"""A URScript program run by Python: its own parser, the maker's signatures, and an arm that does what it is told.

URScript's statements that the program uses are Python's, but for blocks that ``end`` closes and for ``halt``. So blocks
are checked by their ends and by their indentation, which must agree, and Python parses and runs what is left.
"""

from __future__ import annotations

import ast
import inspect
from typing import Any

import numpy as np

# Of the maker's script manual: what may be called, and with what.
MANUAL = {
    "get_actual_joint_positions": "lambda: 0",
    "norm": "lambda a: 0",
    "popup": "lambda s, title='Popup', warning=False, error=False, blocking=False: 0",
    "movej": "lambda q, a=1.4, v=1.05, t=0, r=0: 0",
    "servoj": "lambda q, a=0, v=0, t=0.002, lookahead_time=0.1, gain=300: 0",
    "stopj": "lambda a: 0",
}
STATEMENTS = (ast.FunctionDef, ast.While, ast.If, ast.Assign, ast.Expr, ast.Raise)
VALUES = (
    ast.Call, ast.keyword, ast.Compare, ast.Lt, ast.Gt, ast.BinOp, ast.Add, ast.Sub, ast.Subscript, ast.List,
    ast.UnaryOp, ast.USub, ast.Constant, ast.Name, ast.Load, ast.Store, ast.arguments, ast.Module,
)  # fmt: skip


class Halted(Exception):
    """The program halted."""


class Controller:
    """An arm at ``position`` that does what it is told at once; ``told`` is all that it was."""

    def __init__(self, position: Any) -> None:
        self.position = np.array(position, float)
        self.told: list[tuple[str, dict[str, Any]]] = []

    def run(self, program: str) -> None:
        """Parse and run a program; raises ``Halted`` where it halts, AssertionError where it is none."""
        tree = ast.parse(_as_python(program))
        for node in ast.walk(tree):
            assert isinstance(node, STATEMENTS + VALUES), ast.dump(node)
        (main,) = tree.body
        assert isinstance(main, ast.FunctionDef) and not main.args.args
        names: dict[str, Any] = {name: self._command(name) for name in MANUAL} | {"Halted": Halted}
        exec(compile(tree, "program", "exec"), names)
        names[main.name]()

    def of(self, name: str) -> list[dict[str, Any]]:
        """Return the arguments of all calls of a function."""
        return [arguments for called, arguments in self.told if called == name]

    def _command(self, name: str) -> Any:
        signature = inspect.signature(eval(MANUAL[name]))

        def call(*args: Any, **more: Any) -> Any:
            bound = signature.bind(*args, **more)
            bound.apply_defaults()
            if name == "norm":
                return abs(bound.arguments["a"])
            if name == "get_actual_joint_positions":
                return self.position.tolist()
            self.told.append((name, dict(bound.arguments)))
            if name in ("movej", "servoj"):
                self.position = np.array(bound.arguments["q"], float)
                assert self.position.shape == (6,)
            return None

        return call


def _as_python(program: str) -> str:
    assert program.isascii() and program.endswith("end\n") and max(map(len, program.splitlines())) < 200
    lines, depth = [], 0
    for line in program.splitlines():
        code = line.strip()
        depth -= code == "end"
        assert line == "  " * depth + code, line
        if code == "halt":
            code = "raise Halted"
        if code != "end":
            lines.append("  " * depth + code)
        depth += code.endswith(":") and not code.startswith("#")
    assert depth == 0
    return "\n".join(lines)
