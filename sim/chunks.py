"""The messages of one topic in an MCAP file, from the first on or from any time back, and nothing else unpacked.

Takes: a file, a topic, and for the way back a time. Gives: log times [ns] and the bytes of the messages. Leaves alone:
what is in them, and what a fault means to the reader (`BROKEN` has what is raised where the file cannot be read).

The general reader of the mcap package builds an object of every record; a question about one tick of a long run needs
few of them. Heads of records are looked at as they stand (opcode, length), only messages of the topic are taken out,
and on the way back the chunk index at the end of the file says which chunks there are. Checksums are checked.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import zstandard
from mcap.exceptions import McapError
from mcap.stream_reader import CRCValidationError

MAGIC = b"\x89MCAP0\r\n"
BROKEN = (
    McapError,
    CRCValidationError,
    struct.error,
    zstandard.ZstdError,
    EOFError,
    ValueError,
    MemoryError,
    OverflowError,
)

FOOTER, CHANNEL, MESSAGE, CHUNK, CHUNK_INDEX, DATA_END = 0x02, 0x04, 0x05, 0x06, 0x08, 0x0F
HEAD = struct.Struct("<BQ")
"""Opcode and length of a record."""
TAKEN = struct.Struct("<HIQ")
"""Channel, sequence and log time of a message; its time of publishing follows, then the data."""
DATA = 22
"""Bytes of a message before its data."""
PLACE = struct.Struct("<QQQQ")
"""First and last log time, offset and length of a chunk."""
CHUNK_HEAD = struct.Struct("<QQQII")
"""First and last log time, size and checksum of what is packed, length of the compression's name."""
FOOT = struct.Struct("<BQQQI")
"""Opcode and length of the footer, where the summary and its offsets begin, checksum of both."""
END = FOOT.size + len(MAGIC)
"""Bytes of the footer with all that follows it."""

Found = tuple[int, bytes]
"""Log time [ns] and data of a message."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where a chunk lies: offset of its record's head, bytes of the whole record, first log time [ns] in it."""

    offset: int
    length: int
    start: int


# --- records --------------------------------------------------------------------------------------


def _text(data: bytes, at: int) -> tuple[str, int]:
    """A string with its length before it, and where it ends."""
    (length,) = struct.unpack_from("<I", data, at)
    end = at + 4 + length
    if end > len(data):
        raise EOFError("a name goes beyond its record")
    return data[at + 4 : end].decode(), end


def _unpacked(chunk: bytes, at: int = 0) -> bytes:
    """The records in a chunk whose body begins at `at`."""
    _, _, size, checksum, named = CHUNK_HEAD.unpack_from(chunk, at)
    compression = chunk[at + CHUNK_HEAD.size : at + CHUNK_HEAD.size + named]
    at += CHUNK_HEAD.size + named
    (length,) = struct.unpack_from("<Q", chunk, at)
    packed = memoryview(chunk)[at + 8 : at + 8 + length]
    if len(packed) != length:
        raise EOFError("a chunk goes beyond its record")
    records = _decompress(bytes(compression), packed, size)
    if checksum and zlib.crc32(records) != checksum:
        raise ValueError("the checksum of a chunk is wrong")
    return records


_zstd: Callable[..., bytes] = zstandard.ZstdDecompressor().decompress


def _decompress(compression: bytes, packed: memoryview, size: int) -> bytes:
    match compression:
        case b"zstd":
            return _zstd(packed, size)
        case b"":
            return bytes(packed)
        case _:
            raise ValueError(f"a chunk is packed by {compression.decode(errors='replace')}, not by zstd")


@dataclass(slots=True)
class _Topic:
    """Finds the messages of a topic; channels: those that are known to be of it."""

    name: str
    channels: set[int]

    def channel(self, data: bytes, at: int) -> None:
        """A channel is of the topic or not."""
        (number,) = struct.unpack_from("<H", data, at)
        (self.channels.add if _text(data, at + 4)[0] == self.name else self.channels.discard)(number)

    def found(self, records: bytes) -> list[Found]:
        """The messages in the records of a chunk."""
        at, end, channels, head, taken = 0, len(records), self.channels, HEAD.unpack_from, TAKEN.unpack_from
        messages: list[Found] = []
        while at < end:
            opcode, length = head(records, at)
            at += 9
            if opcode == MESSAGE:
                number, _, time = taken(records, at)
                if number in channels:
                    messages.append((time, records[at + DATA : at + length]))
            elif opcode == CHANNEL:
                self.channel(records, at)
            at += length
        if at != end:
            raise EOFError("a record goes beyond its chunk")
        return messages


# --- from the first on ----------------------------------------------------------------------------


@dataclass(slots=True)
class _Reader:
    """Reads records one after the other; checksum: of all bytes so far."""

    stream: BinaryIO
    left: int
    checksum: int = 0

    def take(self, length: int) -> bytes:
        """The next bytes."""
        if length > self.left:
            raise EOFError("the file ends within a record")
        data = self.stream.read(length)
        if len(data) != length:
            raise EOFError("the file ends within a record")
        self.left -= length
        return data

    def records(self) -> Iterator[tuple[int, bytes]]:
        """Opcode and body of each record, to the footer."""
        self.checksum = zlib.crc32(self.take(len(MAGIC)))
        opcode = 0
        while opcode != FOOTER:
            head = self.take(HEAD.size)
            opcode, length = HEAD.unpack(head)
            body = self.take(length)
            if opcode == DATA_END and body[:4] not in (bytes(4), struct.pack("<I", self.checksum)):
                raise ValueError("the checksum of the data is wrong")
            self.checksum = zlib.crc32(body, zlib.crc32(head, self.checksum))
            yield opcode, body
        if self.take(len(MAGIC)) != MAGIC:
            raise ValueError("the end is wrong")


def messages(path: Path, topic: str) -> Iterator[Found]:
    """The messages of a topic in file order; raises one of `BROKEN` where the file cannot be read further."""
    found = _Topic(topic, set())
    with path.open("rb", buffering=1 << 18) as stream:
        for opcode, body in _Reader(stream, path.stat().st_size).records():
            match opcode:
                case 0x06:
                    yield from found.found(_unpacked(body))
                case 0x04:
                    found.channel(body, 0)
                case 0x05 if TAKEN.unpack_from(body)[0] in found.channels:
                    yield TAKEN.unpack_from(body)[2], body[DATA:]


# --- back from a time -----------------------------------------------------------------------------


def _summary(stream: BinaryIO, size: int) -> bytes:
    """The records between the data and the footer; empty where there are none."""
    if size < END:
        raise EOFError("the file ends before its footer")
    stream.seek(size - END)
    footer = stream.read(END)
    opcode, _, start, _, checksum = FOOT.unpack_from(footer)
    if opcode != FOOTER or start > size - END:
        raise ValueError("the footer is wrong")
    if start == 0:
        return b""
    stream.seek(start)
    summary = stream.read(size - END - start)
    if checksum and zlib.crc32(footer[: FOOT.size - 4], zlib.crc32(summary)) != checksum:
        raise ValueError("the checksum of the index is wrong")
    return summary


def _index(stream: BinaryIO, size: int, topic: _Topic) -> list[Place]:
    """The chunks as the summary of a whole file has them; topic learns its channels."""
    summary, at, places = _summary(stream, size), 0, list[Place]()
    while at < len(summary):
        opcode, length = HEAD.unpack_from(summary, at)
        at += HEAD.size
        if opcode == CHUNK_INDEX:
            first, _, offset, extent = PLACE.unpack_from(summary, at)
            if offset + extent > size:
                raise EOFError("the index speaks of a chunk beyond the end")
            places.append(Place(offset, extent, first))
        elif opcode == CHANNEL:
            topic.channel(summary, at)
        at += length
    return places


def _walked(stream: BinaryIO, size: int, topic: _Topic) -> list[Place]:
    """The chunks of a file without a summary, to the first that is broken; topic learns its channels."""
    places: list[Place] = []
    reader, at = _Reader(stream, size), len(MAGIC)
    try:
        for opcode, body in reader.records():
            if opcode == CHUNK:
                topic.found(_unpacked(body))
                places.append(Place(at, HEAD.size + len(body), CHUNK_HEAD.unpack_from(body)[0]))
            elif opcode == CHANNEL:
                topic.channel(body, 0)
            at += HEAD.size + len(body)
    except BROKEN:
        pass
    return places


@dataclass(frozen=True, slots=True)
class Back:
    """The way back through a topic's messages; what is in the file is looked up once."""

    path: Path
    topic: _Topic
    places: tuple[Place, ...]
    cut_short: bool

    def latest(self, until: float) -> Iterator[Found]:
        """The messages up to a log time [ns], the latest first; what is later is not unpacked.

        Raises one of `BROKEN` where the file cannot be read further.
        """
        with self.path.open("rb", buffering=4096) as stream:  # back and forth: much at once would be read in vain
            for place in reversed(self.places):
                if place.start <= until:
                    found = self.topic.found(_chunk(stream, place))
                    yield from reversed([one for one in found if one[0] <= until])
        if not (self.places or self.cut_short):  # nothing is in chunks
            yield from reversed([one for one in messages(self.path, self.topic.name) if one[0] <= until])


def back(path: Path, topic: str, *, cut_short: bool = False) -> Back:
    """The way back. cut_short: the file has no summary; its chunks are walked to the break. Raises one of `BROKEN`."""
    found, size = _Topic(topic, set()), path.stat().st_size
    with path.open("rb", buffering=4096) as stream:
        places = (_walked if cut_short else _index)(stream, size, found)
    return Back(path, found, tuple(places), cut_short)


def _chunk(stream: BinaryIO, place: Place) -> bytes:
    stream.seek(place.offset)
    record = stream.read(place.length)
    if len(record) != place.length or record[:1] != bytes([CHUNK]):
        raise EOFError("the index speaks of a chunk that is not there")
    return _unpacked(record, HEAD.size)
