"""A recording is the same for the same run, gives back what went in, and says in one line why it cannot be read."""

from __future__ import annotations

import hashlib
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.reader import make_reader

from sim.recording import FORMAT, Recorder, RecordingError, read

HEADER = {"format": FORMAT, "plan": {"name": "früh", "text": '(plan früh "</script>")'}, "seed": 3, "period": 0.1}
NOTE = '{"inputs":"0110","hole":false,"outputs":{"action":"(move-away-from-danger)","goal":null}}'


def world(tick: int) -> dict[str, object]:
    return {
        "t": tick / 10,
        "robot": [tick * 0.02, 1.0 / 3.0, 0.5],
        "sonar": [1.0 + ((tick * 7 + k * 13) % 29) / 31 for k in range(30)],
        "on_board": tick > 50,
    }


def record(path: Path, ticks: int = 100) -> Path:
    with Recorder(path, HEADER) as recorder:
        for tick in range(ticks):
            recorder.tick(tick / 10, world(tick), NOTE)
    return path


def cut(path: Path, size: int) -> Path:
    path.write_bytes(path.read_bytes()[:size])
    return path


def test_what_goes_in_comes_out_exactly(tmp_path: Path) -> None:
    recording = read(record(tmp_path / "run.mcap"))
    assert recording.header == HEADER
    assert not recording.cut_short
    expected = [{"tick": n, "t": n / 10, "world": world(n), "plan": json.loads(NOTE)} for n in range(100)]
    assert list(recording.ticks) == expected
    assert list(recording.ticks) == expected, "ticks can be iterated again"


def test_the_same_run_gives_the_same_bytes(tmp_path: Path) -> None:
    assert record(tmp_path / "a.mcap").read_bytes() == record(tmp_path / "b.mcap").read_bytes()


def test_the_bytes_do_not_depend_on_process_or_hash_seed(tmp_path: Path) -> None:
    script = (
        "import runpy, sys, pathlib\n"
        "runpy.run_path(sys.argv[1])['record'](pathlib.Path(sys.argv[2]))\n"  # this very file, as a script
    )
    digests = []
    for seed in ("1", "4711"):
        path = tmp_path / f"{seed}.mcap"
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        subprocess.run([sys.executable, "-c", script, __file__, str(path)], check=True, env=environment)
        digests.append(hashlib.sha256(path.read_bytes()).hexdigest())
    assert digests[0] == digests[1]


def test_every_stamp_is_simulated_time(tmp_path: Path) -> None:
    with record(tmp_path / "run.mcap", 30).open("rb") as stream:
        messages = [(c.topic, m.log_time, m.publish_time) for _, c, m in make_reader(stream).iter_messages()]
    ticks = [at for topic, at, _ in messages if topic == "/tick"]
    assert ticks == [n * 100_000_000 for n in range(30)]
    assert [at for topic, at, _ in messages if topic == "/pose"] == ticks
    assert all(at == published for _, at, published in messages)


def test_numbers_that_json_does_not_know_become_null(tmp_path: Path) -> None:
    with Recorder(tmp_path / "run.mcap", HEADER) as recorder:
        recorder.tick(0.0, {"ir": {"offset": math.nan, "strength": 2.0}, "sonar": (math.inf, 1.0)}, '{"x": NaN}')
        recorder.tick(0.1, {"stage": "NaN and Infinity"}, '{"says": "NaN"}')
    first, second = read(tmp_path / "run.mcap").ticks
    assert first["world"] == {"ir": {"offset": None, "strength": 2.0}, "sonar": [None, 1.0]}
    assert first["plan"] == {"x": None}
    assert second["world"] == {"stage": "NaN and Infinity"}
    assert second["plan"] == {"says": "NaN"}


def test_a_brain_without_a_plan_leaves_its_part_null(tmp_path: Path) -> None:
    with Recorder(tmp_path / "run.mcap", HEADER) as recorder:
        recorder.tick(0.0, {}, "null")
    assert [tick["plan"] for tick in read(tmp_path / "run.mcap").ticks] == [None]


def test_two_recordings_at_once_do_not_mix(tmp_path: Path) -> None:
    with Recorder(tmp_path / "a.mcap", HEADER) as a, Recorder(tmp_path / "b.mcap", HEADER) as b:
        for tick in range(40):
            a.tick(tick / 10, world(tick), NOTE)
            b.tick(tick / 10, {"other": tick}, "null")
    assert (tmp_path / "a.mcap").read_bytes() == record(tmp_path / "alone.mcap", 40).read_bytes()
    assert [tick["world"] for tick in read(tmp_path / "b.mcap").ticks] == [{"other": n} for n in range(40)]


def test_a_run_that_raises_leaves_a_whole_file(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), Recorder(tmp_path / "run.mcap", HEADER) as recorder:
        recorder.tick(0.0, world(0), NOTE)
        _ = 1 // 0
    recording = read(tmp_path / "run.mcap")
    assert not recording.cut_short
    assert len(list(recording.ticks)) == 1


@pytest.mark.parametrize("number", [3, 190, 195, 200])
def test_a_process_that_is_killed_leaves_all_but_a_fifth_of_a_second(tmp_path: Path, number: int) -> None:
    path = tmp_path / "run.mcap"
    script = (
        "import runpy, sys, os, signal\n"
        "names = runpy.run_path(sys.argv[1])\n"
        "recorder = names['Recorder'](sys.argv[2], names['HEADER'])\n"
        "for tick in range(int(sys.argv[3])): recorder.tick(tick / 10, names['world'](tick), names['NOTE'])\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    subprocess.run([sys.executable, "-c", script, __file__, str(path), str(number)], check=False)
    recording = read(path)
    assert recording.cut_short
    assert recording.header == HEADER
    ticks = list(recording.ticks)
    assert number - 2 <= len(ticks) <= number
    assert [tick["tick"] for tick in ticks] == list(range(len(ticks)))


@pytest.mark.parametrize("kept", [0.7, 0.5, 0.2])
def test_a_file_that_was_cut_short_gives_its_beginning(tmp_path: Path, kept: float) -> None:
    path = record(tmp_path / "run.mcap", 300)
    recording = read(cut(path, int(path.stat().st_size * kept)))
    assert recording.cut_short
    ticks = list(recording.ticks)
    assert 0 < len(ticks) < 300
    assert ticks[-1]["world"] == world(len(ticks) - 1)


@pytest.mark.parametrize(("size", "says"), [(0, "is empty"), (5, "is not an MCAP file"), (60, "was cut short before")])
def test_hardly_a_file_is_a_clear_error(tmp_path: Path, size: int, says: str) -> None:
    with pytest.raises(RecordingError, match=says) as error:
        read(cut(record(tmp_path / "run.mcap"), size))
    assert "run.mcap" in str(error.value)
    assert "\n" not in str(error.value)


def test_another_kind_of_file_is_a_clear_error(tmp_path: Path) -> None:
    path = tmp_path / "plan.rplan"
    path.write_text("(plan find-and-fetch)")
    with pytest.raises(RecordingError, match=r"plan\.rplan is not an MCAP file"):
        read(path)


def test_a_later_format_is_refused(tmp_path: Path) -> None:
    with Recorder(tmp_path / "run.mcap", {**HEADER, "format": FORMAT + 1}):
        pass
    with pytest.raises(RecordingError, match=f"format {FORMAT + 1}, this rplan reads up to {FORMAT}: use a newer"):
        read(tmp_path / "run.mcap")


def test_damage_inside_is_told_while_iterating(tmp_path: Path) -> None:
    path = record(tmp_path / "run.mcap", 300)
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)
    recording = read(path)
    with pytest.raises(RecordingError, match=r"run\.mcap is damaged"):
        list(recording.ticks)


def test_a_place_that_cannot_be_written_or_read_is_an_os_error(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError):
        Recorder(tmp_path, HEADER)
    with pytest.raises(FileNotFoundError):
        Recorder(tmp_path / "nowhere" / "run.mcap", HEADER)
    with pytest.raises(FileNotFoundError):
        read(tmp_path / "none.mcap")
