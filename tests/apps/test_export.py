"""Tables and films of recordings: what they hold, and what is said where they cannot be made."""

from __future__ import annotations

import builtins
import csv
import json
import math
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from rplan.apps import table
from rplan.apps.cli import cli
from rplan.apps.drawing import video
from sim.recording import Recorder, Recording, read

INPUTS = ["(near)", "(< (gap) 2m)"]
HEADER: dict[str, Any] = {
    "plan": {"name": "find", "inputs": INPUTS, "outputs": ["goal", "action"]},
    "scenario": {"name": "lot"},
    "world": {
        "bounds": [-2, -2, 4, 2],
        "robot": {"radius": 0.3, "shape": {"polygon": [[-0.3, -0.2], [0.3, 0], [-0.3, 0.2]]}},
        "things": [{"id": "post", "kind": "post", "shape": {"circle": 0.2}, "pose": [2, 1, 0], "height": 1}],
        "movers": [{"id": "can", "kind": "can", "shape": {"circle": 0.3}, "pose": [1, -1, 0], "height": 1}],
        "goal": {"at": [3, 0], "within": 0.5},
    },
}


def world(n: int) -> dict[str, Any]:
    return {
        "stage": "out, and on",
        "robot": [n / 50, 0.0, None if n == 3 else 0.5],
        "odometry": [n / 49, 0.1, 0.5],
        "head": [0.1, 0.2],
        "movers": {"can": [1.0, -1.0 + n / 100, 0.0]} if n < 15 else {},
        "command": {"drive": [0.2, -0.1]} if n % 2 else {"head": [1.0, 0.5], "flippers": True},
        "contacts": [{"thing": "post", "driven_into": True}, {"thing": "can", "driven_into": False}] if n == 4 else [],
        "on_board": n > 5,
    }


def plan(n: int) -> dict[str, Any]:
    return {
        "inputs": "01" if n % 2 else "10",
        "hole": n == 7,
        "outputs": {"goal": None, "action": '(say "a, b")'},
        "sent": {"goal": [1.0, 2.0, 0.5], "action": '(say "a, b")'},
        "way": {"rules": ["(maint a)", "(ach b)"], "given_up": [{"member": "(maint c)"}]},
        "faults": [{"competence": "go", "message": "lost"}] if n == 2 else [],
    }


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    with Recorder(tmp_path / "run.mcap", HEADER) as recorder:
        for n in range(20):
            recorder.tick(n / 10, world(n), json.dumps(plan(n)))
        recorder.tick(2.0, world(20), "null")
    return tmp_path / "run.mcap"


def export(path: Path, *options: str) -> Result:
    result = CliRunner().invoke(cli, ["export", str(path), *options], catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


def test_a_table_has_a_row_a_tick_and_a_column_for_each_condition(recorded: Path, tmp_path: Path) -> None:
    result = export(recorded, "--csv", str(tmp_path / "run.csv"))
    assert result.exit_code == 0
    assert "(21 rows)" in result.stdout
    with (tmp_path / "run.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 21
    third = rows[3]
    assert (third["tick"], third["t"], third["x"], third["heading"], third["odometry_y"]) == (
        "3",
        "0.3",
        "0.06",
        "",
        "0.1",
    )
    assert (third["speed"], third["turn_rate"], third["look_pan"], third["flippers"]) == ("0.2", "-0.1", "", "")
    assert (rows[4]["look_pan"], rows[4]["flippers"], rows[4]["contacts"]) == ("1.0", "true", "post; can")
    assert [row["(near)"] for row in rows[:3]] == ["true", "false", "true"]
    assert rows[1]["(< (gap) 2m)"] == "true"
    assert (third["output goal"], third["output action"]) == ("", '(say "a, b")')
    assert third["sent goal"] == "[1.0,2.0,0.5]"
    assert (third["stage"], third["way"], third["given_up"]) == ("out, and on", "(maint a); (ach b)", "(maint c)")
    assert (rows[7]["hole"], rows[2]["faults"]) == ("true", "go: lost")
    assert rows[20]["(near)"] == rows[20]["way"] == rows[20]["hole"] == "", "the run is over: nothing is decided"


def test_the_same_recording_gives_the_same_table(recorded: Path, tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv"):
        export(recorded, "--csv", str(tmp_path / name))
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_parquet_holds_the_same_with_types(recorded: Path, tmp_path: Path) -> None:
    import duckdb

    target = tmp_path / "run.parquet"
    assert export(recorded, "--parquet", str(target)).exit_code == 0
    with duckdb.connect() as database:
        found = database.read_parquet(str(target))
        assert dict(zip(found.columns, map(str, found.types), strict=True)) == table.columns(HEADER)
        rows = [dict(zip(found.columns, row, strict=True)) for row in found.fetchall()]
    run = read(recorded)
    for row, expected in zip(rows, table.rows(run), strict=True):
        assert row["tick"] == expected["tick"]
        assert row["x"] == pytest.approx(expected["x"])
        assert row["(near)"] == expected.get("(near)")
        assert row["output action"] == expected.get("output action")
        assert row["heading"] == expected["heading"]


def test_without_duckdb_it_says_how_to_get_it(recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real: Callable[..., Any] = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name == "duckdb":
            raise ModuleNotFoundError("No module named 'duckdb'", name="duckdb")
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    result = export(recorded, "--parquet", str(tmp_path / "run.parquet"))
    assert result.exit_code == 2
    assert result.stderr == "error: Parquet needs DuckDB: pip install 'rplan[data]', or write a .csv\n"
    assert not (tmp_path / "run.parquet").exists()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ((), "nothing is asked for"),
        (("--csv", "nowhere/run.csv"), "nowhere/run.csv: No such file"),
        (("--video", "run.mp4", "--speed", "nan"), "--speed must lie between"),
        (("--video", "run.mp4", "--speed", "0"), "--speed must lie between"),
        (("--video", "run.mp4", "--fps", "0"), "--fps"),
        (("--csv", "run.mcap"), "is the recording itself"),
    ],
)
def test_what_cannot_be_written_is_a_clear_error(
    recorded: Path, options: tuple[str, ...], says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(recorded.parent)
    before = recorded.read_bytes()
    result = export(recorded, *options)
    assert result.exit_code == 2
    assert says in result.stderr
    assert recorded.read_bytes() == before


def test_what_is_no_recording_is_a_clear_error(tmp_path: Path) -> None:
    (tmp_path / "run.mcap").write_text("(plan find)")
    assert "is not an MCAP file" in export(tmp_path / "run.mcap", "--csv", str(tmp_path / "a.csv")).stderr
    assert export(tmp_path / "none.mcap", "--csv", str(tmp_path / "a.csv")).exit_code == 2


def test_damage_further_in_is_told(recorded: Path, tmp_path: Path) -> None:
    data = bytearray(recorded.read_bytes())
    data[len(data) // 2] ^= 0xFF
    recorded.write_bytes(data)
    result = export(recorded, "--csv", str(tmp_path / "a.csv"))
    assert result.exit_code == 2
    assert "is damaged" in result.stderr


def test_of_a_run_that_was_cut_short_what_there_is_is_exported(recorded: Path, tmp_path: Path) -> None:
    data = recorded.read_bytes()
    recorded.write_bytes(data[: len(data) // 2])
    result = export(recorded, "--csv", str(tmp_path / "a.csv"))
    assert result.exit_code == 0
    assert "was cut short" in result.stderr
    assert 1 < len((tmp_path / "a.csv").read_text().splitlines()) < 22


# --- films ------------------------------------------------------------------------------------------

FAKE = "#!/bin/sh\nfor last; do :; done\n{}\n"


@pytest.fixture
def encoder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Puts a program named ffmpeg into the path, which does what a line of shell says; `$last` is the target."""

    def put(line: str) -> None:
        folder = tmp_path / "bin"
        folder.mkdir()
        (folder / "ffmpeg").write_text(FAKE.format(line))
        (folder / "ffmpeg").chmod(0o755)
        monkeypatch.setenv("PATH", f"{folder}:/usr/bin:/bin")

    return put


def test_a_film_shows_a_frame_for_each_moment(recorded: Path, tmp_path: Path, encoder: Callable[[str], None]) -> None:
    encoder('cat > "$last"')
    result = export(recorded, "--video", str(tmp_path / "run.mp4"), "--fps", "5", "--speed", "2")
    assert result.exit_code == 0, result.output
    assert "(6 frames)" in result.stdout, "2 s, at twice its speed, five frames a second, and the first"
    data = (tmp_path / "run.mp4").read_bytes()
    size = len(data) // 6
    assert size * 6 == len(data)
    frames = [data[k * size : (k + 1) * size] for k in range(6)]
    assert len({*frames}) == 6, "the robot moves from frame to frame"


def test_what_ffmpeg_complains_of_is_told(recorded: Path, tmp_path: Path, encoder: Callable[[str], None]) -> None:
    encoder('cat > /dev/null; echo "first" >&2; echo "no such codec" >&2; exit 1')
    result = export(recorded, "--video", str(tmp_path / "run.mp4"))
    assert result.exit_code == 2
    assert result.stderr.endswith("run.mp4: no such codec\n")


def test_ffmpeg_that_dies_at_once_is_told(recorded: Path, tmp_path: Path, encoder: Callable[[str], None]) -> None:
    encoder("exec <&-; exit 3")
    result = export(recorded, "--video", str(tmp_path / "run.mp4"))
    assert result.exit_code == 2
    assert "ffmpeg could not make" in result.stderr


def test_without_ffmpeg_it_says_how_to_get_it(recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    result = export(recorded, "--video", str(tmp_path / "run.mp4"))
    assert result.exit_code == 2
    assert "needs the program ffmpeg" in result.stderr


def test_a_film_of_nothing_is_a_clear_error(tmp_path: Path, encoder: Callable[[str], None]) -> None:
    encoder('cat > "$last"')
    with pytest.raises(ValueError, match="no ticks"):
        video.film(Recording(HEADER, []), tmp_path / "run.mp4")


def test_a_fault_in_the_drawing_leaves_no_encoder_behind(
    recorded: Path, tmp_path: Path, encoder: Callable[[str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    encoder('cat > "$last"')

    def fail(*_: object) -> bytes:
        raise ZeroDivisionError

    monkeypatch.setattr(video._Stage, "frame", fail)
    with pytest.raises(ZeroDivisionError):
        video.film(read(recorded), tmp_path / "run.mp4")


def test_a_scan_is_in_the_film_for_half_a_second(tmp_path: Path) -> None:
    import numpy as np

    from behaviours.interface import Odometry, Pose, Reading, Scan

    bearings = np.linspace(-1, 1, 50)
    scan = Scan(0.0, True, Pose(0.1, 0.0), bearings, np.full(50, 1.5), 0.05, 10.0)
    readings = [Reading(0.0, 0, Odometry(Pose(0, 0), 0, 0), lidar=scan)]
    ticks = [{"tick": n, "t": n / 10, "world": {"robot": [0.0, 0.0, 0.0]}, "plan": None} for n in range(12)]
    with_scan = video._Stage(run := Recording(HEADER, ticks, readings=readings), video.plot.track_of(run))
    without = video._Stage(bare := Recording(HEADER, ticks), video.plot.track_of(bare))
    seen = [with_scan.frame(k) != without.frame(k) for k in (0, 5, 8)]
    assert seen == [True, True, False]


def test_the_real_ffmpeg_makes_a_film_that_plays_and_without_it_there_is_none(recorded: Path, tmp_path: Path) -> None:
    result = export(recorded, "--video", str(tmp_path / "run.mp4"), "--fps", "10")
    if shutil.which("ffmpeg") is None:
        assert result.exit_code == 2
        return
    assert result.exit_code == 0
    asked = ["ffprobe", "-v", "error", "-show_entries", "stream=nb_frames", "-of", "csv=p=0", str(tmp_path / "run.mp4")]
    said = subprocess.run(asked, capture_output=True, check=True, text=True)
    assert int(said.stdout.strip().strip(",")) == math.floor(2.0 * 10 / 4) + 1
