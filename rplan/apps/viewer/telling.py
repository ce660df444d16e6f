"""What a page is told of its plan: the circuit with its wires, and which goals lost and what stood against them.

Takes: a compiled plan, and tick by tick inputs and registers. Gives: plain JSON values, with the places of its rules,
and the `Telling` of a recording whose header has its plan. Leaves alone: how the page shows them (sim/replay.html).

A tick's answer follows from inputs and registers alone, so it is found once for each pair of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from rplan.apps.drawing.inspect_circuit import MOST_GATES, tagged
from rplan.apps.drawing.inspect_circuit_part import compact
from rplan.apps.libraries import Catalogue
from rplan.apps.wiring import compile_source
from rplan.circuit.stats import stats
from rplan.driver import Compiled
from rplan.goals.goal import Do, Reduced
from rplan.lang.diagnostic import PlanError
from rplan.lang.source import Source, Span
from rplan.ways.lost import lost
from rplan.ways.way import taken_way
from rplan.ways.why import Reasons
from sim.recording import Json
from sim.replay import Telling

LOST = "lost"
"""The run of a page that has what `Loser.lost` gives."""
ENOUGH = "enough"
"""The run that has what `Loser.enough` gives."""
MOST_LOST = 60
MOST_INPUTS, MOST_ASKED = 64, 500


class Loser:
    """Says for a tick which goals lost."""

    def __init__(self, compiled: Compiled) -> None:
        self._compiled = compiled
        self._known: dict[tuple[str, str], list[Json]] = {}
        self._enough: dict[tuple[str, str], list[Json]] = {}
        self._reasons: Reasons | None = None
        self._fired: dict[tuple[str, str], tuple[str, ...]] = {}
        heads = (node.goal.head for node in compiled.ways.layout.nodes if isinstance(node.goal, Reduced))
        self.heads: tuple[str, ...] = tuple(dict.fromkeys(heads))

    def lost(self, inputs: str, registers: str) -> list[Json]:
        """The goals that set nothing in a tick, in textual order, without the parts of those that lost as a whole.

        {"goal", "because", "reason", "line"}, where it stands in an included file with its place as "at"; bits as
        recordings have them. See rplan/ways/lost.py.
        """
        key = (inputs, registers)
        if key not in self._known:
            self._known[key] = list(self._lost(_bits(inputs), _bits(registers)))[:MOST_LOST]
        return self._known[key]

    def tick(self, plan: Json) -> Json:
        """For the plan's part of a recorded tick."""
        inputs, registers = plan.get("inputs"), plan.get("registers", "")
        if not isinstance(inputs, str) or not isinstance(registers, str):
            return {}
        return {LOST: self.lost(inputs, registers), ENOUGH: self.enough(inputs, registers)}

    def enough(self, inputs: str, registers: str) -> list[Json]:
        """Conditions that alone make for the outputs of a tick: {"condition", "value"}; see rplan/ways/why.py.

        None are given for plans of more than `MOST_INPUTS` conditions, nor after `MOST_ASKED` different situations.
        """
        key = (inputs, registers)
        ways = self._compiled.ways
        if key not in self._enough:
            if ways.asking > MOST_INPUTS or len(self._enough) >= MOST_ASKED:
                return []
            self._reasons = self._reasons or Reasons(ways)
            found = self._reasons.literals(_bits(inputs), _bits(registers))
            self._enough[key] = [{"condition": one.text, "value": one.value} for one in found]
        return self._enough[key]

    def firing(self, inputs: str, registers: str) -> tuple[str, ...]:
        """The rules that set something in a tick, themselves or by their subgoals, each once."""
        key = (inputs, registers)
        if key not in self._fired:
            values = self._values(_bits(inputs), _bits(registers))
            ways = self._compiled.ways
            acting = [n for n in ways.layout.nodes if isinstance(n.goal, Do) and values[ways.reached[n.number]]]
            self._fired[key] = tuple(dict.fromkeys(head for node in acting for head in self._above(node.number)))
        return self._fired[key]

    def _above(self, number: int) -> Iterator[str]:
        """The rules that a place is in, innermost first."""
        nodes = self._compiled.ways.layout.nodes
        while number >= 0:
            goal = nodes[number].goal
            if isinstance(goal, Reduced):
                yield goal.head
            number = nodes[number].parent

    def _values(self, inputs: list[bool], registers: list[bool]) -> list[bool]:
        ways = self._compiled.ways
        atoms = (*inputs, *(False for _ in ways.atoms[len(inputs) :]))
        every = (*registers, *(False for _ in ways.registers[len(registers) :]))
        return ways.guards.evaluate(atoms, every)

    def _lost(self, inputs: list[bool], registers: list[bool]) -> Iterator[Json]:
        ways = self._compiled.ways
        for one in lost(ways, taken_way(ways, inputs, registers), inputs, registers):
            if not one.part_of:
                place = _place(one.span, self._compiled)
                yield {"goal": one.goal, "because": one.because, "reason": one.reason} | place


def _place(span: Span, compiled: Compiled) -> dict[str, object]:
    return {"line": span.line} if span.file == compiled.source.name else {"line": None, "at": str(span)}


def rules(compiled: Compiled) -> list[Json]:
    """All rules in their order: {"rule", "line", "end_line"}, of those in an included file also "file", its name."""
    own = compiled.source.name
    return [
        {"rule": r.head, "line": r.span.line, "end_line": r.span.end_line}
        | ({} if r.span.file == own else {"file": r.span.file.replace("\\", "/").rpartition("/")[2]})
        for r in compiled.goals.rules
    ]


def _bits(text: str) -> list[bool]:
    return [bit == "1" for bit in text]


def circuit(compiled: Compiled) -> Json:
    """{"stats", "outputs", "svg", "cells": [[operation, operands or index …] …]}; where it is too large to be drawn
    whole, svg is "" and "part" has all that the page draws parts of."""
    costs, made = stats(compiled.circuit), compiled.circuit
    cells = [[c.op.value, *(c.operands or (c.index,))] for c in made.cells]
    large = costs.gates > MOST_GATES
    return {
        "stats": {
            "gates": costs.gates,
            "depth": costs.depth,
            "registers": costs.registers,
            "operations": costs.operations,
        },
        "outputs": [port.name for port, _ in made.outputs],
        "svg": "" if large else tagged(made),
        "cells": [] if large else cells,
    } | ({"part": compact(made)} if large else {})


def telling_of(compiled: Compiled) -> Telling:
    """What the page of a run of this plan is told."""
    return Telling({"circuit": circuit(compiled), "rules": rules(compiled)}, Loser(compiled).tick)


def telling(header: Json, libraries: Catalogue | None = None) -> tuple[Telling | None, str]:
    """What the page of a recording is told, or why nothing can be; the plan's text is compiled again."""
    plan = header.get("plan")
    if not isinstance(plan, Mapping) or not isinstance(plan.get("text"), str):
        return None, "no plan stands in its header"
    included = plan.get("included")
    texts = _texts(included if isinstance(included, Sequence) else ())

    def open_file(path: str) -> Source:
        name = path.replace("\\", "/").rpartition("/")[2]
        if name not in texts:
            raise FileNotFoundError(2, "it is not in the recording", path)
        return Source(path, texts[name])

    try:
        source = Source(str(plan.get("file", "plan.rplan")), plan["text"])
        compiled = compile_source(source, allow_holes=True, open_file=open_file, libraries=libraries)
    except PlanError as error:
        return None, f"its plan does not compile with the libraries at hand ({error.diagnostics[0].message})"
    inputs = [atom.text for atom in compiled.ways.atoms[: compiled.ways.asking]]
    if inputs != plan.get("inputs"):
        return None, "this rplan reads its plan otherwise than the one that recorded it"
    return telling_of(compiled), ""


def _texts(included: Sequence[object]) -> dict[str, str]:
    """File name -> text of what a recorded plan includes."""
    found = (one for one in included if isinstance(one, Mapping))
    return {str(one.get("file", "")): str(one.get("text", "")) for one in found}
