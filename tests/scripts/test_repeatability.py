"""The same answer whatever else the machine does, on a sample of what ``scripts/check_repeatability.py`` runs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.long
SCRIPT = Path(__file__).parents[2] / "scripts" / "check_repeatability.py"


@pytest.fixture(scope="module")
def sampled(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, dict[str, list[dict[str, Any]]]]:
    """Return the table and the answers of three small scenarios, the last without a solution."""
    out = tmp_path_factory.mktemp("repeatability") / "answers.json"
    command = [sys.executable, str(SCRIPT), "--count", "3", "--out", str(out), "--set", "solver.time_limit=3600"]
    command += ["--set", "solver.tries=4", "--set", "solver.intervals=10"]
    # With the kernels' own flags both kinds of vectors compile for 23 s each, to the same bits.
    command += ["--unoptimised"]
    command += ["--only", "beside", "1 worker", "4 workers", "avx2", "plain"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout, json.loads(out.read_text(encoding="utf-8"))


def test_bit_by_bit_beside_load_and_with_any_number_of_workers(sampled: tuple[str, dict[str, Any]]) -> None:
    """The digest holds every number and word of a solution but the seconds; no search ends for want of time."""
    told, found = sampled
    first = found["alone"]
    assert [entry["verdict"] for entry in first][-1] == "infeasible"
    assert "solved" in {entry["verdict"] for entry in first}
    for name in ("beside 6 busy processes", "1 worker", "4 workers"):
        assert [entry["digest"] for entry in found[name]] == [entry["digest"] for entry in first], name
        assert f"| {name} | 3 of 3 | 0 |" in told


def test_other_vectors_come_to_the_same_verdict(sampled: tuple[str, dict[str, Any]]) -> None:
    """Where this processor has them. Which of several optima is the best of a few starts may be for rounding to say."""
    _, found = sampled
    for kind in ("vectors: avx2", "vectors: plain"):
        if found[kind]:
            assert [e["verdict"] for e in found[kind]] == [e["verdict"] for e in found["alone"]], kind
    assert len(found["vectors: plain"]) == 3  # every processor has these
