"""liftopt: how a person and a robot lift an object together, predicted by optimal control."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("liftopt")
except PackageNotFoundError:  # a source tree that was never installed
    __version__ = "0+unknown"
