"""The seal on a file that liftopt wrote: the SHA-256 of all that stands before it, appended.

Loaders of shared libraries and HDF5 ignore what follows the end of the file they know. A seal tells whether a file is
whole; it says nothing of who wrote it.
"""

from __future__ import annotations

import hashlib

DIGEST_BYTES = 32


def sealed(content: bytes) -> bytes:
    """Return ``content`` with its seal."""
    return content + hashlib.sha256(content).digest()


def is_sealed(content: bytes) -> bool:
    """Whether ``content`` ends in its seal."""
    return hashlib.sha256(content[:-DIGEST_BYTES]).digest() == content[-DIGEST_BYTES:]
