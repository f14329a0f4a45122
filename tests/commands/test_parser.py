"""Words of the command line that are wrong: one line says what was meant, exit 2, and nothing is solved or written."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from liftopt.commands.cli import main


@pytest.fixture(autouse=True)
def nothing_is_solved(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def solve(*_: object, **__: object) -> None:
        raise AssertionError("solved")

    monkeypatch.setattr("liftopt.search.solve.solve", solve)
    monkeypatch.chdir(tmp_path)


SPACED = "must be KEY=VALUE without spaces; write --set human.stature=1.75"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        # The value of --set apart from its key.
        ("solve --set human.stature 1.75", SPACED),
        ("solve table5 --set human.stature 1.75", SPACED),
        ("solve --set human.stature 1.75 --json", SPACED),
        ("solve --set=human.stature 1.75", SPACED),
        ("solve --set human.stature = 1.75", SPACED),
        ("solve --set human.stature =1.75", SPACED),
        ("solve --set human.stature = 1.75, human.mass = 70", SPACED),
        ("solve --set human.stature= 1.75", SPACED),
        ("pareto --set human.stature 1.75 --out x", SPACED),
        ("solve --set human.stature:1.75", "write --set human.stature=1.75"),
        ("solve --set human.stature table5", "--set = 'human.stature': must be KEY=VALUE"),
        ("solve --set human.stature", "--set = 'human.stature': must be KEY=VALUE"),
        ("solve --set", "--set: expected one argument"),
        ("solve --set human.stature=1.75 human.mass=70", "write --set human.mass=70"),
        ("solve --set human.stature=1.75,human.mass=70", "holds several entries; give each its own --set"),
        ("solve human.stature=1.75", "write --set human.stature=1.75"),
        # Options.
        ("solve --outt x", "there is no option --outt; did you mean --out?"),
        ("solve --sett a=1", "did you mean --set?"),
        ("solve --stature 1.75", "did you mean --set human.stature=VALUE?"),
        ("solve --human.stature=1.75", "did you mean --set human.stature=1.75?"),
        ("view x --htm page.html", "did you mean --html?"),
        ("view x --port seven", "argument --port: invalid int value: 'seven'"),
        ("solve -q", "there is no option -q"),
        ("solve -out x", "there is no option -out; did you mean --out?"),
        ("solve \u2014out x", "did you mean --out?"),
        ("solve \u2013set a=1", "did you mean --set?"),
        ("--json solve", "there is no option --json here; options stand after the command"),
        # Commands.
        ("solv", "'solv' is no command; did you mean solve?"),
        ("SOLVE", "did you mean solve?"),
        ("help solve", "did you mean liftopt --help?"),
        ("dry_run x", "did you mean dry-run?"),
        ("table5", "did you mean liftopt solve table5?"),
        ("lab.toml", "did you mean liftopt solve lab.toml?"),
        ("xyz", "'xyz' is no command; there are solve, crosscheck, view"),
        ("", "arguments are required: COMMAND"),
        ("view", "arguments are required: RESULT"),
        ("solve a b", "'b' is too much"),
        # One key, two values.
        ("solve --set human.mass=60 --set human.mass=61", "human.mass is given twice, as 60 and as 61"),
        ("solve --refine --set refine.on=false", "refine.on is given twice, as true and as false"),
    ],
)
def test_wrong_words_are_one_line_that_says_what_was_meant(
    words: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words.split()) == 2
    out, err = capsys.readouterr()
    assert said in err
    assert err.startswith("liftopt: error: ")
    assert err.count("\n") == 1
    assert (out == "") is ("--json" not in words)
    assert list(Path().iterdir()) == []


def test_json_is_told_of_wrong_words_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "--json", "--outt", "x"]) == 2
    error = json.loads(capsys.readouterr().out)
    assert error["exit_status"] == 2
    assert "did you mean --out?" in error["error"]["message"]


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ("stature=1.75", "stature = 1.75: unknown key; did you mean human.stature?"),
        ("human.statur=1.7", "human.statur = 1.7: unknown key; did you mean human.stature?"),
        ("person.stature=1.75", "person.stature = 1.75: unknown key; did you mean human.stature?"),
        ("Human.Stature=1.75", "did you mean human.stature?"),
        ("human.height=1.75", "did you mean human.stature?"),
        ("object.weight=75", "did you mean object.mass?"),
        ("box.mass=3", "did you mean object.mass?"),
        ("mass=3", "did you mean human.mass, object.mass or robot.tool.mass?"),
        ("standing-distance=1.8", "did you mean task.standing_distance?"),
        ("task.height=1", "did you mean task.end.height or task.start.height?"),
        ("robot.gripper.length=0.1", "did you mean robot.tool.length?"),
        ("solver.interval=20", "did you mean solver.intervals?"),
        ("xyz=1", "xyz = 1: unknown key; known here: schema, name, duration"),
        ("human.stature=", "human.stature = '': must be a number from 1.2 to 2.2 m"),
        ("human.stature=1.75m", "must be a number from 1.2 to 2.2 m (height of the person); write 1.75\n"),
        ("human.stature=1,75", "; write 1.75\n"),
        ("human.stature=175 cm", "; write 1.75\n"),
        ("human.stature=175", "; in m it is 1.75, if cm were meant\n"),
        ("human.stature='1.75'", "; write 1.75 without quotes\n"),
        ("human.stature=17,5", "(height of the person)\n"),  # 17.5 m would be wrong too: nothing to offer
        ("object.mass=2500 g", "; write 2.5\n"),
        ("duration=2,5s", "; write 2.5\n"),
        ("human/stature=1.75", "did you mean human.stature?"),
        ("human.mass=75 KG", "; write 75\n"),
        ("refine.objective_error=2%", "; write 0.02\n"),
        ("solver.intervals=20.0", "; write 20\n"),
        ("solver.intervals='20'", "; write 20 without quotes\n"),
        ("solver.intervals=20.5", "(spline intervals N)\n"),
        ("task.start.human_distance=Free", "; write free\n"),
        ("human.sex=Male", "; did you mean male?\n"),
        ("refine.on=True", "; write true\n"),
    ],
)
def test_wrong_entries_are_one_line_that_says_what_was_meant(
    entry: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["solve", "--set", entry]) == 2
    out, err = capsys.readouterr()
    assert said in err
    assert (out, err.count("\n")) == ("", 1)


def test_a_key_of_another_section_in_a_file_is_told_with_its_place(capsys: pytest.CaptureFixture[str]) -> None:
    Path("lab.toml").write_text("schema = 1\nduration = 2.0\nstature = 1.75\n[person]\nmass = 70.0\n")
    assert main(["solve", "lab.toml"]) == 2
    assert "stature = 1.75: unknown key; did you mean human.stature?" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["--help"], ["solve", "--help"], ["--version"]])
def test_help_and_version_are_no_errors(words: list[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(words)
    assert caught.value.code == 0
