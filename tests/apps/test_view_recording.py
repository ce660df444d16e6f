"""A watched run is recorded as it happens, with what was done by hand, so that `why` of it tells the truth."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from rplan.apps.cli import cli
from rplan.apps.simulation import load_world, simulate
from rplan.apps.viewer import server
from rplan.apps.viewer.server import Viewer
from rplan.apps.viewer.session import Session, WishError
from rplan.apps.wiring import compile_file
from sim.recording import Recorder, read, readings
from sim.replay import pack

ROOT = Path(__file__).parents[2]
FIND = ROOT / "plans" / "find_and_fetch" / "find_and_fetch.rplan"
LOT = FIND.parent / "parking_lot.yaml"
PATROL = ROOT / "plans" / "patrol" / "patrol.rplan"


def session(record: Path, plan: Path = FIND, world: Path = LOT) -> Session:
    """A session of one tick that is recorded."""
    one = Session(compile_file(plan), load_world(world), 3)
    one.record(record)
    return one


def ticks(path: Path) -> list[Any]:
    recording = read(path)
    assert not recording.cut_short
    return list(recording.ticks)


def told(*arguments: str | Path) -> Any:
    result = CliRunner().invoke(cli, [*map(str, arguments), "--json"], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def said(*arguments: str | Path) -> str:
    return CliRunner().invoke(cli, [*map(str, arguments)], catch_exceptions=False).stdout


def test_a_run_that_nobody_meddles_with_is_recorded_as_it_is_simulated(tmp_path: Path) -> None:
    simulate(compile_file(FIND), load_world(LOT), 3, until=3.0, record=tmp_path / "simulated.mcap")
    one = session(tmp_path / "watched.mcap")
    one.wish({"do": "step", "ticks": 29})
    one.close()
    watched, simulated = ticks(tmp_path / "watched.mcap"), ticks(tmp_path / "simulated.mcap")
    assert len(watched) == len(simulated) == 31
    for mine, other in zip(watched[:-1], simulated[:-1], strict=True):
        assert (mine["t"], mine["plan"]) == (other["t"], other["plan"])
        assert {**mine["world"], "movers": None} == {**other["world"], "movers": None}
        assert "by_hand" not in mine
    assert watched[-1]["plan"] is None
    assert watched[-1]["world"]["command"]["drive"] == [0.0, 0.0]
    mine, other = (read(tmp_path / name).header for name in ("watched.mcap", "simulated.mcap"))
    assert {**mine, "world": None} == {**other, "world": None}


def test_the_same_wishes_give_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a.mcap", "b.mcap"):
        one = session(tmp_path / name)
        one.wish({"do": "force", "percept": "anything-is-too-close", "value": True})
        one.wish({"do": "step", "ticks": 9})
        one.close()
        one.close()
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


def test_a_percept_that_was_forced_is_told_by_why(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    one = session(path)
    one.wish({"do": "force", "percept": "anything-is-too-close", "value": True})
    one.wish({"do": "step", "ticks": 3})
    one.wish({"do": "force", "percept": "anything-is-too-close", "value": None})
    one.wish({"do": "step", "ticks": 3})
    one.close()
    found = told("why", path, "--at", "0.2")
    assert found["literals"] == [{"text": "(anything-is-too-close)", "value": True}]
    assert found["forced"] == {"(anything-is-too-close)": True}
    assert found["since"]["action"]["tick"] == 1
    assert [act["value"] for act in found["way"]["acts"] if act["output"] == "action"] == ["(move-away-from-danger)"]
    assert "  forced by hand: (anything-is-too-close) = true\n" in said("why", path, "--at", "0.2")
    for at in ("0", "0.5"):
        assert told("why", path, "--at", at)["forced"] == {}
        assert "by hand" not in said("why", path, "--at", at)
    other = ("why-not", path, "--at", "0.2", "action=(start-ir-search)")
    assert "  forced by hand: (anything-is-too-close) = true\n" in said(*other)
    assert told(*other)["forced"] == {"(anything-is-too-close)": True}


def test_a_number_that_was_forced_is_the_number_behind_the_comparison(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    one = session(path, PATROL, next(iter(sorted(PATROL.parent.glob("*.yaml")))))
    one.wish({"do": "force", "percept": "battery-level", "value": 0.25})
    one.wish({"do": "step", "ticks": 2})
    one.close()
    assert told("why", path, "--at", "0.1")["percepts"]["(battery-level)"] == 0.25
    text = said("why", path, "--at", "0.1")
    assert "  forced by hand: (battery-level) = 0.25\n" in text
    assert "(< (battery-level) 0.4) is true ((battery-level) = 0.25)" in text
    assert told("why", path, "--at", "0")["percepts"]["(battery-level)"] > 0.9
    sensed = [*readings(path)][1].battery
    assert sensed is not None and sensed.level > 0.9, "the robot sensed what was so"


def test_a_thing_that_was_dragged_is_where_it_was_put_from_the_next_tick_on(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    one = session(path)
    one.wish({"do": "step", "ticks": 2})
    one.wish({"do": "move", "thing": "trashcan-1", "pose": [1.2, 0.0, 0.0]})
    with pytest.raises(WishError):
        one.wish({"do": "move", "thing": "post-1", "pose": one.episode.snapshot()["robot"]})
    one.wish({"do": "step", "ticks": 2})
    one.close()
    every = ticks(path)
    assert [tick.get("by_hand") for tick in every] == [None] * 3 + [{"moved": {"trashcan-1": [1.2, 0.0, 0.0]}}] + [
        None
    ] * 2
    places = [tick["world"]["movers"]["trashcan-1"] for tick in every]
    assert places[2] != [1.2, 0.0, 0.0] == places[3] == places[4]
    packed: Any = pack(read(path))
    assert packed["ticks"] == 6 and "mover trashcan-1" in packed["tracks"]
    assert told("why", path, "--at", "0.3")["tick"] == 3


def test_a_run_that_is_begun_anew_has_a_file_of_its_own(tmp_path: Path) -> None:
    path, taken = tmp_path / "run.mcap", tmp_path / "run-2.mcap"
    path.write_text("what was there before")
    taken.write_text("somebody else's")
    one = session(path)
    one.wish({"do": "step", "ticks": 4})
    one.wish({"do": "restart"})
    one.wish({"do": "step", "ticks": 1})
    one.wish({"do": "restart"})
    one.close()
    files = [path, tmp_path / "run-3.mcap", tmp_path / "run-4.mcap"]
    assert one.recorded == files
    assert [len(ticks(file)) for file in files] == [6, 3, 2]
    assert ticks(files[1])[:2] == ticks(path)[:2], "the same seed"
    assert taken.read_text() == "somebody else's"


def test_nothing_goes_back_in_the_file(tmp_path: Path) -> None:
    one = session(tmp_path / "run.mcap")
    one.wish({"do": "step", "ticks": 5})
    for wish in ({"do": "step", "ticks": -1}, {"do": "seek", "tick": 2}):
        with pytest.raises(WishError):
            one.wish(wish)
    one.wish({"do": "step", "ticks": 1})
    one.close()
    every = ticks(tmp_path / "run.mcap")
    assert [tick["tick"] for tick in every] == [*range(8)]
    assert [round(tick["t"] * 10) for tick in every] == [*range(8)]


def test_the_page_is_told_that_it_is_recorded_and_where_to(tmp_path: Path) -> None:
    unrecorded = Session(compile_file(FIND), load_world(LOT), 3)
    assert (unrecorded.state()["recording"], unrecorded.state()["unwritten"]) == ("", "")
    one = session(tmp_path / "run.mcap")
    assert one.state()["recording"] == "run.mcap"
    one.wish({"do": "restart"})
    assert one.state()["recording"] == "run-2.mcap"
    one.close()
    assert one.state()["recording"] == ""


def test_a_disk_that_is_full_stops_the_run_and_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one = session(tmp_path / "run.mcap")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Recorder, "tick", full)
    one.wish({"do": "step", "ticks": 3})
    assert "No space left on device" in one.over
    one.close()
    assert one.unwritten == f"{tmp_path / 'run.mcap'}: No space left on device"


def test_a_second_file_that_cannot_be_written_is_refused_and_the_run_goes_on(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    folder.mkdir()
    one = session(folder / "run.mcap")
    (folder / "run.mcap").rename(tmp_path / "kept.mcap")
    folder.rmdir()
    with pytest.raises(WishError, match="it cannot be recorded: No such file or directory"):
        one.wish({"do": "restart"})
    one.wish({"do": "step", "ticks": 3})
    one.close()
    assert len(ticks(tmp_path / "kept.mcap")) == 5


# --- the command ------------------------------------------------------------------------------------


def test_the_command_writes_what_stands_when_it_ends(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    arguments = ["view", str(FIND), "--paused", "--record", str(path)]
    process = subprocess.Popen(
        [sys.executable, "-u", "-c", "from rplan.apps.cli import main; main()", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert process.stdout is not None
    assert process.stdout.readline().startswith("watch it at http://127.0.0.1:")
    process.send_signal(signal.SIGINT)
    out, error = process.communicate(timeout=20)
    assert (process.returncode, out, error) == (0, f"ended at 0.1 s of simulated time\nwrote {path}\n", "")
    assert len(ticks(path)) == 2


@pytest.mark.parametrize("full", [False, True])
def test_the_command_says_what_it_wrote_or_could_not(
    full: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "run.mcap"

    async def watched(one: Session, _port: int, ready: Callable[[Viewer], None], _stop: asyncio.Event) -> None:
        ready(Viewer(one))
        one.wish({"do": "step", "ticks": 4})
        if full:
            monkeypatch.setattr(Recorder, "tick", no_space)
        one.close()

    def no_space(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(server, "watch", watched)
    result = CliRunner().invoke(cli, ["view", str(FIND), "--record", str(path)])
    assert result.stdout.endswith(f"ended at 0.5 s of simulated time\nwrote {path}\n")
    assert (result.exit_code, result.stderr) == ((2, f"error: {path}: No space left on device\n") if full else (0, ""))
    assert len(ticks(path)) == (5 if full else 6)


def test_a_place_that_cannot_be_written_is_a_clear_error(tmp_path: Path) -> None:
    result = CliRunner().invoke(cli, ["view", str(FIND), "--record", str(tmp_path / "none" / "run.mcap")])
    assert result.exit_code == 2
    assert result.stderr == f"error: {tmp_path / 'none' / 'run.mcap'}: No such file or directory\n"


def test_a_port_that_is_taken_leaves_an_earlier_recording_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    path.write_text("what was there before")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        result = CliRunner().invoke(cli, ["view", str(FIND), "--port", port, "--record", str(path)])
    assert result.exit_code == 2 and "of 127.0.0.1" in result.stderr
    assert path.read_text() == "what was there before"
