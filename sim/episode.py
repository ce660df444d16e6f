"""A run: sense, think, act, step, for any brain.

Takes: a scenario, a seed, and a `Brain`. Gives: a `Verdict`; to an observer, tick by tick, the
truth as plain JSON values. Leaves alone: what the brain is, where recordings go, how progress is shown.

One tick: the world is sensed, the brain thinks, the observer looks (the state, what was sensed in it and what was
decided belong together), the world is stepped. The robot stands (`STOP`) before the first tick, after the last and when
the brain raises.
"""

from __future__ import annotations

from typing import Protocol

from behaviours.interface import STOP, Command, Reading
from sim import snapshot
from sim.judge import Judge, Verdict
from sim.scenarios.scenario import Scenario
from sim.snapshot import Json
from sim.world import PERIOD, World


class Brain(Protocol):
    """Who decides."""

    def reset(self) -> None:
        """Before the first step of a run."""
        ...

    def step(self, reading: Reading) -> Command:
        """What to do now."""
        ...

    def note(self) -> str:
        """JSON text about the last step, for recordings ("null": nothing to say)."""
        ...


class Observer(Protocol):
    """Who watches: a recorder, a progress bar."""

    def observe(self, episode: Episode) -> None:
        """After the brain has decided, each tick, and once when the run is over; `episode.snapshot()` has the truth."""
        ...


class Episode:
    """One run of a scenario with a seed; period [s] of a tick. Raises ScenarioError where the seed finds no layout."""

    def __init__(self, scenario: Scenario, seed: int, period: float = PERIOD) -> None:
        self.scenario, self.seed = scenario, seed
        self.world = World(scenario, seed, period)
        self.judge = Judge(self.world)
        self.command: Command = STOP
        self.note = "null"
        self.over = False

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.world.time

    def tick(self, brain: Brain, observer: Observer | None = None) -> None:
        """Sense, think, show, step."""
        self.act(brain.step(self.world.sense()))
        if observer is not None:
            self.note = brain.note()
            observer.observe(self)
        self.advance()

    def act(self, command: Command) -> None:
        """What the robot is told in this tick."""
        self.command = command

    def advance(self) -> None:
        """The tick passes."""
        self.world.step(self.command)
        self.judge.observe()

    def run(self, brain: Brain, until_s: float | None = None, observer: Observer | None = None) -> Verdict:
        """Tick until the task is done, or lost, or the time [s] is over (None: the scenario's limit).

        What the brain raises is raised again, once the robot has been stopped.
        """
        until = self.scenario.time_limit if until_s is None else until_s
        brain.reset()
        try:
            while not self.judge.over and self.time < until - self.world.period / 2:
                self.tick(brain, observer)
        finally:
            self._stop()
        if observer is not None:
            observer.observe(self)
        return self.judge.verdict()

    def _stop(self) -> None:
        self.command, self.note, self.over = STOP, "null", True
        self.world.step(STOP)

    # --- for recordings ---------------------------------------------------------------------------

    def header(self) -> Json:
        """What does not change: period, bounds, robot, home, donor, things that stand and things that move."""
        return snapshot.header(self.world)

    def snapshot(self) -> Json:
        """What is so now: lengths to the millimetre, angles to 1e-4 rad, NaN as None."""
        return snapshot.snapshot(self.world, self.judge.stage, self.command)


def run(
    scenario: Scenario, seed: int, brain: Brain, until_s: float | None = None, observer: Observer | None = None
) -> Verdict:
    """A whole episode."""
    return Episode(scenario, seed).run(brain, until_s, observer)
