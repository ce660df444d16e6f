"""The library `perimeter` and its plan in simulated worlds: straight walls, corners, and what a plan may ask."""

from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from behaviours.interface import Workshop
from behaviours.libraries.perimeter import LIBRARY, walls_settings
from rplan.apps.wiring import PlanBrain, compile_source
from rplan.lang.source import Source
from sim.episode import Episode
from sim.scenarios.format import load, loads

HERE = Path(__file__).parents[2] / "plans" / "perimeter"
PLAN = HERE / "perimeter.rplan"
PRESETS = ["paper", "modern"]
SIDES = ["left", "right"]


@cache
def plan(preset, side):
    """The plan of the perimeter with another preset and side."""
    text = PLAN.read_text(encoding="utf-8")
    used, blocked = "(use perimeter)", "(use svfh :when-blocked right)"
    assert used in text and blocked in text
    text = text.replace(used, f"(use perimeter :preset {preset} :side {side})")
    return compile_source(Source(str(PLAN), text.replace(blocked, blocked.replace("right", opposite(side)))))


def opposite(side):
    return "left" if side == "right" else "right"


class Track:
    """Where the robot was, and what was shown."""

    def __init__(self):
        self.places, self.shown = [], []

    def observe(self, episode):
        pose = episode.world.robot.pose
        self.places.append((pose.x, pose.y))
        self.shown.append(json.loads(episode.note or "null"))


def driven(scenario, preset, side, seconds, seed=0, looked_at=False):
    """Places (n, 2) every tick, and notes where somebody looks."""
    track = Track()
    verdict = Episode(scenario, seed).run(PlanBrain(plan(preset, side), looked_at=looked_at), seconds, track)
    assert not verdict.contacts
    return np.array(track.places), track.shown


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("off", [1.0, 2.0])
def test_after_twelve_metres_a_straight_wall_is_held_to_five_centimetres(preset, side, off):
    text = (HERE / "worlds" / f"straight_{side}.yaml").read_text(encoding="utf-8")
    between = "{between: [-2, -1]}" if side == "left" else "{between: [1, 2]}"
    assert between in text
    scenario = loads(text.replace(between, str(-off if side == "left" else off)), "straight")
    places, _ = driven(scenario, preset, side, 34.0)
    held = places[places[:, 0] > 12.0]
    assert len(held) > 60
    assert np.abs(np.abs(held[:, 1]) - 1.5).max() <= 0.05


def room(half, side, thing):
    """A building of side 2 `half`, or a room of that size; the robot 1.7 m off its wall."""
    y = (half + 1.7 if thing == "building" else -(half - 1.7)) * (-1 if side == "left" else 1)
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    walls = [
        f"- {{kind: wall, from: {list(a)}, to: {list(b)}, thickness: 0.02}}"
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
    ]
    box = f"- {{kind: box, id: building, size: [{2 * half}, {2 * half}], at: [0, 0], height: 4}}"
    return loads(
        f"name: corner\nbounds: [-20, -20, 20, 20]\nrobot: {{model: packbot, start: [0, {y}]}}\nthings:\n"
        + (box if thing == "building" else "\n".join(walls))
        + "\n",
        "corner",
    )


def off_building(places, half):
    """Distance [m] of places (n, 2) to the square."""
    return np.hypot(*np.maximum(np.abs(places) - half, 0.0).T)


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("side", SIDES)
def test_a_convex_corner_is_rounded_without_losing_the_wall(preset, side):
    places, _ = driven(room(6.0, side, "building"), preset, side, 30.0)
    off = off_building(places[100:], 6.0)
    assert off.min() > 1.2
    assert off.max() <= (1.8 if preset == "modern" else 3.0)
    assert off[-1] == pytest.approx(1.5, abs=0.2)
    assert places[-1, 0] > 7.0 and abs(places[-1, 1]) < 6.0  # beside the next wall


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("side", SIDES)
def test_a_concave_corner_is_turned_in_time(preset, side):
    places, _ = driven(room(7.0, side, "room"), preset, side, 24.0)
    off = 6.99 - np.abs(places[60:]).max(axis=1)
    assert off.min() > 1.2
    assert places[-1, 0] > 4.5 and off[-1] == pytest.approx(1.5, abs=0.2)


def test_the_presets_differ_and_a_run_is_repeated_to_the_last_bit():
    scenario = load(HERE / "worlds" / "straight_left.yaml")
    first, again = (driven(scenario, "modern", "left", 6.0, seed=3)[0] for _ in range(2))
    other = driven(scenario, "paper", "left", 6.0, seed=3)[0]
    assert np.array_equal(first, again) and not np.array_equal(first, other)


def test_what_is_shown_is_the_wall_and_the_wanted_heading():
    _, notes = driven(load(HERE / "worlds" / "straight_left.yaml"), "paper", "left", 2.0, looked_at=True)
    shown = [note["shown"] for note in notes if note and note.get("shown")]
    lines = [views["wall-line"] for views in shown if "wall-line" in views]
    headings = [views["wanted-heading"] for views in shown if "wanted-heading" in views]
    assert len(lines) == len(headings) == 10  # five scans a second
    assert lines[0]["kind"] == "lines" and lines[0]["frame"] == "robot" and math.dist(*_ends(lines[0])) > 15
    assert headings[0]["kind"] == "heading" and headings[0]["frame"] == "map"


def _ends(view):
    x, y, u, v = view["at"][0]
    return (x, y), (u, v)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"side": "up"}, "side must be left or right"),
        ({"preset": "old"}, "preset must be paper or modern"),
        ({"stand-off": 0.0}, "stand-off must be"),
        ({"stand-off": math.nan}, "stand-off must be finite"),
        ({"gain": -1.0}, "gain must be finite and not negative"),
        ({"decay": 0.0}, "decay must be"),
        ({"decay": 1.5}, "decay must be a share"),
        ({"peaks": 2.5}, "peaks must be a whole number"),
        ({"refine": "perhaps"}, "refine must be on or off"),
        ({"preset": "modern", "look-ahead": 0.0}, "look-ahead must be"),
    ],
)
def test_parameters_that_make_no_sense_are_refused(values, said):
    with pytest.raises(ValueError, match=said):
        LIBRARY.build(values, Workshop())


def test_parameters_reach_the_settings():
    settings = walls_settings({"preset": "modern", "side": "right", "stand-off": 0.2, "refine": "off", "regain": 2.0})
    assert settings.right and settings.follow.stand_off == 0.2 and not settings.hough.refine
    assert settings.contour is not None and settings.contour.regain == 2.0 and settings.contour.least == 0.2
    assert walls_settings({}).contour is None
