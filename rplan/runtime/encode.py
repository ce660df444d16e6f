"""Percepts → bits.

Takes: percept values by canonical text. Gives: the inputs of the circuit; `PerceptError` for a value that is missing,
of the wrong type or not finite. Leaves alone: where values come from.

The encoder is generated Python, one line a percept and one an atom, since it runs in every tick.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from typing import cast

from rplan.goals.condition import Atom, Comparison, Percept, Term, percept_terms
from rplan.goals.goal import Goals

PerceptValue = bool | float
Encode = Callable[[Mapping[str, PerceptValue]], tuple[bool, ...]]


class PerceptError(ValueError):
    """A percept has no value that a circuit can take; key is its canonical text."""

    def __init__(self, key: str, message: str) -> None:
        self.key = key
        super().__init__(f"{key}: {message}")


def encoder(goals: Goals, atoms: Sequence[Atom]) -> Encode:
    """The function from percept values to the inputs of the circuit, in the order of `atoms`."""
    percepts = goals.percepts(driving=True)
    names = {term.text: f"p{n}" for n, term in enumerate(percepts)}
    numeric = {term.text for atom in atoms if isinstance(atom, Comparison) for term in percept_terms(atom)}
    lines = ["def encode(values):", "    try:"]
    lines += [f"        {names[term.text]} = values[{term.text!r}]" for term in percepts] or ["        pass"]
    lines += ["    except KeyError as error:", "        raise missing(error.args[0]) from None"]
    for term in percepts:
        wrong = "wrong_number" if term.text in numeric else "wrong_bool"
        test = f"{wrong}({names[term.text]})" if term.text in numeric else f"{names[term.text]}.__class__ is not bool"
        lines += [f"    if {test}:", f"        raise {wrong}_error({term.text!r}, {names[term.text]})"]
    lines.append(f"    return ({''.join(f'{_expression(atom, names)}, ' for atom in atoms)})")
    scope: dict[str, object] = {
        "missing": lambda key: PerceptError(key, "the plan reads it, and there is no value"),
        "wrong_number": wrong_number,
        "wrong_number_error": lambda key, value: PerceptError(key, f"a finite number is wanted, not {_shown(value)}"),
        "wrong_bool_error": lambda key, value: PerceptError(key, f"true or false is wanted, not {_shown(value)}"),
    }
    exec(compile("\n".join(lines), "<encoder>", "exec"), scope)
    return cast(Encode, scope["encode"])


def wrong_number(value: object) -> bool:
    """Whether it is no finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return True
    try:
        return not math.isfinite(value)
    except OverflowError:
        return True


def _shown(value: object) -> str:
    """A value as JSON has it, cut short."""
    text = json.dumps(value, default=repr)
    return text if len(text) <= 40 else f"{text[:40]}…"


def _expression(atom: Atom, names: Mapping[str, str]) -> str:
    if isinstance(atom, Percept):
        return names[atom.text]
    operator = {"=": "==", "/=": "!="}.get(atom.operator, atom.operator)
    return f"{_side(atom.left, names)} {operator} {_side(atom.right, names)}"


def _side(term: Term, names: Mapping[str, str]) -> str:
    match term.kind:
        case "call":
            return names[term.text]
        case "arithmetic":
            return _arithmetic(term.name, [_side(operand, names) for operand in term.arguments])
        case _:
            return f"({term.value!r})"


def _arithmetic(operator: str, operands: list[str]) -> str:
    """As Python says `rplan.goals.condition.operate`."""
    if operator == "abs" or (operator in ("min", "max") and len(operands) > 1):
        return f"{operator}({', '.join(operands)})"
    if operator == "-" and len(operands) == 1:
        return f"(-{operands[0]})"
    if operator == "-" and len(operands) > 2:
        return f"({operands[0]} - ({' + '.join(operands[1:])}))"
    return f"({f' {operator} '.join(operands)})" if len(operands) > 1 else operands[0]
