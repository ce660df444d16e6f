"""Plan → Goals: every name looked up, every type checked, every rule put in the place of its goal.

Takes: a `Plan`, the signatures of libraries, and whether undeclared names are errors. Gives: `Goals` with warnings
and notes, or `PlanError` with everything that is wrong. Leaves alone: which goals conflict; see rplan/ways.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from rplan.goals import goal as g
from rplan.goals.claims import resolve_assumptions, resolve_properties
from rplan.goals.operators import checked_operators
from rplan.goals.papercuts import check_channels
from rplan.goals.regress import RegressionError, regress
from rplan.goals.resolve import (
    arguments_said,
    resolve_condition,
    resolve_definitions,
    resolve_outputs,
    resolve_settings,
    resolve_value,
)
from rplan.goals.scope import DEEPEST, LONGEST, Findings, Scope, report_unused, scope_of
from rplan.goals.signature import Libraries
from rplan.goals.substitute import Substitution, has_variables, unfold
from rplan.goals.symbols import symbols_of
from rplan.goals.trials import resolve_trials
from rplan.lang import plan as p
from rplan.lang.diagnostic import Diagnostic, PlanError, Related
from rplan.lang.printer import canonical, print_head
from rplan.lang.source import Span
from rplan.lang.suggest import close

DEPTH = 8
"""Steps of operators that a goal may take, where its text tells nothing (L20)."""
LARGEST = 2_000_000
"""Nodes of a reduced goal, at most."""

Key = tuple[str, ...]
"""Kind, name and the canonical texts of the arguments of a goal."""


def expand(plan: p.Plan, libraries: Libraries, *, strict: bool = False) -> tuple[g.Goals, tuple[Diagnostic, ...]]:
    """The reduced goal of a plan, and what is to be said of it."""
    findings = Findings()
    scope = scope_of(plan, libraries, strict, findings)
    settings = resolve_settings(plan, scope)
    for name, definition in scope.conditions.items():
        variables = tuple(p.Variable(parameter, definition.span) for parameter in definition.parameters)
        resolve_condition(p.Call(name, variables, definition.span), scope)
    scope.used = {key: None for key in scope.used if key[0] != "condition"}
    reducer = _Reducer(scope, checked_operators(plan, scope), symbols_of(plan))
    top = _top(plan, reducer, findings)
    for rule in plan.rules:
        reducer.unreached(rule)
    outputs = resolve_outputs(plan, scope, top)
    properties = resolve_properties(plan, scope, outputs)
    assumptions = resolve_assumptions(plan, scope, outputs)
    trials = resolve_trials(plan, scope, outputs)
    definitions = resolve_definitions(scope)
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
        rules=tuple(g.RuleInfo(print_head(rule), rule.doc, rule.span) for rule in plan.rules),
        libraries=settings,
        functions=dict(scope.functions),
        span=plan.span,
        definitions=definitions,
        properties=properties,
        assumptions=assumptions,
        tests=trials,
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
    """Puts rule bodies in the place of goals; each rule is reduced once for the same arguments, and shared.

    path: from the top goal to here; reached: the places of the heads of the rules that were come to.
    endless: something went so deep that no goal is followed any further.
    """

    scope: Scope
    operators: tuple[p.Operator, ...]
    symbols: tuple[str, ...]
    done: dict[Key, g.Goal] = field(default_factory=dict)
    sizes: dict[int, int] = field(default_factory=dict)
    path: list[tuple[Key, Span]] = field(default_factory=list)
    reached: dict[Span, None] = field(default_factory=dict)
    endless: bool = False

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
            case p.Subgoal():
                return self._subgoal(goal)
            case p.Achieve():
                return self._achieve(goal)

    def _subgoal(self, goal: p.Subgoal) -> g.Goal:
        key: Key = (goal.kind, goal.name, *map(canonical, goal.arguments))
        head = _head(key)
        rules = self._fitting(key)
        for rule in rules:
            self.scope.used[("rule", print_head(rule))] = None
        if any(map(has_variables, goal.arguments)):
            return self._in_general(goal, head)
        if self.endless:
            return g.Anything(head, goal.span)
        if not rules:
            return self._without_rule(goal, head)
        self._beaten(goal, head, rules[0])
        circle = [one for one, _ in self.path]
        if key in circle:
            self._circle(circle.index(key), head, goal.span)
            return g.Anything(head, goal.span)
        if len(self.path) >= DEEPEST or len(head) > LONGEST:
            self._too_deep(goal.span)
            return g.Anything(head, goal.span)
        self.path.append((key, goal.span))
        body = self._body(key, rules, goal.arguments)
        self.path.pop()
        return self._sized(g.Reduced(head, body, goal.span, rules[0].span))

    def _fitting(self, key: Key) -> list[p.Rule]:
        """The rules whose heads fit, in textual order."""
        kind, name, *texts = key
        return [
            rule
            for rule in self.scope.rules.get((kind, name), ())
            if len(rule.parameters) == len(texts)
            and all(
                isinstance(one, p.Variable) or canonical(one) == text
                for one, text in zip(rule.parameters, texts, strict=True)
            )
        ]

    def unreached(self, rule: p.Rule) -> None:
        """Check a rule that no goal has come to; its variables stay, and what they stand for is not asked."""
        if rule.head_span in self.reached:
            return
        key: Key = (rule.kind, rule.name, *map(canonical, rule.parameters))
        self.path.append((key, rule.head_span))
        if any(map(has_variables, rule.parameters)):
            self.goal(rule.goal, _head(key))
        else:
            self._body(key, self._fitting(key), rule.parameters)
        self.path.pop()

    def _in_general(self, goal: p.Subgoal, head: str) -> g.Goal:
        """A subgoal whose arguments are not known: some rule or operator has to be there."""
        rules = self.scope.rules.get((goal.kind, goal.name), [])
        if not any(len(rule.parameters) == len(goal.arguments) for rule in rules):
            return self._without_rule(goal, head)
        return g.Anything(head, goal.span)

    def _body(self, key: Key, rules: list[p.Rule], arguments: tuple[p.Argument, ...]) -> g.Goal:
        """What the rules make of the arguments; several rules of one head are an `or` in textual order (L17)."""
        if key in self.done:
            return self.done[key]
        head = _head(key)
        for rule in rules:
            self.reached[rule.head_span] = None
        bodies = tuple(self.goal(self._instance(rule, arguments), head) for rule in rules)
        self.done[key] = bodies[0] if len(rules) == 1 else self._sized(g.Or(bodies, rules[0].span))
        if len(rules) > 1:
            self._several(head, rules)
        return self.done[key]

    def _instance(self, rule: p.Rule, arguments: tuple[p.Argument, ...]) -> p.Goal:
        """The body of the rule with the arguments in the place of its variables."""
        bound = {
            parameter.name: argument
            for parameter, argument in zip(rule.parameters, arguments, strict=True)
            if isinstance(parameter, p.Variable)
        }
        return Substitution(bound, self.scope.findings).goal(rule.goal) if bound else rule.goal

    def _several(self, head: str, rules: list[p.Rule]) -> None:
        self.scope.findings.add(
            "warning", "several-rules", f"{len(rules)} rules reduce `{head}`: they are alternatives in this order",
            rules[0].head_span,
            related=[Related("another", rule.head_span) for rule in rules[1:]],
            hint="say `(or …)` in one rule if this is meant",
        )  # fmt: skip

    # --- operators ---

    def _without_rule(self, goal: p.Subgoal, head: str) -> g.Goal:
        """A goal that only operators can answer; (NAME ARG…) is the fact."""
        if goal.kind == "ach" and self.operators and all(map(_is_value, goal.arguments)):
            fact = p.Call(goal.name, goal.arguments, goal.span)
            return self._regressed(fact, goal.depth, head, goal.span)
        self._no_rule(goal, head)
        return g.Anything(head, goal.span)

    def _regressed(self, condition: p.Condition, depth: int | None, head: str, span: Span) -> g.Goal:
        """Operators in the place of a goal, as an ordinary goal (L20)."""
        unfolded = unfold(condition, self.scope.conditions, self.scope.findings)
        try:
            clauses = regress(unfolded, self.operators, self.symbols, DEPTH if depth is None else depth, span)
        except RegressionError as error:
            self.scope.findings.add("error", "no-regression", f"`{head}` cannot be regressed: {error}", span)
            return g.Anything(head, span)
        goal: g.Goal = g.Impossible(span)
        for clause in reversed(clauses):
            act = g.Anything(head, span) if clause.act is None else self.goal(clause.act, head)
            goal = self._sized(g.If(resolve_condition(clause.condition, self.scope), act, goal, head, act.span, True))
        return self._sized(g.Reduced(head, goal, span, self.operators[0].span))

    def _achieve(self, goal: p.Achieve) -> g.Goal:
        head = f"(ach {canonical(goal.condition)})"
        if has_variables(goal.condition) or self.endless:
            return g.Anything(head, goal.span)
        if not self.operators:
            self.scope.findings.add(
                "error", "no-rule", f"no operator answers `{head}`", goal.span,
                hint="goals that are conditions are answered by operators: "
                "`(defop (NAME) :do (OUTPUT VALUE) :pre CONDITION :add (FACT…))`",
            )  # fmt: skip
            return g.Anything(head, goal.span)
        return self._regressed(goal.condition, goal.depth, head, goal.span)

    def _beaten(self, goal: p.Subgoal, head: str, rule: p.Rule) -> None:
        """Warn where operators could answer too (L20)."""
        adding = [
            operator
            for operator in self.operators
            if goal.kind == "ach"
            and any(fact.name == goal.name and len(fact.arguments) == len(goal.arguments) for fact in operator.adds)
        ]
        if adding:
            self.scope.findings.add(
                "warning", "rule-beats-operators", f"a rule reduces `{head}`; operators that add it are not asked",
                rule.head_span, related=[Related("this one adds it", one.head_span) for one in adding],
            )  # fmt: skip

    # --- what went wrong ---

    def _sized(self, node: g.Goal) -> g.Goal:
        size = 1 + sum(self.sizes.get(id(child), 1) for child in g.children(node))
        if size > LARGEST:
            self.scope.findings.add(
                "error", "too-large", f"the reduced goal has more than {LARGEST:,} nodes", node.span
            )
            self.endless = True
            return g.Anything("", node.span)
        self.sizes[id(node)] = size
        return node

    def _steps(self, start: int) -> list[Related]:
        return [Related(f"which asks for `{_head(key)}`", span) for key, span in self.path[start:]]

    def _too_deep(self, span: Span) -> None:
        self.scope.findings.add(
            "error", "too-deep", f"rules are nested deeper than {DEEPEST}", span, related=self._steps(0)[:3]
        )
        self.endless = True

    def _circle(self, start: int, head: str, span: Span) -> None:
        names = [*(_head(key) for key, _ in self.path[start:]), head]
        self.scope.findings.add(
            "error", "goal-circle", f"`{head}` reduces to itself: {' → '.join(names)}", span,
            related=self._steps(start + 1),
        )  # fmt: skip

    def _no_rule(self, goal: p.Subgoal, head: str) -> None:
        kind, name = goal.kind, goal.name
        rules = self.scope.rules.get((kind, name), [])
        if rules and all(len(rule.parameters) != len(goal.arguments) for rule in rules):
            self.scope.findings.add(
                "error", "wrong-arity", f"no rule for `({kind} {name} …)` takes {arguments_said(len(goal.arguments))}",
                goal.span, related=[Related("a rule is here", rule.head_span) for rule in rules],
                hint=f"there are: {_heads(rules)}",
            )  # fmt: skip
            return
        self.scope.findings.add(
            "error", "no-rule", f"no rule reduces `{head}`", goal.span, hint=self._hint(goal, head, rules)
        )

    def _hint(self, goal: p.Subgoal, head: str, rules: list[p.Rule]) -> str:
        kind, name = goal.kind, goal.name
        other = "maint" if kind == "ach" else "ach"
        meant = close(name, [n for k, n in self.scope.rules if k == kind])
        if rules:
            return f"there are: {_heads(rules)}"
        if (other, name) in self.scope.rules:
            return f"there is a rule for `({other} {name})`; `ach` and `maint` are different heads"
        return f"did you mean `({kind} {meant})`?" if meant else f"write `(defgoalr {head} GOAL)`"


def _head(key: Key) -> str:
    return f"({' '.join(key)})"


def _heads(rules: list[p.Rule]) -> str:
    return ", ".join(dict.fromkeys(f"`{print_head(rule)}`" for rule in rules))


def _is_value(argument: p.Argument) -> bool:
    return isinstance(argument, p.Number | p.Truth | p.Call)
