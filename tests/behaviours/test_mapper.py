"""Maps in patches: what is sent is what the grid knows, a damaged patch is told, and a room comes out sharp."""

from __future__ import annotations

import base64
import math
import zlib
from dataclasses import replace

import numpy as np
import pytest

from behaviours.catalogue import library
from behaviours.cores.occupancy import UNKNOWN, OccupancyGrid, OccupancySettings, Region
from behaviours.cores.patches import SAME, Patch, PatchReader, PatchWriter, around, packed, unpacked
from behaviours.estimators.localisation import Localisation, LocalisationSettings
from behaviours.estimators.mapper import Mapper, MapperSettings
from behaviours.interface import Command, Drive, Pose, Scan, Workshop
from sim.scenarios.format import loads
from sim.world import World

ROOM = """
name: room
bounds: [-8, -8, 8, 8]
robot: {start: [-4, -4], heading: 20 deg, model: packbot}
things:
  - {kind: wall, from: [-7, -7], to: [7, -7]}
  - {kind: wall, from: [7, -7], to: [7, 7]}
  - {kind: wall, from: [7, 7], to: [-7, 7]}
  - {kind: wall, from: [-7, 7], to: [-7, -7]}
  - {kind: box, at: [0, 0], size: [3, 3]}
"""
LEGS = [(0.5, 0.0, 140), (0.0, 0.8, 22), (0.5, 0.05, 120), (0.0, 0.8, 25), (0.5, 0.0, 60)]


COMPASS, FILTERED = LocalisationSettings(), LocalisationSettings(modern=True)


@pytest.fixture(scope="module")
def seen():
    """The readings of a drive through the room."""
    world, told = World(loads(ROOM, "room"), 3), []
    for speed, rate, ticks in LEGS:
        for _ in range(ticks):
            told.append(world.sense())
            world.step(Command(drive=Drive(speed, rate)))
    return told


def mapped(readings, localisation=COMPASS, **settings):
    """The mapper after the readings, and all its patches."""
    place = Localisation(localisation)
    mapper = Mapper(MapperSettings(**settings), place)
    patches = []
    for reading in readings:
        place.update(reading, {}, {})
        mapper.update(reading, {}, {})
        patches += [] if mapper.patch is None else [mapper.patch]
    return mapper, patches


def read(patches):
    reader = PatchReader()
    for patch in patches:
        reader.add(patch)
    return reader


ALL = Region(-150, -150, 300, 300)


# --- the stream -----------------------------------------------------------------------------------


def test_the_map_that_comes_out_is_the_one_that_went_in(seen):
    mapper, patches = mapped(seen[:301])  # a patch is sent with the last of them
    assert len(patches) == 31
    assert np.array_equal(read(patches).plane.copy(ALL), mapper.grid.percents(ALL))


def test_after_every_patch_the_reader_knows_what_has_been_sent(seen):
    place, reader = Localisation(COMPASS), PatchReader()
    mapper = Mapper(MapperSettings(region=6.0), place)
    for reading in seen[:200]:
        place.update(reading, {}, {})
        mapper.update(reading, {}, {})
        if mapper.patch is not None:
            reader.add(mapper.patch)
            region = around(place.pose.x, place.pose.y, 6.0, 0.2)
            assert np.array_equal(reader.plane.copy(region), mapper.grid.percents(region))
    outside = (mapper.grid.percents(ALL) != UNKNOWN) & (reader.plane.copy(ALL) == UNKNOWN)
    assert outside.any()


def test_one_who_joins_late_gets_all_and_goes_on_with_the_patches(seen):
    place = Localisation(COMPASS)
    grid, writer = OccupancyGrid(OccupancySettings()), PatchWriter(0.2, 40.0)
    early, late = PatchReader(), PatchReader()
    assert writer.whole() is None
    for n, reading in enumerate(seen):
        place.update(reading, {}, {})
        grid.add(reading.lidar, place.pose)
        if n == 200:
            late.add(writer.whole())
        patch = writer.delta(grid, place.pose.x, place.pose.y) if n % 10 == 0 else None
        if patch is not None:
            early.add(patch)
            if n >= 200:
                late.add(patch)
    assert np.array_equal(early.plane.copy(ALL), late.plane.copy(ALL))


def test_where_nothing_changes_nothing_is_sent():
    grid, writer = OccupancyGrid(OccupancySettings()), PatchWriter(0.2, 10.0)
    assert writer.delta(grid, 0.0, 0.0) is None
    grid.add(Scan(0.0, True, Pose(0, 0, 0), np.zeros(1), np.ones(1), 0.05, 20.0), Pose(0.05, 0.05, 0.0))
    patch = writer.delta(grid, 0.0, 0.0)
    assert patch.region == Region(0, 0, 6, 1)
    assert unpacked(patch).tolist() == [[40, 40, 40, 40, 40, 70]]
    assert writer.delta(grid, 0.0, 0.0) is None


def test_cells_of_a_patch_that_did_not_change_are_marked_and_left_alone():
    reader = PatchReader()
    reader.add(packed(0.2, Region(0, 0, 3, 1), np.array([[10, 20, 30]], dtype=np.uint8)))
    reader.add(packed(0.2, Region(0, 0, 3, 1), np.array([[SAME, 90, UNKNOWN]], dtype=np.uint8)))
    assert reader.plane.copy(Region(0, 0, 3, 1)).tolist() == [[10, 90, UNKNOWN]]


def test_the_size_of_a_patch_is_that_of_its_bytes():
    for n in range(1, 9):
        patch = packed(0.2, Region(0, 0, n, 1), np.arange(n, dtype=np.uint8).reshape(1, n))
        assert patch.size == len(base64.b64decode(patch.data))


def bomb():
    return base64.b64encode(zlib.compress(bytes(50_000_000), 9)).decode()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"data": "!"}, "damaged data"),
        ({"data": "é"}, "damaged data"),
        ({"data": base64.b64encode(b"no zlib").decode()}, "damaged data"),
        ({"region": Region(0, 0, 4, 1)}, "3 cells instead of 4"),
        ({"region": Region(0, 0, 0, 1)}, "a patch of 0 times 1 cells"),
        ({"region": Region(0, 0, 10**9, 10**9)}, "outside of all maps"),
        ({"region": Region(10**9, 0, 3, 1)}, "outside of all maps"),
        ({"cell": 0.1}, "cells of 0.1 m after cells of 0.2 m"),
    ],
)
def test_a_patch_that_cannot_be_is_told_and_changes_nothing(change, told):
    good = packed(0.2, Region(0, 0, 3, 1), np.array([[10, 20, 30]], dtype=np.uint8))
    reader = read([good])
    with pytest.raises(ValueError, match=told):
        reader.add(replace(good, **change))
    assert reader.plane.copy(Region(-1, 0, 5, 1)).tolist() == [[UNKNOWN, 10, 20, 30, UNKNOWN]]


def test_a_bomb_is_not_unpacked():
    small = Patch(0.2, Region(0, 0, 3, 1), bomb())
    assert unpacked(small).tolist() == [[0, 0, 0]]


# --- the mapper -----------------------------------------------------------------------------------


def uncertain(mapper):
    """Share of the known cells that are neither free nor occupied for sure."""
    odds = np.abs(mapper.grid.odds.cells)
    return float(np.mean(odds[odds > 0] < 2.0))


def test_a_map_by_the_filtered_heading_is_sharper_than_by_the_compass(seen):
    raw, _ = mapped(seen)
    filtered, _ = mapped(seen, FILTERED)
    assert uncertain(filtered) < 0.75 * uncertain(raw)


def solid(mapper):
    cells = mapper.grid.percents(ALL)
    return int(((cells > 60) & (cells != UNKNOWN)).sum())


def test_by_odometry_the_walls_come_out_several_times_and_by_compass_once(seen):
    by_compass, _ = mapped(seen, FILTERED)
    by_odometry, _ = mapped(seen, by_odometry=True)
    assert solid(by_odometry) > 1.2 * solid(by_compass)


def test_the_rate_is_what_was_sent_in_the_time_there_was(seen):
    mapper, patches = mapped(seen)
    assert mapper.bytes_sent == sum(patch.size for patch in patches)
    assert mapper.rate() == pytest.approx(mapper.bytes_sent / (seen[-1].stamp + 1.0))
    assert 100 < mapper.rate() < 2000


@pytest.mark.parametrize(("every", "due"), [(0.5, [0.0, 0.5, 1.0, 1.5]), (0.3, [0.0, 0.3, 0.6, 0.9, 1.2, 1.5])])
def test_patches_come_as_often_as_asked_for(seen, every, due):
    stamps = []
    place = Localisation(COMPASS)
    mapper = Mapper(MapperSettings(every=every), place)
    for n, reading in enumerate(seen[:20]):
        place.update(reading, {}, {})
        mapper.update(replace(reading, stamp=n * 0.1), {}, {})
        stamps += [] if mapper.patch is None else [round(reading.stamp, 3)]
    assert [stamp for stamp in stamps if stamp < 1.6] == due


def test_the_library_gives_its_words_and_the_view(seen):
    workshop = Workshop()
    offer = library("mapping").build({"region": 60.0}, workshop)
    assert offer.percepts["the-map-rate"]() == 0.0
    for estimator in workshop.estimators:
        estimator.update(seen[0], {}, {})
    view = offer.views["map"]()
    assert {key: view[key] for key in ("kind", "frame", "cell")} == {"kind": "grid", "frame": "map", "cell": 0.2}
    cells = np.frombuffer(zlib.decompress(base64.b64decode(view["data"])), np.uint8)
    assert cells.size == view["columns"] * view["rows"]
    assert offer.percepts["the-mapped-area"]() == pytest.approx(
        0.04 * int(((cells != SAME) & (cells != UNKNOWN)).sum())
    )
    for estimator in workshop.estimators:
        estimator.update(seen[1], {}, {})
    assert offer.views["map"]() is None


@pytest.mark.parametrize(("values", "spare"), [({}, 0.0), ({"preset": "paper"}, 0.0), ({"preset": "modern"}, 2.0)])
def test_the_preset_says_how_beams_are_taken(values, spare):
    workshop = Workshop()
    library("mapping").build(values, workshop)
    assert workshop.estimators[-1].settings.grid.spare == spare


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"preset": "best"}, "preset must be paper or modern, not best"),
        ({"by": "gps"}, "by must be hybrid or odometry, not gps"),
        ({"hit": 0.4}, "expected 0 < passed < 0.5 < hit <= surest < 1"),
        ({"surest": 1.0}, "expected 0 < passed < 0.5 < hit <= surest < 1"),
        ({"cell": 0.001}, "cell must be from 0.02 to 5 m"),
        ({"reach": 1000.0}, "reach from 1 to 1000 cells"),
        ({"region": 1e6}, "region must be from 1 to 2000 cells"),
        ({"every": 0.0}, "every must be finite and more than 0"),
        ({"every": math.inf}, "every must be finite"),
    ],
)
def test_a_parameter_that_cannot_be_is_told(values, told):
    with pytest.raises(ValueError, match=told):
        library("mapping").build(values, Workshop())
