"""A plan drives a robot through a world, and what is to be said of it afterwards.

Takes: a compiled plan, a scenario, a seed. Gives: a `Run`: the judge's verdict, ticks and switches of each competence,
and for each switch what made it. Leaves alone: how it is shown; see doing/simulate.py.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from time import perf_counter

from rplan.apps.files import InputError, unreadable
from rplan.apps.libraries import Catalogue
from rplan.apps.wiring import PlanBrain, plan_header
from rplan.driver import Compiled
from rplan.runtime.tick import Decision
from rplan.ways.way import TakenWay
from sim.episode import Episode
from sim.judge import Verdict
from sim.recording import Recorder
from sim.scenarios.format import loads
from sim.scenarios.scenario import Scenario
from sim.scenarios.schema import ScenarioError

OPEN = "nothing"
"""Shown for a channel that a tick leaves open."""


@dataclass(frozen=True, slots=True)
class World:
    """A scenario with the text that it was read from."""

    scenario: Scenario
    text: str


@dataclass(slots=True)
class Share:
    """How much of a run a competence had."""

    ticks: int = 0
    switches: int = 0


@dataclass(frozen=True, slots=True)
class Switch:
    """At `time` [s] `before` gave way to `after` in a channel, since `because`; rules: what the way then served."""

    time: float
    channel: str
    before: str
    after: str
    because: str
    rules: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Run:
    """One episode. shares: competence -> its part; holes: ticks without an open way; wall: seconds it took to run."""

    plan: str
    scenario: str
    seed: int
    verdict: Verdict
    ticks: int
    shares: Mapping[str, Share]
    switches: tuple[Switch, ...]
    holes: int
    faults: tuple[str, ...]
    wall: float
    period: float

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds a second."""
        return self.verdict.duration / self.wall if self.wall > 0 else float("inf")


SCENARIO_SUFFIXES = (".yaml", ".yml")


def load_world(path: Path) -> World:
    """The scenario in a file, or the world of another format in it (FILE#3: one of several).

    Raises ScenarioError, WorldFileError, OSError.
    """
    if path.suffix.lower() in SCENARIO_SUFFIXES:
        text = path.read_bytes().decode("utf-8", errors="replace")
        if not ("resolution:" in text and "image:" in text):
            return World(loads(text, path.name), text)
    from sim.scenarios.importers import Options, load, split

    file, number = split(str(path))
    return World(*load(file, Options(world=number)))


def world_in(path: Path) -> World:
    """`load_world` for commands: raises InputError, with every problem of a scenario."""
    from sim.scenarios.importers.imported import WorldFileError

    try:
        return load_world(path)
    except ScenarioError as error:
        raise InputError("the scenario is wrong\n" + "\n".join(f"  {p}" for p in error.problems)) from None
    except WorldFileError as error:
        raise InputError(str(error)) from None
    except OSError as error:
        unreadable(path, error)


@dataclass(slots=True)
class _Watch:
    """Sees every tick: counts, explains switches, records."""

    brain: PlanBrain
    recorder: Recorder | None
    progress: Callable[[float, str], None] | None
    commands: tuple[str, ...]
    shares: dict[str, Share] = field(default_factory=dict)
    switches: list[Switch] = field(default_factory=list)
    holes: int = 0
    faults: list[str] = field(default_factory=list)
    ticks: int = 0
    last: Decision | None = None

    def observe(self, episode: Episode) -> None:
        if not episode.over:
            self._count(episode.time)
        if self.recorder is not None:
            self.recorder.tick(episode.time, episode.snapshot(), episode.note, episode.world.sense())
        if self.progress is not None and self.ticks % 50 == 0:
            doing = ", ".join(_sent(self.last, channel) for channel in self.commands)
            self.progress(episode.time, f"{episode.judge.stage}: {doing}")

    def _count(self, time: float) -> None:
        tick = self.brain.tick
        assert tick is not None
        decision = tick.decision
        self.ticks += 1
        self.holes += decision.hole
        self.faults += [f"{time:.1f} s: ({fault.competence}): {fault.message}" for fault in tick.faults]
        for channel in decision.sent:
            was, now = _sent(self.last, channel), _sent(decision, channel)
            if was != now and (self.last is not None or channel in self.commands):
                self._switch(time, channel, was, now, decision)
            if channel in self.commands:
                share = self.shares.setdefault(now, Share())
                share.ticks += 1
                share.switches += was != now
        self.last = decision

    def _switch(self, time: float, channel: str, was: str, now: str, decision: Decision) -> None:
        way = self.brain.trace.way(decision)
        self.switches.append(Switch(time, channel, was, now, self._because(decision, way), way.rules))

    def _because(self, decision: Decision, way: TakenWay) -> str:
        """The conditions that changed with the switch and that one of the two ways asks."""
        if self.last is None:
            return "it is the first tick"
        before = self.brain.trace.way(self.last)
        asked = [branch.condition for branch in (*way.branches, *before.branches)]
        atoms = self.brain.compiled.ways.atoms[: self.brain.compiled.ways.asking]
        changed = [
            f"{atom.text} became {'true' if now else 'false'}"
            for atom, was, now in zip(atoms, self.last.inputs, decision.inputs, strict=True)
            if was != now and any(atom.text in condition for condition in asked)
        ]
        return "; ".join(changed) or "what was kept changed"


def lasted(seconds: float | None) -> str:
    """A time for people: to a tenth, from a minute on with minutes; "-" where there is none."""
    if seconds is None:
        return "-"
    minutes, rest = divmod(round(seconds, 1), 60.0)
    return f"{int(minutes)} min {rest:04.1f} s" if minutes else f"{rest:.1f} s"


def _sent(decision: Decision | None, channel: str) -> str:
    term = None if decision is None else decision.sent[channel]
    return OPEN if term is None else term.text


def simulate(
    compiled: Compiled,
    world: World,
    seed: int,
    *,
    until: float | None = None,
    record: Path | None = None,
    progress: Callable[[float, str], None] | None = None,
    libraries: Catalogue | None = None,
) -> Run:
    """Drive one episode.

    Raises `PlanError` (unbound functions), `ScenarioError` (no layout for this seed), `OSError`.
    """
    brain = PlanBrain(compiled, libraries, looked_at=record is not None)
    episode = Episode(world.scenario, seed, compiled.goals.period)
    commands = tuple(o.name for o in compiled.goals.outputs if o.type is not None and o.type.name == "command")
    with _recorder(record, compiled, world, episode) as recorder:
        watch = _Watch(brain, recorder, progress, commands)
        begin = perf_counter()
        try:
            verdict = episode.run(brain, until, watch)
        except KeyboardInterrupt:
            verdict = episode.judge.verdict(f"stopped by hand at {episode.time:.0f} s")
        finally:
            brain.close()
        wall = perf_counter() - begin
    return Run(
        plan=compiled.goals.name,
        scenario=world.scenario.name,
        seed=seed,
        verdict=verdict,
        ticks=watch.ticks,
        shares=watch.shares,
        switches=tuple(watch.switches),
        holes=watch.holes,
        faults=tuple(watch.faults),
        wall=wall,
        period=compiled.goals.period,
    )


@contextmanager
def _recorder(path: Path | None, compiled: Compiled, world: World, episode: Episode) -> Iterator[Recorder | None]:
    if path is None:
        yield None
        return
    with Recorder(path, _header(compiled, world, episode)) as recorder:
        yield recorder


def _header(compiled: Compiled, world: World, episode: Episode) -> Mapping[str, object]:
    return {
        "plan": plan_header(compiled),
        "scenario": {"name": world.scenario.name, "text": world.text},
        "seed": episode.seed,
        "versions": {name: version(name) for name in ("rplan", "numpy", "pymunk")},
        "period": compiled.goals.period,
        "world": episode.header(),
    }
