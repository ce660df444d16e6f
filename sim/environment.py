"""A world that a program drives: `reset(seed)`, then `step(command)`, as reinforcement learning has it.

Takes: a scenario and commands. Gives: what the robot senses (a `Reading`, or what a function of yours makes of it), the
true state, and whether it is over. Leaves alone: rewards; make them of the state.

Nothing is shared between two environments, so many may run in one process, each with a recording of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Generic, NamedTuple, Self, TypeVar, cast, overload

from behaviours.interface import STOP, Command, Pose, Reading
from sim.episode import Episode
from sim.judge import Stage, Verdict
from sim.recording import Recorder
from sim.scenarios.scenario import Scenario
from sim.world import PERIOD, Touch

Seen = TypeVar("Seen")


def _as_it_is(reading: Reading) -> Reading:
    return reading


@dataclass(frozen=True, slots=True)
class State:
    """What is truly so. time [s]; pose, speed [m/s] along x, turn_rate [rad/s] of the robot; things: those that move.

    clearance [m]: from the hull to the nearest thing; touches: what touches it now.
    """

    time: float
    pose: Pose
    speed: float
    turn_rate: float
    clearance: float
    touches: tuple[Touch, ...]
    stage: Stage
    things: Mapping[str, Pose]


class Step(NamedTuple, Generic[Seen]):
    """seen: what the robot senses; done: the task is over, for good or ill; out_of_time: the scenario's limit is."""

    seen: Seen
    state: State
    done: bool
    out_of_time: bool


class Environment(Generic[Seen]):
    """A scenario to be driven in, again and again.

    sense: what to make of a reading, called once for each, in order; without it readings come as they are. begin:
    called before each run, for what lasts in `sense`. period [s]: the length of a tick. record: where each run is
    recorded, the one before being replaced.
    """

    @overload
    def __init__(
        self: Environment[Reading], scenario: Scenario, *, period: float = PERIOD, record: Path | None = None
    ) -> None: ...

    @overload
    def __init__(
        self,
        scenario: Scenario,
        sense: Callable[[Reading], Seen],
        begin: Callable[[], None] = ...,
        *,
        period: float = PERIOD,
        record: Path | None = None,
    ) -> None: ...

    def __init__(
        self,
        scenario: Scenario,
        sense: Callable[[Reading], Seen] | None = None,
        begin: Callable[[], None] = lambda: None,
        *,
        period: float = PERIOD,
        record: Path | None = None,
    ) -> None:
        self.scenario, self.period = scenario, period
        self._sense = cast(Callable[[Reading], Seen], sense or _as_it_is)
        self._begin, self._record = begin, record
        self._episode: Episode | None = None
        self._recorder: Recorder | None = None

    def reset(self, seed: int = 0) -> tuple[Seen, State]:
        """A new run. Raises ScenarioError where the seed finds no layout; OSError where it cannot be recorded."""
        self.close()
        self._episode = episode = Episode(self.scenario, seed, self.period)
        if self._record is not None:
            self._recorder = Recorder(self._record, {"seed": seed, "period": self.period, "world": episode.header()})
        self._begin()
        return self._seen(episode), self._state(episode)

    def step(self, command: Command) -> Step[Seen]:
        """One tick with this command. Raises ValueError where it is not finite, RuntimeError before the first reset."""
        episode = self._running()
        episode.act(command)
        if self._recorder is not None:
            self._recorder.tick(episode.time, episode.snapshot(), "null", episode.world.sense())
        episode.advance()
        late = episode.time >= self.scenario.time_limit - self.period / 2
        return Step(self._seen(episode), self._state(episode), episode.judge.over, late)

    @property
    def verdict(self) -> Verdict:
        """What is to be said of the run so far."""
        return self._running().judge.verdict()

    def close(self) -> None:
        """End the run and its recording; the second call does nothing."""
        if self._recorder is not None and self._episode is not None:
            self._episode.act(STOP)
            self._recorder.tick(self._episode.time, self._episode.snapshot(), "null", self._episode.world.sense())
            self._recorder.close()
        self._episode = self._recorder = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _running(self) -> Episode:
        if self._episode is None:
            raise RuntimeError("call reset() first")
        return self._episode

    def _seen(self, episode: Episode) -> Seen:
        reading = episode.world.sense()
        return self._sense(reading)

    def _state(self, episode: Episode) -> State:
        world = episode.world
        return State(
            time=world.time,
            pose=world.robot.pose,
            speed=world.robot.speed,
            turn_rate=world.robot.turn_rate,
            clearance=world.clearance(),
            touches=world.touches,
            stage=episode.judge.stage,
            things={thing.placed.id: thing.pose for thing in world.things if thing.placed.moves and thing.present},
        )
