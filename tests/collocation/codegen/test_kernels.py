"""Compiled, cached kernels: the uncompiled functions of the same topology are the oracle of their values."""

from __future__ import annotations

import os
import runpy
import shutil
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.codegen import kernel_cache, kernels
from liftopt.collocation.codegen.kernel_cache import cache_folder
from liftopt.collocation.codegen.kernels import ROLES, Kernel, find_compiler, load_kernels
from liftopt.collocation.dynamics import KnotFunctions, Topology, agent_functions
from liftopt.files.checksum import DIGEST_BYTES
from liftopt.types import Progress

needs_compiler = pytest.mark.skipif(find_compiler() is None, reason="no C compiler on this machine")


def tiny_topology() -> Topology:
    """Return a two-joint arm, which compiles in about a second."""
    model = pin.Model()
    first = model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "first")
    second = model.addJoint(first, pin.JointModelRY(), pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.5])), "second")
    for joint in (first, second):
        model.appendBodyToJoint(joint, pin.Inertia(1.0, np.array([0.0, 0.0, 0.2]), 0.1 * np.eye(3)), pin.SE3.Identity())
    tip = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.4]))
    model.addFrame(pin.Frame("tip", second, 0, tip, pin.FrameType.OP_FRAME))
    return Topology.of(model, ("tip",))


def load_tiny(progress: Progress | None = None) -> Kernel:
    return load_kernels([(agent_functions, tiny_topology())], progress)[0]


def assert_right(kernel: Kernel) -> None:
    """Compare every role with the uncompiled function at a random point."""
    topology, rng = tiny_topology(), np.random.default_rng(1)
    functions = agent_functions(topology)
    y, p, m = rng.normal(size=kernel.n_y), np.r_[1.3, topology.parameters], rng.normal(size=kernel.n_c)
    assert (kernel.n_y, kernel.n_p, kernel.n_c, kernel.n_squared) == (9, len(p), 6, 2)
    jacobian = functions.jacobian(y, p)
    arguments = {
        "value": (y, p),
        "gradient": (y, p, m),
        "jacobian": (y, p),
        "curvature": (y, p, m),
        "squares": (jacobian, m[:2]),
    }
    for role in ROLES:
        expected, actual = getattr(functions, role)(*arguments[role]), getattr(kernel, role)(*arguments[role])
        assert actual.sparsity() == expected.sparsity()
        np.testing.assert_allclose(ca.DM(actual).full(), ca.DM(expected).full(), rtol=1e-13, atol=1e-13)


@pytest.fixture(scope="session")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a cache that holds the tiny kernel."""
    folder = tmp_path_factory.mktemp("warm") / "cache"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LIFTOPT_CACHE", str(folder))
        assert load_tiny().compiled
    return folder


@pytest.fixture
def cache(tmp_path: Path, compiled: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a private copy of the warm cache, in use."""
    folder = tmp_path / "cache"
    shutil.copytree(compiled, folder)
    folder.chmod(0o700)
    monkeypatch.setenv("LIFTOPT_CACHE", str(folder))
    return folder


@pytest.fixture
def cold(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an empty cache, in use."""
    monkeypatch.setenv("LIFTOPT_CACHE", str(tmp_path / "cold"))
    return tmp_path / "cold"


def library(folder: Path) -> Path:
    (path,) = folder.iterdir()
    return path


def refuse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a use of the C compiler fail the test."""

    def start(*_: object, **__: object) -> None:
        pytest.fail("the compiler was started")

    monkeypatch.setattr(kernels.subprocess, "Popen", start)


@needs_compiler
def test_compiled_kernel_is_right(cache: Path) -> None:
    kernel = load_tiny()
    assert kernel.compiled
    assert_right(kernel)


@needs_compiler
def test_hit_builds_nothing(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither the builder nor the compiler runs, and there is nothing to say."""
    refuse(monkeypatch)

    def builder(topology: Topology) -> KnotFunctions:
        pytest.fail("the builder was called")

    builder.__name__ = agent_functions.__name__
    lines: list[str] = []
    (kernel,) = load_kernels([(builder, tiny_topology())], lines.append)
    assert kernel.compiled and not lines


@needs_compiler
def test_equal_topologies_share_one_kernel(cold: Path) -> None:
    one, two = load_kernels([(agent_functions, tiny_topology()), (agent_functions, tiny_topology())])
    assert one is two and len(list(cold.iterdir())) == 1


@needs_compiler
def test_cache_is_private_and_holds_nothing_but_the_kernel(cold: Path) -> None:
    assert load_tiny().compiled
    assert library(cold).suffix == ".so"
    assert stat.S_IMODE(cold.stat().st_mode) & 0o022 == 0 and stat.S_IMODE(library(cold).stat().st_mode) & 0o022 == 0


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-100])


def flip(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(bytes(content))


def empty(path: Path) -> None:
    path.write_bytes(b"")


def foreign(path: Path) -> None:
    path.write_bytes(b"not a library" * 100)


def without_checksum(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-DIGEST_BYTES])


@needs_compiler
@pytest.mark.parametrize("damage", [truncate, flip, empty, foreign, without_checksum])
def test_damaged_file_is_rebuilt_and_never_loaded(
    damage: Callable[[Path], None], cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = library(cache)
    damage(path)
    damaged, opened = path.read_bytes(), []
    external = ca.external

    def watched(name: str, file: str) -> object:
        opened.append(Path(file).read_bytes())
        return external(name, file)

    monkeypatch.setattr(ca, "external", watched)
    kernel = load_tiny()
    assert kernel.compiled and opened and damaged not in opened
    assert library(cache) == path and path.read_bytes() != damaged
    assert_right(kernel)


@needs_compiler
def test_whole_file_of_other_functions_is_rebuilt(cache: Path, tmp_path: Path) -> None:
    """A library whose digest is right but that lacks the symbols, as a collision would leave."""
    source, path = tmp_path / "other.c", library(cache)
    source.write_text("int other(void) { return 0; }\n")
    path.unlink()
    compiler = find_compiler()
    assert compiler is not None
    subprocess.run([*compiler, "-shared", "-fPIC", str(source), "-o", str(path)], check=True)
    path.chmod(0o600)
    kernel_cache._add_checksum(path)
    assert_right(load_tiny())


@needs_compiler
def test_file_that_others_can_write_is_not_loaded(cache: Path) -> None:
    path = library(cache)
    path.chmod(0o622)
    assert kernel_cache.find_library(path.stem, str) is None
    assert load_tiny().compiled
    assert stat.S_IMODE(path.stat().st_mode) & 0o022 == 0


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="no owners on this system")
def test_folder_that_others_can_write_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "shared"
    folder.mkdir()
    folder.chmod(0o777)
    monkeypatch.setenv("LIFTOPT_CACHE", str(folder))
    assert cache_folder() is None
    assert_right(load_tiny())
    assert not list(folder.iterdir())


def test_without_compiler_the_vm_gives_the_same_values_and_says_so(cold: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "")
    lines: list[str] = []
    kernel = load_tiny(lines.append)
    assert not kernel.compiled and any("virtual machine" in line for line in lines)
    assert_right(kernel)
    assert not list(cold.iterdir())


def test_failing_compiler_falls_back_and_says_so(cold: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "false")
    lines: list[str] = []
    kernel = load_tiny(lines.append)
    assert not kernel.compiled and any("failed" in line for line in lines)
    assert_right(kernel)
    assert not list(cold.iterdir())


def test_compiler_that_writes_nothing_falls_back(cold: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "true")
    assert not load_tiny().compiled


@needs_compiler
@pytest.mark.parametrize(
    "umask",
    [
        0o022,
        0o002,
    ],
    ids=["private", "group"],
)
def test_unusable_cache_still_compiles(umask: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file in the way of the folder; whatever the user's umask, compiled code of one's own is used."""
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("LIFTOPT_CACHE", str(tmp_path / "file"))
    assert cache_folder() is None
    before = os.umask(umask)
    try:
        kernel = load_tiny()
    finally:
        os.umask(before)
    assert_right(kernel)
    assert kernel.compiled
    assert (tmp_path / "file").read_text() == "in the way"


@needs_compiler
def test_full_disk_leaves_no_temporary_file(cold: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The kernel is loaded all the same."""

    def replace(*_: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr(kernels.os, "replace", replace)
    assert_right(load_tiny())
    assert not list(cold.iterdir())


@needs_compiler
def test_compiler_with_arguments_is_understood(cold: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """CC holds a command and its arguments by convention, such as ``ccache gcc``."""
    monkeypatch.setenv("CC", f"{(find_compiler() or [])[0]} -O0")
    assert load_tiny().compiled


@needs_compiler
def test_relative_cache_folder(compiled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(compiled, tmp_path / "cache")
    monkeypatch.chdir(tmp_path / "cache")
    monkeypatch.setenv("LIFTOPT_CACHE", ".")
    refuse(monkeypatch)
    assert load_tiny().compiled


@needs_compiler
def test_two_processes_on_one_cold_cache_end_well(tmp_path: Path) -> None:
    """Both have the right kernel, one file stays, and neither leaves a temporary file anywhere."""
    work = tmp_path / "tmp"
    work.mkdir()
    environment = {**os.environ, "LIFTOPT_CACHE": str(tmp_path / "cold"), "TMPDIR": str(work), "OMP_NUM_THREADS": "1"}
    environment["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    command = [sys.executable, __file__]
    running = [
        subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(2)
    ]
    ended = [process.communicate(timeout=120) for process in running]
    assert [process.returncode for process in running] == [0, 0], ended
    assert [out.strip() for out, _ in ended] == ["compiled", "compiled"]
    assert library(tmp_path / "cold").suffix == ".so"
    assert not list(work.iterdir())


def test_key_follows_the_options_of_the_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    """An option in CC may choose a processor; a wrapper in CC does not."""

    def key(compiler: str) -> str:
        monkeypatch.setenv("CC", compiler)
        return kernels.kernel_key(agent_functions, tiny_topology())

    assert key("gcc -mavx2") != key("gcc") == key("ccache gcc")


def test_key_follows_topology_and_builder(make_chain: Callable[..., pin.Model]) -> None:
    """Different code or structure: another file; equal ones: the same in another process, too."""
    topology = tiny_topology()
    here = kernels.kernel_key(agent_functions, topology)
    there = runpy.run_path(__file__)["tiny_topology"]()
    assert kernels.kernel_key(agent_functions, there) == here
    assert kernels.kernel_key(agent_functions, Topology.of(make_chain(0, ("RX", "RY")), ("tip",))) != here


if __name__ == "__main__":
    loaded = load_tiny()
    assert_right(loaded)
    print("compiled" if loaded.compiled else "interpreted")
