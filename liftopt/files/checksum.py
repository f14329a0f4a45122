"""The checksum at the end of a file that liftopt wrote: the SHA-256 of all that stands before it.

Loaders of shared libraries and HDF5 ignore what follows the end of the file they know. A checksum tells whether a file
is whole; it says nothing of who wrote it.
"""

from __future__ import annotations

import hashlib

DIGEST_BYTES = 32


def with_checksum(content: bytes) -> bytes:
    """Return ``content`` with its checksum."""
    return content + hashlib.sha256(content).digest()


def has_checksum(content: bytes) -> bool:
    """Whether ``content`` ends in its checksum."""
    return hashlib.sha256(content[:-DIGEST_BYTES]).digest() == content[-DIGEST_BYTES:]
