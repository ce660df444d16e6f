"""What is heard of beacons: the model, the grids, the memory of names, and where to listen next."""

import math

import numpy as np
import pytest

from behaviours.cores.beacon import BeaconModel, chance_to_hear, expected, range_by_strength, suspects_sun
from behaviours.cores.beacon_grid import BearingRange, Cells, best_listening, disc, faintly, missed, weights
from behaviours.estimators.beacons import Beacons, BeaconSettings
from behaviours.estimators.roaming import rings
from behaviours.interface import IrReading, Odometry, Pose, Reading, wrap

MODEL = BeaconModel()
HOME = Pose(0.0, 0.0)


def fixation(pose, at, pan, chance=None, name="ann"):
    """What the reader says of one beacon."""
    away = math.hypot(at[0] - pose.x, at[1] - pose.y)
    offset = wrap(math.atan2(at[1] - pose.y, at[0] - pose.x) - pose.theta - pan)
    noise = 0.0 if chance is None else 0.2 * chance.standard_normal()
    strength = max(0.0, float(expected(np.array(away), np.array(offset), MODEL)) + noise)
    heard = strength > MODEL.heard
    return IrReading(0.0, True, pan, heard, offset if heard else math.nan, strength, name if heard else "")


def reading(pose, ir):
    return Reading(0.0, 0, Odometry(pose, 0.0, 0.0), ir=ir)


def listen(beacons, pose, *ats, chance=None):
    """A circle of fixations; each hears the strongest beacon."""
    for k in range(24):
        pan = wrap((k + 0.5) * math.tau / 24)
        heard = [fixation(pose, at, pan, chance, name) for at, name in zip(ats, ("ann", "bob", "cid"), strict=False)]
        beacons.update(reading(pose, max(heard, key=lambda ir: ir.strength)), {}, {})


def mean(beacons):
    w = weights(beacons.logs())
    return float(w @ beacons.cells.x), float(w @ beacons.cells.y)


def test_a_beacon_is_heard_within_25_feet_and_not_at_28():
    signals = expected(np.array([24.0, 28.0]) * 0.3048, np.zeros(2), MODEL)
    near, far = chance_to_hear(signals, MODEL)
    assert near > 0.9 and far < 0.05


def test_out_of_the_field_nothing_is_heard():
    assert expected(np.array([3.0]), np.array([math.radians(31)]), MODEL)[0] == 0.0


def test_the_range_by_strength_undoes_the_inverse_square():
    heard = [(offset, float(expected(np.array(5.0), np.array(offset), MODEL))) for offset in (-0.2, 0.0, 0.3)]
    assert range_by_strength(heard, MODEL) == pytest.approx(5.0)
    assert math.isnan(range_by_strength([], MODEL))


def test_noise_alone_is_no_sun():
    for seed in range(50):
        noise = np.maximum(0.0, 0.2 * np.random.default_rng(seed).standard_normal(91))
        assert not suspects_sun(noise.tolist(), MODEL)


def test_where_nothing_was_heard_no_beacon_is_likely():
    cells = Cells(np.array([4.0, -4.0, 12.0]), np.zeros(3))
    logs = missed(cells, HOME, 0.0, MODEL)
    assert logs[0] < math.log(0.2), "in front and near"
    assert logs[1] == pytest.approx(0.0, abs=1e-6), "behind"
    assert logs[2] == pytest.approx(0.0, abs=1e-6), "too far to be heard"


def test_a_faint_signal_is_for_places_that_explain_it():
    cells = Cells(np.array([12.0, 18.0, -12.0]), np.zeros(3))
    logs = faintly(cells, HOME, 0.0, float(expected(np.array(12.0), np.array(0.0), MODEL)), MODEL)
    assert np.argmax(logs) == 0


def test_one_circle_tells_where_a_beacon_beyond_hearing_is():
    for seed in range(5):
        beacons = Beacons(BeaconSettings())
        listen(beacons, HOME, (10.0, 9.0), chance=np.random.default_rng(seed))
        assert beacons.heard == {}
        assert math.dist(mean(beacons), (10.0, 9.0)) < 4.0


def test_without_faint_signals_it_only_tells_where_none_is():
    beacons = Beacons(BeaconSettings(faint=False))
    listen(beacons, HOME, (10.0, 9.0))
    w = weights(beacons.logs())
    away = np.hypot(beacons.cells.x, beacons.cells.y)
    assert math.dist(mean(beacons), (0.0, 0.0)) < 0.5
    assert w[away < 6].mean() < 0.1 * w[away > 9].mean()


def test_bearings_from_two_places_make_a_place():
    grid = BearingRange(HOME, 0.1)
    at = (6.0 * math.cos(0.1), 6.0 * math.sin(0.1))
    for pose in (HOME, Pose(2.0, -1.0, 0.3), Pose(3.0, 1.5, -0.2)):
        ir = fixation(pose, at, wrap(math.atan2(at[1] - pose.y, at[0] - pose.x) - pose.theta))
        grid.hear(pose, ir.pan, ir.offset, ir.strength, MODEL)
    found = grid.estimate()
    assert math.dist((found.x, found.y), at) < 0.2 and found.spread < 0.3


def test_a_beacon_in_the_sun_is_placed_by_its_bearings():
    grid = BearingRange(HOME, 0.0)
    at = (3.0, 0.0)
    for pose in (HOME, Pose(1.0, -1.5), Pose(1.0, 1.5), Pose(2.0, 1.5)):
        ir = fixation(pose, at, wrap(math.atan2(at[1] - pose.y, at[0] - pose.x)))
        grid.hear(pose, ir.pan, ir.offset, ir.strength / 10, MODEL)
    found = grid.estimate()
    assert math.dist((found.x, found.y), at) < 0.4


def test_each_name_has_its_own_place():
    beacons = Beacons(BeaconSettings())
    listen(beacons, HOME, (5.0, 0.0), (-4.0, 4.0))
    assert list(beacons.heard) == ["ann", "bob"]
    for name, at in (("ann", (5.0, 0.0)), ("bob", (-4.0, 4.0))):
        found = beacons.estimate(name)
        assert math.dist((found.x, found.y), at) < 0.6


def test_a_beacon_that_moves_is_placed_anew():
    beacons = Beacons(BeaconSettings())
    listen(beacons, HOME, (5.0, 0.0))
    listen(beacons, HOME, (0.0, 5.0))
    found = beacons.estimate("ann")
    assert math.dist((found.x, found.y), (0.0, 5.0)) < 0.6


def test_the_next_place_is_where_more_is_heard_for_the_time():
    cells = disc(HOME, 20.0, 1.0)
    logs = np.where(np.hypot(cells.x - 12.0, cells.y) < 2.0, 0.0, -20.0)
    candidates = disc(HOME, 18.0, 2.0)
    place, chance = best_listening(cells, logs, candidates, HOME, MODEL, 0.15, 40.0)
    assert 3.0 < math.dist((place.x, place.y), (12.0, 0.0)) < 7.5 and chance > 0.9
    assert best_listening(cells, logs, Cells(np.array([]), np.array([])), HOME, MODEL, 0.15, 40.0) is None


def test_the_stops_of_a_spiral_leave_no_place_within_reach_unheard():
    stops = [HOME, *rings(HOME, 18.0)]
    cells = disc(HOME, 18.3, 1.0)
    nearest = np.min([np.hypot(cells.x - stop.x, cells.y - stop.y) for stop in stops], axis=0)
    assert float(nearest.max()) < 7.4
