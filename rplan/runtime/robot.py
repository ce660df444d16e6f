"""What the runtime needs of a robot: protocols, so that it knows no robot.

Takes: nothing. Gives: `Crew`, everything that brings a plan to life. Leaves alone: who offers it; rplan/apps/wiring.py
fills a crew from libraries of behaviours.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, Self, TypeVar


class CommandLike(Protocol):
    """A command to the actuators."""

    def merged(self, other: Self, /) -> Self:
        """Both together; `other` counts where both speak."""
        ...

    def is_finite(self) -> bool:
        """True when every number in it is finite."""
        ...


C = TypeVar("C", bound=CommandLike)
C_co = TypeVar("C_co", bound=CommandLike, covariant=True)
Channels = Mapping[str, object]


class CompetenceLike(Protocol[C_co]):
    """See behaviours/interface.py."""

    def start(self, reading: Any, channels: Channels, /) -> None: ...

    def step(self, reading: Any, channels: Channels, /) -> tuple[C_co, Any]: ...

    def stop(self) -> None: ...


class EstimatorLike(Protocol):
    """See behaviours/interface.py."""

    def update(self, reading: Any, reports: Mapping[str, Any], channels: Channels, /) -> None: ...


@dataclass(frozen=True, slots=True)
class Crew(Generic[C]):
    """Callables by function name; estimators in the order of their updates; safe: the command to stand still.

    views: what people may look at, by name; None where there is nothing new.
    """

    percepts: Mapping[str, Callable[[], bool | float]]
    values: Mapping[str, Callable[[Channels], object]]
    competences: Mapping[str, CompetenceLike[C]]
    estimators: tuple[EstimatorLike, ...]
    safe: C
    views: Mapping[str, Callable[[], Mapping[str, object] | None]] = field(default_factory=dict)
