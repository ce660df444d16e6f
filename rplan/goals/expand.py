"""Plan → Goals: every name looked up, every type checked, every rule put in the place of its goal.

Takes: a `Plan`, the signatures of libraries, and whether undeclared names are errors. Gives: `Goals` with warnings
and notes, or `PlanError` with everything that is wrong. Leaves alone: which goals conflict; see rplan/ways.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from rplan.goals import goal as g
from rplan.goals.papercuts import check_channels
from rplan.goals.resolve import resolve_condition, resolve_definitions, resolve_outputs, resolve_settings, resolve_value
from rplan.goals.scope import Findings, Scope, report_unused, scope_of
from rplan.goals.signature import Libraries
from rplan.lang import plan as p
from rplan.lang.diagnostic import Diagnostic, PlanError, Related
from rplan.lang.source import Span
from rplan.lang.suggest import close

DEEPEST = 1_000
"""Rules inside rules, at most (L17)."""
LARGEST = 2_000_000
"""Nodes of a reduced goal, at most."""


def expand(plan: p.Plan, libraries: Libraries, *, strict: bool = False) -> tuple[g.Goals, tuple[Diagnostic, ...]]:
    """The reduced goal of a plan, and what is to be said of it."""
    findings = Findings()
    scope = scope_of(plan, libraries, strict, findings)
    settings = resolve_settings(plan, scope)
    for name, definition in scope.conditions.items():
        resolve_condition(p.Call(name, (), definition.span), scope)
    scope.used = {key: None for key in scope.used if key[0] != "condition"}
    reducer = _Reducer(scope)
    top = _top(plan, reducer, findings)
    for kind, name in [*scope.rules]:
        reducer.rule(kind, name)
    definitions = resolve_definitions(scope)
    outputs = resolve_outputs(plan, scope, top)
    report_unused(plan, scope)
    if top is not None:
        check_channels(top, outputs, scope)
    if findings.failed() or top is None:
        raise PlanError(findings.list)
    goals = g.Goals(
        name=plan.header.name,
        doc=plan.header.doc,
        period=plan.header.period,
        top=top,
        outputs=outputs,
        rules=tuple(g.RuleInfo(f"({rule.kind} {rule.name})", rule.doc, rule.span) for rule in plan.rules),
        libraries=settings,
        functions=dict(scope.functions),
        span=plan.span,
        definitions=definitions,
    )
    return goals, tuple(findings.list)


def _top(plan: p.Plan, reducer: _Reducer, findings: Findings) -> g.Goal | None:
    if plan.top is None:
        findings.add(
            "error", "no-goal", "the plan has no top goal", plan.span, hint="say what is wanted: `(goalem GOAL)`"
        )
        return None
    return reducer.goal(plan.top.goal, "(goalem)")


@dataclass(slots=True)
class _Reducer:
    """Puts rule bodies in the place of goals; each rule is reduced once and shared."""

    scope: Scope
    done: dict[tuple[str, str], g.Goal] = field(default_factory=dict)
    sizes: dict[int, int] = field(default_factory=dict)
    path: list[tuple[tuple[str, str], Span]] = field(default_factory=list)

    def goal(self, goal: p.Goal, rule: str) -> g.Goal:
        """The goal with everything inside it reduced; `rule` is the head of the rule that it stands in."""
        match goal:
            case p.Do(output, value, span):
                declared = self.scope.output(output, span)
                return g.Do(output, resolve_value(value, declared.type if declared else None, self.scope), rule, span)
            case p.Anything(span):
                return g.Anything(rule, span)
            case p.If(condition, then, otherwise, span):
                resolved = resolve_condition(condition, self.scope)
                return self._sized(g.If(resolved, self.goal(then, rule), self.goal(otherwise, rule), rule, span))
            case p.And(goals, span):
                return self._sized(g.And(tuple(self.goal(inner, rule) for inner in goals), span))
            case p.Or(goals, span):
                return self._sized(g.Or(tuple(self.goal(inner, rule) for inner in goals), span))
            case p.PrioAnd(goals, span):
                return self._sized(g.PrioAnd(tuple(self.goal(inner, rule) for inner in goals), span))
            case p.Subgoal(kind, name, span):
                return self._subgoal(kind, name, span)

    def _subgoal(self, kind: str, name: str, span: Span) -> g.Goal:
        self.scope.used[("rule", f"({kind} {name})")] = None
        if (kind, name) not in self.scope.rules:
            self._no_rule(kind, name, span)
            return g.Anything(f"({kind} {name})", span)
        circle = [key for key, _ in self.path]
        if (kind, name) in circle:
            self._circle(circle.index((kind, name)), kind, name, span)
            return g.Anything(f"({kind} {name})", span)
        if len(self.path) >= DEEPEST:
            self.scope.findings.add(
                "error", "too-deep", f"rules are nested deeper than {DEEPEST}", span, related=self._steps(0)[:3]
            )
            return g.Anything(f"({kind} {name})", span)
        self.path.append(((kind, name), span))
        body = self.rule(kind, name)
        self.path.pop()
        return self._sized(g.Reduced(f"({kind} {name})", body, span, self.scope.rules[(kind, name)][0].span))

    def rule(self, kind: str, name: str) -> g.Goal:
        """The body of a rule; several rules of one head are an `or` in textual order (L17)."""
        if (kind, name) in self.done:
            return self.done[(kind, name)]
        if not self.path or self.path[-1][0] != (kind, name):
            self.path.append(((kind, name), self.scope.rules[(kind, name)][0].head_span))
            body = self.rule(kind, name)
            self.path.pop()
            return body
        rules = self.scope.rules[(kind, name)]
        head = f"({kind} {name})"
        bodies = tuple(self.goal(rule.goal, head) for rule in rules)
        if len(rules) > 1:
            self.scope.findings.add(
                "warning", "several-rules", f"{len(rules)} rules reduce `{head}`: they are alternatives in this order",
                rules[0].head_span,
                related=[Related("another", rule.head_span) for rule in rules[1:]],
                hint="say `(or …)` in one rule if this is meant",
            )  # fmt: skip
            self.done[(kind, name)] = self._sized(g.Or(bodies, rules[0].span))
        else:
            self.done[(kind, name)] = bodies[0]
        return self.done[(kind, name)]

    def _sized(self, node: g.Goal) -> g.Goal:
        size = 1 + sum(self.sizes.get(id(child), 1) for child in g.children(node))
        if size > LARGEST:
            self.scope.findings.add(
                "error", "too-large", f"the reduced goal has more than {LARGEST:,} nodes", node.span
            )
            return g.Anything("", node.span)
        self.sizes[id(node)] = size
        return node

    def _steps(self, start: int) -> list[Related]:
        return [Related(f"which asks for `({kind} {name})`", span) for (kind, name), span in self.path[start:]]

    def _circle(self, start: int, kind: str, name: str, span: Span) -> None:
        names = [f"({k} {n})" for (k, n), _ in self.path[start:]] + [f"({kind} {name})"]
        self.scope.findings.add(
            "error", "goal-circle", f"`({kind} {name})` reduces to itself: {' → '.join(names)}", span,
            related=self._steps(start + 1),
        )  # fmt: skip

    def _no_rule(self, kind: str, name: str, span: Span) -> None:
        other = "maint" if kind == "ach" else "ach"
        meant = close(name, [n for k, n in self.scope.rules if k == kind])
        hint = f"write `(defgoalr ({kind} {name}) GOAL)`"
        if (other, name) in self.scope.rules:
            hint = f"there is a rule for `({other} {name})`; `ach` and `maint` are different heads"
        elif meant:
            hint = f"did you mean `({kind} {meant})`?"
        self.scope.findings.add("error", "no-rule", f"no rule reduces `({kind} {name})`", span, hint=hint)
