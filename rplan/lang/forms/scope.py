"""Where a form stands, and what is said of wrong ones.

Takes: forms. Gives: `Scope`, which notes an error for everything that is wrong. Leaves alone: what stands in for
a form that is wrong.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from rplan.lang.diagnostic import Diagnostic, Related
from rplan.lang.plan import Variable as Parameter
from rplan.lang.reader import Broken, Form, Keyword, ListForm, Numeral, Symbol, Text, Variable
from rplan.lang.source import Span
from rplan.lang.suggest import close
from rplan.lang.units import UNITS


@dataclass(frozen=True, slots=True)
class Scope:
    """found: errors and warnings so far, one list for the whole plan. bound: the variables that may stand here.

    of_outputs: whether conditions may ask outputs here.
    """

    found: list[Diagnostic] = field(default_factory=list)
    bound: tuple[str, ...] = ()
    of_outputs: bool = False

    def binding(self, variables: tuple[str, ...]) -> Scope:
        """The scope of a body whose head has these variables."""
        return replace(self, bound=variables)

    def asking_outputs(self) -> Scope:
        """The scope of a claim about what the plan sets."""
        return replace(self, of_outputs=True)

    def error(self, code: str, message: str, span: Span, hint: str = "", related: tuple[Related, ...] = ()) -> None:
        self.found.append(Diagnostic(code, "error", message, span, related, hint))

    def wrong_parts(self, takes: str, form: Form, parts: Sequence[Form], hint: str = "") -> None:
        if not any(isinstance(part, Broken) for part in parts):
            hint = _spaced_unit(parts) or hint
            self.error("wrong-parts", f"{takes}; here {_parts(len(parts))}", form.span, hint)

    def unexpected(self, form: Form, wanted: str, code: str, hint: str = "") -> None:
        """One error that something else was wanted here; none where it has been reported already."""
        match form:
            case Broken():
                pass
            case Variable():
                self.no_variable(form)
            case _:
                self.error(code, f"here stands {_describe(form)}, expected is {wanted}", form.span, hint)

    def no_variable(self, variable: Variable) -> None:
        message = f"`?{variable.name}`: no variable may stand here"
        hint = "variables stand in the place of values and conditions"
        self.error("no-variables", message, variable.span, hint)

    def parameter(self, variable: Variable) -> Parameter:
        """A variable in the place of a value or a condition; the head must have it."""
        if variable.name not in self.bound:
            meant = close(variable.name, self.bound, shortest=3)
            there_are = " ".join(f"`?{name}`" for name in self.bound) or "none"
            hint = f"did you mean `?{meant}`?" if meant else f"variables of the head: {there_are}"
            self.error("unbound-variable", f"`?{variable.name}` is not in the head", variable.span, hint)
        return Parameter(variable.name, variable.span)

    def no_head(self, form: Form, what: str, known: Sequence[str] = ()) -> None:
        items = form.items if isinstance(form, ListForm) else ()
        if items and isinstance(items[0], Broken):
            return
        if items and isinstance(items[0], Variable):
            self.no_variable(items[0])
            return
        hint = known_names(what.split()[-1], known) if known else ""
        empty = "" if items else "; these parentheses are empty"
        self.error("no-head", f"{what} begins with a name{empty}", items[0].span if items else form.span, hint)

    def unknown(self, head: str, form: ListForm, what: str, known: Sequence[str]) -> None:
        meant = close(head, known, shortest=2)
        hint = (f"did you mean `{meant}`? " if meant else "") + known_names(what, known)
        self.error("unknown-form", f"`{head}` is not a known {what}", form.items[0].span, hint)

    def distinct(self, what: str, named: Iterable[tuple[str, Span]]) -> None:
        """One error for each name that is there again; names that are missing are not compared."""
        seen: dict[str, Span] = {}
        for name, span in named:
            if name and name in seen:
                self.error("duplicate", f"the {what} `{name}` is there twice", span, "", first_is_here(seen[name]))
            seen.setdefault(name, span)


def head_of(form: Form) -> str | None:
    """The name with which a list begins."""
    match form:
        case ListForm(items=(Symbol(name=name), *_)):
            return name
        case _:
            return None


def first_is_here(span: Span) -> tuple[Related, ...]:
    return (Related("the first is here", span),)


def known_names(what: str, names: Sequence[str]) -> str:
    return f"known {what}s: {' '.join(names)}"


def _parts(number: int) -> str:
    return "are none" if number == 0 else "is 1 part" if number == 1 else f"are {number} parts"


def _spaced_unit(parts: Sequence[Form]) -> str:
    """A hint where a number and its unit stand apart."""
    for number, unit in pairwise(parts):
        if isinstance(number, Numeral) and isinstance(unit, Symbol) and not number.unit and unit.name in UNITS:
            return f"a unit follows its number without a space: `{number.text}{unit.name}`"
    return ""


def _describe(form: Form) -> str:
    match form:
        case Symbol(name=name):
            return f"the name `{name}`"
        case Keyword(name=name):
            return f"the keyword `:{name}`"
        case Numeral(text=text):
            return f"the number `{text}`"
        case Text():
            return "a text"
        case ListForm(items=(Symbol(name=name), *_)):
            return f"`({name} ...)`"
        case _:
            return "a list"
