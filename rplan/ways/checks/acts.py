"""Outputs that are never set, or only ever to one value, and competences that are never chosen.

Takes: a `Reach`. Gives: a warning for an output that the text sets and no situation does; notes for the rest. Leaves
alone: outputs that no text sets; see rplan/goals/scope.py.
"""

from __future__ import annotations

from collections.abc import Iterator

from rplan.goals.goal import Do, Output
from rplan.lang.diagnostic import Diagnostic
from rplan.lang.source import Span
from rplan.ways.checks.finding import also
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways


def check_outputs(reach: Reach) -> Iterator[Diagnostic]:
    """Outputs that are never set, and outputs that are only ever sent one value."""
    ways = reach.ways
    for output in ways.goals.outputs:
        values = ways.sets.get(output.name, {})
        possible = [text for text, guard in values.items() if reach.possible((guard, True)) is not False]
        if values and not possible:
            related = also("it would be set here", _acts(ways, output.name))
            yield Diagnostic(
                "never-set", "warning", f"the output `{output.name}` can never be set", output.span, related
            )
        elif len({*possible, *_unset(output)}) == 1 and possible:
            message = f"the output `{output.name}` is only ever set to {possible[0]}"
            yield Diagnostic("one-value", "note", message, output.span, also("here", _acts(ways, output.name)))


def _unset(output: Output) -> list[str]:
    """What may stand where the output is not set."""
    return [term.text for term in (output.idle, output.initial) if term is not None]


def _acts(ways: Ways, output: str) -> list[Span]:
    return [node.goal.span for node in ways.layout.nodes if isinstance(node.goal, Do) and node.goal.output == output]


def check_competences(reach: Reach) -> Iterator[Diagnostic]:
    """Competences that libraries in use offer, or that acts name, and that no situation chooses."""
    ways = reach.ways
    named: dict[str, list[Do]] = {}
    chosen = {term.name: None for output in ways.goals.outputs for term in (output.idle, output.initial) if term}
    for node in ways.layout.nodes:
        if isinstance(node.goal, Do) and node.goal.value.kind == "call":
            named.setdefault(node.goal.value.name, []).append(node.goal)
            if node.goal.value.name not in chosen and reach.possible((ways.reached[node.number], True)) is not False:
                chosen[node.goal.value.name] = None
    uses = {library.name: library.span for library in ways.goals.libraries}
    for name, function in ways.goals.functions.items():
        if function.type is None or function.type.name != "command" or name in chosen:
            continue
        if name in named:
            spans = [do.span for do in named[name]]
            message = f"the competence `({name})` is never chosen"
            yield Diagnostic("never-chosen", "note", message, spans[0], also("nor here", spans[1:]))
        elif function.origin in uses:
            message = f"the competence `({name})` of `{function.origin}` is never chosen"
            yield Diagnostic("never-chosen", "note", message, uses[function.origin])
