"""A circuit as a drawing whose wires can be lit.

Takes: a circuit. Gives: the drawing of svg.py, each of its groups with the net that it shows (`data-net`), and without
its own colours of paper and ink, which the page has. Leaves alone: which wires are lit; the page knows the tick.
"""

from __future__ import annotations

import re

from rplan.apps.drawing.svg import MOST_GATES, svg
from rplan.circuit.circuit import Circuit

__all__ = ["MOST_GATES", "tagged"]

PAPER = re.compile(r"^<style>.*?</style>\n<rect [^>]*/>\n<text class=\"head\".*?</text>\n", re.MULTILINE | re.DOTALL)


def tagged(circuit: Circuit) -> str:
    """The drawing, for a page; `ValueError` if the circuit is too large to be read."""
    ends = [net for _, net in circuit.outputs] + [register.next for register in circuit.registers]
    read = sorted({*(o for cell in circuit.cells for o in cell.operands), *ends})
    groups = iter([*(("wire", n) for n in read), *(("cell", n) for n in read), *(("end", n) for n in ends)])
    plain = PAPER.sub("", svg(circuit), count=1)
    return re.sub(r"^<g>", lambda _: _opening(*next(groups)), plain, flags=re.MULTILINE)


def _opening(kind: str, net: int) -> str:
    return f'<g class="{kind}" data-net="{net}">'
