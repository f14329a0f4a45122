"""The numbers and attributes of a NetCDF-4 file, from its bytes; run as a process of its own, from those on stdin.

A damaged HDF5 file can send the HDF5 library into an endless loop or to its end, which no caller could catch, and one
made on purpose can name other files, filters to be loaded from shared libraries, or arrays beyond any memory. Only
what is in the file itself, plain and of sensible size is read.
"""

from __future__ import annotations

import io
import json
import sys
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

LARGEST_ARRAY = 64_000_000  # bytes; the largest variable of a lift on 400 intervals has 42 kB
LARGEST_ATTRIBUTE = 5_000_000  # bytes or characters; the robot's model has 28 000
MOST_TEXT = 20_000_000  # characters of all attributes
MOST_NAMES = 1_000
MOST_MEMORY = 4_000_000_000  # bytes of addresses, for the process of its own
SCALAR_SIZE = 1


class Contents(NamedTuple):
    """What was read: arrays of numbers by name, attributes as numbers and text."""

    data: dict[str, npt.NDArray[np.float64]]
    attributes: dict[str, Any]


def contents(image: bytes) -> Contents:
    """Return what a NetCDF-4 file holds, given its bytes; variables of text and what is linked are left out.

    Raises:
        ValueError, OSError, KeyError, RuntimeError, TypeError: the file is damaged, or holds what a result does not.
    """
    import h5py

    with h5py.File(h5py.h5f.open_file_image(image)) as file:
        if max(len(file), len(file.attrs)) > MOST_NAMES:
            raise ValueError(f"more than {MOST_NAMES} names")
        names = [name for name in file if file.id.links.get_info(name.encode()).type == h5py.h5l.TYPE_HARD]
        found = {name: file[name] for name in names}
        data = {name: _array(name, item) for name, item in found.items() if _is_numbers(item)}
        return Contents(data, _attributes(file.attrs))


def _is_numbers(item: Any) -> bool:
    import h5py

    return isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu"


def _array(name: str, dataset: Any) -> npt.NDArray[np.float64]:
    import h5py

    plan = dataset.id.get_create_plist()
    known = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32}
    filters = {plan.get_filter(i)[0] for i in range(plan.get_nfilters())}
    if plan.get_layout() == h5py.h5d.VIRTUAL or plan.get_external_count():
        raise ValueError(f"{name} stands in other files")
    if filters - known:
        raise ValueError(f"{name} is packed by filters that results do not use: {sorted(filters - known)}")
    if dataset.nbytes > LARGEST_ARRAY:
        raise ValueError(f"{name} has shape {dataset.shape}, which is more than {LARGEST_ARRAY} bytes")
    return np.asarray(dataset[...], dtype=float)


def _attributes(given: Any) -> dict[str, Any]:
    found: dict[str, Any] = {}
    room = MOST_TEXT
    for name in given:
        found[name] = _attribute(given, name)
        room -= len(found[name]) if isinstance(found[name], str) else 0
        if room < 0:  # many names can stand for one text
            raise ValueError(f"attributes of more than {MOST_TEXT} characters")
    return found


def _attribute(attributes: Any, name: str) -> Any:
    size = attributes.get_id(name).get_storage_size()
    if size > LARGEST_ATTRIBUTE:
        raise ValueError(f"the attribute {name} has {size} bytes")
    value = np.asarray(attributes[name])
    if value.size != SCALAR_SIZE:
        return None  # none of ours
    value = value.reshape(())[()]
    if isinstance(value, bytes):
        value = value.decode("utf-8")
    if not isinstance(value, str):
        return value.item() if isinstance(value, np.number) else None
    if len(value) > LARGEST_ATTRIBUTE:
        raise ValueError(f"the attribute {name} has {len(value)} characters")
    return str(value)


def packed(found: Contents) -> bytes:
    """Return contents as the bytes that ``unpacked`` reads."""
    out, about = io.BytesIO(), {"attributes": found.attributes, "names": list(found.data)}
    arrays: dict[str, Any] = {f"array{i}": array for i, array in enumerate(found.data.values())}
    np.savez(out, about=json.dumps(about), **arrays)
    return out.getvalue()


def unpacked(raw: bytes) -> Contents:
    """Return the contents that ``packed`` wrote; no code can come of them."""
    with np.load(io.BytesIO(raw), allow_pickle=False) as arrays:
        about = json.loads(str(arrays["about"]))
        return Contents({name: arrays[f"array{i}"] for i, name in enumerate(about["names"])}, about["attributes"])


def _limit_memory() -> None:
    try:
        import resource
    except ImportError:  # not on this system
        return
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))


def main() -> None:
    """Read the bytes on stdin and write what they hold to stdout, or why that cannot be to stderr."""
    try:
        _limit_memory()
        sys.stdout.buffer.write(packed(contents(sys.stdin.buffer.read())))
    except Exception as error:  # whatever is wrong with the file
        print(" ".join(str(error).split()) or type(error).__name__, file=sys.stderr)
        sys.exit(1)
