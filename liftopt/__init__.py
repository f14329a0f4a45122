"""liftopt: how a person and a robot lift an object together, predicted by optimal control.

``import liftopt as lo`` offers the names of ``__init__.pyi``; each is imported when it is used first. All else is
private and may change.
"""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

try:
    __version__ = version("liftopt")
except PackageNotFoundError:  # a source tree that was never installed
    __version__ = "0+unknown"
