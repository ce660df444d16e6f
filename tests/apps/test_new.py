"""`rplan new`: a fresh project whose every command works, and which writes over nothing."""

from __future__ import annotations

import errno
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli
from rplan.apps.commands.new import project

ROOT = Path(__file__).parents[2]
COMMANDS = re.compile(r"^```sh\n(.*?)^```$", re.MULTILINE | re.DOTALL)
BARE = ["README.md", "pyproject.toml", "room.yaml", "shy_robot.rplan"]
FULL = [*BARE, "shy_robot.ticks", "stroll.py", "test_shy_robot.py"]


def rplan(*arguments: str) -> Result:
    return CliRunner().invoke(cli, arguments, catch_exceptions=False)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def done(line: str) -> Result:
    """A line of the README, pytest as a program of its own."""
    program, *arguments = shlex.split(line)
    if program == "rplan":
        return rplan(*arguments)
    assert program == "pytest"
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "NO_COLOR": "1"}
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *arguments]
    run = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert run.returncode == 0, run.stdout
    assert " passed" in run.stdout
    return rplan("--version")


@pytest.mark.parametrize("options", [[], ["--bare"]])
def test_every_command_of_the_readme_works_in_the_fresh_folder(
    options: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    made = rplan("new", "shy-robot", *options)
    assert made.exit_code == 0, made.output
    monkeypatch.chdir(tmp_path / "shy-robot")
    assert names(Path()) == (BARE if options else FULL)
    (block,) = COMMANDS.findall(Path("README.md").read_text(encoding="utf-8"))
    lines = block.splitlines()
    assert len(lines) >= 5
    for line in lines:
        assert done(line).exit_code == 0, line
    assert {"run.mcap", "run.html"} < set(names(Path()))


def test_the_line_to_go_on_with_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    last = rplan("new", "shy").stdout.splitlines()[-1]
    assert last == "Go on with: cd shy && rplan check . --library stroll.py"
    monkeypatch.chdir(tmp_path / "shy")
    assert rplan("check", ".", "--library", "stroll.py").stdout == "shy: the plan is sound (no hole)\n"


def test_the_line_to_go_on_with_works_in_a_folder_with_spaces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    last = rplan("new", "über uns/shy").stdout.splitlines()[-1]
    assert shlex.split(last)[3:8] == ["cd", "über uns/shy", "&&", "rplan", "check"]


def test_the_tests_of_the_project_notice_every_slip(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rplan("new", ".", "--name", "shy")
    result = rplan("mutate", ".", "--library", "stroll.py", "--at-least", "100")
    assert result.exit_code == 0, result.output


def test_no_file_is_written_over_and_then_none_is_written(tmp_path: Path) -> None:
    (tmp_path / "room.yaml").write_text("mine", encoding="utf-8")
    result = rplan("new", str(tmp_path), "--name", "shy")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == f"error: {tmp_path} has room.yaml already; nothing was written\n"
    assert names(tmp_path) == ["room.yaml"]
    assert (tmp_path / "room.yaml").read_text(encoding="utf-8") == "mine"


def test_a_link_that_leads_nowhere_is_a_file_too(tmp_path: Path) -> None:
    (tmp_path / "README.md").symlink_to(tmp_path / "elsewhere")
    assert rplan("new", str(tmp_path), "--name", "shy").exit_code == 2
    assert names(tmp_path) == ["README.md"]


def test_other_files_in_the_folder_stay(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine", encoding="utf-8")
    assert rplan("new", str(tmp_path), "--name", "shy", "--bare").exit_code == 0
    assert names(tmp_path) == ["README.md", "notes.txt", "pyproject.toml", "room.yaml", "shy.rplan"]


def test_a_file_in_the_place_of_the_folder_is_said(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("", encoding="utf-8")
    result = rplan("new", str(tmp_path / "taken" / "shy"))
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert "there is a file in its place" in result.stderr
    assert rplan("new", str(tmp_path / "taken")).exit_code == 2


def test_where_not_every_file_can_be_written_none_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = Path.write_text

    def full(path: Path, text: str, encoding: str) -> int:
        if path.name == "stroll.py":
            write(path, text[:10], encoding=encoding)
            raise OSError(errno.ENOSPC, "No space left on device", str(path))
        return write(path, text, encoding=encoding)

    monkeypatch.setattr(Path, "write_text", full)
    result = CliRunner().invoke(cli, ["new", str(tmp_path / "shy")])
    assert isinstance(result.exception, OSError)
    assert names(tmp_path / "shy") == []


@pytest.mark.parametrize(
    "name", ["", "2shy", "shy robot", "shy/robot", '"shy"', "shy\n", "-shy", "shy--robot", "ü", "s" * 65]
)
def test_a_name_that_no_plan_can_have_is_said(name: str, tmp_path: Path) -> None:
    result = rplan("new", str(tmp_path), f"--name={name}")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "is no name for a plan" in result.stderr
    assert names(tmp_path) == []


def test_a_folder_of_such_a_name_asks_for_another(tmp_path: Path) -> None:
    result = rplan("new", str(tmp_path / "my robot"))
    assert result.exit_code == 2
    assert "give one with --name" in result.stderr
    assert names(tmp_path) == []


def test_the_bare_plan_has_ten_lines() -> None:
    assert len(project("shy", bare=True)["shy.rplan"].splitlines()) == 10


def test_every_file_carries_the_name_and_no_placeholder_is_left() -> None:
    for text in (*project("a-b").values(), *project("a-b", bare=True).values()):
        assert "$" not in text
    assert project("a-b")["a_b.ticks"].startswith("; a_b.rplan\n")


def test_the_plans_are_laid_out(tmp_path: Path) -> None:
    for options in ([], ["--bare"]):
        folder = tmp_path / f"shy{len(options)}"
        rplan("new", str(folder), *options)
        assert rplan("fmt", "--check", str(folder)).exit_code == 0
