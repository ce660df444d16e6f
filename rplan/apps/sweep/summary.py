"""What the rows of a sweep say together: how often the task was done, how long it took, and how sure that is.

Takes: rows. Gives: a `Group` for each variant, with 95 % intervals. Leaves alone: how it is shown.

Shares have the interval of Wilson (1927), medians the one between order statistics (exact for any distribution, wider
than asked rather than narrower; David and Nagaraja 2003, section 7.1): nothing is drawn by chance.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rplan.apps.sweep.work import Row, Value

Z = 1.959963984540054
"""Of the normal distribution, 95 % lies this many standard deviations about the middle."""
OUTSIDE = 0.025
"""To either side of an interval, at most."""
TIMES = ("one_way", "round_trip", "duration")


@dataclass(frozen=True, slots=True)
class Median:
    """Of `count` values; interval: None where there are too few of them for 95 %."""

    count: int
    value: float | None
    interval: tuple[float, float] | None


@dataclass(frozen=True, slots=True)
class Group:
    """The episodes of one variant. times: of those that were done; failed: ended by an error.

    contacts, driven_into: of all episodes together; untouched: episodes in which nothing was driven into.
    """

    scenario: str
    params: tuple[tuple[str, Value], ...]
    episodes: int
    done: int
    failed: int
    share: float
    interval: tuple[float, float]
    times: tuple[tuple[str, Median], ...]
    contacts: int
    driven_into: int
    untouched: int


def group(scenario: str, params: tuple[tuple[str, Value], ...], rows: Sequence[Row]) -> Group:
    """What the rows of one variant (one or more) say."""
    done = [row for row in rows if row.get("done")]
    return Group(
        scenario=scenario,
        params=params,
        episodes=len(rows),
        done=len(done),
        failed=sum(row.get("error") is not None for row in rows),
        share=len(done) / len(rows),
        interval=wilson(len(done), len(rows)),
        times=tuple((name, median(_numbers(done, name))) for name in TIMES),
        contacts=_sum(rows, "contacts"),
        driven_into=_sum(rows, "driven_into"),
        untouched=sum(row.get("driven_into") == 0 for row in rows),
    )


def _numbers(rows: Iterable[Row], name: str) -> list[float]:
    values = (row.get(name) for row in rows)
    return [float(value) for value in values if isinstance(value, int | float)]


def _sum(rows: Iterable[Row], name: str) -> int:
    return round(sum(_numbers(rows, name)))


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """The interval of a share in which 95 % of such samples have the true one."""
    share, weight = successes / trials, Z * Z / trials
    middle = (share + weight / 2) / (1 + weight)
    half = Z / (1 + weight) * math.sqrt(share * (1 - share) / trials + weight / (4 * trials))
    low = 0.0 if successes == 0 else middle - half
    return low, 1.0 if successes == trials else middle + half


def median(values: Sequence[float]) -> Median:
    """The median and the order statistics about it between which the true one lies in at least 95 % of samples."""
    if not values:
        return Median(0, None, None)
    ordered = sorted(values)
    rank = _rank(len(ordered))
    interval = (ordered[rank - 1], ordered[-rank]) if rank else None
    return Median(len(ordered), statistics.median(ordered), interval)


def _rank(count: int) -> int:
    """The greatest k for which fewer than k of `count` values lie below the true median in 2.5 % of samples at most."""
    rank = 0
    below = math.exp(-count * math.log(2))
    while below <= OUTSIDE:
        rank += 1
        below += math.exp(_log_choose(count, rank) - count * math.log(2))
    return rank


def _log_choose(n: int, k: int) -> float:
    return math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)
