"""The entry point: what ends with which exit code, and never with a traceback (L24)."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from rplan.apps import cli, libraries
from rplan.apps.commands import import_, map, reproduce
from rplan.apps.drawing import map as drawn
from rplan.apps.reproduce.row import PRESETS
from rplan.lang.diagnostic import InternalError
from sim.robots.models import MODELS
from sim.scenarios import importers

Ends = Callable[[Exception], tuple[int, str]]
PLANS = Path(__file__).parents[2] / "plans"


@pytest.fixture
def ends(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[[Exception], tuple[int, str]]:
    """Lets a command raise; gives the exit code and what stderr says."""

    def run(error: Exception) -> tuple[int, str]:
        def command() -> None:
            raise error

        monkeypatch.setattr(cli, "cli", command)
        with pytest.raises(SystemExit) as caught:
            cli.main()
        said = capsys.readouterr().err
        assert "Traceback" not in said
        return int(str(caught.value.code)), said

    return run


@pytest.mark.rule("L24")
@pytest.mark.parametrize("error", [InternalError("net 3 reads itself"), ZeroDivisionError("by zero")])
def test_a_fault_of_rplan_exits_with_70_and_says_whose_fault_it_is(ends: Ends, error: Exception) -> None:
    code, said = ends(error)
    assert code == 70
    assert said.startswith(f"rplan has a fault of its own: {type(error).__name__}: {error} (")
    assert "test_main:" in said, "where it happened"
    assert "Nothing is wrong with your plan as far as is known" in said


@pytest.mark.rule("L24")
def test_what_the_system_refuses_exits_with_2(ends: Ends) -> None:
    assert ends(OSError(28, "No space left on device")) == (2, "error: No space left on device\n")
    assert ends(OSError(36, "File name too long", "aaa")) == (2, "error: aaa: File name too long\n")


@pytest.mark.rule("L24")
@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["check", "find_and_fetch"], 0, ""),
        (["--version"], 0, ""),
        (["check"], 2, "Missing argument 'PLAN'"),
        (["check", "nowhere"], 2, "error: there is no file or folder nowhere"),
        (["fly"], 2, "There is no command 'fly'"),
        (["simulate", "find_and_fetch", "--until", "1"], 1, ""),
    ],
)
def test_exit_codes_are_those_of_the_commands(
    arguments: list[str], code: int, said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["rplan", *arguments])
    with pytest.raises(SystemExit) as caught:
        cli.main()
    assert (caught.value.code or 0) == code
    assert said in capsys.readouterr().err


@pytest.mark.rule("L24")
def test_an_internal_error_inside_a_command_reaches_the_entry_point(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(ways: object) -> None:
        raise InternalError("no circuit")

    monkeypatch.setattr("rplan.driver.build", broken)
    monkeypatch.setattr(sys, "argv", ["rplan", "check", str(PLANS / "find_and_fetch")])
    with pytest.raises(SystemExit) as caught:
        cli.main()
    assert caught.value.code == 70
    assert "InternalError: no circuit" in capsys.readouterr().err


def test_a_fault_of_a_library_of_the_users_is_told_apart(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    library = "from behaviours.interface import Library\ndef build(values, workshop):\n    return {}[1]\n"
    (tmp_path / "arm.py").write_text(library + "ARM = Library('arm', '', (), (), build)\n", encoding="utf-8")
    (tmp_path / "plan.rplan").write_text("(use arm)(goalem (when (lost) (do lamp on)))", encoding="utf-8")
    given = ["check", str(tmp_path / "plan.rplan"), "--library", str(tmp_path / "arm.py")]
    monkeypatch.setattr(sys, "argv", ["rplan", *given])
    with pytest.raises(SystemExit) as caught:
        cli.main()
    assert caught.value.code == 2
    assert capsys.readouterr().err == f"error: {tmp_path}/arm.py:3: the library fails: KeyError: 1\n"


def test_so_is_a_fault_of_a_library_that_is_installed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    package = tmp_path / "their_arm"
    package.mkdir()
    (package / "__init__.py").write_text("", encoding="utf-8")
    (package / "inside.py").write_text(
        "def deep():\n    return __import__('fractions').Fraction(1, 0)\n", encoding="utf-8"
    )
    library = "from behaviours.interface import Library\nfrom their_arm.inside import deep\n"
    library += "def build(values, workshop):\n    return deep()\nARM = Library('arm', '', (), (), build)\n"
    (package / "offers.py").write_text(library, encoding="utf-8")
    information = tmp_path / "their_arm-1.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: their-arm\nVersion: 1.0\n", encoding="utf-8")
    (information / "entry_points.txt").write_text("[rplan.libraries]\narm = their_arm.offers:ARM\n", encoding="utf-8")
    (tmp_path / "plan.rplan").write_text("(use arm)(goalem (when (lost) (do lamp on)))", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "argv", ["rplan", "check", str(tmp_path / "plan.rplan")])
    with pytest.raises(SystemExit) as caught:
        cli.main()
    assert caught.value.code == 2
    said = capsys.readouterr().err
    assert said.startswith(f"error: {package}/inside.py:2: the library fails: ZeroDivisionError: ")
    assert "report" not in said
    assert cli.INSTALLED == libraries.GROUP


def apart(*arguments: str, stdout: int = subprocess.PIPE) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-c", "from rplan.apps.cli import main; main()"]
    return subprocess.Popen(
        [*command, *arguments], stdin=subprocess.PIPE, stdout=stdout, stderr=subprocess.PIPE, env={**os.environ}
    )


def test_a_terminal_without_the_letters_shows_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONIOENCODING", "latin-1")
    with apart("inspect", str(PLANS / "make_room"), "--table") as process:
        said, wrong = process.communicate()
    assert (process.returncode, wrong) == (0, b"")
    assert "  ?  action=(move-away-from-danger)" in said.decode("latin-1")


def test_a_reader_that_goes_away_is_left_without_a_word() -> None:
    with apart("list", "--json") as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""


@pytest.mark.rule("L22")
def test_each_line_of_a_tick_is_answered_before_the_next_is_given(tmp_path: Path) -> None:
    plan = tmp_path / "plan.rplan"
    plan.write_text("(goalem (when (lost) (do lamp on)))")
    with apart("tick", str(plan)) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stderr is not None
        for number, lost in enumerate(("true", "false", "true")):
            process.stdin.write(f'{{"lost": {lost}}}\n'.encode())
            process.stdin.flush()
            assert process.stdout.readline().startswith(f'{{"tick": {number}, '.encode())
        process.stdin.close()
        process.stderr.read()
    assert process.returncode == 0


# --- help ---------------------------------------------------------------------------------------------

HEAVY = ("numpy", "z3", "lark", "pymunk", "foxglove", "rich", "behaviours", "sim", "rplan.driver", "rplan.ways")


@pytest.mark.parametrize("option", ["--help", "--nonsense"])
def test_help_and_wrong_options_are_answered_without_the_compiler_and_the_simulator(option: str) -> None:
    program = (
        "import sys\nfrom rplan.apps.cli import COMMANDS, cli\n"
        "for command in COMMANDS:\n"
        f"    try: cli([command, {option!r}])\n    except SystemExit: pass\n"
        f"    loaded = [name for name in {HEAVY!r} if name in sys.modules]\n"
        "    if loaded: sys.exit(f'{command} loads {loaded}')\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr.splitlines()[-1]
    assert (done.stdout + done.stderr).count("Usage: ") == len(cli.COMMANDS)


def test_what_help_names_without_loading_it_is_what_there_is() -> None:
    assert import_.FORMATS == importers.FORMATS
    assert (*MODELS,) == import_.MODELS
    assert map.STYLES == drawn.STYLES
    assert (*PRESETS, "both") == reproduce.PRESETS
