"""A circuit as generated Python.

Takes: a circuit. Gives: its source text (`emit`, `generate` with what it costs) and an `Engine` that runs it
(`PythonEngine`). Leaves alone: what the bits mean.

Where a tree of tests that is small enough decides the outputs, the code is that tree: it asks an input only where the
answer matters, and returns one of the few settings of the outputs, all made beforehand. Elsewhere every gate is an
expression: one that is read once stands inside the expression that reads it, so that `and` and `or` stop early; the
others get a name. Either way every register is evaluated in every tick (L11, L19). Comments carry the places in the
plan.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit, Port
from rplan.circuit.decisions import MOST_NODES, Leaf, Test, Tree, decisions, depth_of, nodes_of
from rplan.circuit.evaluate import Bits, first_registers

LONGEST = 40
"""Gates in one expression, at most: keeps the parser of Python from nesting too deep."""


@dataclass(frozen=True, slots=True)
class Generated:
    """Source of `tick(inputs, registers) -> (outputs, registers)`.

    form: whether outputs are decided by a tree or by expressions. tests: inputs and registers asked on the longest path
    of the tree. gates: evaluated besides, at most: those of the registers, without a tree all. ends: of the tree.
    """

    source: str
    form: Literal["tree", "expressions"]
    tests: int
    gates: int
    ends: int

    @property
    def longest(self) -> int:
        """Tests and gates on the longest path (L19)."""
        return self.tests + self.gates


def emit(circuit: Circuit) -> str:
    """Python source of `tick(inputs, registers) -> (outputs, registers)`."""
    return generate(circuit).source


def generate(circuit: Circuit, most: int = MOST_NODES) -> Generated:
    """The source and its cost; a tree of more than `most` nodes is not written out."""
    tree = decisions(circuit, most)
    return _expressions(circuit) if tree is None else _tree(circuit, tree)


# --- a tree of tests --------------------------------------------------------------------------------------


def _tree(circuit: Circuit, tree: Tree) -> Generated:
    body = _Writer(circuit, [register.next for register in circuit.registers])
    ends = _ends(tree)
    numbers = {outputs: number for number, outputs in enumerate(ends)}
    tests, leaves, gates = depth_of(tree), (nodes_of(tree) + 1) // 2, body.gates
    lines = [f"# Longest path: {tests} tests, and {gates} gates for registers; {leaves} paths."]
    lines += [f"# Output {number}: {_at(port)}" for number, (port, _) in enumerate(circuit.outputs)]
    for outputs, number in numbers.items():
        lines += _setting(circuit, outputs, number)
    lines += ["", "", "def tick(inputs, registers=()):"]
    lines += [f"    {name} = {source}  # {said}" for name, source, said in body.loads]
    lines += body.lines
    if circuit.registers:
        lines.append(f"    after = ({body.texts(register.next for register in circuit.registers)})")
    lines += _branches(circuit, tree, numbers, {name for name, _, _ in body.loads})
    return Generated("\n".join(lines) + "\n", "tree", tests, gates, leaves)


def _ends(tree: Tree) -> list[Bits]:
    """Every setting of the outputs once, in the order in which the code comes to them."""
    found: dict[Bits, None] = {}
    seen: set[int] = set()
    waiting = [tree]
    while waiting:
        one = waiting.pop()
        if id(one) in seen:
            continue
        seen.add(id(one))
        match one:
            case Leaf(outputs):
                found[outputs] = None
            case Test():
                waiting += _in_order(one)[1:][::-1]
    return list(found)


def _in_order(test: Test) -> tuple[bool, Tree, Tree]:
    """(whether the test is turned round, the indented branch, the one that goes on): the smaller is indented, so that
    the code nests no deeper than the logarithm of its size."""
    if nodes_of(test.low) < nodes_of(test.high):
        return True, test.low, test.high
    return False, test.high, test.low


def _setting(circuit: Circuit, outputs: Bits, number: int) -> list[str]:
    on = [f"#   {_at(port)}" for (port, _), bit in zip(circuit.outputs, outputs, strict=True) if bit]
    value = f"({''.join(f'{bit}, ' for bit in outputs)})"
    return ["", *(on or ["#   nothing is set"]), f"OUT_{number} = {value if circuit.registers else f'({value}, ())'}"]


def _branches(circuit: Circuit, tree: Tree, numbers: dict[Bits, int], loaded: set[str]) -> list[str]:
    after = ", after" if circuit.registers else ""
    lines: list[str] = []
    waiting: list[tuple[Tree, int]] = [(tree, 1)]
    while waiting:
        one, depth = waiting.pop()
        indent = "    " * depth
        match one:
            case Leaf(outputs):
                lines.append(f"{indent}return OUT_{numbers[outputs]}{after}")
            case Test(variable):
                turned, inner, rest = _in_order(one)
                name, source, said = _variable(circuit, *variable)
                lines.append(f"{indent}if {'not ' * turned}{name if name in loaded else source}:  # {said}")
                waiting += [(rest, depth), (inner, depth + 1)]
    return lines


def _variable(circuit: Circuit, op: Op, index: int) -> tuple[str, str, str]:
    """(local name, where it comes from, what it is)."""
    if op is Op.INPUT:
        return f"i{index}", f"inputs[{index}]", _comment(circuit.inputs[index].name)
    return f"r{index}", f"registers[{index}]", _comment(circuit.registers[index].name)


# --- expressions ------------------------------------------------------------------------------------------


def _expressions(circuit: Circuit) -> Generated:
    nets = [net for _, net in circuit.outputs]
    nexts = [register.next for register in circuit.registers]
    body = _Writer(circuit, nets + nexts)
    lines = [f"# Longest path: {body.gates} gates.", "def tick(inputs, registers=()):"]
    lines += _unpack("i", [port.name for port in circuit.inputs], "inputs")
    lines += _unpack("r", [register.name for register in circuit.registers], "registers")
    lines += body.lines
    lines.append("    return (")
    lines += [f"        {body.text(net, 0)},  # {_at(port)}" for port, net in circuit.outputs]
    lines.append(f"    ), ({body.texts(nexts)})")
    return Generated("\n".join(lines) + "\n", "expressions", 0, body.gates, 0)


def _unpack(letter: str, names: Sequence[str], source: str) -> list[str]:
    if not names:
        return []
    comments = [f"    # {letter}{n}: {_comment(name)}" for n, name in enumerate(names)]
    return [*comments, f"    ({''.join(f'{letter}{n}, ' for n in range(len(names)))}) = {source}"]


def _at(port: Port) -> str:
    """An output and its places, for a comment."""
    places = ", ".join(dict.fromkeys(map(str, port.places)))
    return _comment(port.name + (f" at {places}" if places else ""))


def _comment(text: str) -> str:
    """Text that stays on its line."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)


class _Writer:
    """Turns the nets that `ends` need into expressions and names.

    loads: (name, source, what it is) of each input and register that is read, once. lines: assignments of named nets.
    gates: how many there are.
    """

    def __init__(self, circuit: Circuit, ends: Sequence[int]) -> None:
        self.circuit = circuit
        self.loads: dict[tuple[str, str, str], None] = {}
        self.lines: list[str] = []
        self.expressions: dict[int, tuple[str, int, int]] = {}
        self.readers: dict[int, int] = {}
        for net in self._live(ends):
            self._place(net)
        self.gates = sum(1 for net in self.expressions if circuit.cells[net].operands)

    def _live(self, ends: Sequence[int]) -> Iterator[int]:
        """The nets that are needed, in order; counts who reads them."""
        for net in ends:
            self.readers[net] = self.readers.get(net, 0) + 1
        for net in range(max(ends, default=-1), -1, -1):
            if net in self.readers:
                for operand in self.circuit.cells[net].operands:
                    self.readers[operand] = self.readers.get(operand, 0) + 1
        return iter(sorted(self.readers))

    def _place(self, net: int) -> None:
        """Write one net; nets come in order."""
        text, strength, size = self._expression(net)
        if self.circuit.cells[net].operands and (self.readers[net] > 1 or size > LONGEST):
            self.lines.append(f"    n{net} = {text}")
            text, strength, size = f"n{net}", _ATOM, 0
        self.expressions[net] = text, strength, size

    def text(self, net: int, strength: int) -> str:
        """The expression of a net, in parentheses where it binds weaker than its surroundings."""
        text, own, _ = self.expressions[net]
        return f"({text})" if own < strength else text

    def texts(self, nets: Iterable[int]) -> str:
        """The inside of a tuple."""
        return "".join(f"{self.text(net, 0)}, " for net in nets)

    def _expression(self, net: int) -> tuple[str, int, int]:
        cell = self.circuit.cells[net]
        size = 1 + sum(self.expressions[operand][2] for operand in cell.operands)
        match cell.op:
            case Op.CONSTANT:
                return str(bool(cell.index)), _ATOM, 0
            case Op.INPUT | Op.REGISTER:
                load = _variable(self.circuit, cell.op, cell.index)
                self.loads[load] = None
                return load[0], _ATOM, 0
            case Op.NOT:
                return f"not {self.text(cell.operands[0], _NOT)}", _NOT, size
            case Op.AND:
                return " and ".join(self.text(operand, _AND) for operand in cell.operands), _AND, size
            case Op.OR:
                return " or ".join(self.text(operand, _OR) for operand in cell.operands), _OR, size


_OR, _AND, _NOT, _ATOM = 1, 2, 3, 4

Tick = Callable[[Sequence[bool], Bits], tuple[Bits, Bits]]


class PythonEngine:
    """Runs the generated source of a circuit; `generated` is that source and its cost."""

    def __init__(self, circuit: Circuit) -> None:
        self.generated = generate(circuit)
        names: dict[str, Tick] = {}
        exec(compile(self.generated.source, f"<circuit {_comment(circuit.name)}>", "exec"), names)
        self._tick = names["tick"]
        self._first = first_registers(circuit)
        self._registers = self._first

    @property
    def registers(self) -> Bits:
        return self._registers

    def reset(self) -> None:
        self._registers = self._first

    def tick(self, inputs: Sequence[bool]) -> Bits:
        outputs, self._registers = self._tick(inputs, self._registers)
        return outputs
