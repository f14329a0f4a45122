"""The error tree: every failure liftopt names, with the data a caller needs to act on it."""

from __future__ import annotations


class LiftoptError(Exception):
    """Base of every error raised on purpose by liftopt; its text is one clear sentence."""


NO_VALUE = object()  # stands for the value of an entry that is missing, or of a path


class InputError(LiftoptError):
    """Something the user gave is wrong: the message names the key, the value and what is allowed.

    Attributes:
        key: dotted name of the offending entry (``"object.mass"``) or a path.
        value: the value as given, or ``NO_VALUE`` where there is none to show.
        allowed: what would be accepted, in words.
    """

    def __init__(self, key: str, value: object, allowed: str) -> None:
        self.key, self.value, self.allowed = key, value, allowed
        super().__init__(f"{key}: {allowed}" if value is NO_VALUE else f"{key} = {_shown(value)}: {allowed}")


def _shown(value: object) -> str:
    try:
        text = repr(list(value) if isinstance(value, tuple) else value)  # files and --set have lists
    except ValueError:  # Python refuses to write out integers of thousands of digits
        return "an integer of thousands of digits"
    except RecursionError:
        return "a value nested too deep to show"
    return text if len(text) <= 80 else text[:77] + "..."


class ModelError(LiftoptError):
    """A model cannot be built or used: the message names the model, the part and the fix."""


class SolverError(LiftoptError):
    """The solver adapter failed for a reason that is not the problem's (an option, a library)."""
