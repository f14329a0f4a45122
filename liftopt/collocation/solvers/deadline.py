"""A moment past which work stops, whatever it has found by then."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass


@dataclass(frozen=True)
class Deadline:
    """Until when work may go on, by the clock that never goes back (``time.monotonic``).

    Attributes:
        at: when it passes [s]; by default never.
        began: when the time that it limits began [s].
    """

    at: float = math.inf
    began: float = -math.inf

    @classmethod
    def after(cls, seconds: float) -> Deadline:
        """Return the deadline so many seconds from now."""
        now = time.monotonic()
        return cls(now + seconds, now)

    @property
    def passed(self) -> bool:
        """Whether time is over."""
        return time.monotonic() > self.at

    @property
    def left(self) -> float:
        """Time left [s]; negative once it has passed."""
        return self.at - time.monotonic()

    def share(self, share: float) -> Deadline:
        """Return the deadline after a share of the time; without a limit it never passes."""
        return self if self.at == math.inf else Deadline(self.began + share * (self.at - self.began), self.began)


NEVER = Deadline()
