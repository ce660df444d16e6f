"""Numbers of many episodes in words, and how near they come to what was to be shown.

Takes: measures. Gives: texts with their spread, judgements, typical episodes. Leaves alone: what is compared; rows say
that.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Sequence

from rplan.apps.reproduce.row import Judgement, Measures

CLOSE = 0.1
"""A figure that misses a bound by less than this share of it is close."""


def numbers(measures: Iterable[Measures], key: str) -> list[float]:
    """The values of a measure where there are any."""
    values = (one.get(key) for one in measures)
    return [float(value) for value in values if isinstance(value, bool | int | float)]


def median(measures: Iterable[Measures], key: str) -> float | None:
    """Of those where there is a value."""
    values = numbers(measures, key)
    return statistics.median(values) if values else None


def count(measures: Iterable[Measures], key: str) -> int:
    """In how many episodes it is true, or more than 0."""
    return sum(value > 0 for value in numbers(measures, key))


def of_case(measures: Iterable[Measures], case: str) -> list[Measures]:
    """The episodes of a case."""
    return [one for one in measures if one.get("case") == case]


def share(met: int, of: int) -> str:
    """`19 of 20`."""
    return f"{met} of {of}"


def spread(measures: Iterable[Measures], key: str, unit: str, scale: float = 1.0, digits: int = 0) -> str:
    """Median and range, `4.1 min (2.7 to 6.9, n = 20)`."""
    values = [value * scale for value in numbers(measures, key)]
    if not values:
        return "never"
    middle, least, most = (f"{v:.{digits}f}" for v in (statistics.median(values), min(values), max(values)))
    return f"{middle} {unit} ({least} to {most}, n = {len(values)})".replace("  ", " ").replace(" (", " (")


def judged(value: float | None, least: float, most: float) -> Judgement:
    """Whether a figure lies between two bounds, or nearly so."""
    if value is None:
        return "missed"
    if least <= value <= most:
        return "met"
    return "close" if least - CLOSE * abs(least) <= value <= most + CLOSE * abs(most) else "missed"


def judged_share(met: int, of: int, least: float) -> Judgement:
    """Whether at least this share did; close within a tenth of all."""
    if of == 0:
        return "missed"
    return "met" if met >= least * of else "close" if met >= (least - CLOSE) * of else "missed"


def worst(judgements: Iterable[Judgement]) -> Judgement:
    """The worst of them; met where there is none."""
    order: tuple[Judgement, ...] = ("met", "close", "missed")
    return max(judgements, key=order.index, default="met")


def typical(measures: Sequence[Measures], key: str) -> Measures | None:
    """The episode in the middle of a measure, the lower one of two; None where none has it."""
    return _chosen(measures, key, lambda count: (count - 1) // 2)


def greatest(measures: Sequence[Measures], key: str) -> Measures | None:
    """The episode with the most of a measure; None where none has it."""
    return _chosen(measures, key, lambda count: count - 1)


def _chosen(measures: Sequence[Measures], key: str, place: Callable[[int], int]) -> Measures | None:
    there = [one for one in measures if isinstance(one.get(key), bool | int | float)]
    there.sort(key=lambda one: (numbers([one], key)[0], seed_of(one) or 0))
    return there[place(len(there))] if there else None


def seed_of(one: Measures | None) -> int | None:
    """The seed of an episode."""
    seed = None if one is None else one.get("seed")
    return seed if isinstance(seed, int) else None


def case_of(one: Measures | None) -> str:
    """The name of its case."""
    return "" if one is None else str(one.get("case") or "")
