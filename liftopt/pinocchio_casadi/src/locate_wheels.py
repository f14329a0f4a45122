"""Print, separated by semicolons, where the installed wheels keep the headers and the library to build against."""

from importlib.metadata import distribution
from pathlib import Path


def prefix(name: str) -> Path:
    """Return the directory of headers and libraries of a cmeel wheel."""
    return Path(str(distribution(name).locate_file("cmeel.prefix"))).resolve()


casadi = distribution("casadi")
casadi_directory = Path(str(casadi.locate_file("casadi"))).resolve()
# The versioned name is the soname; its number is CasADi's ABI version, not the wheel's version.
libraries = sorted(casadi_directory.glob("libcasadi.so.*")) or sorted(casadi_directory.glob("libcasadi.*dylib"))
if not libraries:
    raise SystemExit(f"casadi {casadi.version}: no libcasadi in {casadi_directory}")

print(
    casadi.version,
    casadi_directory,
    libraries[0],
    distribution("libpinocchio").version,
    prefix("libpinocchio"),
    prefix("cmeel-boost"),
    prefix("cmeel-eigen"),
    sep=";",
)
