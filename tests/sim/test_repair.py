"""A recording of a run that was killed becomes a whole file again, and nothing else is touched."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

from sim.recording import Recorder, RecordingError, read
from sim.repair import Saved, repair


def record(path: Path, ticks: int = 100) -> Path:
    with Recorder(path, {"plan": {"name": "a plan"}}) as recorder:
        for n in range(ticks):
            world = {"robot": [n / 50, 1 / 3, 0.5], "sonar": [1 + ((n * 7 + k * 13) % 29) / 31 for k in range(30)]}
            recorder.tick(n / 10, world, '{"hole":false}')
    return path


def cut(path: Path, share: float) -> Path:
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])
    return path


def ticks_of(path: Path) -> list[Any]:
    return list(read(path).ticks)


@pytest.mark.parametrize("share", [0.7, 0.4, 0.3])
def test_what_was_written_before_the_break_is_saved(tmp_path: Path, share: float) -> None:
    whole = ticks_of(record(tmp_path / "whole.mcap"))
    path = cut(record(tmp_path / "run.mcap"), share)
    readable = ticks_of(path)
    saved = repair(path)
    assert saved == Saved(len(readable), (len(readable) - 1) / 10, whole=False)
    assert 0 < saved.ticks < 100
    recording = read(path)
    assert not recording.cut_short
    assert list(recording.ticks) == whole[: saved.ticks]
    assert sorted(other.name for other in tmp_path.iterdir()) == ["run.mcap", "whole.mcap"]


def test_any_reader_opens_the_saved_file_and_finds_every_channel(tmp_path: Path) -> None:
    path = record(tmp_path / "run.mcap")
    with path.open("rb") as stream:
        before = make_reader(stream).get_summary()
    saved = repair(cut(path, 0.5))
    with path.open("rb") as stream:
        reader = make_reader(stream)
        after = reader.get_summary()
        assert before is not None and after is not None and after.statistics is not None
        names = sorted(channel.topic for channel in after.channels.values())
        assert names == sorted(channel.topic for channel in before.channels.values())
        assert {s.name: s.data for s in after.schemas.values()} == {s.name: s.data for s in before.schemas.values()}
        assert sum(1 for _ in reader.iter_messages(topics=["/tick"])) == saved.ticks
        _, _, last = next(reader.iter_messages(topics=["/pose"], reverse=True))
        assert last.log_time == round(saved.seconds * 1e9), "the index leads to the end of the file"


def test_a_saved_file_can_go_elsewhere_and_the_old_one_stays(tmp_path: Path) -> None:
    path = cut(record(tmp_path / "run.mcap"), 0.5)
    broken = path.read_bytes()
    saved = repair(path, tmp_path / "saved.mcap")
    assert path.read_bytes() == broken
    assert len(ticks_of(tmp_path / "saved.mcap")) == saved.ticks


def test_a_whole_file_is_left_as_it_is(tmp_path: Path) -> None:
    path = record(tmp_path / "run.mcap")
    before = path.read_bytes()
    assert repair(path, tmp_path / "saved.mcap") == Saved(100, 9.9, whole=True)
    assert path.read_bytes() == before
    assert not (tmp_path / "saved.mcap").exists()


def test_of_a_damaged_file_the_part_before_the_damage_is_saved(tmp_path: Path) -> None:
    path = record(tmp_path / "run.mcap")
    data = bytearray(path.read_bytes())
    data[len(data) // 3] ^= 0xFF
    path.write_bytes(data)
    saved = repair(path)
    assert not saved.whole
    assert 0 < saved.ticks < 100
    assert [tick["tick"] for tick in ticks_of(path)] == list(range(saved.ticks))


def test_repairing_twice_changes_nothing(tmp_path: Path) -> None:
    path = cut(record(tmp_path / "run.mcap"), 0.5)
    first = repair(path)
    once = path.read_bytes()
    assert repair(path) == Saved(first.ticks, first.seconds, whole=True)
    assert path.read_bytes() == once


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "is empty"),
        (b"(plan find)", "is not an MCAP file"),
        (b"\x89MCAP0\r\n", "cut short before its header"),
        (b"\x89MCAP0\r\n" + bytes(range(256)) * 40, "cut short before its header"),
    ],
)
def test_what_is_no_recording_is_a_clear_error_and_is_not_touched(tmp_path: Path, data: bytes, says: str) -> None:
    path = tmp_path / "run.mcap"
    path.write_bytes(data)
    with pytest.raises(RecordingError, match=says):
        repair(path)
    assert path.read_bytes() == data


def test_a_place_that_cannot_be_written_is_an_os_error_and_leaves_nothing(tmp_path: Path) -> None:
    path = cut(record(tmp_path / "run.mcap"), 0.5)
    with pytest.raises(FileNotFoundError):
        repair(path, tmp_path / "nowhere" / "run.mcap")
    with pytest.raises(FileNotFoundError):
        repair(tmp_path / "none.mcap")
    assert [other.name for other in tmp_path.iterdir()] == ["run.mcap"]
