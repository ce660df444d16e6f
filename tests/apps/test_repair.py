"""`rplan repair` says what it saved, leaves whole files alone, and has a clear word for all else."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli
from sim.recording import Recorder, read


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    with Recorder(tmp_path / "run.mcap", {"plan": None}) as recorder:
        for n in range(60):
            recorder.tick(n / 10, {"robot": [n / 50, 0.0, 0.0]}, "null")
    return tmp_path / "run.mcap"


def repair(path: Path, *options: str) -> Result:
    result = CliRunner().invoke(cli, ["repair", str(path), *options], catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


def cut(path: Path) -> Path:
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    return path


def test_it_says_how_much_it_saved_and_where(recorded: Path) -> None:
    result = repair(cut(recorded))
    ticks = list(read(recorded).ticks)
    assert result.exit_code == 0
    assert result.stdout == (
        f"saved {len(ticks)} ticks, {(len(ticks) - 1) / 10:.1f} s of simulated time\nwrote {recorded}\n"
    )
    assert not read(recorded).cut_short


def test_it_writes_elsewhere_where_that_is_asked(recorded: Path, tmp_path: Path) -> None:
    broken = cut(recorded).read_bytes()
    result = repair(recorded, "-o", str(tmp_path / "saved.mcap"))
    assert result.stdout.endswith(f"wrote {tmp_path / 'saved.mcap'}\n")
    assert recorded.read_bytes() == broken
    assert not read(tmp_path / "saved.mcap").cut_short


def test_a_whole_file_is_left_as_it_is(recorded: Path) -> None:
    before = recorded.read_bytes()
    result = repair(recorded)
    assert result.exit_code == 0
    assert result.stdout == f"{recorded} is whole (60 ticks, 5.9 s of simulated time): nothing to repair\n"
    assert recorded.read_bytes() == before


def test_garbage_a_missing_file_and_a_missing_folder_are_clear_errors(recorded: Path, tmp_path: Path) -> None:
    garbage = tmp_path / "garbage.mcap"
    garbage.write_bytes(bytes(range(256)) * 20)
    for result, says in (
        (repair(garbage), "garbage.mcap is not an MCAP file"),
        (repair(tmp_path / "none.mcap"), "none.mcap: No such file"),
        (repair(cut(recorded), "-o", str(tmp_path / "nowhere" / "run.mcap")), "No such file"),
        (repair(tmp_path), "Is a directory"),
    ):
        assert result.exit_code == 2
        assert result.stderr.startswith("error: ")
        assert says in result.stderr
