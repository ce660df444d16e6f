"""Plans as text and what is said of them; situations to try them in.

Takes: plan texts, resolved goals. Gives: compiled plans, codes of findings, texts of goals with parts lifted into
rules, and every situation that can make a difference. Leaves alone: files; see rplan/apps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import product

from rplan.backends.python import PythonEngine
from rplan.driver import NO_LIBRARIES, Compiled, compile_plan
from rplan.goals.condition import Atom, Comparison, percept_terms, print_condition
from rplan.goals.condition import atoms as atoms_of
from rplan.goals.goal import And, Goal, If, Or, PrioAnd, conditions, print_goal
from rplan.goals.signature import Libraries
from rplan.lang.diagnostic import Diagnostic, PlanError
from rplan.lang.source import Source
from rplan.runtime.tick import Decider

Values = Mapping[str, bool | float]
"""Canonical text of a percept -> its value."""


def compiled(
    text: str, libraries: Libraries = NO_LIBRARIES, *, strict: bool = False, allow_holes: bool = False
) -> Compiled:
    return compile_plan(Source("test.rplan", text), libraries, strict=strict, allow_holes=allow_holes)


def findings(text: str, libraries: Libraries = NO_LIBRARIES, *, strict: bool = False) -> tuple[Diagnostic, ...]:
    try:
        return compiled(text, libraries, strict=strict).diagnostics
    except PlanError as error:
        return error.diagnostics


def said(found: Iterable[Diagnostic], *severities: str) -> list[str]:
    """Codes of the findings of some severities (default: errors and warnings)."""
    wanted = severities or ("error", "warning")
    return [diagnostic.code for diagnostic in found if diagnostic.severity in wanted]


def decider(plan: Compiled) -> Decider:
    return Decider(plan.goals, plan.ways.atoms, plan.circuit, PythonEngine(plan.circuit))


def as_text(goal: Goal, lift: Callable[[], bool], rules: list[str]) -> str:
    """A goal as text; where `lift` says so a part becomes a rule of its own."""
    match goal:
        case If(condition=condition, then=then, otherwise=otherwise):
            parts = [print_condition(condition), as_text(then, lift, rules), as_text(otherwise, lift, rules)]
            text = f"(if {' '.join(parts)})"
        case And(goals) | Or(goals) | PrioAnd(goals):
            head = {And: "and", Or: "or", PrioAnd: "prio-and"}[type(goal)]
            text = f"({head} {' '.join(as_text(inner, lift, rules) for inner in goals)})"
        case _:
            text = print_goal(goal)
    if not lift():
        return text
    name = f"(ach part-{len(rules)})"
    rules.append(f"(defgoalr {name} {text})")
    return name


def situations(goal: Goal, numbers: Iterable[float]) -> Iterator[Values]:
    """Every combination of truth values, and of `numbers`, of the percepts that a goal reads."""
    atoms = [atom for condition in conditions(goal) for atom in atoms_of(condition)]
    terms = {term.text: isinstance(atom, Comparison) for atom in atoms for term in percept_terms(atom)}
    domains: list[tuple[bool | float, ...]] = [
        tuple(numbers) if is_number else (False, True) for is_number in terms.values()
    ]
    for values in product(*domains):
        yield dict(zip(terms, values, strict=True))


def holds(atom: Atom, values: Values) -> bool:
    """Whether an atom holds, said once more without the compiler's help."""
    if not isinstance(atom, Comparison):
        return bool(values[atom.text])
    left, right = (values[t.text] if t.kind == "call" else t.value for t in (atom.left, atom.right))
    assert left is not None and right is not None
    return {
        "<": left < right, "<=": left <= right, ">": left > right, ">=": left >= right,
        "=": left == right, "/=": left != right,
    }[atom.operator]  # fmt: skip


def situation(goal: Goal, values: Values) -> Callable[[str], bool]:
    """The values as rplan.ways.meaning takes them."""
    atoms = {atom.text: atom for condition in conditions(goal) for atom in atoms_of(condition)}
    return lambda text: holds(atoms[text], values)
