"""A circuit as C99.

Takes: a circuit. Gives: its source (`emit_c`) and an `Engine` that runs it (`CEngine`), compiled by the system's C
compiler; `EngineError` where there is none. Leaves alone: what the bits mean.

The source needs no header and no library, allocates nothing, has no loop and no branch: the same gates in the same
order in every tick (L19). Names are those of the plan as far as C takes them; comments carry the places in the plan.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port
from rplan.circuit.evaluate import Bits, first_registers

COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared")


class EngineError(RuntimeError):
    """The system cannot run a circuit this way."""


# --- the source -------------------------------------------------------------------------------------------


def emit_c(circuit: Circuit) -> str:
    """C99 source: `struct NAME_state`, `NAME_init`, `NAME_tick`, and enumerations of inputs, outputs and registers."""
    name = identifier(circuit.name)
    lines = [
        *_head(circuit),
        *_enumeration(name, "INPUT", [port.name for port in circuit.inputs]),
        *_enumeration(name, "OUTPUT", [port.name for port, _ in circuit.outputs]),
        *_enumeration(name, "REGISTER", [register.name for register in circuit.registers]),
        f"struct {name}_state {{",
        f"    unsigned char registers[{max(1, len(circuit.registers))}];",
        "};",
        "",
        f"void {name}_init(struct {name}_state *state);",
        f"void {name}_tick(struct {name}_state *state, const unsigned char inputs[], unsigned char outputs[]);",
        "",
        *_init(circuit, name),
        *_tick(circuit, name),
    ]
    return "\n".join(lines) + "\n"


def identifier(text: str) -> str:
    """A C identifier that looks like `text`: letters, digits and single underscores, a letter first."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_")
    return plain if plain[:1].isalpha() else f"plan_{plain}".rstrip("_")


def _head(circuit: Circuit) -> list[str]:
    """The comment that says what stands at which index."""
    lines = [
        f"/* {_comment(circuit.name)}",
        " *",
        " * Call ..._init once, then ..._tick in every tick. An input is true where it is not 0; an output is 0 or 1.",
        " *",
    ]
    lines += [f" * inputs[{number}]: {_at(port)}" for number, port in enumerate(circuit.inputs)]
    lines += [f" * outputs[{number}]: {_at(port)}" for number, (port, _) in enumerate(circuit.outputs)]
    lines += [f" * registers[{n}]: {_comment(register.name)}" for n, register in enumerate(circuit.registers)]
    return [*lines, " */", ""]


def _enumeration(name: str, kind: str, texts: Sequence[str]) -> list[str]:
    """Constants for indices, and how many there are."""
    prefix = f"{name}_{kind}".upper()
    count = f"{prefix}_COUNT"
    used = {count: len(texts)}
    for number, text in enumerate(texts):
        constant = f"{prefix}_{identifier(text).upper()}"
        while constant in used:
            constant += f"_{number}"
        used[constant] = number
    members = [f"    {constant} = {number}," for constant, number in used.items() if constant != count]
    return [f"enum {name}_{kind.lower()} {{", *members, f"    {count} = {len(texts)}", "};", ""]


def _init(circuit: Circuit, name: str) -> list[str]:
    firsts = [
        f"    state->registers[{number}] = {int(register.initial)}; /* {_comment(register.name)} */"
        for number, register in enumerate(circuit.registers)
    ]
    unused = "    state->registers[0] = 0; /* this plan remembers nothing */"
    return [f"void {name}_init(struct {name}_state *state)", "{", *(firsts or [unused]), "}", ""]


def _tick(circuit: Circuit, name: str) -> list[str]:
    lines = [
        f"void {name}_tick(struct {name}_state *state, const unsigned char inputs[], unsigned char outputs[])",
        "{",
    ]
    live = _live(circuit)
    lines += [
        f"    const unsigned char n{net} = {_expression(cell)};{_said(cell, circuit)}"
        for net, cell in enumerate(circuit.cells)
        if live[net]
    ]
    lines += ["    (void) state;", "    (void) inputs;", "    (void) outputs;"]
    lines += [f"    state->registers[{n}] = n{register.next};" for n, register in enumerate(circuit.registers)]
    lines += [f"    outputs[{n}] = n{net}; /* {_at(port)} */" for n, (port, net) in enumerate(circuit.outputs)]
    return [*lines, "}"]


def _live(circuit: Circuit) -> list[bool]:
    """Whether an output or a register needs a net; an unused constant would be a warning."""
    live = [False] * len(circuit.cells)
    for net in [net for _, net in circuit.outputs] + [register.next for register in circuit.registers]:
        live[net] = True
    for net in range(len(circuit.cells) - 1, -1, -1):
        for operand in circuit.cells[net].operands if live[net] else ():
            live[operand] = True
    return live


def _expression(cell: Cell) -> str:
    match cell.op:
        case Op.CONSTANT:
            return str(cell.index)
        case Op.INPUT:
            return f"inputs[{cell.index}] != 0"
        case Op.REGISTER:
            return f"state->registers[{cell.index}]"
        case Op.NOT:
            return f"!n{cell.operands[0]}"
        case Op.AND:
            return f"n{cell.operands[0]} & n{cell.operands[1]}"
        case Op.OR:
            return f"n{cell.operands[0]} | n{cell.operands[1]}"


def _said(cell: Cell, circuit: Circuit) -> str:
    match cell.op:
        case Op.INPUT:
            return f" /* {_comment(circuit.inputs[cell.index].name)} */"
        case Op.REGISTER:
            return f" /* {_comment(circuit.registers[cell.index].name)} */"
        case _:
            return ""


def _at(port: Port) -> str:
    places = ", ".join(dict.fromkeys(map(str, port.places)))
    return _comment(port.name + (f" at {places}" if places else ""))


def _comment(text: str) -> str:
    """Text that neither ends a comment, nor opens one, nor joins lines (a trigraph), nor leaves its line or ASCII."""
    plain = "".join(letter if letter.isprintable() else "?" for letter in text)
    plain = plain.replace("*/", "* /").replace("/*", "/ *").replace("??/", "?? /")
    return plain.encode("ascii", "backslashreplace").decode("ascii")


# --- the engine -------------------------------------------------------------------------------------------


def library(source: str, folder: Path | None = None) -> Path:
    """The shared library of a source, compiled unless `folder` (by default the user's cache) has it; `EngineError`.

    Its name is a hash of source and flags: a process that has loaded a library is never given another one for it.
    """
    folder = _cache() if folder is None else folder
    key = hashlib.sha256("\n".join((*FLAGS, source)).encode()).hexdigest()[:32]
    path = folder / f"{key}.so"
    if not path.exists():
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=folder) as scratch:
                _compile(source, Path(scratch)).replace(path)
        except OSError as error:
            raise EngineError(f"{error.filename or folder}: {error.strerror or error}") from error
    return path


def _cache() -> Path:
    base = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return (base if base.is_absolute() else Path.home() / ".cache") / "rplan" / "engines"


def _compile(source: str, scratch: Path) -> Path:
    compiler = next((found for name in COMPILERS if (found := shutil.which(name))), None)
    if compiler is None:
        raise EngineError(f"there is no C compiler ({', '.join(COMPILERS)}) on the path; install one, gcc for instance")
    text, compiled = scratch / "plan.c", scratch / "plan.so"
    text.write_text(source, encoding="ascii")
    command = [compiler, *FLAGS, "-o", str(compiled), str(text)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise EngineError(f"{compiler} refuses the generated source: {done.stderr.strip()}")
    return compiled


class CEngine:
    """Runs the compiled source of a circuit, with a state of its own; folder: where the library is kept."""

    def __init__(self, circuit: Circuit, folder: Path | None = None) -> None:
        ffi, loaded = _load(circuit, library(emit_c(circuit), folder))
        name = identifier(circuit.name)
        self._library = loaded
        self._init, self._tick = getattr(loaded, f"{name}_init"), getattr(loaded, f"{name}_tick")
        self._inputs = len(circuit.inputs)
        self._state = ffi.new(f"struct {name}_state *")
        self._outputs = ffi.new(f"unsigned char[{max(1, len(circuit.outputs))}]")
        self._seen = _view(ffi, self._outputs, len(circuit.outputs))
        self._remembered = _view(ffi, self._state.registers, len(first_registers(circuit)))
        self.reset()

    @property
    def registers(self) -> Bits:
        return tuple(self._remembered)

    def reset(self) -> None:
        self._init(self._state)

    def tick(self, inputs: Sequence[bool]) -> Bits:
        given = bytes(inputs)
        if len(given) != self._inputs:
            raise ValueError(f"{self._inputs} inputs are wanted, not {len(given)}")
        self._tick(self._state, given, self._outputs)
        return tuple(self._seen)


def _load(circuit: Circuit, path: Path) -> tuple[Any, Any]:
    try:
        from cffi import FFI
    except ImportError:
        raise EngineError("the engine in C needs cffi: pip install 'rplan[c]'") from None
    ffi = FFI()
    name = identifier(circuit.name)
    ffi.cdef(
        f"struct {name}_state {{ unsigned char registers[{max(1, len(circuit.registers))}]; }};"
        f"void {name}_init(struct {name}_state *);"
        f"void {name}_tick(struct {name}_state *, const unsigned char[], unsigned char[]);"
    )
    try:
        return ffi, ffi.dlopen(str(path))
    except OSError as error:
        raise EngineError(str(error)) from error


def _view(ffi: Any, array: Any, count: int) -> Iterable[bool]:
    """The bytes of an array as truth values, without a copy."""
    return memoryview(ffi.buffer(array))[:count].cast("?")
