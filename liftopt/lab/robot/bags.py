"""Bags of ROS 1, of ROS 2, and MCAP, without ROS: written by the package ``rosbags``."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal, NamedTuple

from liftopt.lab.extra import check_extra
from liftopt.lab.robot.ros_messages import RosMessages

Kind = Literal["ros1", "ros2", "mcap"]
SUFFIX: dict[Kind, str] = {"ros1": ".bag", "ros2": "_ros2", "mcap": "_mcap"}  # of a file, of a folder, of a folder
# The newest that ROS 2 Humble and Iron read, and later ones too: from 9 on the offered QoS are a list, not a text.
METADATA_VERSION: Literal[8] = 8


class Record(NamedTuple):
    """One message in a bag: its topic, type, time of arrival [ns] and content."""

    topic: str
    kind: str
    stamp: int
    message: Any


def write_bag(path: Path, kind: Kind, messages: RosMessages, records: Iterable[Record]) -> Path:
    """Write a bag and return where it is: ``path`` with the suffix of its kind.

    A ROS 2 bag is a folder with metadata.yaml and one file, SQLite for ``"ros2"`` and MCAP for ``"mcap"``.

    Args:
        path: without suffix; there must be nothing.
        kind: of the bag.
        messages: that made the records, of the same generation of ROS.
        records: in order of their stamps.

    Raises:
        InputError: ``rosbags`` is not installed.
        OSError: it cannot be written.
    """
    path = path.with_name(path.name + SUFFIX[kind])
    with _writer(path, kind) as writer:
        connections: dict[str, Any] = {}
        for record in records:
            if record.topic not in connections:
                connections[record.topic] = writer.add_connection(record.topic, record.kind, typestore=messages.store)
            writer.write(connections[record.topic], record.stamp, messages.serialized(record.message, record.kind))
    return path


def _writer(path: Path, kind: Kind) -> Any:
    check_extra("rosbags", "write ROS bags")
    from rosbags import rosbag1, rosbag2

    if kind == "ros1":
        return rosbag1.Writer(path)
    storage = rosbag2.StoragePlugin.MCAP if kind == "mcap" else rosbag2.StoragePlugin.SQLITE3
    return rosbag2.Writer(path, version=METADATA_VERSION, storage_plugin=storage)
