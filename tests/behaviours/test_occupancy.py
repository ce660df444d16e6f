"""The occupancy grid: what one beam tells, what many do, how it grows, and where it ends."""

from __future__ import annotations

import math

import numpy as np
import pytest

from behaviours.cores.occupancy import MOST, UNKNOWN, OccupancyGrid, OccupancySettings, Region, logit
from behaviours.interface import Pose, Scan

HERE = Pose(0.05, 0.05, 0.0)
"""Within the cell (0, 0), off its edges."""


AHEAD = Pose(0.0, 0.0, 0.0)


def scan(ranges, bearings=None, mount=AHEAD, far=20.0):
    ranges = np.asarray(ranges, dtype=float)
    bearings = np.zeros(ranges.size) if bearings is None else np.asarray(bearings, dtype=float)
    return Scan(0.0, True, mount, bearings, ranges, 0.05, far)


def grid_of(*scans, pose=HERE, **settings):
    grid = OccupancyGrid(OccupancySettings(**settings))
    for one in scans:
        grid.add(one, pose)
    return grid


def row(grid, columns, row=0, column=0):
    return grid.percents(Region(column, row, columns, 1))[0].tolist()


def test_a_beam_frees_the_cells_before_its_end_and_fills_that():
    assert row(grid_of(scan([1.0])), 8) == [40, 40, 40, 40, 40, 70, UNKNOWN, UNKNOWN]


def test_nothing_beside_a_beam_changes():
    grid = grid_of(scan([1.0]))
    assert grid.known == 6
    assert grid.area == pytest.approx(6 * 0.04)


def test_a_beam_that_met_nothing_frees_all_its_range_and_fills_nothing():
    assert row(grid_of(scan([2.0], far=2.0)), 12) == [40] * 10 + [UNKNOWN] * 2


def test_what_lies_beyond_the_reach_is_left_out():
    assert row(grid_of(scan([5.0]), reach=1.0), 8) == [40] * 5 + [UNKNOWN] * 3


@pytest.mark.parametrize("ranges", [[math.nan], [], [math.nan, math.nan]])
def test_a_scan_without_a_sound_beam_tells_nothing(ranges):
    assert grid_of(scan(ranges)).known == 0


def test_a_failed_beam_does_not_spoil_the_others():
    assert row(grid_of(scan([math.nan, 1.0], [0.0, 0.0])), 6) == [40, 40, 40, 40, 40, 70]


def test_one_scan_changes_a_cell_once_however_many_beams_touch_it():
    many = grid_of(scan([1.0] * 50, np.linspace(-0.01, 0.01, 50)))
    assert row(many, 7) == row(grid_of(scan([1.0])), 7)


def test_where_one_beam_ends_and_another_passes_something_stands():
    both = grid_of(scan([1.0, 3.0], [0.0, 0.0]))
    assert row(both, 6) == [40, 40, 40, 40, 40, 70]


def test_evidence_adds_up_and_what_goes_away_fades():
    assert row(grid_of(*[scan([1.0])] * 2), 6)[5] == 84
    assert row(grid_of(scan([1.0]), scan([3.0]), scan([3.0])), 6)[5] == 51
    assert row(grid_of(scan([1.0]), *[scan([3.0])] * 4), 6)[5] < 50


def test_evidence_that_cancels_out_is_still_known():
    grid = grid_of(scan([1.0]), scan([3.0]), hit=0.6, passed=0.4)
    assert row(grid, 6)[5] == 50
    assert grid.known == 16
    grid.add(scan([3.0]), HERE)
    assert grid.known == 16


def test_no_cell_gets_surer_than_the_surest():
    grid = grid_of(*[scan([1.0])] * 100)
    assert row(grid, 6) == [3, 3, 3, 3, 3, 97]
    grid.add(scan([3.0]), HERE)
    assert row(grid, 6)[5] < 97
    assert logit(0.97) == pytest.approx(float(grid.odds.cells.max()), abs=0.5)


def test_the_sensor_sits_where_it_is_mounted():
    mount = Pose(0.4, 0.2, math.pi / 2)
    grid = grid_of(scan([1.0], mount=mount), pose=Pose(1.05, 2.05, math.pi / 2))
    assert grid.percents(Region(-2, 12, 7, 1))[0].tolist() == [UNKNOWN, 70, 40, 40, 40, 40, 40]


@pytest.mark.parametrize("turn", range(4))
def test_a_scan_turned_by_a_right_angle_gives_the_map_turned(turn):
    chance = np.random.default_rng(3)
    bearings, ranges = np.linspace(-3, 3, 61) + 0.0123, chance.uniform(0.5, 6.0, 61)
    pose = Pose(0.1, 0.1, turn * math.pi / 2)  # the middle of the cell (0, 0)
    window = Region(-35, -35, 71, 71)
    straight = grid_of(scan(ranges, bearings), pose=Pose(0.1, 0.1, 0.0)).percents(window)
    turned = grid_of(scan(ranges, bearings), pose=pose).percents(window)
    assert np.mean(np.rot90(straight, -turn)[::1] != turned) < 0.002


def test_no_cell_that_a_beam_crosses_by_more_than_its_half_is_missed():
    for bearing in np.linspace(0.03, 1.54, 40):
        grid = grid_of(scan([6.0], [bearing]), pose=Pose(0.1, 0.1, 0.0))
        for k in range(1, 28):
            at = 0.1 + k * 0.2 * math.cos(bearing), 0.1 + k * 0.2 * math.sin(bearing)
            assert row(grid, 1, math.floor(at[1] / 0.2), math.floor(at[0] / 0.2)) == [40]


def test_the_grid_grows_and_keeps_what_it_knew():
    grid = grid_of(scan([1.0]))
    before = row(grid, 8)
    for x in (-30.0, 55.0, 20.0):
        grid.add(scan([1.0]), Pose(x + 0.05, -40.0, 0.0))
    assert row(grid, 8) == before
    assert grid.percents(Region(275, -200, 6, 1))[0].tolist() == [40] * 5 + [70]
    assert grid.odds.cells.size < 700 * 320


def test_what_lies_too_far_off_is_not_kept():
    grid = grid_of(scan([1.0]))
    for pose in (Pose(1e6, 0, 0), Pose(0, -1e300, 0), Pose(math.nan, 0, 0), Pose(0, math.inf, 0)):
        grid.add(scan([1.0]), pose)
    assert grid.known == 6
    grid.add(scan([1.0]), Pose((MOST - 100) * 0.2, 0, 0))
    assert grid.known == 12


def test_what_was_never_looked_at_is_unknown():
    assert row(OccupancyGrid(OccupancySettings()), 3) == [UNKNOWN] * 3
    assert row(grid_of(scan([1.0])), 3, row=5000) == [UNKNOWN] * 3


def along_a_wall(**settings):
    """What is seen of a wall 1.5 m to the left on a way of 12 m along it."""
    bearings = np.arange(1, 362) / 361 * math.tau - math.pi
    ranges = np.where(bearings > 0.01, np.minimum(1.53 / np.sin(np.maximum(bearings, 0.01)), 20.0), 20.0)
    grid, chance = OccupancyGrid(OccupancySettings(**settings)), np.random.default_rng(8)
    for k in range(121):
        seen = np.where(ranges < 20.0, ranges + 0.02 * chance.standard_normal(361), 20.0)
        grid.add(scan(seen, bearings), Pose(k * 0.1, 0.0, 0.0))
    wall = grid.percents(Region(0, 7, 60, 1))[0]
    return float(np.mean((wall > 50) & (wall <= 100)))


def test_beams_that_graze_a_wall_wear_it_away_unless_the_last_cells_are_spared():
    worn, whole = along_a_wall(), along_a_wall(spare=2.0)
    assert whole > max(worn, 0.95)


def test_cells_that_are_spared_are_left_as_they_were():
    assert row(grid_of(scan([1.0]), spare=2.0), 7) == [40, 40, 40, UNKNOWN, UNKNOWN, 70, UNKNOWN]
    assert row(grid_of(scan([0.1]), spare=2.0), 3) == [70, UNKNOWN, UNKNOWN]
    assert row(grid_of(scan([2.0], far=2.0), spare=2.0), 12) == [40] * 10 + [UNKNOWN] * 2


def test_a_room_is_mapped_with_its_walls_where_they_are():
    bearings = np.arange(361) / 361 * math.tau - math.pi
    ranges = np.minimum(4.5 / np.abs(np.cos(bearings)), 3.1 / np.abs(np.sin(bearings)))
    grid = grid_of(*[scan(ranges, bearings)] * 5, pose=Pose(0.0, 0.0, 0.0))
    cells = grid.percents(Region(-40, -40, 80, 80))
    rows, columns = np.nonzero((cells > 50) & (cells <= 100))
    assert (rows.min() - 40, rows.max() - 40) == (-16, 15)
    assert (columns.min() - 40, columns.max() - 40) == (-23, 22)
    assert (cells[26:54, 19:61] < 50).all()
