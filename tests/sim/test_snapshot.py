"""What is said of a world in recordings: what never changes, and what is so now, as plain JSON values."""

from __future__ import annotations

import json
from typing import Any

from behaviours.interface import Command, Drive, Flippers, Head
from sim import snapshot
from sim.scenarios.format import loads
from sim.world import World

HALL = """
name: hall
bounds: [-5, -5, 15, 7]
robot:
  start: [0, 0]
  heading: 90 deg
  shape: {polygon: [[-0.5, -0.3], [0.5, -0.3], [0.5, 0.3], [-0.5, 0.3]]}
  height: 0.6
  drive: {kind: differential}
  sensors: [{kind: odometry, name: odometry}]
goal: {at: [12, 3], within: 0.5 m}
ground: [{region: [4, -4, 8, 0], rise: 0.1, uphill: 1.5}]
things:
  - {kind: outline, height: 1, rings: ["-4 -4, 14 -4, 14 6, -4 6", "-3.8 -3.8, -3.8 5.8, 13.8 5.8, 13.8 -3.8"]}
  - {kind: box, at: [3, 3], size: [1, 0.5], height: 1, mass: 5, id: crate}
  - {kind: disc, keyframes: [[0, 6, 0], [5, 6, 2]], radius: 0.3, height: 1, id: shuttle}
  - {kind: disc, at: [8, 4], radius: 0.3, height: 1, id: post}
"""


def world() -> World:
    return World(loads(HALL, "hall.yaml"), seed=3)


def test_the_header_says_what_to_go_round() -> None:
    task = "round: {about: [1, 2], turns: 3, within: 2.5}"
    round_it = World(loads(HALL.replace("goal: {at: [12, 3], within: 0.5 m}", task), "hall.yaml"), seed=3)
    assert snapshot.header(round_it)["round"] == {"about": [1.0, 2.0], "turns": 3, "within": 2.5}


def test_the_header_of_a_world_without_a_donor_has_hull_goal_and_slopes() -> None:
    header: Any = snapshot.header(world())
    assert header["donor"] is None
    assert header["goal"] == {"at": [12.0, 3.0], "within": 0.5}
    assert header["round"] is None
    assert header["slopes"] == [{"region": [4.0, -4.0, 8.0, 0.0], "rise": 0.1, "uphill": 1.5}]
    assert header["robot"]["shape"] == {"polygon": [[-0.5, -0.3], [0.5, -0.3], [0.5, 0.3], [-0.5, 0.3]]}
    assert header["robot"]["height"] == 0.6
    assert header["home"] == [0.0, 0.0, 1.5708]
    assert (header["scenario"], header["seed"], header["period"]) == ("hall", 3, 0.1)


def test_what_may_be_elsewhere_later_is_a_mover_and_all_else_stands() -> None:
    header: Any = snapshot.header(world())
    assert [thing["id"] for thing in header["things"]] == ["outline-1", "post"]
    assert [thing["id"] for thing in header["movers"]] == ["crate", "shuttle"]
    walls = header["things"][0]
    assert (walls["kind"], len(walls["shape"]["rings"])) == ("outline", 2)


def test_the_snapshot_follows_what_moves() -> None:
    hall = world()
    for _ in range(10):
        hall.step(Command(Drive(0.5, 0.0)))
    now: Any = snapshot.snapshot(hall, "to the goal", Command(Drive(0.12345, 0.5), Head(0.1, 0.2), Flippers(True)))
    assert now["t"] == 1.0
    assert now["stage"] == "to the goal"
    assert now["robot"][1] > 0.2
    assert now["movers"]["crate"] == [3.0, 3.0, 0.0]
    assert now["movers"]["shuttle"] == [6.0, 0.4, 0.0]
    assert now["command"] == {"drive": [0.123, 0.5], "head": [0.1, 0.2], "flippers": True}
    assert "sonar" not in now
    assert json.loads(json.dumps(now, allow_nan=False)) == now


def test_a_shape_never_changes_on_its_way_into_json() -> None:
    header = snapshot.header(world())
    assert json.loads(json.dumps(header, allow_nan=False)) == header
