"""Kernels for several knots a call: the uncompiled functions of one knot are the oracle, lane by lane."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from liftopt.collocation.codegen import simd_kernels as lanes
from liftopt.collocation.codegen.kernels import find_compiler
from liftopt.collocation.codegen.simd_kernels import SimdKernel, load_simd_kernels
from liftopt.collocation.dynamics import KnotFunctions, Topology, agent_functions, object_functions

Built = dict[str, tuple[pin.Model, Topology, KnotFunctions]]
CALL = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.POINTER(ctypes.c_void_p), ctypes.POINTER(ctypes.c_void_p), ctypes.c_void_p, ctypes.c_void_p,
    ctypes.c_int,
)  # fmt: skip


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("kernels")
    folder.chmod(0o700)
    return folder


@pytest.fixture
def kernels(cache: Path, knot_functions: Built, monkeypatch: pytest.MonkeyPatch) -> list[SimdKernel]:
    """Return those of a random arm of four joints and of a box with three grasps."""
    if find_compiler() is None:
        pytest.skip("no C compiler")
    monkeypatch.setenv("LIFTOPT_CACHE", str(cache))
    loaded = load_simd_kernels(
        [(agent_functions, knot_functions["arm"][1]), (object_functions, knot_functions["box"][1])]
    )
    assert loaded is not None
    return loaded


def aligned(size: int) -> np.ndarray:
    """Return zeros that start at a multiple of 64 bytes, as vector loads need them."""
    room = np.zeros(size + 8)
    first = -room.ctypes.data % 64 // 8
    return room[first : first + size]


def call(address: int, arguments: list[np.ndarray], sizes: list[int], lanes: int) -> list[np.ndarray]:
    """Call a SIMD function on arguments (lanes, n) and return results (lanes, n)."""
    flat = [aligned(a.size) for a in arguments]
    for room, argument in zip(flat, arguments, strict=True):
        room[:] = argument.T.ravel()
    results = [aligned(n * lanes) for n in sizes]
    arg, res = ((ctypes.c_void_p * len(rooms))(*(r.ctypes.data for r in rooms)) for rooms in (flat, results))
    assert CALL(address)(arg, res, None, None, 0) == 0
    return [r.reshape(-1, lanes).T for r in results]


@pytest.mark.parametrize(("index", "name"), [(0, "arm"), (1, "box")])
def test_every_lane_is_the_function_of_one_knot(
    kernels: list[SimdKernel], knot_functions: Built, rng: np.random.Generator, index: int, name: str
) -> None:
    kernel, (_, topology, functions) = kernels[index], knot_functions[name]
    lanes, p = kernel.lanes, np.concatenate([[1.7], topology.parameters])
    y = rng.normal(size=(lanes, functions.value.size1_in(0)))
    m = rng.normal(size=(lanes, functions.value.size1_out(0)))
    shared = np.tile(p, (lanes, 1))
    (value,) = call(kernel.value, [y, shared], [m.shape[1]], lanes)
    sizes = [functions.jacobian.nnz_out(0), functions.curvature.nnz_out(0)]
    slopes, curvatures = call(kernel.derivatives, [y, shared, m], sizes, lanes)
    assert lanes in (2, 4, 8)
    for lane in range(lanes):
        at, by = y[lane], m[lane]
        for got, expected in (
            (value[lane], functions.value(at, p)),
            (slopes[lane], functions.jacobian(at, p)),
            (curvatures[lane], functions.curvature(at, p, by)),
        ):
            reference = np.array(expected.nonzeros())
            np.testing.assert_allclose(got, reference, rtol=0, atol=1e-12 * (1.0 + np.abs(reference).max()))


def test_another_processor_does_not_find_them(
    kernels: list[SimdKernel], knot_functions: Built, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a compiler there it has none, rather than code that it cannot run; none was compiled for it before."""
    monkeypatch.setattr(lanes, "EXTENSIONS", ())
    monkeypatch.setenv("CC", "")
    assert load_simd_kernels([(object_functions, knot_functions["box"][1])]) is None


@pytest.mark.parametrize("extensions", [(), ("avx", "avx2", "fma")], ids=["baseline", "avx2"])
def test_vectors_of_any_width_give_the_same_bits(
    kernels: list[SimdKernel],
    knot_functions: Built,
    rng: np.random.Generator,
    cache: Path,
    extensions: tuple[str, ...],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The kernel of this processor is the oracle, knot by knot."""
    _, topology, functions = knot_functions["box"]
    monkeypatch.setattr(lanes, "EXTENSIONS", extensions)
    if len(lanes._extensions()) < len(extensions):
        pytest.skip("this processor has no such vectors")
    other = load_simd_kernels([(object_functions, topology)])
    assert other is not None
    y = rng.normal(size=(8, functions.value.size1_in(0)))
    m = rng.normal(size=(8, functions.value.size1_out(0)))
    p = np.tile(np.concatenate([[1.7], topology.parameters]), (8, 1))
    sizes = [functions.jacobian.nnz_out(0), functions.curvature.nnz_out(0)]

    def evaluated(kernel: SimdKernel) -> list[bytes]:
        parts = [
            [*call(kernel.value, [y[k], p[k]], [m.shape[1]], kernel.lanes),
             *call(kernel.derivatives, [y[k], p[k], m[k]], sizes, kernel.lanes)]
            for k in np.split(np.arange(8), 8 // kernel.lanes)
        ]  # fmt: skip
        return [np.ascontiguousarray(np.vstack(part)).tobytes() for part in zip(*parts, strict=True)]

    assert evaluated(other[0]) == evaluated(kernels[1])


def test_they_are_compiled_once(kernels: list[SimdKernel], knot_functions: Built, cache: Path) -> None:
    files = {f.name: f.stat().st_ino for f in cache.iterdir()}
    lines: list[str] = []
    assert load_simd_kernels([(agent_functions, knot_functions["arm"][1])], lines.append) is not None
    assert not lines and {f.name: f.stat().st_ino for f in cache.iterdir()} == files


def test_without_a_compiler_there_are_none(
    knot_functions: Built, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "")
    monkeypatch.setenv("LIFTOPT_CACHE", str(tmp_path))
    assert load_simd_kernels([(agent_functions, knot_functions["arm"][1])]) is None


def test_a_damaged_file_is_compiled_anew(kernels: list[SimdKernel], knot_functions: Built, cache: Path) -> None:
    """The last of those that share a cache: after it the arm would take the compiler's seconds once more."""
    for file in cache.iterdir():
        content = bytearray(file.read_bytes())
        content[len(content) // 2] ^= 0xFF
        file.unlink()
        file.write_bytes(bytes(content))
        file.chmod(0o600)
    lines: list[str] = []
    assert load_simd_kernels([(object_functions, knot_functions["box"][1])], lines.append) is not None
    assert any("compiling" in line for line in lines)


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("flags\t\t: fpu sse2 avx avx2 fma abm", ("avx", "avx2", "fma")),
        ("flags\t\t: fpu sse2 avx", ()),
        ("flags\t\t: fpu avx512fp16 avx512_bf16", ()),
        ("Features\t: fp asimd", ()),
    ],
)
def test_a_processor_gets_the_widest_vectors_that_it_has_whole(
    line: str, expected: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Processors as Linux describes them, with extensions whose names begin like ours."""
    monkeypatch.setattr(lanes.Path, "read_text", lambda path: f"processor\t: 0\n{line}\n")
    assert lanes._extensions() == expected
