"""The memory of places: where the robot has been, where it has not, and the way round a dead end."""

import math
from pathlib import Path

import pytest

from behaviours.catalogue import library
from behaviours.cores.circles import Circle
from behaviours.cores.commitment import Lock, were_reversed
from behaviours.cores.places import (
    Atlas,
    Place,
    PlacesSettings,
    as_way,
    frontiers,
    is_closed,
    is_seen,
    look_about,
    straight_to,
    visit,
    way_out,
)
from behaviours.estimators.obstacles import Obstacles
from behaviours.estimators.places import Places
from behaviours.interface import Pose, Workshop
from rplan.apps.simulation import World, simulate
from rplan.apps.wiring import compile_source
from rplan.lang.source import Source
from sim.scenarios.format import loads

ROOT = Path(__file__).parents[2]
WORLDS = ROOT / "plans" / "find_and_fetch" / "worlds"
PLAN = (ROOT / "plans" / "go_to_goal" / "go_to_goal.rplan").read_text(encoding="utf-8")
SETTINGS = PlacesSettings()
GOAL = Pose(8.0, 0.0)


def wall(*ends):
    """Circles every 0.2 m along straight walls."""
    spots = []
    for (ax, ay), (bx, by) in ends:
        count = round(math.hypot(bx - ax, by - ay) / 0.2)
        spots += [(ax + (bx - ax) * k / count, ay + (by - ay) * k / count) for k in range(count + 1)]
    return [Circle(k, ((x, y, 0),), x, y, 0.05) for k, (x, y) in enumerate(spots)]


BAY = wall(((2, -2), (2, 2)), ((-3, 2), (2, 2)), ((-3, -2), (2, -2)))
"""Open to the left, the goal beyond its back wall."""


def driven(*spots, circles=(), atlas=None):
    for x, y in spots:
        atlas = visit(atlas or Atlas(), Pose(x, y), circles, 6.0, SETTINGS)
    return atlas


# --- the atlas ------------------------------------------------------------------------------------


def test_there_is_a_place_every_metre_of_way_and_a_way_between_them():
    atlas = driven(*((0.1 * k, 0.0) for k in range(26)))
    assert [round(place.x, 1) for place in atlas.places.values()] == [0.0, 1.0, 2.0]
    assert list(atlas.ways) == [(0, 1), (1, 2)] and atlas.here == 2


def test_who_comes_back_is_at_the_same_place_and_the_quickest_time_of_a_way_is_kept():
    atlas = driven((0, 0), (1, 0))
    back = visit(atlas, Pose(0.2, 0.1), (), 4.0, SETTINGS)
    assert back.here == 0 and len(back.places) == 2 and back.ways == {(0, 1): 4.0}


def test_places_are_bounded_the_oldest_goes_first():
    atlas = Atlas()
    for k in range(6):
        atlas = visit(atlas, Pose(1.5 * k, 0.0), (), 6.0, PlacesSettings(most=4))
    assert list(atlas.places) == [2, 3, 4, 5] and list(atlas.ways) == [(2, 3), (3, 4), (4, 5)]


def test_a_place_knows_how_far_it_is_clear_in_each_direction():
    reach = look_about(0.0, 0.0, BAY, SETTINGS)
    assert reach[0] == pytest.approx(1.5, abs=0.06) and reach[12] == SETTINGS.sight
    assert reach[6] == pytest.approx(1.5, abs=0.06)


def test_a_frontier_is_the_end_of_a_clear_heading_that_no_other_place_sees():
    atlas = driven((0, 0), circles=BAY)
    (out,) = {f.heading for f in frontiers(atlas, (), SETTINGS.sight, SETTINGS)} & {12}
    assert out == 12
    atlas = driven((-1.2, 0), (-2.4, 0), circles=BAY, atlas=atlas)
    assert 12 not in {f.heading for f in frontiers(atlas, (), SETTINGS.sight, SETTINGS) if f.place == 0}


def test_what_was_tried_and_what_was_seen_to_be_shut_is_no_frontier():
    atlas = driven((0, 0))
    (first, *_) = ends = frontiers(atlas, (), SETTINGS.sight, SETTINGS)
    assert len(ends) == 24 and first not in frontiers(atlas, (first,), SETTINGS.sight, SETTINGS)
    assert is_closed(atlas, first, wall(((1.0, -1.0), (1.0, 1.0))), SETTINGS)
    assert not is_closed(atlas, first, (), SETTINGS) and not is_seen(atlas, first, SETTINGS)


def test_the_goal_is_in_sight_only_where_nothing_stands_before_it():
    assert straight_to(Pose(0.0, 0.0), Pose(2.0, 0.0), (), SETTINGS)
    assert not straight_to(Pose(0.0, 0.0), Pose(2.0, 0.0), wall(((1, -1), (1, 1))), SETTINGS)
    assert not straight_to(Pose(0.0, 0.0), GOAL, (), SETTINGS)


def open_in(*headings):
    return tuple(SETTINGS.sight if k in headings else 0.0 for k in range(24))


CORRIDOR = Atlas(
    {0: Place(0.0, 0.0, open_in(18)), 1: Place(1.0, 0.0, open_in()), 2: Place(2.0, 0.0, open_in(6))},
    {(0, 1): 5.0, (1, 2): 5.0},
    0,
)
"""Three places in a row; the first is open to the right, the last to the left."""
ENDS = frontiers(CORRIDOR, (), SETTINGS.sight, SETTINGS)


@pytest.mark.parametrize(("goal", "expected"), [((2.0, 8.0), (0, 1, 2)), ((0.0, -8.0), (0,))])
def test_the_way_out_is_the_cheapest_by_driven_time_and_straight_way_to_the_goal(goal, expected):
    path, end = way_out(CORRIDOR, ENDS, (), Pose(0.0, 0.0), Pose(*goal), SETTINGS)
    assert path == expected and end.place == expected[-1]


def test_a_way_that_took_long_is_not_worth_a_short_rest():
    slow = Atlas(CORRIDOR.places, {(0, 1): 5.0, (1, 2): 90.0}, 0)
    _, end = way_out(slow, ENDS, (), Pose(0.0, 0.0), Pose(2.0, 8.0), SETTINGS)
    assert end.place == 0


def test_a_blocked_way_is_not_taken_and_without_a_way_there_is_none():
    _, end = way_out(CORRIDOR, ENDS, {as_way(2, 1)}, Pose(0.0, 0.0), Pose(2.0, 8.0), SETTINGS)
    assert end.place == 0
    assert way_out(CORRIDOR, [], (), Pose(0.0, 0.0), GOAL, SETTINGS) is None
    assert way_out(Atlas(), [], (), Pose(0.0, 0.0), GOAL, SETTINGS) is None


# --- the search -----------------------------------------------------------------------------------


def test_without_a_dead_end_the_goal_is_the_goal():
    places = Places(SETTINGS, 0.5)
    assert places.aim(Pose(0.0, 0.0), GOAL, BAY, 0.0) == GOAL
    assert places.aim(Pose(0.0, 0.0), None, BAY, 0.3) is None
    places.dead_end(Pose(0.0, 0.0))
    assert not places.is_searching


def trapped():
    places = Places(SETTINGS, 0.5)
    places.aim(Pose(0.0, 0.0), GOAL, BAY, 0.0)
    places.dead_end(Pose(0.0, 0.0))
    return places


def test_after_a_dead_end_the_aim_is_a_frontier_until_the_robot_is_nearer_than_ever():
    places = trapped()
    aim = places.aim(Pose(0.0, 0.0), GOAL, BAY, 0.3)
    assert aim.x < -1.5 and abs(aim.y) < 1.5
    assert places.aim(Pose(-1.0, 0.0), GOAL, BAY, 5.0) != GOAL
    assert places.aim(Pose(3.0, 4.0), GOAL, BAY, 60.0) == GOAL
    assert not places.is_searching


def test_a_frontier_that_gets_no_nearer_is_given_up_for_another():
    places = trapped()
    first = places.aim(Pose(0.0, 0.0), GOAL, BAY, 0.3)
    assert places.aim(Pose(0.0, 0.0), GOAL, BAY, 15.0) == first
    places.aim(Pose(0.0, 0.0), GOAL, BAY, 22.0)
    places.aim(Pose(0.0, 0.0), GOAL, BAY, 43.0)
    assert places.aim(Pose(0.0, 0.0), GOAL, BAY, 43.3) != first


def test_another_goal_is_gone_for_straight():
    places, other = trapped(), Pose(-8.0, 0.0)
    assert places.aim(Pose(0.0, 0.0), other, BAY, 0.3) == other and not places.is_searching


def test_where_no_frontier_is_left_the_goal_is_tried_again():
    box = [*BAY, *wall(((-1, -2), (-1, 2)))]
    places = Places(SETTINGS, 0.5)
    places.aim(Pose(0.5, 0.0), GOAL, box, 0.0)
    places.dead_end(Pose(0.5, 0.0))
    aims = [places.aim(Pose(0.5, 0.0), GOAL, box, 25.0 * k) for k in range(1, 40)]
    assert GOAL in aims


def test_a_place_that_is_entered_again_and_again_is_a_dead_end():
    places = Places(SETTINGS, 0.5)
    for k in range(6):
        places.aim(Pose(1.2 * (k % 2), 0.0), GOAL, BAY, 3.0 * k)
    assert places.is_searching


def test_driving_about_without_coming_to_another_place_is_a_dead_end_and_standing_is_not():
    for step, searching in ((0.05, True), (0.0, False)):
        places = Places(SETTINGS, 0.5)
        for k in range(200):
            places.aim(Pose(step * (k % 2), 0.0), GOAL, BAY, 0.3 * k)
        assert places.is_searching is searching


def test_near_the_goal_nothing_is_a_dead_end():
    places, near = Places(SETTINGS, 0.5), Pose(7.5, 0.0)
    places.aim(near, GOAL, (), 0.0)
    places.dead_end(near)
    assert not places.is_searching


def test_a_lock_is_reversed_where_its_detour_has_grown():
    before = {0: Lock("cw", 4.0, 5.0)}
    assert were_reversed(before, {0: Lock("ccw", 4.0, 10.0)})
    assert not were_reversed(before, before) and not were_reversed(before, {1: Lock("cw", 4.0, 10.0)})


# --- the switch, and worlds -------------------------------------------------------------------------


def places_of(**values):
    workshop = Workshop()
    library("natigation").build(values, workshop)
    return next(one for one in workshop.estimators if isinstance(one, Obstacles)).places


def test_the_preset_modern_has_places_the_paper_has_none_and_a_plan_may_override_both():
    assert places_of() is None and places_of(preset="modern", places="off") is None
    assert places_of(preset="modern") is not None and places_of(places="on") is not None
    with pytest.raises(ValueError, match="places"):
        places_of(places="perhaps")


def verdict(name, switches, seed, seconds):
    text = (WORLDS / f"{name}.yaml").read_text(encoding="utf-8")
    plan = compile_source(Source("plan.rplan", PLAN.replace("(use natigation ", f"(use natigation {switches} ")))
    return simulate(plan, World(loads(text, "world.yaml"), text), seed, until=seconds).verdict


@pytest.mark.parametrize(("name", "seed", "seconds"), [("maze_spiral", 9, 400.0), ("maze_rooms", 6, 480.0)])
def test_the_robot_finds_out_of_a_maze_that_it_does_not_leave_without_places(name, seed, seconds):
    found = verdict(name, ":preset modern", seed, seconds)
    assert found.done and found.contacts == ()
    assert not verdict(name, ":preset modern :places off", seed, seconds).done
