"""The words of a reproduced experiment: what is run, what is seen of it, what is measured and how that is judged.

Takes: nothing. Gives: frozen values. Leaves alone: which experiments there are (rows/, one file each), who runs them
(experiment.py) and how they are shown (report.py, page.py).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from behaviours.interface import Command, Pose, Reading, Report, View
from rplan.apps.sweep.work import Change
from rplan.apps.sweep.work import Row as Columns
from sim.judge import Verdict

Preset = Literal["paper", "modern"]
PRESETS: tuple[Preset, ...] = ("paper", "modern")
Judgement = Literal["met", "close", "missed"]

Measures = Columns
"""What one episode measured: `case`, `preset`, `seed`, `error` (None: it ran), and what the row's `measure` gives."""


@dataclass(frozen=True, slots=True)
class Case:
    """Episodes of one kind. plan, scenario: below plans/; seeds: one episode each.

    settings: keys of the scenario with other values, as YAML (`things[0].speed`, `1.2`). changes: of parameters of the
    plan's libraries. presets: with which it is run.
    """

    name: str
    plan: str
    scenario: str
    seeds: tuple[int, ...]
    settings: tuple[tuple[str, str], ...] = ()
    changes: tuple[Change, ...] = ()
    presets: tuple[Preset, ...] = PRESETS

    @property
    def is_plain(self) -> bool:
        """Whether plan and scenario are run as their files have them."""
        return not (self.settings or self.changes)


@dataclass(frozen=True, slots=True)
class Moment:
    """One tick. pose, speed [m/s], movers (donor and what else may move, while it is there): the truth.

    action: what the plan sent to the drive, as text; shown: what it gave to look at, where that is new.
    """

    time: float
    pose: Pose
    speed: float
    action: str
    reading: Reading
    command: Command
    percepts: Mapping[str, bool | float]
    reports: Mapping[str, Report]
    movers: Mapping[str, Pose]
    shown: Mapping[str, View]


@dataclass(frozen=True, slots=True)
class Seen:
    """One episode, whole."""

    verdict: Verdict
    period: float
    moments: Sequence[Moment]


@dataclass(frozen=True, slots=True)
class Plot:
    """How a measure spreads, as the share of episodes below it. band: the paper's least and greatest."""

    key: str
    label: str
    scale: float = 1.0
    band: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Drawn:
    """A map that the robot draws of the run that a page shows. words: what it is; changes: of the plan's libraries."""

    words: str
    changes: tuple[Change, ...] = ()


@dataclass(frozen=True, slots=True)
class Finding:
    """One figure of the paper and ours. because: why it is not met, empty where it is; case, seed: one run to see."""

    what: str
    printed: str
    ours: str
    judgement: Judgement
    because: str = ""
    case: str = ""
    seed: int | None = None


@dataclass(frozen=True, slots=True)
class Row:
    """One experiment.

    set_up: what is run; printed: what the paper says; presets: those that it is judged by, unless others are asked for.
    cases: for a number of seeds; none where nothing is driven. measure: of one episode. judge: of all
    episodes of one preset that ran. plots: of measures, over all cases. note: what agreement is worth.
    modern: what else the preset modern changes in the plan. picture: the case that pages draw, "": the first figure's.
    courses: cases of which pages also draw one run each, by `draw`: the run, its title, the file.
    maps: those that pages show side by side of the run they draw; the plan uses the library `mapping`.
    """

    name: str
    paper: str
    title: str
    set_up: str
    printed: str
    cases: Callable[[int], tuple[Case, ...]]
    measure: Callable[[Seen], Measures]
    judge: Callable[[Preset, Sequence[Measures]], tuple[Finding, ...]]
    presets: tuple[Preset, ...] = ("paper",)
    plots: tuple[Plot, ...] = ()
    note: str = ""
    modern: tuple[Change, ...] = ()
    picture: str = ""
    maps: tuple[Drawn, ...] = ()
    courses: tuple[str, ...] = ()
    draw: Callable[[Seen, str, Path], None] | None = None

    def cases_with(self, preset: Preset, seeds: int) -> tuple[Case, ...]:
        """Those that are run with a preset."""
        return tuple(case for case in self.cases(seeds) if preset in case.presets)
