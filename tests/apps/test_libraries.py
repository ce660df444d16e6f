"""Libraries of behaviours that do not come with rplan: installed ones, and files while they are written."""

from __future__ import annotations

from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from rplan.apps import libraries
from rplan.apps.cli import cli
from rplan.apps.libraries import LibraryError, catalogue

LIBRARY = '''"""Turning on the spot."""

from behaviours.interface import Command, Drive, Function, Library, Offer, Parameter, Report


class Spin:
    def __init__(self, rate):
        self.rate = rate

    def start(self, reading, channels):
        pass

    def step(self, reading, channels):
        return Command(drive=Drive(0.0, self.rate)), Report()

    def stop(self):
        pass


SPIN = Library(
    "spin",
    "Turning on the spot.",
    (Function("spin", "command", "Turn.", actuators=("drive",)), Function("dizzy", "bool", "Never.")),
    (Parameter("rate", "number", "rad/s", 0.5, "How fast."),),
    lambda values, workshop: Offer(percepts={"dizzy": lambda: False}, competences={"spin": Spin(values["rate"])}),
)
'''
PLAN = """(plan turning) (use spin :rate 30deg/s)
(defoutput action command)
(goalem (if (dizzy) (do anything) (do action (spin))))
"""
LOT = str(Path(__file__).parents[2] / "plans" / "find_and_fetch" / "parking_lot.yaml")


def rplan(*arguments: str) -> Result:
    return CliRunner().invoke(cli, arguments)


@pytest.fixture
def files(tmp_path: Path) -> tuple[str, str]:
    (tmp_path / "spin.py").write_text(LIBRARY)
    (tmp_path / "turning.rplan").write_text(PLAN)
    return str(tmp_path / "turning.rplan"), str(tmp_path / "spin.py")


def test_a_library_in_a_file_drives_the_robot(files: tuple[str, str]) -> None:
    result = rplan("simulate", files[0], "--library", files[1], "--scenario", LOT, "--until", "5", "--json")
    assert '"(spin)": {' in result.stdout
    assert '"faults": []' in result.stdout


@pytest.mark.parametrize("command", ["check", "compile", "ways", "prove", "test"])
def test_every_command_that_compiles_takes_it(files: tuple[str, str], command: str) -> None:
    assert rplan(command, files[0], "--library", files[1]).exit_code == 0
    without = rplan(command, files[0])
    assert without.exit_code == 1
    assert "unknown-library" in without.output


def test_list_says_what_it_offers(files: tuple[str, str]) -> None:
    said = rplan("list", "spin", "--library", files[1]).stdout
    assert "(spin)" in said
    assert ":rate" in said


def test_its_parameters_are_checked_as_those_of_any_library(files: tuple[str, str], tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.rplan"
    wrong.write_text(PLAN.replace("30deg/s", "3m"))
    result = rplan("check", str(wrong), "--library", files[1])
    assert result.exit_code == 1
    assert "unit-mismatch" in result.stderr


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("raise RuntimeError('no')", "cannot be loaded: RuntimeError: no"),
        ("def (", "cannot be loaded: SyntaxError"),
        ("x = 1", "has no behaviours.interface.Library"),
        (LIBRARY.replace('"spin",\n    "Turning', '"robot",\n    "Turning'), "there is a library `robot` already"),
    ],
)
@pytest.mark.rule("L24")
def test_a_file_that_is_no_library_is_told_plainly(
    files: tuple[str, str], tmp_path: Path, text: str, said: str
) -> None:
    bad = tmp_path / "bad.py"
    bad.write_text(text)
    result = rplan("check", files[0], "--library", str(bad))
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr


def test_a_file_that_is_not_there_is_told_plainly(files: tuple[str, str]) -> None:
    result = rplan("check", files[0], "--library", "nowhere.py")
    assert result.exit_code == 2
    assert "there is no file nowhere.py" in result.stderr


def test_installed_libraries_are_found_by_their_entry_points(monkeypatch: pytest.MonkeyPatch) -> None:
    point = EntryPoint("home", "behaviours.catalogue:ROBOT", libraries.GROUP)
    monkeypatch.setattr(libraries, "entry_points", lambda group: [point] if group == libraries.GROUP else [])
    monkeypatch.setattr(libraries, "LIBRARIES", {})
    assert list(catalogue()) == ["robot"]


@pytest.mark.parametrize(
    ("value", "said"), [("nowhere:X", "cannot be loaded"), ("behaviours.interface:STOP", "is no behaviours.interface")]
)
def test_an_entry_point_that_leads_nowhere_is_named(monkeypatch: pytest.MonkeyPatch, value: str, said: str) -> None:
    point = EntryPoint("bad", value, libraries.GROUP)
    monkeypatch.setattr(libraries, "entry_points", lambda group: [point])
    with pytest.raises(LibraryError, match=said):
        catalogue()
