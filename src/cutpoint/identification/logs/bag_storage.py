"""The messages in a file of a ROS 2 bag, still encoded: SQLite (.db3) or MCAP (.mcap)."""

import io
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple
from urllib.request import pathname2url

from cutpoint.identification.logs.table import LARGEST_FILE, optional

SCHEMA, CHANNEL, MESSAGE, CHUNK, DATA_END = 3, 4, 5, 6, 15
"""Kinds of MCAP records.  The numbers and the layouts below are from mcap.dev/spec, version 0."""

MESSAGE_ITSELF = 100
"""Bytes that a message takes in addition to its strings and its data."""

MAGIC = b"\x89MCAP0\r\n"


class Message(NamedTuple):
    """Topic, type (`sensor_msgs/msg/JointState`), time of reception, ns, and bytes (CDR)."""

    topic: str
    type: str
    received: int
    data: bytes


def stored_messages(path: Path) -> Iterator[Message]:
    """The messages of a .db3 or .mcap, in the file's order.

    Raises ValueError, EOFError or sqlite3.Error for another kind of file, CutpointError for a missing unpacker.
    """
    if path.suffix.lower() == ".db3":
        yield from _from_sqlite(path)
        return
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise ValueError("it does not begin like an MCAP file")
        yield from _Mcap().messages(file)


def _from_sqlite(path: Path) -> Iterator[Message]:
    with closing(sqlite3.connect(f"file:{pathname2url(str(path.resolve()))}?immutable=1", uri=True)) as base:
        base.execute("PRAGMA trusted_schema = OFF")
        # a view could run anything
        query = "SELECT COUNT(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages')"
        if base.execute(query).fetchone() != (2,):
            raise ValueError("it has no tables 'topics' and 'messages'")
        # as could a computed column
        query = "SELECT COUNT(*) FROM pragma_table_xinfo('topics') AS t, pragma_table_xinfo('messages') AS m"
        if base.execute(f"{query} WHERE t.hidden OR m.hidden").fetchone() != (0,):
            raise ValueError("its tables 'topics' and 'messages' have computed columns")
        left = LARGEST_FILE
        query = "SELECT name, type, timestamp, data FROM messages JOIN topics ON topics.id = topic_id"
        for topic, kind, received, data in base.execute(query):
            if not (isinstance(received, int) and isinstance(data, bytes)):
                raise ValueError("its messages are not bytes with a time stamp")
            message = Message(str(topic), str(kind), received, data)
            left -= len(message.topic) + len(message.type) + len(data) + MESSAGE_ITSELF
            if left < 0:
                raise ValueError(f"its messages exceed {LARGEST_FILE:,} bytes")
            yield message


class _Mcap:
    """Schemas and channels of the records read so far, and how much more may be unpacked."""

    def __init__(self) -> None:
        self.types: dict[int, str] = {}
        self.channels: dict[int, tuple[str, str]] = {}
        self.left = LARGEST_FILE

    def messages(self, file: BinaryIO, within_chunk: bool = False) -> Iterator[Message]:
        while kind := file.read(1):
            record = io.BytesIO(_exactly(file, _number(file, 8)))
            if kind[0] == SCHEMA:
                schema = _number(record, 2)
                self.types[schema] = _text(record)
            elif kind[0] == CHANNEL:
                key, schema = _number(record, 2), _number(record, 2)
                self.channels[key] = (_text(record), self.types.get(schema, ""))
            elif kind[0] == MESSAGE:
                yield self.message(record)
            elif kind[0] == CHUNK and not within_chunk:
                yield from self.messages(io.BytesIO(self.unpacked(record)), within_chunk=True)
            elif kind[0] == DATA_END:  # what follows is an index
                return

    def message(self, record: BinaryIO) -> Message:
        self.take(MESSAGE_ITSELF)
        topic, kind = self.channels[_number(record, 2)]
        _exactly(record, 4)  # its number
        received = _number(record, 8)
        _exactly(record, 8)  # when it was sent
        return Message(topic, kind, received, record.read())

    def unpacked(self, chunk: BinaryIO) -> bytes:
        """The records in a chunk, never more than announced, nor than the file's total limit."""
        _exactly(chunk, 16)  # its first and last time
        size = _number(chunk, 8)
        self.take(size)
        _exactly(chunk, 4)  # a checksum
        packing = _text(chunk)
        packed = _exactly(chunk, _number(chunk, 8))
        records = packed if packing == "" else _unpacker(packing).decompress(packed, size + 1)
        if len(records) != size:
            raise ValueError(f"a chunk does not unpack to its stated {size:,} bytes")
        return records

    def take(self, size: int) -> None:
        self.left -= size
        if self.left < 0:
            raise ValueError(f"its unpacked messages exceed {LARGEST_FILE:,} bytes")


def _unpacker(packing: str) -> Any:
    if packing == "lz4":
        return optional("lz4.frame", "an MCAP with this compression").LZ4FrameDecompressor()
    if packing != "zstd":
        raise ValueError(f"a chunk is compressed with {packing!r}: only lz4 and zstd are supported")
    try:
        return import_module("compression.zstd").ZstdDecompressor()  # Python 3.14 and later
    except ImportError:
        return optional("backports.zstd", "an MCAP with this compression").ZstdDecompressor()


def _exactly(file: BinaryIO, size: int) -> bytes:
    if size > LARGEST_FILE:
        raise ValueError(f"a record claims {size:,} bytes")
    found = file.read(size)
    if len(found) < size:
        raise EOFError("it ends in the middle of a record")
    return found


def _number(file: BinaryIO, size: int) -> int:
    return int.from_bytes(_exactly(file, size), "little")


def _text(file: BinaryIO) -> str:
    return _exactly(file, _number(file, 4)).decode()
