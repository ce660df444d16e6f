"""Syntax to text (L21)."""

from __future__ import annotations

import pytest

from rplan.lang.parse import parse_text
from rplan.lang.plan import Call, Number, Truth
from rplan.lang.printer import WIDTH, canonical, print_condition, print_goal, print_plan, quoted
from rplan.lang.source import NOWHERE, Source

TEXT = """(plan patrol "a \\"round\\"" :period 0.2s)
(use lib :radius 7.62m :mode (paper))
(declare (distance (to pose)) (number m) "how far")
(defoutput action command :idle (stop))
(defoutput speed (number m/s) :hold :initial 0.1m/s)
(defcond (near) (< (distance (home)) 0.57m))
(defgoalr (ach go)
  "a goal with a text that is long enough for the rule to need more than one line, and then some"
  (if
    (and (near) (or (bumped) (not (lost))) (/= (distance (the-place-where-we-started)) 5))
    (do action (move))
    (do anything)))
(goalem (prio-and (maint safe) (or (ach go) (and (ach rest)))))
"""


def test_a_plan_is_laid_out_and_reads_back_to_the_same_text() -> None:
    plan, _ = parse_text(Source("a.rplan", TEXT))
    assert print_plan(plan) == TEXT
    assert all(len(line) <= WIDTH for line in TEXT.split("\n"))


def test_a_goal_and_a_condition_are_one_line() -> None:
    plan, _ = parse_text(Source("a.rplan", "(defcond c (and x\n (not y)))\n(goalem (when c\n (do o 57cm)))"))
    assert plan.top
    assert print_goal(plan.top.goal) == "(if (c) (do o 0.57m) (do anything))"
    assert print_condition(plan.conditions[0].condition) == "(and (x) (not (y)))"


@pytest.mark.rule("L21")
def test_canonical_text_of_values() -> None:
    home = Call("home", (), NOWHERE)
    assert canonical(home) == "(home)"
    assert (
        canonical(Call("go", (home, Number(7.62, "m", NOWHERE), Truth(True, NOWHERE)), NOWHERE))
        == "(go (home) 7.62m true)"
    )
    assert canonical(Number(2.0, "s", NOWHERE)) == "2s"
    assert canonical(Truth(False, NOWHERE)) == "false"


def test_quoting_escapes_what_a_string_cannot_hold() -> None:
    assert quoted('a "b"\n\\') == '"a \\"b\\"\\n\\\\"'
