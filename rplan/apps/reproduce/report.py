"""Measures of every row as one table, for people and for programs.

Takes: rows with their presets, measures of all episodes. Gives: `Result`s, a rich table, plain values. Leaves alone:
pages and pictures; see page.py.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rich.table import Table
from rich.text import Text

from rplan.apps.reproduce.experiment import PRESET, Asked
from rplan.apps.reproduce.figures import case_of
from rplan.apps.reproduce.row import Case, Finding, Judgement, Measures

STYLES: Mapping[Judgement, str] = {"met": "green", "close": "yellow", "missed": "red"}


@dataclass(frozen=True, slots=True)
class Result:
    """A row with a preset and what came of it. measures: of the episodes that ran; failed: those that did not."""

    asked: Asked
    cases: tuple[Case, ...]
    measures: tuple[Measures, ...]
    failed: tuple[Measures, ...]
    findings: tuple[Finding, ...]


def results(asked: Sequence[Asked], measures: Sequence[Measures], seeds: int) -> list[Result]:
    """Every row judged by its own episodes."""
    return [_result(one, measures, seeds) for one in asked]


def _result(one: Asked, measures: Sequence[Measures], seeds: int) -> Result:
    mine = [m for m in measures if (m.get("row"), m.get(PRESET)) == (one.row.name, one.preset)]
    ran = tuple(m for m in mine if m.get("error") is None)
    failed = tuple(m for m in mine if m.get("error") is not None)
    cases = one.row.cases_with(one.preset, seeds)
    return Result(one, cases, ran, failed, one.row.judge(one.preset, ran))


def see(result: Result, finding: Finding) -> str:
    """The command that shows one run of a finding; empty where nothing is driven."""
    name, case = result.asked.row.name, next((c for c in result.cases if c.name == finding.case), None)
    if case is None or finding.seed is None:
        return "rplan ways --paper plans/figure_1/text.rplan" if not result.cases else ""
    if result.asked.preset == "paper" and case.is_plain:
        world = case.scenario.removeprefix(f"{case.plan}/")
        return f"rplan simulate plans/{case.plan} --scenario {world} --seed {finding.seed} --replay x.html"
    preset = "" if result.asked.preset == "paper" else f" --preset {result.asked.preset}"
    return f"rplan reproduce {name}{preset} --case '{case.name}' --seed {finding.seed} --replay x.html"


def preset_of(result: Result) -> str:
    """What the table says of the preset; nothing where nothing is driven."""
    return result.asked.preset if result.cases else "-"


def table(every: Sequence[Result]) -> Table:
    """One line a finding."""
    shown = Table(box=None, pad_edge=False, padding=(0, 1))
    shown.add_column("row", no_wrap=True)
    shown.add_column("preset", no_wrap=True)
    for name, ratio in (("set-up", 4), ("what", 2), ("paper", 2), ("ours", 4)):
        shown.add_column(name, overflow="fold", ratio=ratio)
    shown.add_column("verdict", no_wrap=True)
    shown.add_column("one run", overflow="fold", ratio=5)
    for result in every:
        for k, finding in enumerate(result.findings):
            row = result.asked.row
            first = (row.name, preset_of(result), row.set_up) if k == 0 else ("", "", "")
            verdict = Text(finding.judgement, STYLES[finding.judgement])
            shown.add_row(*first, finding.what, finding.printed, finding.ours, verdict, see(result, finding))
    return shown


def reasons(every: Sequence[Result]) -> list[str]:
    """Why, where something is not met, and what did not run."""
    told = [
        f"{result.asked.row.name} ({preset_of(result)}), {finding.what}: {finding.judgement}, since {finding.because}"
        for result in every
        for finding in result.findings
        if finding.because
    ]
    told += [
        f"{result.asked.row.name} ({result.asked.preset}), {case_of(one)}, seed {one.get('seed')}: {one.get('error')}"
        for result in every
        for one in result.failed
    ]
    return told


def plain(every: Sequence[Result]) -> list[dict[str, object]]:
    """For programs: findings and the measures of every episode."""
    return [
        {
            "row": result.asked.row.name,
            "paper": result.asked.row.paper,
            "preset": result.asked.preset if result.cases else None,
            "title": result.asked.row.title,
            "set_up": result.asked.row.set_up,
            "printed": result.asked.row.printed,
            "findings": [
                {
                    "what": f.what,
                    "paper": f.printed,
                    "ours": f.ours,
                    "verdict": f.judgement,
                    "because": f.because,
                    "see": see(result, f),
                }
                for f in result.findings
            ],
            "episodes": [*result.measures, *result.failed],
        }
        for result in every
    ]
