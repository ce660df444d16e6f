"""Ways → Circuit.

Takes: `Ways`. Gives: a circuit with one input an atom, the output `hole`, and one output for each channel and value.
Leaves alone: what can be left out; see passes/.
"""

from __future__ import annotations

from rplan.circuit.cell import Cell, Op
from rplan.circuit.circuit import Circuit, Port, Register
from rplan.goals.condition import Atom, Percept
from rplan.goals.goal import Do
from rplan.lang.source import Span
from rplan.ways.guards import Node
from rplan.ways.reduce import Ways

HOLE = "hole"


def build(ways: Ways) -> Circuit:
    """The circuit of a plan, not yet swept."""
    places: dict[tuple[str, str], list[Span]] = {}
    for node in ways.layout.nodes:
        if isinstance(node.goal, Do):
            places.setdefault((node.goal.output, node.goal.value.text), []).append(node.goal.span)
    outputs = [(Port(HOLE, (ways.goals.span,)), ways.hole)]
    outputs += [
        (Port(f"{output}={value}", tuple(dict.fromkeys(places[(output, value)]))), guard)
        for output, values in ways.sets.items()
        for value, guard in values.items()
    ]
    return Circuit(
        name=ways.goals.name,
        inputs=tuple(Port(atom.text, (_place(atom),)) for atom in ways.atoms[: ways.asking]),
        registers=tuple(Register(one.name, one.initial, one.next) for one in ways.registers[: ways.driving]),
        cells=tuple(_cell(node, ways.asking, ways.driving) for node in ways.guards.nodes),
        outputs=tuple(outputs),
    )


def _place(atom: Atom) -> Span:
    return atom.term.span if isinstance(atom, Percept) else atom.left.span


def _cell(node: Node, inputs: int, registers: int) -> Cell:
    """The cell of a guard; what serves properties alone reads nothing and is swept away."""
    kind, a, b = node
    match kind:
        case "constant":
            return Cell(Op.CONSTANT, (), a)
        case "atom":
            return Cell(Op.INPUT, (), a) if a < inputs else Cell(Op.CONSTANT)
        case "register":
            return Cell(Op.REGISTER, (), a) if a < registers else Cell(Op.CONSTANT)
        case "not":
            return Cell(Op.NOT, (a,))
        case "and":
            return Cell(Op.AND, (a, b))
        case "or":
            return Cell(Op.OR, (a, b))
