"""A circuit as Graphviz dot text.

Takes: a circuit. Gives: dot text, inputs at the left and outputs at the right. Leaves alone: drawing it.
"""

from __future__ import annotations

from rplan.circuit.cell import Op
from rplan.circuit.circuit import Circuit

SHAPES = {Op.NOT: "invtriangle", Op.AND: "house", Op.OR: "invhouse", Op.REGISTER: "box", Op.CONSTANT: "plaintext"}


def dot(circuit: Circuit) -> str:
    """The circuit as a directed graph."""
    lines = [f"digraph {_quoted(circuit.name)} {{", "  rankdir=LR;", '  node [fontname="Helvetica", fontsize=10];']
    for net, cell in enumerate(circuit.cells):
        match cell.op:
            case Op.INPUT:
                label, shape = circuit.inputs[cell.index].name, "cds"
            case Op.REGISTER:
                label, shape = circuit.registers[cell.index].name, SHAPES[cell.op]
            case Op.CONSTANT:
                label, shape = ("true" if cell.index else "false"), SHAPES[cell.op]
            case _:
                label, shape = cell.op.value, SHAPES[cell.op]
        lines.append(f"  n{net} [label={_quoted(label)}, shape={shape}];")
        lines += [f"  n{operand} -> n{net};" for operand in cell.operands]
    for number, (port, net) in enumerate(circuit.outputs):
        lines.append(f"  o{number} [label={_quoted(port.name)}, shape=cds, style=bold];")
        lines.append(f"  n{net} -> o{number};")
    lines += [
        f"  n{register.next} -> n{net} [style=dashed, constraint=false];"
        for net, cell in enumerate(circuit.cells)
        if cell.op is Op.REGISTER
        for register in [circuit.registers[cell.index]]
    ]
    return "\n".join([*lines, "}"]) + "\n"


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
