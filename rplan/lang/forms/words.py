"""The words of the language, and what their forms take.

Takes: nothing. Gives: the heads of goals, conditions and numbers, the names that nobody may define, and what each form
takes, as messages say it. Leaves alone: the forms themselves.
"""

from __future__ import annotations

from rplan.lang.plan import ArithmeticOperator, Comparator, Past
from rplan.lang.reader import TOP_FORMS

GOAL_FORMS = ("do", "if", "when", "cond", "and", "or", "prio-and", "ach", "maint")
COMPARATORS: tuple[Comparator, ...] = ("<", "<=", ">", ">=", "=", "/=")
MEMORY_FORMS: tuple[Past, ...] = (
    "delay", "once", "historically", "since", "latch", "rose", "fell", "held-for", "within", "at-least",
)  # fmt: skip
OPERATORS: tuple[ArithmeticOperator, ...] = ("+", "-", "*", "/", "min", "max", "abs")
CONDITION_FORMS = ("not", "and", "or", *COMPARATORS, *MEMORY_FORMS)
TYPES = ("bool", "number", "pose", "command", "symbol")
TRUTHS = ("true", "false")
RESERVED = (*TRUTHS, "anything", "else", *TOP_FORMS, *GOAL_FORMS, *CONDITION_FORMS, *OPERATORS)

TAKES = {
    "plan": "a name",
    "use": "the name of a library and its parameters",
    "declare": "`(NAME (ARGUMENT TYPE)...)`, a type and perhaps a text",
    "defoutput": "a name and a type",
    "defcond": "`(NAME ?ARG...)`, perhaps a text, and a condition",
    "defgoalr": "`(ach NAME ARG...)` or `(maint NAME ARG...)`, perhaps a text, and a goal",
    "defop": "`(NAME ?ARG...)`, perhaps a text, and `:do`, `:pre`, `:add`, `:del`",
    "defproperty": "a name, perhaps a text, `:always CONDITION` and perhaps `:provided CONDITION`",
    "assume": "a condition",
    "deftest": "a name, perhaps a text, and one or more steps `(tick ...)`",
    "tick": "`:times`, `:given`, `:expect` and `:hole`, and nothing else",
    "goalem": "a goal",
    "goallem": "a goal",
    "do": "an output and a value, or is `(do anything)`",
    "if": "a condition, a goal and an else goal",
    "when": "a condition and a goal",
    "cond": "one or more clauses `(CONDITION GOAL)`, at last perhaps `(else GOAL)`",
    "ach": "the name of a goal and its arguments, or a condition",
    "maint": "the name of a goal and its arguments",
    "not": "a condition",
    "delay": "a first value (`true` or `false`) and a condition",
    "once": "a condition",
    "historically": "a condition",
    "since": "a condition, and the condition since which it holds",
    "latch": "a condition that sets and one that resets",
    "rose": "a condition",
    "fell": "a condition",
    "held-for": "a time and a condition",
    "within": "a time and a condition",
    "at-least": "a number of ticks and a condition, and perhaps `:reset CONDITION`",
}
"""What stands behind the head of a form."""
HINTS = {
    ("if", 2): "use `when` for an if without else",
    ("when", 3): "use `if` for a when with an else goal",
    ("defgoalr", 3): "join goals with `and`, `or` or `prio-and`",
    ("goalem", 2): "join goals with `and`, `or` or `prio-and`",
    ("goallem", 2): "join goals with `and`, `or` or `prio-and`",
    ("not", 2): "join conditions with `and` or `or`",
}
"""What was perhaps meant, by the head and the number of parts."""


def what_is(name: str) -> str:
    """What kind of word a reserved name is."""
    if name in TOP_FORMS:
        return "a form of the top level"
    if name in CONDITION_FORMS:
        return "a condition"
    return "a goal" if name in GOAL_FORMS else "a word of the language"
