"""Sees every tick of an episode, and what rows ask of what was seen.

Takes: a compiled plan, a scenario, a seed. Gives: `Seen`, and questions to it that several rows ask. Leaves alone: what
a row makes of the answers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

from rplan.apps.libraries import Catalogue
from rplan.apps.reproduce.row import Moment, Seen
from rplan.apps.simulation import OPEN
from rplan.apps.wiring import PlanBrain
from rplan.driver import Compiled
from sim.episode import Episode
from sim.scenarios.scenario import Scenario
from sim.things.thing import Thing

FLEEING = "(move-away-from-danger)"
NAVIGATE = "move-according-to-NaT-plan"
MOVING = 0.01  # [m/s] above which the robot is in motion


@dataclass(slots=True)
class Watch:
    """Keeps every tick."""

    brain: PlanBrain
    moments: list[Moment] = field(default_factory=list)
    _movers: tuple[Thing, ...] | None = None
    _action: str = field(init=False)

    def __post_init__(self) -> None:
        """The action is what the first channel of commands holds."""
        outputs = self.brain.compiled.goals.outputs
        self._action = next((o.name for o in outputs if o.type is not None and o.type.name == "command"), "")

    def observe(self, episode: Episode) -> None:
        """See a tick; the standing still after the last one is none."""
        tick = self.brain.tick
        if episode.over or tick is None:
            return
        world = episode.world
        if self._movers is None:
            self._movers = tuple(t for t in world.things if t.placed.moves or t.placed.kind == "donor")
        sent = tick.decision.sent.get(self._action)
        self.moments.append(
            Moment(
                time=episode.time,
                pose=world.robot.pose,
                speed=world.robot.speed,
                action=OPEN if sent is None else sent.text,
                reading=world.sense(),
                command=tick.command,
                percepts=tick.percepts,
                reports=tick.reports,
                movers={thing.placed.id: thing.pose for thing in self._movers if thing.present},
                shown=tick.shown,
            )
        )


class _Noteless(PlanBrain):
    """Nobody records the run, so nothing is put into words."""

    def note(self) -> str:
        return "null"


def watch(compiled: Compiled, scenario: Scenario, seed: int, libraries: Catalogue | None = None) -> Seen:
    """Drive one episode. Raises `PlanError`, `ScenarioError`."""
    brain = _Noteless(compiled, libraries)
    seen = Watch(brain)
    try:
        verdict = Episode(scenario, seed, compiled.goals.period).run(brain, None, seen)
    finally:
        brain.close()
    return Seen(verdict, compiled.goals.period, seen.moments)


# --- what rows ask ------------------------------------------------------------------------------------


def episodes_of(moments: Sequence[Moment], action: str, apart: float = 0.0) -> list[tuple[float, float]]:
    """From when to when [s] an action had its turn; breaks of no more than `apart` [s] do not count."""
    found: list[tuple[float, float]] = []
    for sent, some in groupby(moments, key=lambda moment: moment.action):
        if sent != action:
            continue
        stretch = list(some)
        begin, end = stretch[0].time, stretch[-1].time
        if found and begin - found[-1][1] <= apart:
            begin = found.pop()[0]
        found.append((begin, end))
    return found


def starts_of(moments: Sequence[Moment], competence: str) -> list[float]:
    """When [s] a competence began."""
    return [begin for begin, _ in episodes_of(moments, f"({competence})")]


def described(moment: Moment, competence: str) -> Mapping[str, Any]:
    """What a competence reported of its step; empty where it had no turn."""
    report = moment.reports.get(competence)
    return {} if report is None else report.details


def share_in_motion(moments: Sequence[Moment]) -> float:
    """Share of the ticks in which the robot moves."""
    return sum(abs(moment.speed) > MOVING for moment in moments) / len(moments) if moments else 0.0
