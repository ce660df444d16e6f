"""Which name means what, and which name was meant.

Takes: a `Plan` and the signatures of the libraries that there are. Gives: `Scope` (tables of names) and look-ups that
note, warn or refuse with "did you mean" (L6). Leaves alone: goals; see expand.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal

from rplan.goals.signature import COMPETENCE_FAILED, FunctionSignature, Libraries, LibrarySignature
from rplan.lang.diagnostic import Diagnostic, Related, Severity
from rplan.lang.plan import Call, NamedCondition, OutputDeclaration, Plan, Rule, Type
from rplan.lang.printer import print_head
from rplan.lang.source import Span
from rplan.lang.suggest import Names, close

Asks = Literal["nothing", "outputs", "percepts"]
"""What the condition at hand may ask of this tick: in a property outputs, in an assumption percepts alone."""

DEEPEST = 1_000
"""Rules inside rules and named conditions inside named conditions, at most (L17)."""
LONGEST = 1_000
"""Letters of the canonical text of a goal or of a named condition with its arguments, at most."""


@dataclass(slots=True)
class Findings:
    """Diagnostics as they are found, each once."""

    _found: dict[Diagnostic, None] = field(default_factory=dict)

    @property
    def list(self) -> list[Diagnostic]:
        """All of them in the order in which they were found."""
        return [*self._found]

    def add(
        self,
        severity: Severity,
        code: str,
        message: str,
        span: Span,
        *,
        related: Iterable[Related] = (),
        hint: str = "",
    ) -> None:
        """Take down one finding; the same one twice counts once."""
        self._found.setdefault(Diagnostic(code, severity, message, span, tuple(related), hint))

    def failed(self) -> bool:
        return any(d.severity == "error" for d in self._found)


@dataclass(slots=True)
class Scope:
    """The tables of names of one plan, one a name space, and which of them have been used.

    recursive: named conditions that ask their own past, by their text. asks: whether outputs may be asked here.
    endless: conditions went so deep that none is followed any further.
    """

    functions: dict[str, FunctionSignature]
    outputs: dict[str, OutputDeclaration]
    conditions: dict[str, NamedCondition]
    rules: dict[tuple[str, str], list[Rule]]
    libraries: dict[str, LibrarySignature]
    findings: Findings
    strict: bool
    period: float
    recursive: dict[str, Call] = field(default_factory=dict)
    used: dict[tuple[str, str], None] = field(default_factory=dict)
    unknown: dict[tuple[str, str], None] = field(default_factory=dict)
    spaces: dict[str, Names] = field(default_factory=dict)
    taken: dict[str, tuple[Type, Span]] = field(default_factory=dict)
    channels: dict[str, Type | None] = field(default_factory=dict)
    asks: Asks = "nothing"
    endless: bool = False

    def function(self, name: str, span: Span, what: str) -> FunctionSignature | None:
        """The function of this name; an unknown one is noted once, a close one is an error."""
        self.used[("function", name)] = None
        if name in self.functions:
            return self.functions[name]
        space = "condition" if what == "condition" else "function"
        self.stranger(space, name, span, f"`{name}` is declared nowhere: it is taken for a {what}")
        return None

    def take_for(self, name: str, kind: Type, span: Span) -> None:
        """A place takes an undeclared function for this type; two places that do not agree are an error (L5, L6)."""
        known, first = self.taken.setdefault(name, (kind, span))
        if known.name == kind.name and "" in (known.unit, kind.unit):
            self.taken[name] = (known if known.unit else kind, first)
        elif known != kind:
            self.findings.add(
                "error", "type-mismatch", f"`{name}` is declared nowhere and taken for {kind} here", span,
                related=[Related(f"and for {known} here", first)], hint="`declare` it, or rename one of them",
            )  # fmt: skip

    def output(self, name: str, span: Span) -> OutputDeclaration | None:
        """The declaration of an output, if there is one."""
        self.used[("output", name)] = None
        if name in self.outputs:
            return self.outputs[name]
        self.stranger("output", name, span, f"`{name}` is declared nowhere: it is taken for an output")
        return None

    def _known(self, space: str) -> Names:
        """The names of a name space; asked once the tables are complete."""
        if space not in self.spaces:
            names = [*self.outputs] if space == "output" else [*self.functions]
            self.spaces[space] = Names([*names, *self.conditions] if space == "condition" else names)
        return self.spaces[space]

    def stranger(self, space: str, name: str, span: Span, note: str) -> None:
        """A name that nothing declares: an error where it is close to one that is known, else a note (L6)."""
        if (space, name) in self.unknown:
            return
        meant = self._known(space).close(name)
        if meant is not None:
            self.findings.add(
                "error", "misspelt", f"no {space} is called `{name}`", span, hint=f"did you mean `{meant}`?"
            )
        else:
            self.unknown[(space, name)] = None
            self.findings.add("error" if self.strict else "note", "undeclared", note, span)


def scope_of(plan: Plan, libraries: Libraries, strict: bool, findings: Findings) -> Scope:
    """The tables of a plan; unknown libraries, and names that two of them offer, are reported."""
    scope = Scope({COMPETENCE_FAILED.name: COMPETENCE_FAILED}, {}, {}, {}, {}, findings, strict, plan.header.period)
    for use in plan.uses:
        if use.library not in libraries:
            meant = close(use.library, list(libraries))
            hint = f"did you mean `{meant}`?" if meant else f"there are: {', '.join(libraries) or 'none'}"
            findings.add("error", "unknown-library", f"no library is called `{use.library}`", use.span, hint=hint)
            continue
        scope.libraries[use.library] = libraries[use.library]
        for function in libraries[use.library].functions:
            _offer(scope, function, use.span)
    for declaration in plan.declarations:
        parameters = tuple(kind for _, kind in declaration.parameters)
        _offer(
            scope, FunctionSignature(declaration.name, parameters, declaration.type, declaration.doc), declaration.span
        )
    scope.outputs = {output.name: output for output in plan.outputs}
    for condition in plan.conditions:
        if condition.name in scope.functions:
            findings.add(
                "error", "duplicate", f"`{condition.name}` is a function already and cannot be a condition too",
                condition.span,
            )  # fmt: skip
        scope.conditions[condition.name] = condition
    for rule in plan.rules:
        scope.rules.setdefault((rule.kind, rule.name), []).append(rule)
    return scope


def _offer(scope: Scope, function: FunctionSignature, span: Span) -> None:
    before = scope.functions.get(function.name)
    if before is not None:
        scope.findings.add(
            "error", "duplicate", f"`{function.name}` comes from {function.origin} and from {before.origin}", span
        )
    scope.functions[function.name] = function


def report_unused(plan: Plan, scope: Scope) -> None:
    """Warn of what is declared and not used (L6)."""
    used = scope.used
    for declaration in plan.declarations:
        if ("function", declaration.name) not in used:
            scope.findings.add("warning", "unused", f"`{declaration.name}` is declared and not used", declaration.span)
    for output in plan.outputs:
        if ("output", output.name) not in used:
            scope.findings.add("warning", "unused", f"the output `{output.name}` is never set", output.span)
    for condition in plan.conditions:
        if ("condition", condition.name) not in used:
            scope.findings.add("warning", "unused", f"the condition `{condition.name}` is not used", condition.span)
    for rule in plan.rules:
        if plan.top is not None and ("rule", print_head(rule)) not in used:
            scope.findings.add(
                "warning", "unused", f"no goal that is reached asks for `{print_head(rule)}`", rule.head_span
            )
    for use in plan.uses:
        library = scope.libraries.get(use.library)
        if library is None or library.works_unasked:
            continue
        if not any(("function", f.name) in used for f in library.functions):
            scope.findings.add("warning", "unused", f"nothing of the library `{use.library}` is used", use.span)
