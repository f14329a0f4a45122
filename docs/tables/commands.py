"""The command line, from its own help."""

from __future__ import annotations

import argparse
import re

from liftopt.commands.cli import _parser


def commands() -> str:
    """Return the help of every command; the keys of a scenario stand elsewhere."""
    (action,) = [a for a in _parser()._actions if isinstance(a, argparse._SubParsersAction)]
    parts = []
    for name, parser in action.choices.items():
        parser.epilog, parser.prog = None, f"liftopt {name}"
        text = re.sub(r"\x1b\[[0-9;]*m", "", parser.format_help()).rstrip()
        parts.append(f"## {name}\n\n```text\n{text}\n```\n")
    return "\n".join(parts)
