"""README and documentation are true: every command and all Python in them runs as it stands there, page by page."""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

import liftopt
from liftopt.commands.cli import main
from liftopt.viz.viewer_server import PageServer

pytestmark = pytest.mark.long
ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
MADE = ("_build", "_drawings", "_tables", "gallery")
CHEAP = ("solver.starts=1", "solver.tries=6", "solver.intervals=12")
SOLVING = ("solve", "sensitivity", "pareto")
# Those that later pages start from come first.
FIRST = ("README.md", "docs/first_lift.md")
PAGES = sorted(
    (path.relative_to(ROOT).as_posix() for path in [ROOT / "README.md", *DOCS.rglob("*.md")]
     if not set(path.relative_to(ROOT).parts) & set(MADE)),
    key=lambda page: (page not in FIRST, page),
)  # fmt: skip


def _blocks(page: str, language: str) -> list[str]:
    text = (ROOT / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)


def _commands() -> dict[tuple[str, ...], str]:
    """Return the arguments of every ``liftopt`` command in the sh blocks, each once, and the page it is first on."""
    found: dict[tuple[str, ...], str] = {}
    for page in PAGES:
        for block in _blocks(page, "sh"):
            for line in block.replace("\\\n", " ").splitlines():
                for command in line.split("&&"):
                    words = shlex.split(command, comments=True)
                    if words and words[0].rpartition("/")[2] == "liftopt":
                        found.setdefault(tuple(words[1:]), page)
    return found


def _served_until_interrupted(words: list[str]) -> int:
    """Return the exit status of a served page, ended by Ctrl-C once its address stands there."""
    command = [sys.executable, "-m", "liftopt", *words, "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as served:
        assert served.stdout is not None
        for line in served.stdout:
            if "http://" in line:
                served.send_signal(signal.SIGINT)
                break
        served.stdout.read()
        return served.wait(timeout=300)  # only so that a hang fails


def _served_here(words: list[str]) -> int:
    """Return the exit status of a page that is served by this process, interrupted as soon as it waits for requests."""

    def interrupted(server: PageServer, poll_interval: float) -> None:
        assert server.page and server.server_port and poll_interval < 1.0
        raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(PageServer, "serve_forever", interrupted)
        return main([*words, "--no-browser"])


def _made_cheap(words: list[str]) -> list[str]:
    extra = [word for entry in CHEAP for word in ("--set", entry)] if words[0] in SOLVING else []
    if words[0] == "pareto":
        extra += ["--points", "3"]
    if words[0] == "plot":
        extra += ["--format", "svg"]
    if words == ["crosscheck"]:
        extra += ["--samples", "20"]
    return [*words, *extra]


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory, column_urdf: str) -> Path:
    """Run all commands in order, in one folder, solves on a coarse mesh; what they leave is for the other tests."""
    folder, here = tmp_path_factory.mktemp("pages"), Path.cwd()
    (folder / "my_arm.urdf").write_text(column_urdf, encoding="utf-8")  # a reader's own robot
    os.chdir(folder)
    processes = 0
    try:
        for command, page in _commands().items():
            words = list(command)
            if words[0] == "view" and "--html" not in words:
                # Each start of another process takes a second: one shows that Ctrl-C ends it, the others serve here.
                serve, processes = (_served_here if processes else _served_until_interrupted), processes + 1
                assert serve(words) == 0, (page, words)
            else:
                assert main(_made_cheap(words)) == 0, (page, words)
    finally:
        os.chdir(here)
    return folder


def test_every_command_runs_in_the_pages_order(lab: Path) -> None:
    commands = [words[0] for words in _commands()]
    assert commands.count("solve") >= 10
    told = {"view", "report", "plot", "crosscheck", "sensitivity", "pareto", "dry-run", "export", "compare"}
    assert told <= set(commands)
    assert (lab / "report.html").stat().st_size > 1_000_000
    for folder in ("table5", "table5_near", "free", "mine", "box", "wrench"):
        with xr.open_dataset(lab / "results" / folder / "solution.nc", engine="h5netcdf") as result:
            assert result.attrs["status"] == "solved"


@pytest.mark.parametrize("page", [page for page in PAGES if _blocks(page, "python")])
def test_python_runs_beside_the_results(page: str, lab: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The blocks of a page are run one after the other, as a reader does, and none of them fails."""
    monkeypatch.chdir(lab)
    names: dict[str, Any] = {"__name__": "__main__"}
    for index, block in enumerate(_blocks(page, "python")):
        exec(compile(block, f"{page}, Python block {index}", "exec"), names)
    solved = names.get("solution")
    assert solved is None or solved.solved


def test_every_block_is_run_or_says_that_it_is_not() -> None:
    """A block of commands is ``sh`` and run, or ``text``, ``bash`` or a file's content and not."""
    for page in PAGES:
        languages = re.findall(r"^```([a-z{].*)$", (ROOT / page).read_text(encoding="utf-8"), flags=re.MULTILINE)
        known = {"sh", "python", "text", "bash", "toml", "{toctree}", "{include}", "{literalinclude}", "{eval-rst}"}
        assert {language.split()[0] for language in languages} <= known, page


def test_links_between_pages_lead_somewhere() -> None:
    """Sphinx checks those of its pages; the README is read where the files are."""
    for page in PAGES:
        for target in re.findall(r"\]\(((?!https?:)[^)#]+)", (ROOT / page).read_text(encoding="utf-8")):
            made = set(Path(target).parts) & set(MADE)
            assert made or ((ROOT / page).parent / target).exists(), f"{page}: {target}"


def test_every_kind_of_finding_is_explained(solved: Callable[..., Any]) -> None:
    text = (DOCS / "howto" / "results.md").read_text(encoding="utf-8")
    for finding in solved("table5").solution.assessment:
        family = f"`{finding.code.partition('.')[0]}.*`"
        grasp = finding.code.replace("moment", "force")
        assert f"`{finding.code}`" in text or f"`{grasp}`" in text or family in text, finding.code


def test_every_example_has_a_place_in_the_gallery() -> None:
    sys.path.insert(0, str(DOCS))
    try:
        from tables import GALLERY
    finally:
        sys.path.remove(str(DOCS))
    assert sorted(GALLERY) == sorted(path.stem for path in (ROOT / "scripts" / "examples").glob("*.py"))


def test_every_public_name_is_on_the_api_page() -> None:
    page = (DOCS / "api.md").read_text(encoding="utf-8")
    documented = set(re.findall(r"^\.\. auto(?:class|function|exception):: (\w+)$", page, flags=re.MULTILINE))
    assert documented == set(liftopt.__all__)
