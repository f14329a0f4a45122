"""Malformed scenario and result files: exit status 2 and one line on stderr, whatever they hold; nothing is written.

The files are the same at every run. The oracle is the contract of the command line; a file that comes out of the
mill still readable is counted apart.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from liftopt.scenario.model import load_scenario

MODEL = "urdf_robot"
NUMBERS = ["nan", "inf", "-inf", "1e999", "-1", "0", "1e308", "9" * 400, "0x" + "f" * 400, "1979-05-27", "true", '"1"']
VALUES = [*NUMBERS, "[]", "{}", "[" * 90 + "]" * 90, "[[1.0]]", '"\\u0000"', "'''\n'''", "07:32:00", '""', "{a.b.c=1}"]


@pytest.fixture(scope="module")
def result(solved: Callable[..., Any]) -> Path:
    """Return a whole result."""
    folder: Path = solved("table5", "solver.intervals=10", "solver.starts=1").folder
    return folder


def _damaged(raw: bytes, rng: random.Random) -> bytes:
    """Cut, overwrite, move, repeat or leave out some of a file."""
    data, i, j = bytearray(raw), rng.randrange(len(raw)), rng.randrange(len(raw))
    length = rng.choice([1, 8, 64, 512])
    kind = rng.randrange(6)
    if kind == 0:
        del data[i:]
    elif kind == 1:
        for _ in range(rng.choice([1, 4, 64])):
            data[rng.randrange(len(data))] = rng.randrange(256)
    elif kind == 2:
        data[i : i + 8] = rng.choice([b"\xff" * 8, b"\0" * 8, b"\x7f" + b"\xff" * 7])
    elif kind == 3:
        data[i : i + length] = data[j : j + length]
    elif kind == 4:
        del data[i : i + length]
    else:
        data[i:i] = data[j : j + length]
    return bytes(data)


def _wrong_entry(lines: list[str], rng: random.Random) -> str:
    """Give an entry of a scenario another value, leave it out, write it twice or misspell it."""
    i = rng.choice([i for i, line in enumerate(lines) if "=" in line])
    key = lines[i].partition(" =")[0]
    changed = [f"{key} = {rng.choice(VALUES)}", "", f"{lines[i]}\n{lines[i]}", f"x{lines[i]}", f"{key}.{lines[i]}"]
    return "\n".join([*lines[:i], rng.choice(changed), *lines[i + 1 :]])


def test_a_hundred_malformed_scenarios_are_refused(refused: Callable[[list[str]], str], tmp_path: Path) -> None:
    rng, text, path = random.Random(1), load_scenario("table5").to_toml(), tmp_path / "scenario.toml"
    count = readable = 0
    while count < 100:
        by_entry = rng.random() < 0.7
        path.write_bytes(_wrong_entry(text.splitlines(), rng).encode() if by_entry else _damaged(text.encode(), rng))
        if refused(["solve", str(path), "--out", str(tmp_path / "out")]):
            count += 1
        else:
            readable += 1
    assert readable < count / 2


HOSTILE_TOML = {
    "nothing": b"",
    "garbage": bytes(range(256)) * 40,
    "UTF-16": "schema = 1".encode("utf-16"),
    "large": b"# \n" * 100_000,
    "nested arrays": b"a = " + b"[" * 40_000,
    "nested tables": b"a = " + b"{a=" * 30_000,
    "a key of many parts": b"a." * 40_000 + b"a = 1",
    "a table of many parts": b"[" + b"a." * 40_000 + b"a]",
    "parts on every line": b"".join(b"a." * 199 + b"k%d = 1\n" % i for i in range(200)),
    "deep but parsed": b"schema." + b"a." * 190 + b"a = 1",
    "arrays of tables": b"[[a]]\n" * 16_000,
    "one long key": b"a" * 90_000 + b" = 1",
    "one long text": b'name = "' + b"a" * 90_000 + b'"',
    "many quotes": b"a = '" + b"'" * 90_000,
    "many escapes": b'name = "' + b"\\u0041" * 15_000 + b'"',
    "control characters": b'name = "\x1b[2J\x07"',
    "a name that clears the screen": b'"\\u001b[2J" = 1',
    "a name that is a path": b'name = "../../etc/x"',
    "line ends": b"\r" * 1000,
    "a digit of many": b"schema = " + b"9" * 90_000,
    "a date": b"schema = 0000-00-00",
}


@pytest.mark.parametrize("case", HOSTILE_TOML)
def test_a_hostile_scenario_is_refused(case: str, refused: Callable[[list[str]], str], tmp_path: Path) -> None:
    (tmp_path / "scenario.toml").write_bytes(HOSTILE_TOML[case])
    line = refused(["solve", str(tmp_path / "scenario.toml"), "--out", str(tmp_path / "out")])
    assert line.strip().isprintable()
    assert 0 < len(line) < 1000


def _view(folder: Path) -> list[str]:
    return ["view", str(folder), "--html", str(folder.parent / "page.html")]


def _damaged_text(text: str, rng: random.Random) -> str:
    return _damaged(text.encode(), rng).decode("utf-8", "replace").replace("\0", "\1")  # HDF5 takes no NUL


@pytest.mark.parametrize(("attribute", "wanted"), [(None, 14), ("scenario", 25), (MODEL, 55)])
def test_a_hundred_damaged_results_are_refused(
    attribute: str | None,
    wanted: int,
    result: Path,
    refused: Callable[[list[str]], str],
    retext: Callable[..., None],
    tmp_path: Path,
) -> None:
    """In the file and in its texts a change of a digit can go unnoticed; only that."""
    rng, folder = random.Random(2), Path(shutil.copytree(result, tmp_path / "result"))
    file, count, readable = folder / "solution.nc", 0, 0
    raw = file.read_bytes()
    while count < wanted:
        file.write_bytes(raw if attribute else _damaged(raw, rng))
        if attribute:
            retext(folder, attribute, partial(_damaged_text, rng=rng))
        if refused(_view(folder)):
            count += 1
        else:
            readable += 1
    assert readable < 2 * count


ODD: list[Any] = [None, True, -1, 1e999, "text", "", [], [[]], {}, {"a": {"b": None}}, 10**400, [None], "\x1b[2J\n"]


def _set_record(file: h5py.File, text: str) -> None:
    file.attrs["record"] = text


def _places(tree: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    inner = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in inner:
        yield (*path, key)
        yield from _places(value, (*path, key))


def test_sixty_records_of_wrong_types_are_refused(
    result: Path, refused: Callable[[list[str]], str], rewritten: Callable[..., None], tmp_path: Path
) -> None:
    """Each has one entry of another type, at any depth; where the new value is as good as the old it is readable."""
    rng, folder = random.Random(3), Path(shutil.copytree(result, tmp_path / "result"))
    raw = (folder / "solution.nc").read_bytes()
    with h5py.File(folder / "solution.nc") as file:
        text = str(file.attrs["record"])
    places, count, readable = list(_places(json.loads(text))), 0, 0
    while count < 60:
        record = json.loads(text)
        *way, last = rng.choice(places)
        inner = record
        for key in way:
            inner = inner[key]
        inner[last] = rng.choice(ODD)
        (folder / "solution.nc").write_bytes(raw)
        rewritten(folder, partial(_set_record, text=json.dumps(record)))
        if refused(_view(folder)):
            count += 1
        else:
            readable += 1
    assert readable < count


def _replaced(name: str, make: Callable[[h5py.File], object]) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        del file[name]
        make(file)

    return change


def _filtered(file: h5py.File) -> None:
    """Make a variable that only a filter from a shared library could read."""
    plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plan.set_chunk((21, 13))
    plan.set_filter(32000, h5py.h5z.FLAG_OPTIONAL)
    h5py.h5d.create(file.id, b"human_q", h5py.h5t.NATIVE_DOUBLE, h5py.h5s.create_simple((21, 13)), plan)


def _virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout(shape=(21, 13), dtype=float)
    layout[:] = h5py.VirtualSource("other.nc", "human_q", shape=(21, 13))
    file.create_virtual_dataset("human_q", layout)


HUGE = (10**6, 10**6)
HOSTILE_NETCDF: dict[str, Callable[[h5py.File], object]] = {
    "a variable elsewhere": _replaced("human_q", lambda f: f.__setitem__("human_q", h5py.ExternalLink("o.nc", "/a"))),
    "a variable in a pipe": _replaced("human_q", lambda f: f.__setitem__("human_q", h5py.ExternalLink("pipe", "/a"))),
    "a variable by its path": _replaced("human_q", lambda f: f.__setitem__("human_q", h5py.SoftLink("/human_v"))),
    "a path to itself": _replaced("human_q", lambda f: f.__setitem__("human_q", h5py.SoftLink("/human_q"))),
    "a group": _replaced("human_q", lambda f: f.create_group("human_q").__setitem__("again", f["/"])),
    "numbers from any file": _replaced(
        "human_q", lambda f: f.create_dataset("human_q", (21, 13), float, external=[("/etc/passwd", 0, 2184)])
    ),
    "numbers of another file": _replaced("human_q", _virtual),
    "a filter": _replaced("human_q", _filtered),
    "a huge variable": _replaced("human_q", lambda f: f.create_dataset("human_q", HUGE, float, chunks=(64, 64))),
    "a huge variable more": lambda f: f.create_dataset("more", HUGE, float, chunks=(64, 64)),
    "packed zeros": _replaced("time", lambda f: f.create_dataset("time", (10**9,), float, compression="gzip")),
    "many knots": _replaced("time", lambda f: f.create_dataset("time", data=np.linspace(0.0, 2.0, 10**6))),
    "no knots": _replaced("time", lambda f: f.create_dataset("time", data=np.zeros(0))),
    "one number": _replaced("time", lambda f: f.create_dataset("time", data=1.0)),
    "texts": _replaced("time", lambda f: f.create_dataset("time", data=["a"] * 21)),
    "complex numbers": _replaced("time", lambda f: f.create_dataset("time", data=np.ones(21, complex))),
    "an enormous number": lambda f: f["human_q"].__setitem__((3, 4), 1e300),
    "another duration": lambda f: f["time"].__setitem__(slice(None), 2.0 * f["time"][:]),
    "a deep record": lambda f: f.attrs.__setitem__("record", "[" * 50_000),
    "endless iterations": lambda f: f.attrs.__setitem__("iterations", np.inf),
    "an empty attribute": lambda f: f.attrs.__setitem__("record", h5py.Empty("f")),
    "an attribute of bytes": lambda f: f.attrs.__setitem__("record", np.bytes_(b"\xff\xfe")),
    "a link for an attribute": lambda f: f.attrs.__setitem__("record", f["time"].ref),
    "much text": lambda f: [f.attrs.__setitem__(f"a{i}", 4_000_000 * "a") for i in range(6)],
    "a long scenario": lambda f: f.attrs.__setitem__("scenario", "# \n" * 100_000),
    "a scenario of many parts": lambda f: f.attrs.__setitem__("scenario", "a." * 40_000 + "a = 1"),
    "a nested scenario": lambda f: f.attrs.__setitem__("scenario", "a = " + "[" * 40_000),
    "scenarios in a row": lambda f: f.attrs.__setitem__("scenario", ["schema = 1", "schema = 1"]),
    "many attributes": lambda f: [f.attrs.__setitem__(f"a{i}", i) for i in range(1500)],
}


@pytest.mark.parametrize("case", HOSTILE_NETCDF)
def test_a_hostile_netcdf_is_refused(
    case: str, result: Path, refused: Callable[[list[str]], str], rewritten: Callable[..., None], tmp_path: Path
) -> None:
    folder = Path(shutil.copytree(result, tmp_path / "result"))
    os.mkfifo(folder / "pipe")
    rewritten(folder, HOSTILE_NETCDF[case], checksum=case != "a filter")
    assert refused(_view(folder)).startswith(f"liftopt: error: {folder / 'solution.nc'}: ")


@pytest.mark.parametrize("kind", ["a pipe", "a folder", "a device", "a link to itself", "a huge file"])
@pytest.mark.parametrize("name", ["solution.nc", "scenario.toml", "models/sawyer.urdf"])
def test_what_is_no_file_is_refused(
    name: str,
    kind: str,
    result: Path,
    refused: Callable[[list[str]], str],
    as_of_old: Callable[[Path], None],
    tmp_path: Path,
) -> None:
    """What stands beside solution.nc is read of results of earlier versions alone."""
    folder = Path(shutil.copytree(result, tmp_path / "result"))
    if name != "solution.nc":
        as_of_old(folder)
    path = folder / name
    path.unlink()
    if kind == "a pipe":
        os.mkfifo(path)
    elif kind == "a folder":
        path.mkdir()
    elif kind == "a device":
        path.symlink_to("/dev/zero")
    elif kind == "a link to itself":
        path.symlink_to(path.name)
    else:
        with path.open("wb") as file:
            file.truncate(10**12)
    assert refused(_view(folder))


def test_a_result_runs_no_module_that_stands_beside_it(
    result: Path, rewritten: Callable[..., None], tmp_path: Path
) -> None:
    """Whoever unpacks a stranger's result may stand in its folder; what another program wrote is read apart."""
    folder = Path(shutil.copytree(result, tmp_path / "result"))
    rewritten(folder, lambda file: file.attrs.__setitem__("record", "{}"), checksum=False)
    for name in ("numpy", "h5py", "json", "liftopt", "sitecustomize"):
        (folder / f"{name}.py").write_text("open('ran', 'w')")
    path = [p for p in sys.path if p]
    code = f"import sys; sys.path = {path!r}; from liftopt.commands.cli import main; sys.exit(main())"
    command = [sys.executable, "-I", "-c", code, "view", ".", "--html", "page.html"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert run.returncode == 2
    assert run.stderr.startswith("liftopt: error: solution.nc: is no whole result of liftopt")
    assert not (folder / "ran").exists()


def test_a_read_that_hangs_is_ended(
    result: Path, rewritten: Callable[..., None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from liftopt.errors import InputError
    from liftopt.storage import netcdf_file
    from liftopt.storage.reader import load_result

    folder = Path(shutil.copytree(result, tmp_path / "result"))
    rewritten(folder, lambda file: None, checksum=False)
    monkeypatch.setattr(netcdf_file, "READ_PATIENCE", 0.2)
    monkeypatch.setattr(netcdf_file, "READ", "import time; time.sleep(60)")
    with pytest.raises(InputError, match=r"it is damaged: reading it takes more than 0.2 s"):
        load_result(folder)
    monkeypatch.setattr(netcdf_file, "READ_PATIENCE", 60.0)
    monkeypatch.setattr(netcdf_file, "READ", "import os; os.abort()")
    with pytest.raises(InputError, match="it is damaged: the HDF5 library crashes on it"):
        load_result(folder)
