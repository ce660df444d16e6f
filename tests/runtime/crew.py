"""A crew that takes down what is asked of it, in order.

Takes: percept values, what shall go wrong. Gives: a `Crew` over `Move`s, and its log. Leaves alone: robots.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from properties.texts import compiled, decider

from rplan.goals.signature import COMMAND, FunctionSignature, LibrarySignature
from rplan.lang.plan import Type
from rplan.runtime.controller import Controller, Deadline, Tick
from rplan.runtime.robot import Channels, Crew

NAMES = ("rest", "walk", "run", "look")
LIBRARY = LibrarySignature(
    "crew",
    (
        *(FunctionSignature(name, (), Type("bool"), origin="crew") for name in ("a", "b", "c")),
        FunctionSignature("level", (), Type("number"), origin="crew"),
        *(FunctionSignature(name, (), Type("pose"), origin="crew") for name in ("home", "next", "fix")),
        *(FunctionSignature(name, (), COMMAND, origin="crew") for name in NAMES),
    ),
    (),
)


@dataclass(frozen=True)
class Move:
    """Legs and eyes; None leaves them alone."""

    legs: float | None = None
    eyes: float | None = None

    def merged(self, other: Move) -> Move:
        return Move(self.legs if other.legs is None else other.legs, self.eyes if other.eyes is None else other.eyes)

    def is_finite(self) -> bool:
        return all(part is None or abs(part) < float("inf") for part in (self.legs, self.eyes))


@dataclass
class Report:
    status: str
    details: Mapping[str, object]


class WreckError(Exception):
    """What a competence of this crew raises."""


@dataclass
class Member:
    """A competence that logs. Its trouble: "start", "step" or "stop" raises, "nan" or "late" happens in a step."""

    name: str
    move: Move
    crew: Logged
    trouble: str = ""

    def start(self, reading: object, channels: Channels) -> None:
        self._log("start", channels)

    def step(self, reading: object, channels: Channels) -> tuple[Move, Report]:
        self._log("step", channels)
        if self.trouble == "late":
            self.crew.now += 1.0
        self.crew.now += 0.01
        return (Move(float("nan")) if self.trouble == "nan" else self.move), Report("running", {"by": self.name})

    def stop(self) -> None:
        self._log("stop", None)

    def _log(self, what: str, channels: Channels | None) -> None:
        self.crew.log.append(f"{what} {self.name}")
        if channels is not None:
            self.crew.seen[f"{what} {self.name}"] = dict(channels)
        if self.trouble == what:
            raise WreckError(f"cannot {what}")


@dataclass
class Logged:
    """Everything that was asked, in order; what can be seen at each step; a clock that competences push on."""

    log: list[str] = field(default_factory=list)
    seen: dict[str, dict[str, object]] = field(default_factory=dict)
    percepts: dict[str, bool | float] = field(default_factory=lambda: {"a": False, "b": False, "c": False, "level": 0})
    reports: list[tuple[dict[str, object], dict[str, object]]] = field(default_factory=list)
    now: float = 0.0

    def __post_init__(self) -> None:
        moves = {"rest": Move(0.0), "walk": Move(1.0), "run": Move(2.0), "look": Move(None, 3.0)}
        self.members = {name: Member(name, move, self) for name, move in moves.items()}

    def update(self, reading: object, reports: Mapping[str, object], channels: Channels) -> None:
        self.log.append(f"estimate {reading}")
        self.reports.append((dict(reports), dict(channels)))

    def sample(self, name: str) -> Callable[[], bool | float]:
        def percept() -> bool | float:
            self.log.append(f"sample {name}")
            return self.percepts[name]

        return percept

    def value(self, name: str) -> Callable[[Channels], object]:
        def give(channels: Channels) -> object:
            self.log.append(f"value {name}")
            self.seen[f"value {name}"] = dict(channels)
            return (name, len(self.log))

        return give

    def crew(self) -> Crew[Move]:
        return Crew(
            {name: self.sample(name) for name in self.percepts},
            {name: self.value(name) for name in ("home", "next", "fix")},
            self.members,
            (self,),
            Move(0.0),
        )


def controller(text: str, crew: Logged, deadline: float | None = None) -> Controller[Move]:
    plan = compiled(f"(use crew) {text}", {"crew": LIBRARY}, allow_holes=True)
    limit = None if deadline is None else Deadline(deadline, lambda: crew.now)
    return Controller(decider(plan), crew.crew(), limit)


def ticks(control: Controller[Move], crew: Logged, *true: str) -> list[Tick[Move]]:
    """One tick for each text of percepts that shall be true, "ab" for a and b."""
    made = []
    for number, names in enumerate(true):
        crew.percepts |= {name: name in names for name in ("a", "b", "c")}
        made.append(control.step(f"reading {number}"))
    return made
