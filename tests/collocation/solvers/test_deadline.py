"""The deadline: the oracle is a clock that is set by hand."""

from __future__ import annotations

import math
import time

import pytest

from liftopt.collocation.solvers.deadline import NEVER, Deadline


def test_a_deadline_passes_when_the_clock_is_past_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(time, "monotonic", lambda: 100.0)
    deadline = Deadline.after(50.0)
    assert (deadline.began, deadline.at, deadline.left, deadline.passed) == (100.0, 150.0, 50.0, False)
    monkeypatch.setattr(time, "monotonic", lambda: 150.0)
    assert not deadline.passed and deadline.left == 0.0
    monkeypatch.setattr(time, "monotonic", lambda: 160.0)
    assert deadline.passed and deadline.left == -10.0


def test_a_share_counts_from_the_same_beginning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(time, "monotonic", lambda: 100.0)
    whole = Deadline.after(50.0)
    monkeypatch.setattr(time, "monotonic", lambda: 130.0)
    assert whole.share(0.5) == Deadline(125.0, 100.0) and whole.share(0.5).passed
    assert not whole.share(0.7).passed
    assert whole.share(1.0) == whole


def test_no_limit_never_passes_and_has_no_shares() -> None:
    assert not NEVER.passed and NEVER.left == math.inf and NEVER.share(0.1) == NEVER
