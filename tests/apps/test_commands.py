"""The command line, as a user meets it: exit codes (L24), what goes to stdout and what to stderr, never a traceback."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from rplan.apps.cli import COMMANDS, cli

ERRORS = Path(__file__).parents[1] / "errors"
PLANS = Path(__file__).parents[2] / "plans"
FIND = str(PLANS / "find_and_fetch")
TEXT = str(PLANS / "figure_1" / "text.rplan")
HOLE = "(goalem (and (when (lost) (do a stop)) (when (found) (do a go))))"
Write = Callable[..., str]


def rplan(*arguments: str, stdin: str | bytes = "") -> Result:
    """What a command does; an exception that it lets through fails the test."""
    result = CliRunner().invoke(cli, arguments, input=stdin, catch_exceptions=False)
    assert "Traceback" not in result.output
    return result


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Writes a file and gives its path."""

    def put(content: str | bytes, name: str = "test.rplan") -> str:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return str(path)

    return put


# --- which file is meant ----------------------------------------------------------------------------


@pytest.mark.rule("L24")
@pytest.mark.parametrize("command", ["check", "compile", "ways", "tick", "simulate"])
def test_a_missing_file_is_said_to_be_missing(command: str) -> None:
    result = rplan(command, "nowhere/plan.rplan")
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "there is no file or folder nowhere/plan.rplan" in result.stderr
    assert "find_and_fetch" in result.stderr


@pytest.mark.rule("L24")
def test_a_folder_needs_one_plan_or_one_of_its_own_name(tmp_path: Path) -> None:
    folder = tmp_path / "patrol"
    folder.mkdir()
    assert "has no plan" in rplan("check", str(folder)).stderr
    (folder / "a.rplan").write_text("(goalem (do x one))")
    assert rplan("check", str(folder)).exit_code == 0
    (folder / "b.rplan").write_text("(goalem (do x one))")
    several = rplan("check", str(folder))
    assert several.exit_code == 2
    assert "a.rplan" in several.stderr
    assert "b.rplan" in several.stderr
    (folder / "patrol.rplan").write_text("(goalem (do x one))")
    assert rplan("check", str(folder)).stdout.startswith("patrol: ")


@pytest.mark.parametrize("name", ["find_and_fetch", "plans/find_and_fetch", "figure_1/text.rplan"])
def test_a_plan_that_comes_with_rplan_is_found_by_name_from_anywhere(
    name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    assert rplan("check", name).exit_code == 0


@pytest.mark.rule("L24")
def test_a_file_that_the_system_does_not_give_is_said_so(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write("(goalem (do x one))")

    def refuse(self: Path) -> bytes:
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr(Path, "read_bytes", refuse)
    result = rplan("check", path)
    assert (result.exit_code, result.stderr) == (2, f"error: {path}: Permission denied\n")


@pytest.mark.rule("L24")
def test_an_unknown_command_is_refused_with_the_known_ones() -> None:
    slip = rplan("simulat", "x")
    assert slip.exit_code == 2
    assert "Did you mean 'simulate'?" in slip.stderr
    other = rplan("zzz")
    assert other.exit_code == 2
    assert f"There are: {', '.join(COMMANDS)}." in other.stderr
    assert rplan("--wrong").exit_code == 2


def test_help_names_every_command_and_every_command_has_help() -> None:
    overview = rplan("--help")
    assert overview.exit_code == 0
    for name in COMMANDS:
        assert name in overview.stdout
        assert rplan(name, "--help").exit_code == 0
    assert rplan("--version").stdout.startswith("rplan, version ")


# --- check ------------------------------------------------------------------------------------------


@pytest.mark.rule("L24")
def test_a_sound_plan_is_said_to_be_sound() -> None:
    result = rplan("check", FIND, "--strict")
    assert (result.exit_code, result.stdout, result.stderr) == (
        0, "find-and-fetch: the plan is sound (no hole)\n", "",
    )  # fmt: skip


@pytest.mark.rule("L24")
@pytest.mark.parametrize(
    ("content", "code"),
    [
        (bytes(range(256)) * 4, "not-text"),
        (b"(goalem (do x \xff\xfe))", "not-text"),
        (b"", "empty-plan"),
        (b"; nothing but words\n", "empty-plan"),
        (b"\x00\x00", "error["),
        (b"(" * 5_000, "error["),
        (b"PK\x03\x04 binary", "error["),
    ],
)
def test_a_plan_that_is_none_is_an_error_with_its_place(write: Write, content: bytes, code: str) -> None:
    result = rplan("check", write(content))
    assert (result.exit_code, result.stdout) == (1, "")
    assert code in result.stderr
    assert "  --> " in result.stderr


def test_what_a_terminal_would_obey_is_not_printed(write: Write) -> None:
    result = rplan("check", write("(goalem (do x \x1b[31m))"))
    assert "\x1b" not in result.stderr
    assert "�[31m" in result.stderr


@pytest.mark.rule("L24")
def test_all_five_mistakes_of_a_plan_are_reported_with_their_places_on_stderr(write: Write) -> None:
    text = (ERRORS / "five-mistakes.txt").read_text(encoding="utf-8").partition("----\n")[0]
    path = write(text)
    result = rplan("check", path)
    assert (result.exit_code, result.stdout) == (1, "")
    for place in ("2:40", "4:2", "7:3", "9:29", "10:1"):
        assert f"--> {path}:{place}\n" in result.stderr
    assert result.stderr.endswith("\n5 errors\n")


@pytest.mark.rule("L18")
@pytest.mark.parametrize("command", ["check", "compile", "tick"])
def test_a_hole_is_an_error_unless_holes_are_allowed(command: str, write: Write) -> None:
    path = write(HOLE)
    refused = rplan(command, path)
    assert (refused.exit_code, refused.stdout) == (1, "")
    assert "error[hole]" in refused.stderr
    assert "when: (lost) and (found)" in refused.stderr
    allowed = rplan(command, path, "--allow-holes")
    assert allowed.exit_code == 0
    assert "warning[hole]" in allowed.stderr


def test_strict_makes_an_unknown_name_an_error(write: Write) -> None:
    path = write("(goalem (when (lost) (do lamp on)))")
    assert rplan("check", path).exit_code == 0
    for command in ("check", "compile", "tick"):
        assert rplan(command, path, "--strict").exit_code == 1


def test_many_notes_are_cut_short_and_findings_are_counted() -> None:
    said = rplan("check", TEXT).stderr
    assert said.count("note[undeclared]") == 8
    assert "… and 15 more notes (all of them with --json)" in said
    assert said.endswith("\n23 notes\n")


def test_one_warning_is_counted_as_one(write: Write) -> None:
    said = rplan("check", write('(declare (far) bool "") (goalem (do anything))')).stderr
    assert said.endswith("\n1 warning\n")


def test_holes_that_could_not_be_decided_are_not_called_none(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    from rplan.ways.reach import Reach
    from rplan.ways.situations import Undecided

    monkeypatch.setattr(Reach, "trace", lambda reach, *question: Undecided())
    assert "(holes not decided)" in rplan("check", write("(goalem (do anything))")).stdout


# --- JSON -------------------------------------------------------------------------------------------


def read(*arguments: str, code: int = 0) -> Any:
    result = rplan(*arguments, "--json")
    assert result.exit_code == code
    return json.loads(result.stdout)


@pytest.mark.rule("L24")
def test_every_command_that_reports_speaks_json(write: Write) -> None:
    checked = read("check", FIND)
    assert checked["ok"]
    assert {one["severity"] for one in checked["diagnostics"]} == {"note"}
    costs = read("compile", FIND)
    assert (costs["plan"], costs["ways"], costs["inputs"], costs["registers"]) == ("find-and-fetch", 19, 12, 0)
    assert costs["operations"] == costs["gates"] > 30
    assert 0 < costs["longest_path_in_python"] < costs["gates"]
    assert {plan["plan"].split("/")[-1] for plan in read("list")["plans"]} >= {"find_and_fetch.rplan", "text.rplan"}
    assert read("list", "runaway")["name"] == "runaway"
    assert read("ways", TEXT, "--paper") == {"ways": 63, "distinct": 36, "taken": 31, "situations": 4096, "holes": 0}
    ways = read("ways", FIND)["ways"]
    assert len(ways) == 19
    assert any(act["value"] == "(move-away-from-danger)" for way in ways for act in way["acts"])


@pytest.mark.rule("L24")
def test_a_wrong_plan_is_wrong_in_json_too(write: Write) -> None:
    for command in ("check", "compile", "ways"):
        said = read(command, write("(goalem (ach nothing))"), code=1)
        assert said["ok"] is False
        (found,) = said["diagnostics"]
        assert (found["code"], found["severity"], found["place"]["line"]) == ("no-rule", "error", 1)


# --- compile ----------------------------------------------------------------------------------------


def test_a_report_says_what_a_tick_costs() -> None:
    lines = rplan("compile", FIND).stdout.splitlines()
    assert lines[0] == "find-and-fetch: a tick every 0.1 s"
    assert [line.rsplit(maxsplit=1)[0].strip() for line in lines[1:]] == [
        "ways that can be taken", "inputs", "outputs", "registers", "gates", "depth", "operations a tick",
        "longest path in Python",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("form", "begins"),
    [
        ("sexp", "(circuit find-and-fetch"),
        ("python", "# Longest path: "),
        ("c", "/* find-and-fetch\n"),
        ("dot", 'digraph "find-and-fetch" {'),
        ("svg", "<svg "),
        ("json", "{"),
    ],
)
def test_a_circuit_is_emitted_in_every_form_to_stdout_or_into_a_file(form: str, begins: str, tmp_path: Path) -> None:
    printed = rplan("compile", FIND, "--emit", form)
    assert (printed.exit_code, printed.stderr) == (0, "")
    assert printed.stdout.startswith(begins)
    target = tmp_path / "circuit"
    written = rplan("compile", FIND, "--emit", form, "-o", str(target))
    assert (written.exit_code, written.stdout) == (0, "")
    assert target.read_text(encoding="utf-8") == printed.stdout


def test_an_emitted_circuit_is_whole() -> None:
    circuit = json.loads(rplan("compile", FIND, "--emit", "json").stdout)
    assert circuit["inputs"][0]["name"] == "(anything-is-too-close)"
    assert all(operand < net for net, cell in enumerate(circuit["cells"]) for operand in cell["operands"])
    assert circuit["outputs"][0] == {
        "name": "hole", "net": circuit["outputs"][0]["net"], "places": circuit["outputs"][0]["places"],
    }  # fmt: skip
    scope: dict[str, Any] = {}
    exec(rplan("compile", FIND, "--emit", "python").stdout, scope)
    outputs, registers = scope["tick"]((True, *(False,) * 11))
    assert (sum(outputs), registers) == (2, ())


@pytest.mark.rule("L24")
def test_an_output_that_cannot_be_written_is_said_so(tmp_path: Path) -> None:
    result = rplan("compile", FIND, "-o", str(tmp_path / "nowhere" / "x"))
    assert result.exit_code == 2
    assert "No such file or directory" in result.stderr
    assert rplan("compile", FIND, "--emit", "vhdl").exit_code == 2


# --- ways -------------------------------------------------------------------------------------------


@pytest.mark.rule("L23")
def test_the_ways_of_the_paper_are_63() -> None:
    assert rplan("ways", TEXT, "--paper").stdout == (
        "63 ways (36 distinct, 31 ever taken)\nno hole in 4,096 situations\n"
    )


def test_holes_are_counted_among_situations_where_these_can_be_counted(write: Write) -> None:
    assert rplan("ways", write(HOLE), "--paper").stdout.endswith("1 hole in 4 situations\n")
    numbers = write("(goalem (when (< (d) 2m) (do x one)))", "numbers.rplan")
    assert rplan("ways", numbers, "--paper").stdout == "2 ways (2 distinct, 2 ever taken)\n"
    assert "situations" not in read("ways", numbers, "--paper")


def test_ways_are_listed_with_acts_rules_what_they_give_up_and_a_situation(write: Write) -> None:
    path = write("(defgoalr (ach a) (when (p) (do x one)))\n(goalem (prio-and (ach a) (do x two)))")
    listed = rplan("ways", path).stdout
    assert "x=(one)" in listed
    assert "gives up (do x (two)): x would be (two), and (ach a) sets it to (one)" in listed
    assert "by (ach a)" in listed
    assert listed.endswith("\n2 ways can be taken\n")
    assert rplan("ways", path, "--limit", "1").stdout.endswith("there may be more (--limit 1)\n")
    assert "(sets nothing)" in rplan("ways", write("(goalem (do anything))", "nothing.rplan")).stdout


# --- list -------------------------------------------------------------------------------------------


def test_plans_and_libraries_are_listed() -> None:
    listed = rplan("list").stdout
    assert "find_and_fetch/find_and_fetch.rplan  (scenarios: parking_lot.yaml)" in listed
    assert "runaway" in listed
    details = rplan("list", "runaway").stdout
    assert "(anything-is-too-close)" in details
    assert ":safety-radius" in details
    assert "Parameters" not in rplan("list", "robot").stdout


@pytest.mark.rule("L24")
def test_an_unknown_library_is_refused() -> None:
    result = rplan("list", "flying")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "there are: robot, runaway" in result.stderr


def test_the_ways_of_plans_that_are_large_or_compare_numbers_are_counted_too(write: Write) -> None:
    many = write("(goalem (and " + " ".join(f"(when (p{n}) (do x{n} on))" for n in range(25)) + "))")
    costs = read("compile", many)
    assert costs["ways"] > 1_000
    assert costs["ways_exact"] is False
    assert re.search(r"ways that can be taken +≥ 1,", rplan("compile", many).stdout)
    numbers = read("compile", write("(goalem (cond ((< (d) 2) (do x on)) ((< (d) 1) (do x off))))", "numbers.rplan"))
    assert (numbers["ways"], numbers["ways_exact"]) == (2, True)
