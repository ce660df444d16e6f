"""Parts of a plan that are never reached: known answers, members never served, alternatives never taken.

Takes: a `Reach`. Gives: one warning for each such part, at the outermost place, with everything inside it that is
never done. Leaves alone: a rule that stands in several places and is reached in one of them.
"""

from __future__ import annotations

from collections.abc import Iterator

from rplan.goals.condition import print_condition
from rplan.goals.goal import Do, Goal, If, Or, PrioAnd, print_goal
from rplan.lang.diagnostic import Diagnostic, Related
from rplan.lang.source import Span
from rplan.ways.checks.conflicts import clash
from rplan.ways.checks.finding import Place, also, not_decided, places, shown
from rplan.ways.layout import Node
from rplan.ways.reach import Reach
from rplan.ways.reduce import Ways
from rplan.ways.situations import Undecided, replay
from rplan.ways.way import label

NEVER_DONE = "so this is never done"


def check_branches(reach: Reach) -> Iterator[Diagnostic]:
    """Everything that is never reached, said once."""
    yield from _Branches(reach).findings()


class _Branches:
    def __init__(self, reach: Reach) -> None:
        self.reach = reach
        self.ways: Ways = reach.ways
        self.every = places(self.ways, lambda node: _key(node.goal))
        self.undecided: dict[Span, None] = {}
        self.never = self._never()

    def _never(self) -> dict[int, bool]:
        """Node number -> every node of its place is never reached."""
        parent_never: dict[int, bool] = {}
        for node in self.ways.layout.nodes:
            above = node.parent >= 0 and parent_never[node.parent]
            parent_never[node.number] = above or self._impossible(
                node.goal.span, (self.ways.reached[node.number], True)
            )
        self.alone = parent_never
        return {
            node.number: all(parent_never[n.number] for n in place.nodes)
            for place in self.every
            for node in place.nodes
        }

    def _impossible(self, span: Span, *question: tuple[int, bool]) -> bool:
        answer = self.reach.possible(*question)
        if isinstance(answer, Undecided):
            self.undecided[span] = None
        return answer is False

    def findings(self) -> Iterator[Diagnostic]:
        if self.alone[0]:
            return
        for place in self.every:
            reached = [node for node in place.nodes if not self.alone[node.number]]
            match place.goal:
                case If(condition=condition, generated=False) if reached:
                    yield from self._condition(place, reached, print_condition(condition))
                case Or() if reached:
                    yield from self._alternatives(reached)
                case PrioAnd() if reached:
                    yield from self._members(reached)
        for span in self.undecided:
            yield not_decided("whether this is ever reached", span)

    # --- conditions ---

    def _condition(self, place: Place, reached: list[Node], text: str) -> Iterator[Diagnostic]:
        for value, word in ((True, "true"), (False, "false")):
            never = all(self.alone[self._branch(node, not value)] for node in reached)
            if never and not any(self.alone[self._branch(node, value)] for node in reached):
                yield self._known(place, reached, text, value, word)

    def _branch(self, node: Node, value: bool) -> int:
        return self.ways.layout.inside[node.number][0 if value else 1]

    def _known(self, place: Place, reached: list[Node], text: str, value: bool, word: str) -> Diagnostic:
        lost = self._lost([self._branch(node, not value) for node in reached])
        again = [self._asked_before(node) for node in reached]
        if all(again):
            return Diagnostic(
                "duplicate-condition", "warning",
                f"`{text}` is asked a second time on one path: here it is always {word}",
                place.goal.span, (*also("it is asked first here", (span for span in again if span)), *lost),
                "leave the second question out",
            )  # fmt: skip
        reasons = dict.fromkeys(span for node in reached for span in self._reasons(node, not value))
        return Diagnostic(
            "always-true" if value else "always-false", "warning",
            f"`{text}` is always {word} where it is asked", place.goal.span,
            (*also("after what is asked here", reasons), *lost), "leave the question out, or mend it",
        )  # fmt: skip

    def _above(self, node: Node) -> Iterator[tuple[Node, bool]]:
        """The `if`s around a node with the branch that it is in, the innermost first."""
        child = node
        while child.parent >= 0:
            parent = self.ways.layout.nodes[child.parent]
            if isinstance(parent.goal, If):
                yield parent, self.ways.layout.inside[parent.number][0] == child.number
            child = parent

    def _asked_before(self, node: Node) -> Span | None:
        asked = self.ways.asked
        same = (asked[node.number], self.ways.guards.negation(asked[node.number]))
        return next((parent.goal.span for parent, _ in self._above(node) if asked[parent.number] in same), None)

    def _reasons(self, node: Node, value: bool) -> list[Span]:
        """The `if`s around it that rule a value out, none of them to be spared; empty where it is not they alone."""
        above = [(parent.goal.span, (self.ways.asked[parent.number], branch)) for parent, branch in self._above(node)]
        wanted = (self.ways.asked[node.number], value)
        if self.reach.possible(wanted, *(one for _, one in above)) is not False:
            return []
        for reason in list(above):
            fewer = [one for one in above if one is not reason]
            if self.reach.possible(wanted, *(one for _, one in fewer)) is False:
                above = fewer
        return [span for span, _ in above]

    # --- alternatives and members ---

    def _alternatives(self, reached: list[Node]) -> Iterator[Diagnostic]:
        inside = self.ways.layout.inside
        for number in range(len(inside[reached[0].number])):
            here = [inside[node.number][number] for node in reached]
            goals = [self.ways.layout.nodes[child].goal for child in inside[reached[0].number][: number + 1]]
            texts = [print_goal(goal) for goal in goals]
            if texts[-1] in texts[:-1]:
                first = goals[texts.index(texts[-1])]
                yield Diagnostic(
                    "duplicate-rule", "warning", f"{label(goals[-1])} is the same as an alternative before it",
                    goals[-1].span, (Related("the same is here", first.span), *self._lost(here)),
                    "leave one of them out",
                )  # fmt: skip
            elif all(self.alone[child] for child in here) and not self._goes(reached, number):
                yield Diagnostic(
                    "dead", "warning",
                    f"{label(goals[-1])} is never taken: it does not go together with what else must be, or another "
                    "alternative gives up less",
                    goals[-1].span, self._lost(here), "leave it out, or let what stands against it be given up",
                )  # fmt: skip
            elif all(self.alone[child] for child in here):
                yield Diagnostic(
                    "shadowed", "warning",
                    f"{label(goals[-1])} is never taken: an alternative before it always goes at least as well",
                    goals[-1].span,
                    (*also("an alternative before it", (goal.span for goal in goals[:-1])), *self._lost(here)),
                    "put it first, or leave it out",
                )  # fmt: skip

    def _goes(self, reached: list[Node], number: int) -> bool:
        """Whether an alternative could be taken if none stood before it."""
        offers = (self.ways.on_offer.get((node.number, number)) for node in reached)
        return any(offer is not None and self.reach.possible((offer, True)) is not False for offer in offers)

    def _members(self, reached: list[Node]) -> Iterator[Diagnostic]:
        inside = self.ways.layout.inside
        for number in range(1, len(inside[reached[0].number])):
            here = [inside[node.number][number] for node in reached]
            if all(self.alone[child] for child in here):
                yield self._never_served(reached[0], here)
                return

    def _never_served(self, node: Node, here: list[int]) -> Diagnostic:
        goal = self.ways.layout.nodes[here[0]].goal
        later = [self.ways.layout.nodes[child] for child in self.ways.layout.inside[node.number]]
        with_it = [one.goal for one in later if one.number > here[0]]
        message = f"{label(goal)} is never served together with what comes before it"
        if with_it:
            message += f", nor what comes after it: {', '.join(map(label, with_it))}"
        lost = self._lost([one.number for one in later if one.number >= here[0]])
        trace = self.reach.trace((self.ways.reached[node.number], True))
        if trace is None or isinstance(trace, Undecided):
            return Diagnostic("dead", "warning", message, goal.span, lost)
        against = clash(self.ways, here[0], replay(self.ways, trace).guards)
        related = tuple(Related(f"`{do.output}` is set to {do.value.text} here", do.span) for do in against)
        return shown(self.ways, trace, "dead", "warning", message, goal.span, (*related, *lost))

    def _lost(self, numbers: list[int]) -> tuple[Related, ...]:
        """The acts inside these nodes that are never done anywhere."""
        stack, found = list(reversed(numbers)), []
        while stack:
            node = self.ways.layout.nodes[stack.pop()]
            if isinstance(node.goal, Do) and self.never[node.number]:
                found.append(node.goal.span)
            stack.extend(reversed(self.ways.layout.inside[node.number]))
        return also(NEVER_DONE, found)


def _key(goal: Goal) -> object:
    """What makes two nodes one place of the text; arguments of rules may differ."""
    match goal:
        case Do(output=output, value=value, span=span):
            return "do", output, value.text, span
        case If(condition=condition, span=span):
            return "if", print_condition(condition), span
        case Or() | PrioAnd():
            return type(goal).__name__, goal.span, print_goal(goal)
        case _:
            return type(goal).__name__, goal.span
