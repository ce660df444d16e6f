"""Messages of an MCAP file are those that the general reader gives; back from a time only what is asked is unpacked."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer

from sim import chunks
from sim.recording import Recorder, RecordingError, backwards, read

TICKS = 120
DATA = Path(__file__).parents[1] / "data" / "recordings"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Twelve seconds, whose ticks lie in some sixty chunks."""
    with Recorder(tmp_path / "run.mcap", {"seed": 0}) as recorder:
        for tick in range(TICKS):
            recorder.tick(tick / 10, {"robot": [tick / 7, 0.0, 0.0]}, json.dumps({"inputs": f"{tick:b}"}))
    return tmp_path / "run.mcap"


def written(
    path: Path, compression: CompressionType, *, chunking: bool = True, index: IndexType = IndexType.ALL
) -> Path:
    """A file of another writer with the same ticks, and with other messages between them."""
    with path.open("wb") as stream:
        writer: Any = Writer(stream, 4096, compression, index, use_chunking=chunking)
        writer.start()
        header, other, tick = (writer.register_channel(topic, "json", 0) for topic in ("/header", "/other", "/tick"))
        writer.add_message(header, 0, b'{"format": 2}', 0)
        for n in range(TICKS):
            writer.add_message(other, n * 10**8, b"x" * 100, n * 10**8)
            writer.add_message(tick, n * 10**8, f'{{"tick":{n}}}'.encode(), n * 10**8)
        writer.finish()
    return path


def general(path: Path, topic: str) -> list[chunks.Found]:
    """What the reader of the mcap package finds."""
    with path.open("rb") as stream:
        return [(m.log_time, m.data) for _, _, m in make_reader(stream).iter_messages(topics=[topic])]


def damaged(path: Path, at: int) -> Path:
    data = bytearray(path.read_bytes())
    data[at] ^= 0xFF
    path.write_bytes(data)
    return path


def places(path: Path) -> Iterator[tuple[int, int]]:
    """Offset and length of every chunk."""
    data, at = path.read_bytes(), len(chunks.MAGIC)
    while at < len(data) - len(chunks.MAGIC):
        opcode, length = struct.unpack_from("<BQ", data, at)
        if opcode == chunks.CHUNK:
            yield at, 9 + length
        at += 9 + length


def numbers(path: Path, until: float = math.inf) -> list[int]:
    return [json.loads(text)["tick"] for text in backwards(path).latest(until)]


@pytest.mark.parametrize("topic", ["/header", "/tick", "/pose", "/nothing"])
def test_the_messages_are_those_that_the_general_reader_finds(path: Path, topic: str) -> None:
    expected = general(path, topic)
    assert list(chunks.messages(path, topic)) == expected
    assert list(chunks.back(path, topic).latest(math.inf)) == expected[::-1]


def test_a_file_of_the_second_format_is_read_both_ways() -> None:
    whole = DATA / "format_2.mcap"
    expected = general(whole, "/tick")
    assert list(chunks.messages(whole, "/tick")) == expected
    assert list(chunks.back(whole, "/tick").latest(math.inf)) == expected[::-1]


@pytest.mark.parametrize("until", [0.0, 0.05, 0.1, 3.14, 11.9, 99.0])
def test_the_way_back_begins_with_the_last_tick_that_is_not_later(path: Path, until: float) -> None:
    count = min(int(until * 10 + 1e-9) + 1, TICKS)
    assert numbers(path, until) == [*reversed(range(count))]
    assert numbers(path, -0.1) == []


def test_a_message_at_the_very_time_counts(path: Path, tmp_path: Path) -> None:
    bare = written(tmp_path / "bare.mcap", CompressionType.NONE, chunking=False)
    for file in (path, bare):
        assert next(chunks.back(file, "/tick").latest(10**8))[0] == 10**8
        assert next(chunks.back(file, "/tick").latest(10**8 - 1))[0] == 0


def test_an_index_that_speaks_of_what_is_beyond_the_end_is_told(path: Path) -> None:
    data = bytearray(path.read_bytes())
    footer = len(data) - chunks.END
    (at,) = struct.unpack_from("<Q", data, footer + 9)
    while data[at] != chunks.CHUNK_INDEX:
        at += 9 + int(struct.unpack_from("<Q", data, at + 1)[0])
    struct.pack_into("<Q", data, at + 9 + 16, 2**63)
    struct.pack_into("<I", data, footer + chunks.FOOT.size - 4, 0)  # no checksum
    path.write_bytes(data)
    with pytest.raises(RecordingError, match="the index speaks of a chunk beyond the end"):
        list(backwards(path).latest())


def test_what_is_not_asked_is_not_unpacked(path: Path) -> None:
    """Neither chunks after the time nor those further back than one goes."""
    every = [*places(path)]
    for offset, length in (every[-2], every[3]):
        damaged(path, offset + length // 2)
    ticks = backwards(path).latest(6.0)
    assert [json.loads(next(ticks))["tick"] for _ in range(20)] == [*range(60, 40, -1)]
    with pytest.raises(RecordingError, match=r"run\.mcap is damaged .*rplan repair"):
        list(ticks)
    with pytest.raises(RecordingError, match="is damaged"):
        list(backwards(path).latest())


def test_a_file_that_was_cut_short_anywhere_gives_the_same_both_ways(path: Path) -> None:
    data = path.read_bytes()
    offset, length = [*places(path)][40]
    cut = path.with_name("cut.mcap")
    for size in (offset, offset + 1, offset + length // 2, offset + length, offset + length + 5, len(data) - 1):
        cut.write_bytes(data[:size])
        forwards = [tick["tick"] for tick in read(cut).ticks]
        assert forwards and forwards == [*range(len(forwards))]
        assert numbers(cut) == forwards[::-1]
        assert numbers(cut, 2.0) == [*range(20, -1, -1)]


def test_a_file_that_was_cut_short_ends_at_the_first_chunk_that_is_broken(path: Path) -> None:
    offset, length = [*places(path)][40]
    path.write_bytes(path.read_bytes()[:-30])
    damaged(path, offset + length // 2)
    forwards = [tick["tick"] for tick in read(path).ticks]
    assert 0 < len(forwards) < 100
    assert numbers(path) == forwards[::-1]


@pytest.mark.parametrize(
    ("compression", "chunking", "index"),
    [
        (CompressionType.NONE, True, IndexType.ALL),
        (CompressionType.ZSTD, True, IndexType.ALL),
        (CompressionType.ZSTD, True, IndexType.NONE),
        (CompressionType.NONE, False, IndexType.ALL),
    ],
)
def test_files_of_other_writers_are_read(
    compression: CompressionType, chunking: bool, index: IndexType, tmp_path: Path
) -> None:
    path = written(tmp_path / "other.mcap", compression, chunking=chunking, index=index)
    assert [tick["tick"] for tick in read(path).ticks] == [*range(TICKS)]
    assert numbers(path, 5.0) == [*range(50, -1, -1)]


def test_another_compression_is_a_clear_error(tmp_path: Path) -> None:
    path = written(tmp_path / "other.mcap", CompressionType.LZ4)
    with pytest.raises(RecordingError, match="a chunk is packed by lz4, not by zstd"):
        read(path)


def test_every_damaged_byte_is_told_or_does_no_harm(path: Path) -> None:
    """Whatever byte is wrong, one gets the ticks as they are or one clear error, both ways."""
    data, expected = path.read_bytes(), [*range(TICKS)]
    for at in range(8, len(data), 211):
        damaged(path, at)
        for way in (lambda: numbers(path)[::-1], lambda: [tick["tick"] for tick in read(path).ticks]):
            try:
                assert way() == expected, at
            except RecordingError as error:
                assert "\n" not in str(error)
        path.write_bytes(data)
