"""The readers of the ecosystem, each by its own library, and the CSV of the same run to compare with."""

import csv
import math
import struct
from pathlib import Path
from typing import Any

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from wpiutil.log import DataLogReader

Messages = dict[str, list[tuple[int, Any]]]


def by_mcap(path: Path) -> Messages:
    """Messages by topic, with their times in ns: the reference library of the format, CDR by its support for ROS 2."""
    messages: Messages = {}
    with path.open("rb") as file:
        for decoded in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            of_topic = messages.setdefault(decoded.channel.topic, [])
            of_topic.append((decoded.message.log_time, decoded.decoded_message))
    return messages


def by_rosbags(path: Path) -> Messages:
    """The same by a library that shares nothing with it."""
    messages: Messages = {}
    with AnyReader([path]) as reader:
        for connection, time, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            messages.setdefault(connection.topic, []).append((time, message))
    return messages


def by_wpilib(path: Path) -> tuple[dict[str, str], dict[str, list[tuple[int, Any]]]]:
    """Types of entries, and their values with times in us."""
    kinds: dict[str, str] = {}
    names: dict[int, str] = {}
    values: dict[str, list[tuple[int, Any]]] = {}
    reader = DataLogReader(str(path))
    assert reader.isValid() and reader.getVersion() == 0x0100
    for record in reader:
        if record.isStart():
            start = record.getStartData()
            names[start.entry], kinds[start.name] = start.name, start.type
            continue
        name = names[record.getEntry()]
        values.setdefault(name, []).append((record.getTimestamp(), decoded(kinds[name], record)))
    return kinds, values


def decoded(kind: str, record: Any) -> Any:
    """By the reader's own methods; structs by the layout that their schema gives."""
    simple = {
        "double": record.getDouble,
        "float": record.getFloat,
        "int64": record.getInteger,
        "boolean": record.getBoolean,
        "string": record.getString,
        "double[]": record.getDoubleArray,
        "string[]": record.getStringArray,
    }
    if kind in simple:
        return simple[kind]()
    raw = bytes(record.getRaw())
    if kind.startswith("struct:Pose2d"):
        return list(struct.iter_unpack("<3d", raw))
    return raw.decode()


class Table:
    """A CSV file: names, and rows of text."""

    def __init__(self, path: Path) -> None:
        with path.open() as file:
            self.names, *self.rows = csv.reader(file)

    def column(self, name: str) -> list[str]:
        index = self.names.index(name)
        return [row[index] for row in self.rows]


def same(text: str, value: Any, float_format: str = "<d") -> bool:
    """Whether a field of a log is, to the last bit, what stands in a file: its numbers read back as themselves."""
    if isinstance(value, str):
        return text == value
    if isinstance(value, bool):
        return text == str(int(value))
    if isinstance(value, int):
        return int(text) == value
    expected = float(text) if text else math.nan
    bits = [struct.pack(float_format, number) for number in (expected, value)]
    return bits[0] == bits[1] or (math.isnan(expected) and math.isnan(value))
