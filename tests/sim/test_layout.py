"""What a seed makes of a scenario keeps the distances that were asked for."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from sim.frames import distance_to_segment
from sim.noise import chance
from sim.raycast import Circle
from sim.scenarios.format import load
from sim.scenarios.layout import Layout, distance, lay_out
from sim.scenarios.schema import ScenarioError

LOT = load(Path(__file__).parents[2] / "plans" / "find_and_fetch" / "parking_lot.yaml")


def layout(seed: int) -> Layout:
    return lay_out(LOT, chance(seed).layout)


def scattered(made: Layout) -> list:
    kinds = ("trashcan", "post", "person")
    return [thing for thing in made.things if thing.kind in kinds and thing.id not in ("walker", "rolled-trashcan")]


def test_the_same_seed_gives_the_same_layout_and_another_one_another():
    assert layout(3) == layout(3)
    assert layout(3) != layout(4)


def test_the_lot_has_four_to_seven_obstacles_and_every_number_occurs():
    counts = [len(scattered(layout(seed))) for seed in range(40)]
    assert sorted(dict.fromkeys(counts)) == [4, 5, 6, 7]


def test_scattered_things_keep_their_gaps_and_leave_the_view_to_the_donor_free():
    for seed in range(25):
        made = layout(seed)
        for thing in scattered(made):
            at = thing.pose.x, thing.pose.y
            assert isinstance(thing.outline, Circle)
            radius = thing.outline.radius
            gaps = [distance(at, other.outline, other.pose) - radius for other in made.things if other is not thing]
            assert min(gaps) >= 1.5
            assert math.dist(at, (0, 0)) - radius - 0.35 >= 1.5
            assert distance_to_segment(at, (0, 0), LOT.donor.at) >= 0.3 + radius
            assert distance_to_segment(at, (5.4, -3.8), (5.4, 2.9)) >= 0.25 + radius  # where somebody walks


def test_the_heading_is_drawn_from_the_interval():
    headings = [layout(seed).start.theta for seed in range(30)]
    assert all(abs(heading) <= math.pi / 3 for heading in headings)
    assert max(headings) - min(headings) > 1.0


def test_too_little_room_is_told(small):
    crowd = "scatter: [{kinds: [post], count: [9, 9], region: [2, 2, 3, 3], min_gap: 1}]"
    with pytest.raises(ScenarioError, match="no room for 9 scattered things"):
        lay_out(small(more=crowd), chance(0).layout)


def test_a_robot_that_starts_in_a_thing_is_told(small):
    with pytest.raises(ScenarioError, match="the robot stands in 'post-1' there"):
        lay_out(small("{kind: post, at: [0.4, 0]}"), chance(0).layout)


def test_names_that_are_given_do_not_clash_with_names_that_are_made(small):
    made = lay_out(small("{kind: post, at: [3, 0], id: post-1}", "{kind: post, at: [5, 0]}"), chance(0).layout)
    assert [thing.id for thing in made.things] == ["donor", "post-1", "post-2"]
