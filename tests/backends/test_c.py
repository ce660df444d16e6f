"""C99: it compiles without a warning whatever the names, and a library is never taken for another one."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from properties.texts import compiled

from rplan.backends.c import CEngine, EngineError, emit_c, identifier, library
from rplan.backends.interpreter import Interpreter
from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port, Register
from rplan.circuit.stats import stats
from rplan.lang.source import Span

A, MEMORY = Cell(Op.INPUT, (), 0), Cell(Op.REGISTER, (), 0)
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion", "-Wmissing-prototypes", "-c")


def small(name: str, op: Op = Op.OR) -> Circuit:
    cells = (A, MEMORY, Cell(op, (0, 1)))
    return Circuit(name, (Port("set"),), (Register("on", op is Op.AND, 2),), cells, ((Port("out"), 2),))


def warnings(source: str, folder: Path) -> str:
    """What a C compiler says of it at its strictest."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    assert compiler is not None, "these tests need a C compiler (cc, gcc or clang) on the path"
    (folder / "plan.c").write_text(source, encoding="ascii")
    command = [compiler, *STRICT, "plan.c", "-o", "plan.o"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False).stderr


@pytest.mark.rule("L19")
def test_a_tick_is_the_same_gates_in_the_same_order_without_branch_loop_or_allocation(tmp_path: Path) -> None:
    plan = compiled("(goalem (if (lost) (do lamp on) (if (dark) (do lamp dim) (do anything))))").circuit
    for circuit in (plan, small("latch")):
        source = emit_c(circuit)
        assert warnings(source, tmp_path) == ""
        body = re.sub(r"/\*.*?\*/", "", source[source.rindex("_tick(") :])
        assert not re.search(r"\b(if|for|while|do|switch|goto|malloc)\b|\?", body)
        assert len(re.findall(r" [&|] |!n", body)) == stats(circuit).gates > 0


def test_places_and_names_stand_in_comments_and_constants() -> None:
    source = emit_c(compiled("(plan night-light)(goalem (when (lost) (do lamp on)))").circuit)
    assert " * inputs[0]: (lost) at test.rplan:1:33\n" in source
    assert " * outputs[1]: lamp=(on) at test.rplan:1:40\n" in source
    assert "    NIGHT_LIGHT_INPUT_LOST = 0,\n    NIGHT_LIGHT_INPUT_COUNT = 1\n" in source
    assert "    NIGHT_LIGHT_OUTPUT_HOLE = 0,\n    NIGHT_LIGHT_OUTPUT_LAMP_ON = 1,\n" in source
    assert "struct night_light_state {" in source
    assert "void night_light_tick(struct night_light_state *state, const unsigned char inputs[]" in source
    assert "    outputs[1] = n1; /* lamp=(on) at test.rplan:1:40 */\n" in source


@pytest.mark.parametrize(
    ("text", "name"),
    [("find-and-fetch", "find_and_fetch"), ("int", "int"), ("2nd", "plan_2nd"), ("", "plan"), ("größe", "gr_e"),
     ("_x__y_", "x_y"), ("日本", "plan"), ("(a (b 1.5m))", "a_b_1_5m")],
)  # fmt: skip
def test_any_name_gives_an_identifier(text: str, name: str) -> None:
    assert identifier(text) == name


NAMES = (
    "int",
    "*/ int x; /*",
    "a??/",
    "a\\",
    "count",
    "日本",
    "a\nb",
    "\u202e",
    "\udcff",
    "A",
    "a",
    "a 4",
    "a-10",
    "/*",
    "//",
)


def test_any_name_compiles_without_a_warning_and_keeps_its_number(tmp_path: Path) -> None:
    """Also names that are one identifier, key words, or ends of comments; and ports that nothing drives or reads."""
    ports = tuple(Port(name, (Span(f"{name}.rplan", 1, 1, 1, 2),)) for name in NAMES)
    cells = (*(Cell(Op.INPUT, (), n) for n in range(len(NAMES))), Cell(Op.CONSTANT, (), 1), Cell(Op.NOT, (0,)))
    registers = tuple(Register(name, False, number) for number, name in enumerate(NAMES))
    source = emit_c(Circuit("*/ 日", ports, registers, cells, tuple((port, n) for n, port in enumerate(ports))))
    assert warnings(source, tmp_path) == ""
    for kind in ("INPUT", "OUTPUT", "REGISTER"):
        constants = dict(re.findall(rf"^    PLAN_{kind}_(\w+) = (\d+)", source, re.MULTILINE))
        assert sorted(map(int, constants.values())) == [*range(len(NAMES) + 1)]


@pytest.mark.parametrize("registers", [(), (Register("r", True, 0),)])
def test_a_circuit_without_inputs_registers_or_outputs_compiles_too(
    registers: tuple[Register, ...], tmp_path: Path
) -> None:
    empty = Circuit("empty", (), registers, (Cell(Op.CONSTANT, (), 0),), ())
    assert warnings(emit_c(empty), tmp_path) == ""
    engine = CEngine(empty, tmp_path)
    assert engine.tick(()) == ()
    assert engine.registers == (False,) * len(registers)


def test_two_plans_of_one_name_are_two_libraries(tmp_path: Path) -> None:
    """A process that opens a path twice is given the first library both times."""
    one, two = CEngine(small("same"), tmp_path), CEngine(small("same", Op.AND), tmp_path)
    assert [one.tick((bit,)) for bit in (False, True, False)] == [(False,), (True,), (True,)]
    assert [two.tick((bit,)) for bit in (True, False, True)] == [(True,), (False,), (False,)]
    assert len(list(tmp_path.iterdir())) == 2


def test_engines_of_one_library_have_each_their_own_memory(tmp_path: Path) -> None:
    one, two = CEngine(small("twice"), tmp_path), CEngine(small("twice"), tmp_path)
    assert (one.tick((True,)), two.tick((False,))) == ((True,), (False,))
    assert (one.registers, two.registers) == ((True,), (False,))
    assert len(list(tmp_path.iterdir())) == 1


def test_any_true_byte_is_true_and_a_wrong_count_is_refused(tmp_path: Path) -> None:
    engine = CEngine(small("bytes"), tmp_path)
    with pytest.raises(ValueError, match="1 inputs are wanted, not 2"):
        engine.tick((True, True))
    assert engine.tick((7,)) == (True,)
    assert engine.tick((False,)) == Interpreter(small("bytes", Op.AND)).tick((True,))


def test_the_cache_is_where_the_system_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    path = library(emit_c(small("cached")))
    assert path.parent == tmp_path / "rplan" / "engines"
    written = path.stat().st_mtime_ns
    assert library(emit_c(small("cached"))) == path
    assert path.stat().st_mtime_ns == written, "compiled once"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert library(emit_c(small("cached"))).parent == tmp_path / "home" / ".cache" / "rplan" / "engines"


def test_without_a_compiler_the_error_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(EngineError, match=r"there is no C compiler .* install one"):
        CEngine(small("none"), tmp_path)


def test_what_the_compiler_refuses_is_told(tmp_path: Path) -> None:
    with pytest.raises(EngineError, match=r"refuses the generated source: .*error"):
        library("this is no C", tmp_path)


def test_a_cache_that_cannot_be_written_or_read_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(EngineError, match="file"):
        CEngine(small("nowhere"), tmp_path / "file")
    library(emit_c(small("broken")), tmp_path).write_bytes(b"no library")
    with pytest.raises(EngineError):
        CEngine(small("broken"), tmp_path)


def test_without_cffi_the_error_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cffi", None)
    with pytest.raises(EngineError, match=r"pip install 'rplan\[c\]'"):
        CEngine(small("without"), tmp_path)
