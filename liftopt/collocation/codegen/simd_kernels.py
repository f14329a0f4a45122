"""Knot functions for several knots at once: CasADi's generated C with a vector type in the place of ``double``.

Every knot runs the same instructions on other numbers, so one call serves as many knots as the processor's vectors
have lanes. Arguments and results are interleaved: entry j of lane l is at ``j * lanes + l``. The vector types are GCC's
and Clang's; another compiler refuses them, and then there are none. The code uses the instructions that are named to
the compiler and no other, and only a processor that has them all finds it.
"""

from __future__ import annotations

import ctypes
import hashlib
import re
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from liftopt.collocation.codegen.kernel_cache import cache_folder, find_library, keep
from liftopt.collocation.codegen.kernels import Builder, baseline_flags, find_compiler, kernel_key
from liftopt.collocation.dynamics import KnotFunctions, Topology
from liftopt.types import Progress

SYMBOLS = ("simd_value", "simd_derivatives", "simd_lanes")
# Scheduling takes most of the compiler's time and spills what it moves; -O1 evaluates half as fast.
# Looking for what is computed twice takes nearly half of the time that is left, and finds nothing that CasADi left.
# No fused multiplications: processors without them would round differently, and a search finds other optima then.
FLAGS = (
    "-O2",
    "-ffp-contract=off",
    "-fno-schedule-insns",
    "-fno-schedule-insns2",
    "-fno-tree-pre",
    "-fno-gcse",
    "-fno-code-hoisting",
    "-fno-tree-sink",
    "-fPIC",
    "-shared",
    "-fno-math-errno",
)
# Extensions of x86-64 that the code gains from, as both the kernel and the compiler call them.
EXTENSIONS = ("avx", "avx2", "fma", "avx512f", "avx512dq", "avx512vl")
# The sets of them that change the vectors' width, the widest first: a processor runs the first that it has whole.
PROCESSORS = (EXTENSIONS, EXTENSIONS[:3], ())
# What generated code may call beside arithmetic; a function that is missing here would not compile. The conditions on
# LANES are those that vectors.hpp tests at run time.
PRELUDE = """\
#include <math.h>
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#define LANES 8
#elif defined(__AVX2__) && defined(__FMA__)
#define LANES 4
#else
#define LANES 2
#endif
typedef double lane __attribute__((vector_size(8 * LANES), aligned(8 * LANES)));
typedef long long casadi_int;
#define LIFT(name, call) static inline lane name(lane x, lane y) \\
{ lane r; (void)y; for (int i = 0; i < LANES; ++i) r[i] = call; return r; }
/* Sine and cosine that round alike with vectors of any width, which no library's do: Cody and Waite's reduction by
multiples of pi / 2 in three parts, then Taylor's polynomials as fdlibm fits them on -pi/4 to pi/4. Angles are small. */
typedef long long places __attribute__((vector_size(8 * LANES), aligned(8 * LANES)));
#define EITHER(mask, one, other) (lane)(((places)(one) & (mask)) | ((places)(other) & ~(mask)))
static inline lane quarter_turns(lane x, places ahead) {
  const double whole = 6755399441055744.0; /* 1.5 * 2^52: the sum ends at the units */
  lane t = x * 0.63661977236758134308 + whole, k = t - whole;
  places n = (places)t + ahead;
  lane r = ((x - k * 1.57079632673412561417) - k * 6.07710050630396597660e-11) - k * 2.02226624879595063154e-21;
  lane z = r * r;
  lane s = r + r * z * (-1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04
    + z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
  lane c = 1.0 - 0.5 * z + z * z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * (
    2.48015872894767294178e-05 + z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09
    + z * -1.13596475577881948265e-11)))));
  lane v = EITHER((n & 1) == 0, s, c);
  return (lane)((places)v ^ ((n & 2) << 62));
}
#define lane_sin(x, y) quarter_turns(x, (places){0})
#define lane_cos(x, y) quarter_turns(x, (places){0} + 1)
LIFT(lane_sqrt, sqrt(x[i]))
LIFT(lane_fabs, fabs(x[i]))
LIFT(lane_fmax, fmax(x[i], y[i]))
LIFT(lane_fmin, fmin(x[i], y[i]))
static inline lane lane_sq(lane x) { return x * x; }
#define ALL(value) ((lane){0} + (value))
"""
HEAD = "(const lane** arg, lane** res, casadi_int* iw, double* w, int mem)"
UNARY, BINARY = ("sin", "cos", "sqrt", "fabs"), ("casadi_fmax", "casadi_fmin")


@dataclass(frozen=True)
class SimdKernel:
    """Machine code for several knots of one topology, with CasADi's calling convention; see ``lanes_source``.

    Attributes:
        library: keeps the code loaded.
        lanes: number of knots a call.
        value, derivatives: addresses of the functions.
    """

    library: ctypes.CDLL
    lanes: int
    value: int
    derivatives: int


def load_simd_kernels(
    requests: Sequence[tuple[Builder, Topology]],
    progress: Progress | None = None,
    extensions: Sequence[str] | None = None,
) -> list[SimdKernel] | None:
    """Return a wide kernel for each (builder, topology), or None where one cannot be made.

    Those that neither the package nor the cache has are compiled.

    Args:
        requests: what to load; equal topologies share one kernel.
        progress: called with a line of progress when there is something to wait for.
        extensions: of the processor that is to run them, one of ``PROCESSORS``; None is this one.
    """
    progress = progress or (lambda line: None)
    options = tuple(f"-m{name}" for name in (_extensions() if extensions is None else extensions))
    keys = [_key(builder, topology, options) for builder, topology in requests]
    found: dict[str, SimdKernel] = {}
    for key in dict.fromkeys(keys):
        if (kernel := find_library(key, _load)) is not None:
            found[key] = kernel
    missing = {key: request for key, request in zip(keys, requests, strict=True) if key not in found}
    if missing:
        found.update(_compile(missing, options, cache_folder(), progress))
    return [found[key] for key in keys] if all(key in found for key in keys) else None


def _key(builder: Builder, topology: Topology, options: tuple[str, ...]) -> str:
    digest = hashlib.sha256(kernel_key(builder, topology).encode())
    digest.update(repr((FLAGS, options)).encode())
    digest.update(Path(__file__).read_bytes())
    return digest.hexdigest()[:32]


def _extensions() -> tuple[str, ...]:
    """Return the first of ``PROCESSORS`` that this processor and system have whole, of ``EXTENSIONS`` at most."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return ()
    has = {*next((line for line in lines if line.startswith("flags")), "").split()}.intersection(EXTENSIONS)
    return next(extensions for extensions in PROCESSORS if has.issuperset(extensions))


def _compile(
    missing: Mapping[str, tuple[Builder, Topology]], options: Sequence[str], folder: Path | None, progress: Progress
) -> dict[str, SimdKernel]:
    compiler = find_compiler()
    if compiler is None:
        return {}
    progress("compiling the equations of motion for several knots at once (once; kept for later runs)")
    found = {}
    with tempfile.TemporaryDirectory(prefix="liftopt-") as work:
        jobs = {}
        for key, (builder, topology) in missing.items():
            source, built = Path(work) / f"{key}.c", Path(work) / f"{key}.so"
            source.write_text(lanes_source(builder(topology)))
            command = [*compiler, *FLAGS, *baseline_flags(), *options, str(source), "-o", str(built), "-lm"]
            silent = subprocess.DEVNULL
            jobs[key] = built, subprocess.Popen(command, stdout=silent, stderr=silent)
        for key, (built, process) in jobs.items():
            if process.wait() == 0 and built.exists() and (kernel := keep(built, folder, _load)):
                found[key] = kernel
            else:
                progress("the C compiler cannot make code for several knots at once")
    return found


def _load(path: Path) -> SimdKernel | None:
    try:
        library = ctypes.CDLL(str(path))
        lanes = ctypes.c_int.in_dll(library, "simd_lanes").value
        value, derivatives = (ctypes.cast(library[name], ctypes.c_void_p).value or 0 for name in SYMBOLS[:2])
    except (OSError, AttributeError, ValueError):
        return None
    return SimdKernel(library, lanes, value, derivatives)


def lanes_source(functions: KnotFunctions) -> str:
    """Return C source of a topology's functions on lanes.

    ``simd_value`` is (y, p) -> c; ``simd_derivatives`` is (y, p, m) -> (dc/dy, upper triangle of ``sum m_i c_i''``),
    which share most of their work. ``simd_lanes`` is the number of lanes.
    """
    import casadi as ca

    arguments = functions.curvature.sx_in()
    derivatives = ca.cse([functions.jacobian(*arguments[:2]), functions.curvature(*arguments)])
    bodies = (_body(functions.value), _body(ca.Function("derivatives", arguments, derivatives)))
    value, derivative, lanes = SYMBOLS
    source = f"{PRELUDE}\nconst int {lanes} = LANES;\n"
    return source + "".join(f"int {n}{HEAD} {{\n{b}\n}}\n" for n, b in zip((value, derivative), bodies, strict=True))


def _body(function: Any) -> str:
    import casadi as ca

    inputs = function.sx_in()
    generator = ca.CodeGenerator("lanes.c")
    generator.add(ca.Function("f", inputs, function.call(inputs)))
    found = re.search(r"^static int casadi_f0\([^)]*\) \{\n(.*?)^\}", generator.dump(), re.MULTILINE | re.DOTALL)
    if found is None:
        raise RuntimeError("CasADi generated code of an unknown form")
    body = found.group(1).replace("casadi_real ", "lane ")
    body = re.sub(r"arg\[(\d+)\]\? (arg\[\1\]\[\d+\]) : 0;", r"\2;", body)
    body = re.sub(r"=(-?[0-9.][0-9.e+-]*);", r"=ALL(\1);", body)
    body = body.replace("casadi_sq(", "lane_sq(")
    for name in UNARY:
        body = re.sub(rf"(?<![a-z_]){name}\((a\d+)\)", rf"lane_{name}(\1, \1)", body)
    for name in BINARY:
        body = body.replace(f"{name}(", f"lane_{name.removeprefix('casadi_')}(")
    return body.rstrip()
