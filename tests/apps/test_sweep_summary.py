"""What rows say together: shares and medians with intervals that keep what they promise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rplan.apps.sweep.summary import group, median, wilson
from rplan.apps.sweep.work import Row


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [
        (0, 10, 0.0, 0.2775),
        (1, 10, 0.0179, 0.4042),
        (5, 10, 0.2366, 0.7634),
        (10, 10, 0.7225, 1.0),
        (81, 263, 0.2553, 0.3662),
    ],
)
def test_the_interval_of_a_share_is_wilsons(successes: int, trials: int, low: float, high: float) -> None:
    """The last one is an example of Newcombe (1998, table I)."""
    assert wilson(successes, trials) == pytest.approx((low, high), abs=5e-5)


@pytest.mark.parametrize(
    ("count", "rank"), [(5, None), (6, 1), (8, 1), (9, 2), (12, 3), (20, 6), (50, 18), (100, 40), (5000, 2431)]
)
def test_the_interval_of_a_median_lies_between_the_order_statistics_of_the_tables(count: int, rank: int | None) -> None:
    """Ranks as in tables of the sign test."""
    values = [float(value) for value in range(1, count + 1)]
    expected = None if rank is None else (float(rank), float(count + 1 - rank))
    assert median(list(reversed(values))).interval == expected


def test_the_interval_of_a_median_has_the_true_one_at_least_as_often_as_it_says() -> None:
    chance = np.random.default_rng(1)
    true = math.log(2)
    intervals = [median(chance.exponential(size=15).tolist()).interval for _ in range(2000)]
    inside = sum(one is not None and one[0] <= true <= one[1] for one in intervals)
    assert 0.95 <= inside / 2000 <= 0.985


def test_a_median_of_nothing_is_nothing() -> None:
    assert (median([]).count, median([]).value, median([]).interval) == (0, None, None)


def test_times_are_those_of_the_episodes_that_were_done() -> None:
    rows: list[Row] = [
        {"done": True, "duration": 10.0, "one_way": 3, "contacts": 2, "driven_into": 0},
        {"done": True, "duration": 30.0, "one_way": None, "contacts": 1, "driven_into": 1},
        {"done": False, "duration": 99.0, "one_way": 1.0, "contacts": 0, "driven_into": 0},
        {"done": False, "error": "ValueError: no"},
    ]
    said = group("lot", (("a.b", 1.0),), rows)
    times = {name: (one.count, one.value) for name, one in said.times}
    assert times == {"one_way": (1, 3.0), "round_trip": (0, None), "duration": (2, 20.0)}
    assert (said.episodes, said.done, said.failed, said.share) == (4, 2, 1, 0.5)
    assert (said.contacts, said.driven_into, said.untouched) == (3, 1, 2)
