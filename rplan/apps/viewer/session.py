"""A simulation that someone watches and meddles with: run, stop, step, move things, force percepts, break at rules.

Takes: a compiled plan, a scenario, a seed, and wishes. Gives: tick by tick the rows that a page shows, and everything
so far as the data of a page; where it is wished, a recording of each run. Leaves alone: who watches and when ticks
happen; see server.py.

What is watched is the run that `rplan simulate` makes of the same seed, as long as nobody meddles with it. A tick is
recorded when it happens; going back to look at ticks that were writes nothing. A run that is begun anew has a file of
its own, since what was done by hand cannot be done again.
"""

from __future__ import annotations

import json
import math
from collections import deque
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from pathlib import Path

from behaviours.interface import STOP, Pose
from rplan.apps.libraries import Catalogue, catalogue
from rplan.apps.simulation import World
from rplan.apps.viewer.forcing import forcing
from rplan.apps.viewer.telling import Loser, circuit, rules
from rplan.apps.wiring import PlanBrain, plan_header
from rplan.driver import Compiled
from rplan.runtime.encode import wrong_number
from sim.episode import Episode
from sim.raycast import Rings
from sim.recording import Json, Recorder, json_text
from sim.replay import Packing
from sim.scenarios.scenario import Event, Put, Scenario
from sim.things.thing import Thing
from sim.world import World as Space

SPEEDS = (0.1, 100.0)
"""Simulated seconds a second, from and to."""
KEPT = 2000
"""So many rows are kept for pages that lag behind; one that lags more gets everything anew."""
FIXED = ("wall", "outline", "curb")
"""Kinds of things that stay where they are."""
NEAR = 0.02
"""[m] that a thing must stay away from the robot."""
MOST_STEPS = 1000


class WishError(ValueError):
    """What someone wishes cannot be; the message says why."""


@dataclass(slots=True)
class Wishes:
    """What stands until it is taken back. forced: function name -> value; breaks: heads of rules."""

    running: bool = False
    speed: float = 1.0
    forced: dict[str, bool | float] = field(default_factory=dict)
    breaks: dict[str, None] = field(default_factory=dict)


class Session:
    """One plan in one world, under control.

    Raises PlanError where nothing brings a function of the plan to life, ScenarioError where the seed finds no layout.
    """

    def __init__(self, compiled: Compiled, world: World, seed: int, libraries: Catalogue | None = None) -> None:
        self.compiled, self.seed, self.wishes = compiled, seed, Wishes()
        self._world = world
        self._scenario = with_loose_things(world.scenario, seed, compiled.goals.period)
        self._brain = PlanBrain(compiled, forcing(libraries or catalogue(), self.wishes.forced))
        self._loser = Loser(compiled)
        self._circuit = circuit(compiled)
        self.percepts = {
            t.name: _kind(compiled, t.name) for t in compiled.goals.percepts(driving=True) if not t.arguments
        }
        self.run_number = 0
        self.recorded: list[Path] = []
        self.unwritten = ""
        self._record: Path | None = None
        self._recorder: Recorder | None = None
        self._begin()

    def _begin(self) -> None:
        episode = Episode(self._scenario, self.seed, self.compiled.goals.period)
        recorder = self._new_recorder(episode)
        self._end_recording()
        self.run_number += 1
        self.episode, self._recorder = episode, recorder
        self._moved: dict[str, list[float]] = {}
        self.packing = Packing()
        self.rows: deque[str] = deque(maxlen=KEPT)
        self.said = ""
        self._firing: tuple[str, ...] = ()
        self._fault = ""
        self._brain.reset()
        self.step()

    # --- time -------------------------------------------------------------------------------------

    @property
    def ticks(self) -> int:
        """How many there have been."""
        return len(self.packing.milliseconds)

    @property
    def over(self) -> str:
        """Why there are no more ticks; "" while there are."""
        episode = self.episode
        if self._fault:
            return self._fault
        if episode.judge.over:
            verdict = episode.judge.verdict()
            return "the task is done" if verdict.done else verdict.reason
        return "the time is over" if episode.time >= episode.scenario.time_limit - episode.world.period / 2 else ""

    def step(self) -> bool:
        """One tick, if there is one more; stops running where a rule breaks or the run is over."""
        if self.over:
            self._stop(self.over)
            return False
        episode = self.episode
        try:
            episode.tick(self._brain, self)
        except Exception as error:
            self._fault = f"{type(error).__name__}: {error}"
            self._stop(self._fault)
            return False
        if self.over:
            self._stop(self.over)
        return True

    def observe(self, episode: Episode) -> None:
        """Pack the tick; called by the episode."""
        note = json.loads(episode.note)
        world = episode.snapshot()
        tick = {"t": episode.time, "world": world, "plan": note}
        self.packing.tick(tick, self._loser.tick(note))
        self.packing.reading(self.ticks - 1, episode.world.sense())
        if self._recorder is not None:
            self._recorder.tick(episode.time, world, episode.note, episode.world.sense(), self._by_hand())
        self.rows.append(json_text(self.packing.last()))
        firing = self._loser.firing(note["inputs"], note["registers"])
        hit = [rule for rule in firing if rule in self.wishes.breaks and rule not in self._firing]
        self._firing = firing
        if hit:
            self._stop(f"{hit[0]} fires at {episode.time:.1f} s")

    def _stop(self, said: str) -> None:
        self.wishes.running, self.said = False, said

    def close(self) -> None:
        """Stop what runs, and end the recording; the second call does nothing."""
        self._brain.close()
        self._end_recording()

    # --- recordings -------------------------------------------------------------------------------

    def record(self, path: Path) -> None:
        """Begin anew, and record this run and those that are begun anew after it.

        The first replaces what is at `path`, the others take names that are free: `run.mcap`, `run-2.mcap` and so on.
        Raises OSError where the file cannot be written.
        """
        self._record = path
        self._begin()

    def _new_recorder(self, episode: Episode) -> Recorder | None:
        if self._record is None:
            return None
        path, number = self._record, 2
        while self.recorded and (path in self.recorded or path.exists()):
            path, number = self._record.with_stem(f"{self._record.stem}-{number}"), number + 1
        recorder = Recorder(path, self._header(episode))
        self.recorded.append(path)
        return recorder

    def _by_hand(self) -> Json:
        """What was forced in this tick, and what was moved since the one before."""
        forced = {f"({name})": value for name, value in self.wishes.forced.items()}
        moved, self._moved = self._moved, {}
        return ({"forced": forced} if forced else {}) | ({"moved": moved} if moved else {})

    def _end_recording(self) -> None:
        """The last tick of the run that stands: the robot stops. What cannot be written any more is said."""
        recorder, self._recorder = self._recorder, None
        if recorder is None:
            return
        episode = self.episode
        episode.act(STOP)
        try:
            with recorder:
                recorder.tick(episode.time, episode.snapshot(), "null", episode.world.sense())
        except OSError as error:
            self.unwritten = f"{self.recorded[-1]}: {error.strerror or error}"

    # --- wishes -----------------------------------------------------------------------------------

    def wish(self, wish: object) -> None:
        """Do what a page asks for; WishError where it cannot be done."""
        self.said = ""
        match wish:
            case {"do": "run", "on": bool(on)}:
                self.wishes.running = on and not self.over
                self.said = self.over if on else ""
            case {"do": "step", "ticks": int(ticks)} if 0 < ticks <= MOST_STEPS:
                self.wishes.running = False
                for _ in range(ticks):
                    if not self.step() or self.said:
                        break
            case {"do": "speed", "to": int() | float() as to} if SPEEDS[0] <= to <= SPEEDS[1]:
                self.wishes.speed = float(to)
            case {"do": "move", "thing": str(name), "pose": [x, y, theta]}:
                self.move(name, _pose(x, y, theta))
            case {"do": "force", "percept": str(name), "value": value}:
                self.force(name, value)
            case {"do": "break", "rule": str(rule), "on": bool(on)}:
                self.break_at(rule, on)
            case {"do": "restart"}:
                self.wishes.running = False
                self._restart()
            case _:
                raise WishError("that is no wish that a session knows")

    def _restart(self) -> None:
        try:
            self._begin()
        except OSError as error:
            raise WishError(f"it cannot be recorded: {error.strerror or error}") from None

    def move(self, name: str, pose: Pose) -> None:
        """Put a thing elsewhere, from the next tick on."""
        thing = next((one for one in self.episode.world.things if one.placed.id == name), None)
        if thing is None:
            raise WishError(f"there is no thing {name!r}")
        if not movable(thing):
            raise WishError(f"{name!r} cannot be moved by hand")
        put(self.episode.world, thing, pose)
        self._moved[name] = [pose.x, pose.y, pose.theta]

    def force(self, name: str, value: object) -> None:
        """Give a percept a value from the next tick on; None takes it back."""
        name = name.removeprefix("(").removesuffix(")")
        kind = self.percepts.get(name)
        if kind is None:
            raise WishError(f"the plan reads no percept ({name})")
        if value is None:
            self.wishes.forced.pop(name, None)
        elif kind == "truth" and isinstance(value, bool):
            self.wishes.forced[name] = value
        elif kind == "number" and isinstance(value, int | float) and not wrong_number(value):
            self.wishes.forced[name] = float(value)
        else:
            raise WishError(f"({name}) is a {'truth value' if kind == 'truth' else 'finite number'}, not {value!r}")

    def break_at(self, rule: str, on: bool) -> None:
        """Stop when a rule begins to set something, itself or by its subgoals."""
        if rule not in self._loser.heads:
            raise WishError(f"the plan has no rule {rule}")
        self.wishes.breaks.pop(rule, None)
        if on:
            self.wishes.breaks[rule] = None

    # --- what a page is told ----------------------------------------------------------------------

    def data(self) -> Json:
        """Everything so far."""
        return {
            "header": self.header(),
            "verdict": "",
            "cut_short": False,
            "circuit": self._circuit,
            "rules": rules(self.compiled),
        } | self.packing.packed()

    def header(self) -> Json:
        """The header of a recording of this run."""
        return self._header(self.episode)

    def _header(self, episode: Episode) -> Json:
        scenario = self._world.scenario
        return {
            "plan": plan_header(self.compiled),
            "scenario": {"name": scenario.name, "text": self._world.text},
            "seed": self.seed,
            "versions": {name: version(name) for name in ("rplan", "numpy", "pymunk")},
            "period": self.compiled.goals.period,
            "world": episode.header(),
        }

    def state(self) -> Json:
        """What the page's buttons show."""
        wishes = self.wishes
        return {
            "running": wishes.running,
            "speed": wishes.speed,
            "forced": dict(wishes.forced),
            "breaks": list(wishes.breaks),
            "said": self.said,
            "over": self.over,
            "recording": self.recorded[-1].name if self._recorder is not None else "",
            "unwritten": self.unwritten,
        }

    def fixed(self) -> Json:
        """What does not change: percepts that can be forced, things that can be moved, rules that can break."""
        things = [one.placed.id for one in self.episode.world.things if movable(one)]
        return {
            "percepts": self.percepts,
            "movable": things,
            "rules": list(self._loser.heads),
            "period": self.compiled.goals.period,
        }


def _kind(compiled: Compiled, name: str) -> str:
    signature = compiled.goals.functions.get(name)
    is_number = signature is not None and signature.type is not None and signature.type.name != "bool"
    return "number" if is_number else "truth"


def _pose(*numbers: object) -> Pose:
    given = [float(n) for n in numbers if isinstance(n, int | float) and math.isfinite(n) and abs(n) < 1e4]
    if len(given) != 3:
        raise WishError("a pose is three finite numbers: x, y [m], theta [rad]")
    return Pose(*given)


# --- moving things by hand -------------------------------------------------------------------------


def movable(thing: Thing) -> bool:
    """Whether a thing can be moved by hand: it is there, goes no way of its own and is no part of a building."""
    fixed = thing.placed.kind in FIXED or isinstance(thing.placed.outline, Rings)
    return thing.present and thing.placed.motion is None and not fixed


def with_loose_things(scenario: Scenario, seed: int, period: float) -> Scenario:
    """The scenario with everything that can be moved by hand marked as what may be elsewhere later."""
    loose = [thing.placed for thing in Space(scenario, seed, period).things if movable(thing)]
    events = tuple(Event(math.inf, Put(placed.id, placed.pose)) for placed in loose)
    return replace(scenario, events=(*scenario.events, *events))


def put(world: Space, thing: Thing, pose: Pose) -> None:
    """A thing elsewhere, at rest; WishError, and all as it was, where the robot stands there."""
    before = thing.pose
    thing.put(pose.x, pose.y, pose.theta)
    if world.clearance() < NEAR:
        thing.put(before.x, before.y, before.theta)
        world.clearance()
        raise WishError(f"the robot stands where {thing.placed.id!r} would be")
