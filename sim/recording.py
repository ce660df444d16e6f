"""A run on disk: one MCAP file with a header, one JSON object a tick, what the robot sensed, and a view for viewers.

Takes: a header, and tick by tick the state of the world, the brain's note (JSON text) and the Reading. Gives: a file
that is the same to the byte for the same run, since every stamp in it is simulated; and the ways back: `read`,
`readings` and `backwards`. Leaves alone: what world and brain put into their parts, the judgement of the run, how it is
shown.

Topics: `/header` once and `/tick` (JSON; tick n carries `tick`, `t` [s], `world`, `plan`), `/reading` (JSON, all that
was sensed to the last bit), and the typed channels of `viewing.py`, so that any MCAP viewer can play the file as well.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Self

from foxglove import Channel, Context, open_mcap
from foxglove.mcap import MCAPCompression, MCAPWriteOptions
from mcap.records import McapRecord
from mcap.stream_reader import StreamReader

from behaviours.interface import Reading
from sim import chunks
from sim import readings as texts
from sim.chunks import BROKEN, MAGIC
from sim.plain import Json as Json
from sim.readings import ReadingTexts
from sim.viewing import View

FORMAT = 2
"""Number of the layout of header and ticks; a reader refuses a later one. 2: readings and views beside the ticks."""

CHUNK = 128 * 1024
"""Bytes [uncompressed] that are closed and written together at most."""

KEEP_S = 0.2
"""After so much simulated time [s] a chunk is closed and written: what a run that is killed may lose."""


class RecordingError(Exception):
    """A recording that cannot be read: what, which file, what to do, in one line."""


# --- writing --------------------------------------------------------------------------------------


def _finite(value: object) -> object:
    """The same JSON value with None for every number that JSON does not know."""
    match value:
        case float():
            return value if math.isfinite(value) else None
        case Mapping():
            return {key: _finite(part) for key, part in value.items()}
        case str():
            return value
        case Sequence():
            return [_finite(part) for part in value]
        case _:
            return value


_encode = json.JSONEncoder(separators=(",", ":"), ensure_ascii=False, allow_nan=False, check_circular=False).encode


def json_text(value: object) -> str:
    """Compact JSON; a number that is not finite becomes null."""
    try:
        return _encode(value)
    except ValueError:
        return _encode(_finite(value))


def _finite_text(note: str) -> str:
    """The note as it is, unless it speaks of numbers that JSON does not know."""
    return json_text(json.loads(note)) if "NaN" in note or "Infinity" in note else note


HEADER_SCHEMA = {
    "type": "object",
    "title": "rplan.Header",
    "properties": {"format": {"type": "integer"}, "seed": {"type": "integer"}, "period": {"type": "number"}},
}
NUMBERS = {"type": "array", "items": {"type": "number"}}
TICK_SCHEMA = {
    "type": "object",
    "title": "rplan.Tick",
    "properties": {
        "tick": {"type": "integer"},
        "t": {"type": "number"},
        "world": {
            "type": "object",
            "properties": {
                "stage": {"type": "string"},
                "robot": NUMBERS,
                "odometry": NUMBERS,
                "head": NUMBERS,
                "command": {"type": "object", "properties": {"drive": NUMBERS, "head": NUMBERS}},
                "on_board": {"type": "boolean"},
            },
        },
        "plan": {"type": "object"},
        "by_hand": {"type": "object"},
    },
}
READING_SCHEMA = {
    "type": "object",
    "title": "rplan.Reading",
    "properties": {"tick": {"type": "integer"}, "stamp": {"type": "number"}, "object_on_board": {"type": "boolean"}},
}
"""What viewers are told of the JSON; they find the rest themselves."""


class Recorder:
    """Writes one recording; a context manager. An existing file is replaced.

    The header stands on disk before the first tick, and all ticks but those of the last `KEEP_S` do, so that little of
    a run that dies is lost. view: whether the typed channels for viewers are written too.
    Raises OSError where the file cannot be written.
    """

    def __init__(self, path: Path | str, header: Json, *, view: bool = True) -> None:
        self._file = FileIO(path, "wb")
        self._context = context = Context()  # the channels die with it
        options = MCAPWriteOptions(
            compression=MCAPCompression.Zstd,
            compression_level=1,  # chunks are small: higher levels cost much and save little
            chunk_size=CHUNK,
            compression_threads=0,
            disable_seeking=True,  # a chunk is put together in memory and written whole
        )
        self._writer = open_mcap(self._file, context=context, writer_options=options)
        header_channel = Channel("/header", schema=HEADER_SCHEMA, context=context)
        self._tick = Channel("/tick", schema=TICK_SCHEMA, context=context)
        self._reading = Channel("/reading", schema=READING_SCHEMA, context=context)
        self._readings = ReadingTexts()
        self._view = View(context, header) if view else None
        self._count, self._kept = 0, 0
        try:
            with _as_oserror():
                header_channel.log(json_text({"format": FORMAT, **header}).encode(), log_time=0)
                if self._view is not None:
                    self._view.begin()
                self._writer.flush()
        except OSError:
            self._file.close()
            raise

    def tick(
        self, t: float, world: Json, note_json: str, reading: Reading | None = None, by_hand: Json | None = None
    ) -> None:
        """Append one tick: simulated time [s], the world's snapshot, the brain's note as JSON text ("null": none).

        reading: what the robot sensed in it; where it is given, `readings` gives it back. by_hand: what someone made
        otherwise who watched; where there is nothing, it is left out.
        """
        nanoseconds = round(t * 1e9)
        note = _finite_text(note_json)
        more = f',"by_hand":{json_text(by_hand)}' if by_hand else ""
        text = f'{{"tick":{self._count},"t":{json_text(t)},"world":{json_text(world)},"plan":{note}{more}}}'
        with _as_oserror():
            self._tick.log(text.encode(), log_time=nanoseconds)
            if reading is not None:
                self._reading.log(self._readings.text(reading).encode(), log_time=nanoseconds)
            if self._view is not None:
                self._view.tick(nanoseconds, world, reading)
            if nanoseconds - self._kept >= KEEP_S * 1e9 - 1:
                self._writer.flush()
                self._kept = nanoseconds
        self._count += 1

    def close(self) -> None:
        """Finish the file; the second call does nothing."""
        if not self._file.closed:
            try:
                with _as_oserror():
                    self._writer.close()
            finally:
                self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, at: TracebackType | None) -> None:
        self.close()


@contextmanager
def _as_oserror() -> Iterator[None]:
    """What the writer says of a full disk is a RuntimeError; callers wait for an OSError."""
    try:
        yield
    except RuntimeError as fault:
        raise OSError(f"the recording cannot be written: {fault}") from fault


# --- reading --------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Recording:
    """One run. ticks and readings may be iterated again and again; those of a file are read anew each time.

    cut_short: the writer died before it closed the file; ticks has what it had written by then. readings: what the
    robot sensed, at the same times as the ticks; none in a recording of the first format.
    """

    header: Json
    ticks: Iterable[Json]
    cut_short: bool = False
    readings: Iterable[Reading] = ()


@dataclass(frozen=True, slots=True)
class _Ticks:
    path: Path
    cut_short: bool

    def __iter__(self) -> Iterator[Json]:
        return (json.loads(data) for data in _messages(self.path, "/tick", self.cut_short))


@dataclass(frozen=True, slots=True)
class _Readings:
    path: Path
    cut_short: bool

    def __iter__(self) -> Iterator[Reading]:
        try:
            yield from texts.readings(_messages(self.path, "/reading", self.cut_short))
        except ValueError as fault:
            raise RecordingError(f"{self.path} is damaged ({fault}): record the run again") from fault


def records(path: Path) -> Iterator[McapRecord]:
    """Every record of an MCAP file, in order; raises one of `BROKEN` where the file cannot be read further."""
    with path.open("rb") as stream:
        yield from StreamReader(stream, validate_crcs=True, record_size_limit=path.stat().st_size).records


def _messages(path: Path, topic: str, cut_short: bool) -> Iterator[bytes]:
    """The messages of a topic in file order; where the file was cut short it ends quietly."""
    with _told(path, cut_short):
        yield from (data for _, data in chunks.messages(path, topic))


@contextmanager
def _told(path: Path, cut_short: bool) -> Iterator[None]:
    """What is broken is said, unless it is the end of a file that was cut short."""
    try:
        yield
    except BROKEN as fault:
        if not cut_short:
            advice = "record the run again, or save its beginning by `rplan repair`"
            raise RecordingError(f"{path} is damaged ({fault}): {advice}") from fault


def _is_cut_short(path: Path) -> bool:
    """Whether the closing magic is missing; raises RecordingError where the opening one is."""
    with path.open("rb") as stream:
        start = stream.read(len(MAGIC))
        stream.seek(-len(start), 2)
        end = stream.read()
        if not start:
            raise RecordingError(f"{path} is empty: the run wrote nothing; record it again")
        if start != MAGIC:
            raise RecordingError(f"{path} is not an MCAP file: give a recording made by rplan")
        return end != MAGIC or stream.tell() == len(MAGIC)


def _header(path: Path, cut_short: bool) -> Json:
    text = next(_messages(path, "/header", cut_short), None)
    if text is None and cut_short:
        raise RecordingError(f"{path} was cut short before its header was written: record the run again")
    header = None if text is None else json.loads(text)
    if not isinstance(header, dict) or not isinstance(header.get("format"), int):
        raise RecordingError(f"{path} is an MCAP file without rplan's /header: give a recording made by rplan")
    if header["format"] > FORMAT:
        raise RecordingError(
            f"{path} has recording format {header['format']}, this rplan reads up to {FORMAT}: use a newer rplan"
        )
    return header


def read(path: Path | str) -> Recording:
    """The recording in a file; its ticks are read while they are iterated.

    Raises RecordingError where the file is no recording (also while iterating, where it is damaged further in);
    OSError where it cannot be opened.
    """
    path = Path(path)
    cut_short = _is_cut_short(path)
    header = _header(path, cut_short)
    return Recording(header, _Ticks(path, cut_short), cut_short, _Readings(path, cut_short))


def readings(path: Path | str) -> Iterator[Reading]:
    """What the robot sensed, tick by tick, to the last bit.

    Raises RecordingError where the file is no recording, holds no readings or is damaged further in; OSError where it
    cannot be opened.
    """
    found = iter(read(path).readings)
    first = next(found, None)
    if first is None:
        raise RecordingError(f"{path} holds no readings: record the run again with this rplan")
    yield first
    yield from found


@dataclass(frozen=True, slots=True)
class Backwards:
    """The ticks of a recording from any time back, as their JSON texts."""

    _back: chunks.Back

    def latest(self, until: float = math.inf) -> Iterator[str]:
        """Those up to a time [s], the latest first; what is later is not unpacked.

        Raises RecordingError where the file is damaged where it is looked at; OSError where it cannot be opened.
        """
        with _told(self._back.path, self._back.cut_short):
            for _, data in self._back.latest(until * 1e9 + 0.5):
                yield data.decode()


def backwards(path: Path | str) -> Backwards:
    """The ticks of a recording, to be looked at from its end.

    Raises RecordingError where the file is no recording or its index is damaged; OSError where it cannot be opened.
    """
    path = Path(path)
    cut_short = _is_cut_short(path)
    with _told(path, cut_short=False):
        return Backwards(chunks.back(path, "/tick", cut_short=cut_short))
