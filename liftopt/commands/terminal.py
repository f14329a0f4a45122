"""What a command tells: results on stdout, progress and errors on stderr, in any encoding the terminal has."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from liftopt.commands.exit_status import DONE
from liftopt.files.interrupt import interrupts
from liftopt.types import Progress

if TYPE_CHECKING:
    from rich.console import Console

Command = Callable[[argparse.Namespace], int]


def write(text: str) -> None:
    """Write a result to stdout, as it is."""
    encoding = sys.stdout.encoding or "utf-8"
    try:
        sys.stdout.write(text.encode(encoding, "replace").decode(encoding))
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has seen enough; keep the interpreter from trying again on its way out
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def write_error(text: str) -> None:
    """Write text to stderr, as it is."""
    encoding = sys.stderr.encoding or "utf-8"
    sys.stderr.write(text.encode(encoding, "replace").decode(encoding))
    sys.stderr.flush()


def complain(message: str) -> None:
    """Write a message to stderr, as one line."""
    write_error(f"liftopt: error: {' '.join(message.split())}\n")


@contextmanager
def progress_line() -> Iterator[Progress]:
    """Give a function that shows where the work is, on a terminal, and ends it there if an interrupt was lost."""
    with interrupts() as found:
        if not sys.stderr.isatty():
            yield lambda message: found.check()
            return
        from rich.console import Console
        from rich.markup import escape

        def show(message: str) -> None:
            found.check()
            line.update(escape(message))

        with Console(stderr=True).status("loading the solver") as line:
            yield show


def printing(job: Callable[[argparse.Namespace], str]) -> Command:
    """Return the command that prints what a job returns."""

    def run(args: argparse.Namespace) -> int:
        write(job(args))
        return DONE

    return run


def telling(job: Callable[[argparse.Namespace, Progress], str]) -> Command:
    """Return the command that prints what a long job returns, and meanwhile where it is."""

    def run(args: argparse.Namespace) -> int:
        with progress_line() as progress:
            text = job(args, progress)
        write(text)
        return DONE

    return run


def captured(show: Callable[[Console], None]) -> str:
    """Return what ``show`` prints on a console, without the blanks at the ends of lines."""
    from rich.console import Console

    console = Console()
    with console.capture() as capture:
        show(console)
    return "\n".join(line.rstrip() for line in capture.get().split("\n"))
