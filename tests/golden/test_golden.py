"""Every stage of a plan, print for print.

A golden file is a line with the command and the plan, then what the command prints. Adding a test is adding a file;
`RPLAN_BLESS=1` in the environment rewrites what is expected.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from rplan.apps.wiring import compile_source
from rplan.backends.python import emit
from rplan.circuit.circuit import print_circuit
from rplan.driver import Compiled
from rplan.goals.goal import print_goal
from rplan.lang.printer import print_plan
from rplan.lang.source import Source
from rplan.ways.listing import taken_ways
from rplan.ways.situations import replay
from rplan.ways.way import TakenWay, taken_way

HERE = Path(__file__).parent
PLANS = HERE.parents[1] / "plans"
GOLDEN = sorted(HERE.glob("*.txt"))


def printed(stage: str, plan: Compiled) -> str:
    match stage:
        case "plan":
            return print_plan(plan.plan)
        case "goals":
            return laid_out(print_goal(plan.goals.top))
        case "ways":
            return "".join(sorted(ways(plan)))
        case "circuit":
            return print_circuit(plan.circuit)
        case "python":
            return emit(plan.circuit)
        case _:
            raise ValueError(f"there is no stage {stage}")


def laid_out(goal: str) -> str:
    """A goal with a line for each goal inside it."""
    lines, depth = [], 0
    for part in re.split(r" (?=\((?:rule|if|do|prio-and) )", goal):
        lines.append("  " * depth + part)
        depth += part.count("(") - part.count(")")
    return "\n".join(lines) + "\n"


def ways(plan: Compiled) -> list[str]:
    """Each way that can be taken: its rules, branches, acts, and what it gives up. Situations are left to z3."""
    return [one(way) for way in every_way(plan)]


def every_way(plan: Compiled) -> list[TakenWay]:
    last = [replay(plan.ways, trace) for trace in taken_ways(plan.ways, 1_000)]
    return [taken_way(plan.ways, seen.atoms, seen.registers) for seen in last]


def one(way: TakenWay) -> str:
    lines = ["way\n"]
    lines += [f"  if {'' if branch.value else 'not '}{branch.condition}\n" for branch in way.branches]
    lines += [f"  {act.output} = {act.value} by {act.rule}\n" for act in way.acts]
    lines += [f"  without {given.member}: {given.because}\n" for given in way.given_up]
    return "".join(lines)


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_every_stage_prints_as_expected(path: Path) -> None:
    first, _, expected = path.read_text(encoding="utf-8").partition("\n")
    stage, name = first.split()
    text = (PLANS / name).read_text(encoding="utf-8")
    now = printed(stage, compile_source(Source(Path(name).name, text)))
    if os.environ.get("RPLAN_BLESS") == "1":
        path.write_text(f"{first}\n{now}", encoding="utf-8")
    else:
        assert now == expected


def test_every_stage_has_its_golden_file() -> None:
    assert {path.stem.split(".")[-1] for path in GOLDEN} == {"plan", "goals", "ways", "circuit", "python"}
