"""`rplan fmt`: files laid out in place, on stdout, or only compared; exit codes of L24."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import cli

PLANS = Path(__file__).parents[2] / "plans"
MESSY = "(plan rest)\n(defgoalr (maint rest)\n(do action (stop))) ; why\n\n\n\n(goalem (maint rest))"
NEAT = "(plan rest)\n(defgoalr (maint rest)\n  (do action (stop)))  ; why\n\n(goalem (maint rest))\n"


def fmt(*arguments: str) -> Result:
    return CliRunner().invoke(cli, ["fmt", *arguments], catch_exceptions=False)


@pytest.fixture
def messy(tmp_path: Path) -> Path:
    path = tmp_path / "messy.rplan"
    path.write_text(MESSY, encoding="utf-8")
    return path


@pytest.mark.rule("L24")
def test_a_file_is_laid_out_in_place_and_then_left_alone(messy: Path) -> None:
    first = fmt(str(messy))
    assert (first.exit_code, first.stdout, first.stderr) == (0, "", f"{messy}: laid out\n")
    assert messy.read_text(encoding="utf-8") == NEAT
    before = messy.stat().st_mtime_ns
    assert fmt(str(messy)).output == ""
    assert messy.stat().st_mtime_ns == before


@pytest.mark.rule("L24")
def test_check_writes_nothing_and_ends_with_1(messy: Path) -> None:
    result = fmt("--check", str(messy))
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr == f"{messy}: not in the canonical layout\n"
    assert messy.read_text(encoding="utf-8") == MESSY
    fmt(str(messy))
    assert fmt("--check", str(messy)).exit_code == 0


def test_stdout_has_the_text_and_the_file_keeps_its_own(messy: Path) -> None:
    result = fmt("--stdout", str(messy))
    assert (result.exit_code, result.stdout, result.stderr) == (0, NEAT, "")
    assert messy.read_text(encoding="utf-8") == MESSY


def test_check_looks_at_every_file_and_names_the_ones_that_differ(messy: Path, tmp_path: Path) -> None:
    neat, last = tmp_path / "neat.rplan", tmp_path / "last.rplan"
    neat.write_text(NEAT, encoding="utf-8")
    last.write_text(MESSY, encoding="utf-8")
    result = fmt("--check", str(messy), str(neat), str(last))
    assert result.exit_code == 1
    assert [line.split(": ")[0] for line in result.stderr.splitlines()] == [str(messy), str(last)]


def test_lines_that_end_as_elsewhere_are_mended(tmp_path: Path) -> None:
    path = tmp_path / "windows.rplan"
    path.write_bytes(NEAT.replace("\n", "\r\n").encode())
    assert fmt("--check", str(path)).exit_code == 1
    assert fmt(str(path)).exit_code == 0
    assert path.read_bytes() == NEAT.encode()


@pytest.mark.rule("L24")
def test_a_broken_plan_is_said_to_be_broken_and_left_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "broken.rplan"
    path.write_text("(goalem (do a b)", encoding="utf-8")
    result = fmt(str(path))
    assert (result.exit_code, result.stdout) == (1, "")
    assert "error[missing-parenthesis]" in result.stderr
    assert path.read_text(encoding="utf-8") == "(goalem (do a b)"


@pytest.mark.rule("L24")
@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ([], "Missing argument"),
        (["nowhere.rplan"], "there is no file or folder nowhere.rplan"),
        (["--check", "--stdout", str(PLANS / "make_room")], "--stdout goes with neither --check nor --json"),
    ],
)
def test_wrong_use_ends_with_2(arguments: list[str], says: str) -> None:
    result = fmt(*arguments)
    assert result.exit_code == 2
    assert says in result.stderr


@pytest.mark.parametrize("path", sorted(PLANS.glob("[!f]*/*.rplan")) + sorted(PLANS.glob("fe*/*.rplan")))
def test_plans_that_come_with_rplan_are_in_the_canonical_layout(path: Path) -> None:
    """All but those of Figure 1, which keep the line breaks of the print."""
    assert fmt("--check", str(path)).output == ""


@pytest.mark.rule("L24")
def test_json_says_which_texts_change(tmp_path: Path) -> None:
    crooked, straight = tmp_path / "crooked.rplan", tmp_path / "straight.rplan"
    crooked.write_text("(goalem\n      (do a (b)))\n")
    straight.write_text("(goalem (do a (b)))\n")
    result = CliRunner().invoke(cli, ["fmt", "--check", "--json", str(crooked), str(straight)])
    assert result.exit_code == 1
    said = [(Path(one["plan"]).name, one["changed"]) for one in json.loads(result.stdout)["plans"]]
    assert said == [("crooked.rplan", True), ("straight.rplan", False)]
