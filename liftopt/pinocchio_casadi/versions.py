"""The extension inlines headers of CasADi and Pinocchio: only their very versions may meet it at run time."""

from __future__ import annotations

from .extension import REINSTALL


def require_same_version(package: str, installed: str, built_against: str) -> None:
    """Raise ImportError, naming the fix, unless the installed version is the one that was built against."""
    if installed != built_against:
        raise ImportError(
            f"pinocchio.casadi was built against {package} {built_against}, but {installed} is installed; "
            f"run `pip install {package}=={built_against}`, or {REINSTALL}"
        )
