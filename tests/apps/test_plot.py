"""The plot shows what the recording says, is the same each time, and says what is missing."""

from __future__ import annotations

import builtins
import math
import re
import sys
from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from behaviours.interface import Odometry, Pose, Reading, Scan
from rplan.apps.drawing import plot
from sim.recording import Recording

BOX = [[-1, -0.5], [1, -0.5], [1, 0.5], [-1, 0.5]]
WORLD: dict[str, Any] = {
    "bounds": [-5, -5, 10, 5],
    "robot": {"radius": 0.35},
    "things": [{"id": "car-1", "kind": "car", "shape": {"polygon": BOX}, "pose": [2, 3, 0.3], "height": 1.4}],
    "movers": [
        {"id": "donor", "kind": "donor", "shape": {"circle": 0.25}, "pose": [7, 0, 0], "height": 0.9},
        {"id": "can", "kind": "trashcan", "shape": {"circle": 0.3}, "pose": [3, -4, 0], "height": 0.8},
    ],
    "donor": {"id": "donor", "reach": 0.9},
    "home": [0, 0, 0],
}
PLAN = {"name": "find $x$", "outputs": ["goal", "action"]}
HEADER: dict[str, Any] = {"format": 1, "plan": PLAN, "scenario": {"name": "lot"}, "seed": 3, "world": WORLD}


def tick(n: int) -> dict[str, Any]:
    """Out for 30 s, a second of runaway at 20 s, loading, and back."""
    out = n * 0.02 if n < 300 else 6.0 - (n - 300) * 0.02
    world = {
        "robot": [out, 0.3 * math.sin(n / 30), 0.0],
        "odometry": [out * 1.02, 0.3 * math.sin(n / 30), 0.0],
        "movers": {"donor": [7.0, 0.0, 0.0]} | ({"can": [3.0, -4.0 + n / 100, 0.0]} if n < 200 else {}),
        "contacts": [{"thing": "can", "driven_into": True}] if 204 <= n < 206 else [],
        "on_board": n >= 300,
        "stage": "to the donor" if n < 300 else "return",
    }
    action = "(flee-from-danger)" if 200 <= n < 210 else "(go)" if n < 550 else None
    return {
        "tick": n,
        "t": n / 10,
        "world": world,
        "plan": {"outputs": {"action": action, "goal": None}, "hole": n == 50},
    }


@pytest.fixture
def run() -> Recording:
    return Recording(HEADER, [tick(n) for n in range(600)])


def colour_share(path: Path, colour: str) -> float:
    """Share of the picture's pixels that have just this colour."""
    return float((np.abs(imread(path)[..., :3] - to_rgb(colour)).max(axis=2) < 0.01).mean())


def test_the_picture_shows_each_competence_in_its_colour(run: Recording, tmp_path: Path) -> None:
    plot.draw(run, tmp_path / "run.png")
    assert colour_share(tmp_path / "run.png", plot.PALETTE[0]) > 0.01, "the way and the band of (go)"
    assert colour_share(tmp_path / "run.png", plot.DANGER) > 0.0005, "the runaway"
    assert colour_share(tmp_path / "run.png", plot.OPEN) > 0.0005, "where the action is left open"
    assert colour_share(tmp_path / "run.png", plot.THING) > 0.005, "the parked car"


def test_the_picture_speaks_of_what_happened(run: Recording) -> None:
    words = texts(run)
    assert {"find $x$ · lot · seed 3", "on board at 0:30.0, end at 0:59.9"} <= words
    assert {"donor", "start, home", "on board 0:30.0", "runaway 0:20.0", "contact 0:20.4"} <= words
    assert {"to the donor", "return", "go  54.0 s", "flee-from-danger  1.0 s", "left open  5.0 s", "hole  1×"} <= words


def test_a_verdict_takes_the_place_of_the_moments(run: Recording) -> None:
    assert "fetched in 4:10" in texts(run, "fetched in 4:10")


def texts(recording: Recording, verdict: str = "") -> set[str]:
    """All words that are drawn."""
    import matplotlib.text

    figure = plot._figure(recording, plot.track_of(recording), verdict)
    return {text.get_text() for text in figure.findobj(matplotlib.text.Text) if text.get_text()}


def test_the_same_run_gives_the_same_picture(run: Recording, tmp_path: Path) -> None:
    plot.draw(run, tmp_path / "a.png")
    plot.draw(run, tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_hand_written_brain_in_a_bare_world_is_drawn_too(tmp_path: Path) -> None:
    ticks = [{"t": n / 10, "world": {"robot": [n / 50, 0.0, 0.0]}, "plan": None} for n in range(20)]
    plot.draw(Recording({"format": 1}, ticks), tmp_path / "run.png")
    assert colour_share(tmp_path / "run.png", plot.DRIVEN) > 0.005


def test_the_colours_go_by_where_the_plan_names_a_competence() -> None:
    lasted = plot._lasted(plot.bands_of(["(a)", "(b)", "(b)", None, "(run-away)", "(a)", "(a)"]))
    assert list(lasted.items()) == [("(a)", 3), ("(b)", 2), (None, 1), ("(run-away)", 1)]
    first, second, *_ = plot.PALETTE
    expected = {"(b)": first, "(a)": second, None: plot.OPEN, "(run-away)": plot.DANGER}
    assert plot._colours(lasted, "(do action (b)) (do action (a))") == expected


def test_odometry_is_laid_on_the_first_true_pose() -> None:
    track = plot.Track(pose=[(1.0, 2.0, math.pi / 2)], odometry=[(0.0, 0.0, 0.0), (3.0, 0.0, 0.0)])
    np.testing.assert_allclose(plot._believed(track), [(1.0, 2.0), (1.0, 5.0)], atol=1e-12)


def test_nothing_to_draw_is_a_clear_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no ticks"):
        plot.draw(Recording(HEADER, []), tmp_path / "run.png")


def test_without_matplotlib_it_says_how_to_get_it(
    run: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real: Callable[..., Any] = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.startswith("matplotlib"):
            raise ModuleNotFoundError("No module named 'matplotlib'", name="matplotlib")
        return real(name, *rest)

    for name in [name for name in sys.modules if name.startswith("matplotlib")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match=re.escape("pip install 'rplan[plot]'")):
        plot.draw(run, tmp_path / "run.png")
    assert not (tmp_path / "run.png").exists()


def test_a_place_that_cannot_be_written_is_an_os_error(run: Recording, tmp_path: Path) -> None:
    with pytest.raises(OSError):
        plot.draw(run, tmp_path / "nowhere" / "run.png")


# --- robots and worlds of other kinds ----------------------------------------------------------------

SQUARE = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
MAP: dict[str, Any] = {
    "bounds": [-5, -5, 10, 5],
    "robot": {"radius": 0.6, "shape": {"polygon": [[-0.5, -0.3], [0.6, 0.0], [-0.5, 0.3]]}, "height": 0.5},
    "donor": None,
    "goal": {"at": [6, 3], "within": 1},
    "slopes": [{"region": [2, -4, 4, -2], "rise": 0.1, "uphill": 1.57}],
    "things": [
        {
            "id": "map",
            "kind": "outline",
            "shape": {"rings": [[[2 * x, 2 * y] for x, y in SQUARE], [[x, y] for x, y in SQUARE[::-1]]]},
            "pose": [0, 2, 0],
            "height": 1,
        },
        {"id": "kerb", "kind": "curb", "shape": {"polygon": SQUARE}, "pose": [5, -3, 0.3], "height": 0.1},
    ],
    "movers": [],
    "home": [0, 0, 0],
}


def test_a_map_with_holes_a_goal_a_slope_and_a_curb_are_drawn(tmp_path: Path) -> None:
    ticks = [{"t": n / 10, "world": {"robot": [n / 20, 0.0, 0.3], "stage": "to the goal"}} for n in range(100)]
    world = deepcopy(MAP)
    run = Recording({"world": world, "scenario": {"name": "hall"}}, ticks)
    plot.draw(run, tmp_path / "run.png")
    assert colour_share(tmp_path / "run.png", plot.CURB) > 0.01
    assert colour_share(tmp_path / "run.png", plot.SLOPE) > 0.005
    solid = colour_share(tmp_path / "run.png", plot.THING)
    world["things"][0]["shape"]["rings"].pop()
    plot.draw(run, tmp_path / "filled.png")
    assert colour_share(tmp_path / "filled.png", plot.THING) > solid + 0.01, "a hole is open"
    assert {"goal", "6° up →", "start, home", "to the goal"} <= texts(run)


def test_the_hull_is_drawn_as_it_turns() -> None:
    from matplotlib.patches import Polygon

    ticks = [{"t": n / 10, "world": {"robot": [n / 20, 0.0, n / 100]}} for n in range(120)]
    run = Recording({"world": {**MAP, "things": []}}, ticks)
    figure = plot._figure(run, plot.track_of(run), "")
    hulls = [patch.get_xy()[1] for patch in figure.findobj(Polygon) if len(patch.get_xy()) == 4]
    assert len(hulls) == 3
    np.testing.assert_allclose(hulls[1], [2.5 + 0.6 * math.cos(0.5), 0.6 * math.sin(0.5)], atol=1e-9)


def test_what_the_lidar_saw_is_drawn_where_it_was(tmp_path: Path) -> None:
    scan = Scan(0.5, True, Pose(0.2, 0.0, 0.1), np.array([-0.1, 1.0, 2.0]), np.array([2.0, 10.0, math.nan]), 0.1, 10.0)
    np.testing.assert_allclose(plot.seen(scan, (1.0, 1.0, math.pi / 2)), [[1.0, 3.2]], atol=1e-12)
    ticks = [{"t": n / 10, "world": {"robot": [n / 20, 0.0, 0.0]}} for n in range(30)]
    many = replace(scan, bearings=np.linspace(-3, 3, 2000), ranges=np.full(2000, 2.5), stamp=1.6)
    readings = [Reading(s.stamp, 5, Odometry(Pose(0.0, 0.0), 0.0, 0.0), lidar=s) for s in (scan, many)]
    plot.draw(Recording({"world": MAP}, ticks, readings=readings), tmp_path / "seen.png")
    plot.draw(Recording({"world": MAP}, ticks), tmp_path / "bare.png")
    assert (imread(tmp_path / "seen.png") != imread(tmp_path / "bare.png")).any(axis=2).sum() > 50
