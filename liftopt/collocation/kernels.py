"""The knot functions as fast kernels: compiled with the C compiler, cached between runs by content.

A kernel's key digests all that it is generated from, so a change of topology, of the generating code or of a library's
version makes another file. Files appear by renaming, whole or not at all, so processes that start at once on a cold
cache do not disturb each other. A file carries the digest of its own bytes and must belong to the user: what is
damaged or somebody else's is never loaded. Without a compiler, CasADi's virtual machine evaluates the same functions.
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
from importlib.metadata import version
from pathlib import Path
from typing import Any

from liftopt.collocation import dynamics
from liftopt.collocation.dynamics import KnotFunctions, Topology

# -O1: a higher level takes minutes and evaluates no faster.
FLAGS = ("-O1", "-fPIC", "-shared", "-fno-math-errno")
DIGEST_BYTES = 32
ROLES = ("value", "gradient", "jacobian", "curvature", "squares")
Builder = Callable[[Topology], KnotFunctions]
Say = Callable[[str], None]


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


def load_kernels(requests: Sequence[tuple[Builder, Topology]], say: Say | None = None) -> list[Kernel]:
    """Return a kernel for each (builder, topology), compiling those that the cache lacks.

    Args:
        requests: what to load; equal topologies share one kernel.
        say: called with a line of progress when there is something to wait for.
    """
    say = say or (lambda line: None)
    keys = [kernel_key(builder, topology) for builder, topology in requests]
    found: dict[str, Kernel] = {}
    folder = cache_folder()
    for key in dict.fromkeys(keys):
        if folder is not None and (kernel := _load(folder / f"{key}.so", key)) is not None:
            found[key] = kernel
    missing = {key: request for key, request in zip(keys, requests, strict=True) if key not in found}
    if missing:
        found.update(_build(missing, folder, say))
    return [found[key] for key in keys]


def cache_folder() -> Path | None:
    """Return the folder that keeps compiled kernels, made if need be; None where none can be had.

    ``LIFTOPT_CACHE`` names it, otherwise it is the user's cache folder. A folder that others own or can write to is
    not used, since code is loaded from it.
    """
    from platformdirs import user_cache_dir

    named = os.environ.get("LIFTOPT_CACHE")
    folder = Path(named) if named else Path(user_cache_dir("liftopt")) / "kernels"
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    except OSError:
        return None
    return folder if _is_ours(folder) else None


def find_compiler() -> list[str] | None:
    """Return the command of the C compiler: ``CC`` if set (empty: none), else the first of cc, gcc, clang found."""
    if "CC" in os.environ:
        command = shlex.split(os.environ["CC"])
        return command if command and shutil.which(command[0]) else None
    return next(([path] for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)


def kernel_key(builder: Builder, topology: Topology) -> str:
    """Return a digest of all that the functions of a topology are generated from."""
    digest = hashlib.sha256()
    for part in (builder.__name__, topology.signature(), platform.machine(), platform.system(), *FLAGS):
        digest.update(part.encode() + b"\0")
    for package in ("casadi", "pin"):
        digest.update(version(package).encode() + b"\0")
    for source in (dynamics.__file__, __file__):
        digest.update(Path(source).read_bytes())
    return digest.hexdigest()[:32]


def _build(missing: dict[str, tuple[Builder, Topology]], folder: Path | None, say: Say) -> dict[str, Kernel]:
    compiler = find_compiler()
    say("building the equations of motion")
    functions = {key: builder(topology) for key, (builder, topology) in missing.items()}
    interpreted = {key: _kernel([getattr(f, role) for role in ROLES], compiled=False) for key, f in functions.items()}
    if compiler is None:
        say("no C compiler found: CasADi's virtual machine evaluates the dynamics, several times slower")
        return interpreted
    kept = "once; kept for later runs" if folder is not None else "there is no private cache folder to keep it in"
    say(f"compiling the equations of motion ({kept})")
    kernels = dict(interpreted)
    with tempfile.TemporaryDirectory(prefix="liftopt-") as work:
        jobs = {key: _start_compiler(compiler, Path(work), key, f) for key, f in functions.items()}
        for key, process in jobs.items():
            _, errors = process.communicate()
            built = Path(work) / f"{key}.so"
            if process.returncode != 0 or not built.exists():
                say(f"the C compiler failed ({(errors or 'no message').strip().splitlines()[-1:]}): using the VM")
                continue
            # Without a folder to keep it the library is loaded from the work folder; it stays mapped when that goes.
            path = keep(built, folder)
            if kernel := _load(path, key):
                kernels[key] = kernel
            else:
                say("what the C compiler made cannot be loaded: using CasADi's virtual machine")
    return kernels


def _start_compiler(compiler: list[str], work: Path, key: str, functions: KnotFunctions) -> subprocess.Popen[str]:
    import casadi as ca

    generator = ca.CodeGenerator(f"kernel_{key}.c")
    for role in ROLES:
        source = getattr(functions, role)
        generator.add(ca.Function(_symbol(role, key), source.sx_in(), source.call(source.sx_in())))
    generator.generate(f"{work}{os.sep}")
    command = [*compiler, *FLAGS, str(work / f"kernel_{key}.c"), "-o", str(work / f"{key}.so"), "-lm"]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def _symbol(role: str, key: str) -> str:
    return f"{role}_{key[:12]}"


def keep(built: Path, folder: Path | None) -> Path:
    """Seal a library and move it to the cache folder, if there is one; return where it is."""
    _seal(built)
    return _publish(built, folder / built.name) if folder is not None else built


def _seal(path: Path) -> None:
    """Append the digest of the file's bytes, which a loader of shared libraries ignores, and make it private."""
    path.chmod(0o600)
    with path.open("ab") as file:
        file.write(hashlib.sha256(path.read_bytes()).digest())


def _publish(built: Path, target: Path) -> Path:
    """Copy beside the target and rename, so that the target is whole whenever it exists; fall back to ``built``."""
    try:
        with tempfile.TemporaryDirectory(dir=target.parent, prefix=".new-") as beside:
            copy = Path(beside) / target.name
            with copy.open("wb") as file:
                file.write(built.read_bytes())
                file.flush()
                os.fsync(file.fileno())
            copy.chmod(0o600)
            os.replace(copy, target)
    except OSError:
        return built
    return target


def _is_ours(path: Path) -> bool:
    if not hasattr(os, "getuid"):
        return True
    status = path.stat()
    return status.st_uid == os.getuid() and not status.st_mode & 0o022


def is_sealed(path: Path) -> bool:
    """Whether a library is the user's own and whole; raises OSError where it cannot be read."""
    content = path.read_bytes()
    return _is_ours(path) and hashlib.sha256(content[:-DIGEST_BYTES]).digest() == content[-DIGEST_BYTES:]


def _load(path: Path, key: str) -> Kernel | None:
    """Return the kernel of a sealed library, or None where it is missing, damaged or not the user's own."""
    import casadi as ca

    try:
        if not is_sealed(path):
            return None
        roles = [ca.external(_symbol(role, key), str(path)) for role in ROLES]
    except (OSError, RuntimeError):
        return None
    return _kernel(roles, compiled=True)


def _kernel(functions: Sequence[Any], compiled: bool) -> Kernel:
    value, gradient, jacobian, curvature, squares = functions
    return Kernel(value, gradient, jacobian, curvature, squares, compiled)
