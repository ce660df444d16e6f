"""Looking ahead: the cheapest way through what is seen."""

import heapq
import itertools
import math

import numpy as np
import pytest

from behaviours.cores.look_ahead import BEYOND, TOUCHING, LookAheadSettings, carrot, cell_costs, costs_to_go, way
from behaviours.interface import Pose

SMALL = LookAheadSettings(half=1.5)
SETTINGS = LookAheadSettings()
NOTHING = np.zeros((0, 2))


def wall(x1, y1, x2, y2):
    count = int(math.hypot(x2 - x1, y2 - y1) / 0.05) + 1
    return np.column_stack([np.linspace(x1, x2, count), np.linspace(y1, y2, count)])


def literally(costs, wanted):
    """Dijkstra from beyond the edge."""
    n = len(costs)
    total, heap = np.full((n, n), math.inf), []
    for row, column in itertools.product(range(n), range(n)):
        if {row, column} & {0, n - 1}:
            ahead = (column - n // 2) * math.cos(wanted) + (row - n // 2) * math.sin(wanted)
            heap.append((BEYOND * (2 * n - ahead) + costs[row, column], row, column))
    heapq.heapify(heap)
    while heap:
        cost, row, column = heapq.heappop(heap)
        if cost >= total[row, column]:
            continue
        total[row, column] = cost
        for down, right in itertools.product((-1, 0, 1), repeat=2):
            r, c = row + down, column + right
            if 0 <= r < n and 0 <= c < n:
                heapq.heappush(heap, (cost + math.hypot(down, right) * (costs[row, column] + costs[r, c]) / 2, r, c))
    return total


@pytest.mark.parametrize("seed", range(4))
def test_costs_to_go_are_those_of_dijkstra(seed):
    chance = np.random.default_rng(seed)
    costs = cell_costs(chance.uniform(-1.5, 1.5, (12, 2)), SMALL)
    wanted = chance.uniform(-3, 3)
    assert costs_to_go(costs, wanted) == pytest.approx(literally(costs, wanted), abs=1e-3)


def test_a_cell_costs_more_the_nearer_something_stands():
    costs = cell_costs(np.array([[0.0, 0.0]]), SETTINGS)
    middle = SETTINGS.cells // 2
    row = costs[middle, middle:]
    assert (row[:3] == TOUCHING).all()
    assert (np.diff(row[3:]) <= 0).all()
    assert row[3] > 2.0
    assert row[-1] == pytest.approx(1.0, abs=0.1)
    assert (costs == costs.T).all()


def test_in_the_open_the_way_is_straight():
    places = way(NOTHING, 0.0, NOTHING, SETTINGS)
    assert places[0].tolist() == [0.0, 0.0]
    assert places[-1] == pytest.approx([4.0, 0.0])
    assert carrot(places, Pose(0.0, 0.0), 0.6) == pytest.approx(0.0)


def test_out_of_a_pocket_the_way_leads_back_and_round():
    pocket = np.concatenate([wall(1.5, -1, 1.5, 1), wall(-1, 1, 1.5, 1), wall(-1, -1, 1.5, -1)])
    places = way(pocket, 0.0, NOTHING, SETTINGS)
    assert places[:, 0].min() < -1.0
    assert places[-1, 0] == pytest.approx(4.0)
    assert np.hypot(*(places[:, None] - pocket[None]).transpose(2, 0, 1)).min() > SETTINGS.keep - SETTINGS.cell


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_of_two_ways_alike_the_one_found_last_is_kept(side):
    before = way(np.concatenate([wall(1.5, -1, 1.5, 1), wall(1.5, -side, 1.5, -3 * side)]), 0.0, NOTHING, SETTINGS)
    assert way(wall(1.5, -1, 1.5, 1), 0.0, before, SETTINGS)[:, 1].dot([1] * len(before)) * side > 0


def test_without_a_way_there_is_no_direction():
    assert carrot(NOTHING, Pose(0.0, 0.0), 0.6) is None


def test_walled_in_a_way_is_still_told():
    """Through the wall, for want of another; whoever drives sees to the hull."""
    walled = np.concatenate([wall(-1, y, 1, y) for y in (-1, 1)] + [wall(x, -1, x, 1) for x in (-1, 1)])
    assert way(walled, 0.0, NOTHING, SETTINGS)[-1, 0] == pytest.approx(4.0)
