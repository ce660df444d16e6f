"""The plans of one pytest run.

Takes: paths of plans. Gives: each compiled once, with the ticks that tests took with it. Leaves alone: what is tested.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from rplan.apps.libraries import catalogue
from rplan.apps.testing import PlanUnderTest
from rplan.apps.trying import Watch
from rplan.apps.wiring import compile_file
from rplan.driver import Compiled
from rplan.lang.diagnostic import Diagnostic, PlanError, render
from rplan.lang.source import Span
from rplan.runtime.tick import Decision
from rplan.ways.checks.branches import check_branches
from rplan.ways.forks import Fork, forks
from rplan.ways.parts import Asked, asked
from rplan.ways.reach import Reach
from rplan.ways.tally import Bits, Prover, Reached, Ticks, reached


@dataclass
class Plan:
    """A compiled plan, what has been proven of it, and the ticks that were seen of it.

    explained: so many of its rules failed and were put into words.
    """

    compiled: Compiled
    ticks: Ticks = field(default_factory=dict)
    explained: int = 0

    def watch(self, decision: Decision) -> None:
        """Count a tick."""
        key = (decision.inputs, decision.registers)
        self.ticks[key] = self.ticks.get(key, 0) + 1

    @cached_property
    def reach(self) -> Reach:
        return Reach(self.compiled.ways)

    @cached_property
    def asked(self) -> Asked:
        """The parts of its conditions."""
        return asked(self.compiled.ways)

    @cached_property
    def prover(self) -> Prover:
        """What can be reached of it, the parts of its conditions too."""
        return Prover(self.asked.ways)

    def reached(self) -> Reached:
        """What the ticks that were seen reached of it."""
        return reached(self.asked, self.ticks, self.prover)

    @cached_property
    def forks(self) -> tuple[Fork, ...]:
        return forks(self.compiled.ways)

    @cached_property
    def by_rule(self) -> dict[Span, list[Fork]]:
        """The forks of each rule, by its place; the first says whether the rule is served."""
        found: dict[Span, list[Fork]] = {}
        for fork in self.forks:
            found.setdefault(fork.owner, []).append(fork)
        return found

    @cached_property
    def never(self) -> tuple[Diagnostic, ...]:
        """Why parts of it are never reached."""
        return tuple(check_branches(self.reach))


class Shelf:
    """Plans by path. A plan that is edited during a run is the one that was read first."""

    def __init__(self, library_files: Iterable[Path] = ()) -> None:
        self.libraries = catalogue(library_files)
        self.plans: dict[Path, Plan] = {}
        self.substitutes: Mapping[Path, Compiled] = {}
        self.opened: dict[Path, None] = {}

    def plan(self, path: Path) -> Plan:
        """The plan in a file, holes allowed; `PlanError`, `OSError`."""
        known = path.resolve()
        if known not in self.plans:
            self.plans[known] = Plan(compile_file(path, allow_holes=True, libraries=self.libraries))
        return self.plans[known]

    def under_test(self, path: Path) -> PlanUnderTest:
        """A plan for a test in Python; what stands in `substitutes` takes its place."""
        known = path.resolve()
        self.opened[known] = None
        if known in self.substitutes:
            return PlanUnderTest(self.substitutes[known], self.libraries, ways=False)
        plan = self.plan(path)
        watch: Watch = plan.watch
        return PlanUnderTest(plan.compiled, self.libraries, watch)

    # --- between processes ---

    def handed_over(self) -> dict[str, list[tuple[str, str, int]]]:
        """The ticks that were seen of each plan, as plain values."""
        return {
            str(path): [(_text(inputs), _text(registers), times) for (inputs, registers), times in plan.ticks.items()]
            for path, plan in self.plans.items()
        }

    def taken_over(self, path: Path, ticks: Iterable[tuple[str, str, int]]) -> None:
        """Count what another process has seen."""
        plan = self.plan(path)
        for inputs, registers, times in ticks:
            key = (_bits(inputs), _bits(registers))
            plan.ticks[key] = plan.ticks.get(key, 0) + times


def _text(bits: Bits) -> str:
    return "".join("1" if bit else "0" for bit in bits)


def _bits(text: str) -> Bits:
    return tuple(letter == "1" for letter in text)


def rendered(error: PlanError) -> str:
    """Everything that is wrong with a plan."""
    every = [render(one, error.texts) for one in error.diagnostics if one.severity == "error"]
    return "\n\n".join(every or [render(one, error.texts) for one in error.diagnostics])
