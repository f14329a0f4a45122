"""Ctrl-C while a command runs: it acts even where the first KeyboardInterrupt is swallowed, and the second one ends.

Python raises KeyboardInterrupt wherever it is. Where that is a conversion or a callback inside CasADi's bindings, they
take it for a failed attempt: it is dropped, or comes out as another error. Where it is a weak reference's callback or
a finaliser, as in Python's own import system, Python prints it and drops it.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

INTERRUPTED = 130  # the exit status of a command that was interrupted


class Interrupts:
    """Whether there was a Ctrl-C.

    Attributes:
        noted: there was.
    """

    def __init__(self) -> None:
        """Start without."""
        self.noted = False

    def check(self) -> None:
        """Raise KeyboardInterrupt if there was a Ctrl-C, which then has been swallowed."""
        if self.noted:
            raise KeyboardInterrupt


@contextmanager
def interrupts() -> Iterator[Interrupts]:
    """Note a Ctrl-C within the block, where nobody else handles it; the second one ends the process at once.

    Any error that comes out of the block after one is the KeyboardInterrupt it was. What is done between two calls of
    ``check`` is the longest that a swallowed one can take to act.
    """
    found, handler = Interrupts(), signal.getsignal(signal.SIGINT)
    # Only the main thread may set handlers, and a command started in the background ignores the signal.
    if handler is not signal.default_int_handler or threading.current_thread() is not threading.main_thread():
        yield found
        return

    def note(_: int, frame: FrameType | None) -> None:
        if found.noted:
            with suppress(OSError):
                os.write(2, b"liftopt: error: interrupted\n")
            os._exit(INTERRUPTED)
        found.noted = True
        raise KeyboardInterrupt

    def drop(report: sys.UnraisableHookArgs) -> None:
        # ``check`` raises it again: it is not for the user to read.
        if not (found.noted and issubclass(report.exc_type, KeyboardInterrupt)):
            unraisable(report)

    unraisable, sys.unraisablehook = sys.unraisablehook, drop
    signal.signal(signal.SIGINT, note)
    try:
        yield found
    except Exception:
        if found.noted:
            raise KeyboardInterrupt from None
        raise
    finally:
        signal.signal(signal.SIGINT, handler)
        sys.unraisablehook = unraisable
