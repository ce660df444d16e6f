"""A recording that was cut short becomes a whole file again.

Takes: the file that a killed run, a full disk or a damaged medium left. Gives: a file with everything that stands
before the break, with index and footer, and a word on how much that is. Leaves alone: whole files.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mcap.records import Channel, Footer, Header, McapRecord, Message, Schema
from mcap.writer import CompressionType, Writer

from sim.chunks import BROKEN
from sim.recording import CHUNK, RecordingError, read, records


@dataclass(slots=True)
class Saved:
    """What a recording holds: ticks, simulated time of the last [s]; whole: nothing had to be done."""

    ticks: int = 0
    seconds: float = 0.0
    whole: bool = False


def repair(path: Path | str, to: Path | str | None = None) -> Saved:
    """Make a whole file of one that was cut short or damaged; without `to` it takes the place of the old one.

    A whole file is left as it is, and nothing is written. Raises RecordingError where the file is no recording or
    its header is lost, OSError where it cannot be read or written.
    """
    path = Path(path)
    read(path)
    saved = _look(path)
    if saved.whole:
        return saved
    target = path if to is None else Path(to)
    part = target.with_name(f"{target.name}.part")
    try:
        _rewrite(path, part)
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)
    return saved


def _look(path: Path) -> Saved:
    saved, ticks = Saved(), list[int]()
    for record in _readable(path):
        match record:
            case Channel() if record.topic == "/tick":
                ticks.append(record.id)
            case Message() if record.channel_id in ticks:
                saved.ticks += 1
                saved.seconds = record.log_time / 1e9
            case Footer():
                saved.whole = True
    return saved


def _readable(path: Path) -> Iterator[McapRecord]:
    """The records before the break."""
    try:
        yield from records(path)
    except BROKEN:
        return


@dataclass(slots=True)
class _Copy:
    """Puts records into a writer; their numbers may change."""

    writer: Any
    schemas: dict[int, int] = field(default_factory=lambda: {0: 0})
    channels: dict[int, int] = field(default_factory=dict)

    def put(self, record: McapRecord) -> None:
        match record:
            case Header():
                self.writer.start(record.profile, record.library)
            case Schema() if record.id not in self.schemas:
                self.schemas[record.id] = self.writer.register_schema(record.name, record.encoding, record.data)
            case Channel() if record.id not in self.channels:
                schema = self.schemas[record.schema_id]
                number = self.writer.register_channel(record.topic, record.message_encoding, schema, record.metadata)
                self.channels[record.id] = number
            case Message():
                self.writer.add_message(
                    self.channels[record.channel_id],
                    record.log_time,
                    record.data,
                    record.publish_time,
                    record.sequence,
                )
            case _:
                pass


def _rewrite(path: Path, target: Path) -> None:
    with target.open("wb") as stream:
        writer: Any = Writer(stream, chunk_size=CHUNK, compression=CompressionType.ZSTD)  # not typed throughout
        copy = _Copy(writer)
        for record in _readable(path):
            try:
                copy.put(record)
            except KeyError as fault:
                raise RecordingError(f"{path} speaks of a channel that it does not name: nothing was saved") from fault
        writer.finish()
        stream.flush()
        os.fsync(stream.fileno())
