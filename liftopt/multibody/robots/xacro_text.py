"""A xacro file written out as the URDF that it stands for, by the package ``xacro``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from liftopt.errors import NO_VALUE, InputError
from liftopt.multibody.robots.package_files import package_folders

INSTALL = 'pip install "liftopt[robots]"'


def expanded(path: Path, arguments: Mapping[str, str]) -> str:
    """Return the URDF of a xacro file. xacro evaluates the expressions in it: expand only files that you trust.

    Args:
        path: of the file.
        arguments: values of its ``xacro:arg``.

    Raises:
        InputError: the package is not installed, or it cannot expand the file; it says why.
    """
    try:
        import xacro
    except ImportError:
        raise InputError(str(path), NO_VALUE, f"is a xacro file; the package xacro expands it: {INSTALL}") from None
    with _packages_found(path):
        try:
            document = xacro.process_file(str(path), mappings=dict(arguments))
        except (Exception, SystemExit) as error:  # of many kinds: what the file's own expressions raise
            told = " ".join(str(error).split()) or type(error).__name__
            raise InputError(str(path), NO_VALUE, f"xacro cannot expand it: {told}") from None
    return str(document.documentElement.toxml())


@contextmanager
def _packages_found(path: Path) -> Iterator[None]:
    """Let ``$(find NAME)`` find packages by our rule: xacro's own asks an installation of ROS 2."""
    from xacro import substitution_args

    def find(package: str) -> str:
        folder = next(package_folders(package, path), None)
        if folder is None:
            raise ValueError(f"package {package!r} is not above the file, nor in ROS_PACKAGE_PATH")
        return str(folder)

    own, substitution_args._eval_find = substitution_args._eval_find, find
    own_in_expressions = substitution_args._eval_dict["find"]
    substitution_args._eval_dict["find"] = find
    try:
        yield
    finally:
        substitution_args._eval_find = own
        substitution_args._eval_dict["find"] = own_in_expressions
