"""The knot functions as fast kernels: compiled with the C compiler, kept between runs by content.

A kernel's key digests all that it is generated from, so a change of topology, of the generating code, of a library's
version or of the compiler's options makes another file; ``kernel_cache`` says where files are and which are trusted.
Processes that start at once on a cold cache do not disturb each other. Where a kernel is neither shipped nor kept and
there is no compiler, CasADi's virtual machine evaluates the same functions.
"""

from __future__ import annotations

import hashlib
import os
import platform
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from liftopt.collocation import dynamics
from liftopt.collocation.codegen.kernel_cache import cache_folder, find_library, keep
from liftopt.collocation.dynamics import KnotFunctions, Topology
from liftopt.types import Progress

# -O1: a higher level takes minutes and evaluates no faster.
FLAGS = ("-O1", "-fPIC", "-shared", "-fno-math-errno")
ROLES = ("value", "gradient", "jacobian", "curvature", "squares")
Builder = Callable[[Topology], KnotFunctions]


@dataclass(frozen=True)
class Kernel:
    """The functions of one topology, ready to be mapped over knots; see ``KnotFunctions``.

    Attributes:
        value, gradient, jacobian, curvature, squares: as there.
        compiled: False where CasADi's virtual machine evaluates them.
    """

    value: Any
    gradient: Any
    jacobian: Any
    curvature: Any
    squares: Any
    compiled: bool

    @property
    def n_y(self) -> int:
        """Size of the knot variables."""
        return int(self.value.size1_in(0))

    @property
    def n_p(self) -> int:
        """Size of the parameters."""
        return int(self.value.size1_in(1))

    @property
    def n_c(self) -> int:
        """Size of the outputs."""
        return int(self.value.size1_out(0))

    @property
    def n_squared(self) -> int:
        """Number of leading outputs that may enter the objective squared."""
        return int(self.squares.size1_in(1))


def load_kernels(requests: Sequence[tuple[Builder, Topology]], progress: Progress | None = None) -> list[Kernel]:
    """Return a kernel for each (builder, topology), compiling those that neither the package nor the cache has.

    Args:
        requests: what to load; equal topologies share one kernel.
        progress: called with a line of progress when there is something to wait for.
    """
    progress = progress or (lambda line: None)
    keys = [kernel_key(builder, topology) for builder, topology in requests]
    found: dict[str, Kernel] = {}
    for key in dict.fromkeys(keys):
        if (kernel := find_library(key, partial(_load, key))) is not None:
            found[key] = kernel
    missing = {key: request for key, request in zip(keys, requests, strict=True) if key not in found}
    if missing:
        found.update(_build(missing, cache_folder(), progress))
    return [found[key] for key in keys]


def find_compiler() -> list[str] | None:
    """Return the command of the C compiler: ``CC`` if set (empty: none), else the first of cc, gcc, clang found."""
    if "CC" in os.environ:
        command = shlex.split(os.environ["CC"])
        return command if command and shutil.which(command[0]) else None
    return next(([path] for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)


def baseline_flags() -> tuple[str, ...]:
    """Return the options for what every processor of this machine's kind runs, however the compiler is set up."""
    return {"x86_64": ("-march=x86-64",), "aarch64": ("-march=armv8-a",)}.get(platform.machine(), ())


def kernel_key(builder: Builder, topology: Topology) -> str:
    """Return a digest of all that the functions of a topology are generated from."""
    import casadi as ca
    import pinocchio as pin

    digest = hashlib.sha256()
    # CC may hold options too, and not all of them yield to ours.
    options = [part for part in shlex.split(os.environ.get("CC", ""))[1:] if part.startswith("-")]
    where = (platform.machine(), platform.system(), *FLAGS, *baseline_flags(), *options)
    for part in (builder.__name__, topology.signature(), *where, ca.CasadiMeta.version(), pin.printVersion()):
        digest.update(part.encode() + b"\0")
    for source in (dynamics.__file__, __file__):
        digest.update(Path(source).read_bytes())
    return digest.hexdigest()[:32]


def _build(missing: dict[str, tuple[Builder, Topology]], folder: Path | None, progress: Progress) -> dict[str, Kernel]:
    compiler = find_compiler()
    progress("building the equations of motion")
    functions = {key: builder(topology) for key, (builder, topology) in missing.items()}
    interpreted = {key: _kernel([getattr(f, role) for role in ROLES], compiled=False) for key, f in functions.items()}
    if compiler is None:
        progress("no C compiler found: CasADi's virtual machine evaluates the dynamics, several times slower")
        return interpreted
    kept = "once; kept for later runs" if folder is not None else "there is no private cache folder to keep it in"
    progress(f"compiling the equations of motion ({kept})")
    kernels = dict(interpreted)
    with tempfile.TemporaryDirectory(prefix="liftopt-") as work:
        jobs = {key: _start_compiler(compiler, Path(work), key, f) for key, f in functions.items()}
        for key, process in jobs.items():
            _, errors = process.communicate()
            built = Path(work) / f"{key}.so"
            if process.returncode != 0 or not built.exists():
                progress(f"the C compiler failed ({(errors or 'no message').strip().splitlines()[-1:]}): using the VM")
                continue
            if kernel := keep(built, folder, partial(_load, key)):
                kernels[key] = kernel
            else:
                progress("what the C compiler made cannot be loaded: using CasADi's virtual machine")
    return kernels


def _start_compiler(compiler: list[str], work: Path, key: str, functions: KnotFunctions) -> subprocess.Popen[str]:
    import casadi as ca

    generator = ca.CodeGenerator(f"kernel_{key}.c")
    for role in ROLES:
        source = getattr(functions, role)
        generator.add(ca.Function(_symbol(role, key), source.sx_in(), source.call(source.sx_in())))
    generator.generate(f"{work}{os.sep}")
    code, built = work / f"kernel_{key}.c", work / f"{key}.so"
    command = [*compiler, *FLAGS, *baseline_flags(), str(code), "-o", str(built), "-lm"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def _symbol(role: str, key: str) -> str:
    return f"{role}_{key[:12]}"


def _load(key: str, path: Path) -> Kernel | None:
    """Return the kernel of a library, or None where it is none of that key."""
    import casadi as ca

    try:
        roles = [ca.external(_symbol(role, key), str(path)) for role in ROLES]
    except RuntimeError:
        return None
    return _kernel(roles, compiled=True)


def _kernel(functions: Sequence[Any], compiled: bool) -> Kernel:
    value, gradient, jacobian, curvature, squares = functions
    return Kernel(value, gradient, jacobian, curvature, squares, compiled)
