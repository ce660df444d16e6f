"""The replay page stands alone, carries the whole run, and no text of the run can break out of it."""

from __future__ import annotations

import base64
import json
import math
import re
import zlib
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from behaviours.interface import Odometry, Pose, Ranges, Reading, Scan
from sim.recording import Recorder, Recording, read
from sim.replay import pack, write_replay

HOSTILE = '(plan p) ; </script><img src="x" onerror="alert(1)"><!-- {{data}} {{title}}'
HEADER: dict[str, Any] = {
    "format": 1,
    "plan": {"name": "find", "text": HOSTILE, "inputs": ["(near)"], "outputs": ["goal", "action"], "rules": []},
    "scenario": {"name": "lot </title><script>alert(2)</script> {{data}}", "text": ""},
    "seed": 5,
    "period": 0.1,
    "world": {"bounds": [-5, -5, 5, 5], "robot": {"radius": 0.35}, "things": [], "movers": [], "donor": None},
}


def tick(n: int) -> dict[str, Any]:
    world: dict[str, Any] = {
        "robot": [n * 0.0123, math.sin(n / 9), wrapped(n / 5)],
        "odometry": [n * 0.0125, 0.0, 0.0],
        "movers": {"car": [5 - n / 50, 1.0, 3.1]},
        "contacts": [{"thing": "wall", "driven_into": True}] if n == 40 else [],
        "head": [0.1, 0.2],
        "command": {"drive": [0.1, -0.2], "head": None} if n % 2 else {"drive": None, "head": None},
        "on_board": n >= 60,
        "stage": "out" if n < 60 else "home",
    }
    if n % 3 == 0:
        world["sonar"] = [1.0 + k / 10 + n / 100 for k in range(30)]
    if n % 10 == 0:
        world["ir"] = {"detected": n > 20, "offset": 0.5 if n > 20 else None, "strength": 3.0, "pan": 0.25}
    action = "(flee)" if 30 <= n < 33 else "(go)"
    plan = {"inputs": "01"[n % 2], "hole": n == 50, "outputs": {"action": action, "goal": None}, "way": {"rules": []}}
    plan["reports"] = {"(go)": {"status": "running", "details": {"circles": [[1.23456 + n, 2.0, 0.5, 0]]}}}
    return {"tick": n, "t": n / 10, "world": world, "plan": plan}


def wrapped(angle: float) -> float:
    return math.remainder(angle, math.tau)


@pytest.fixture
def run() -> Recording:
    return Recording(HEADER, [tick(n) for n in range(100)])


def page_of(recording: Recording, tmp_path: Path, verdict: str = "") -> str:
    write_replay(recording, tmp_path / "run.html", verdict)
    return (tmp_path / "run.html").read_text(encoding="utf-8")


def embedded(page: str) -> dict[str, Any]:
    (text,) = re.findall(r'<script type="application/octet-stream" id="data">([A-Za-z0-9+/=]+)</script>', page)
    unpacked: dict[str, Any] = json.loads(zlib.decompress(base64.b64decode(text)))
    return unpacked


def track(packed: dict[str, Any], name: str) -> tuple[list[int], list[list[float | None]]]:
    """Ticks and rows of a track, by the rule that the page follows."""
    part, columns = packed["tracks"][name], []
    for steps in part["columns"]:
        values, last = list[float | None](), 0
        for step in steps:
            last += step or 0
            values.append(None if step is None else last / part["scale"])
        columns.append(values)
    return list(np.cumsum(part["at"])), [list(row) for row in zip(*columns, strict=True)]


def run_of(packed: dict[str, Any], name: str) -> list[Any]:
    """The value in every tick, by the rule that the page follows."""
    part, values = packed["runs"][name], []
    starts = [*np.cumsum(part["at"]), packed["ticks"]]
    for k, index in enumerate(part["of"]):
        values += [part["values"][index]] * (starts[k + 1] - starts[k])
    return values


class Tags(HTMLParser):
    """What a browser would see: tags with attributes, and the title."""

    def __init__(self) -> None:
        super().__init__()
        self.seen: list[tuple[str, dict[str, str | None]]] = []
        self.title, self._in_title = "", False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append((tag, dict(attrs)))
        self._in_title = tag == "title"

    def handle_data(self, data: str) -> None:
        if self._in_title:
            self.title += data

    def handle_endtag(self, tag: str) -> None:
        self._in_title = False


def test_the_page_fetches_nothing(run: Recording, tmp_path: Path) -> None:
    page = page_of(run, tmp_path)
    tags = Tags()
    tags.feed(page)
    assert not [tag for tag, attributes in tags.seen if {"src", "href"} & attributes.keys()]
    assert not [tag for tag, _ in tags.seen if tag in ("link", "img", "iframe", "object", "embed", "base")]
    assert not re.search(
        r"https?://(?!www.w3.org/2000/svg\")|@import|\bfetch\(|XMLHttpRequest|WebSocket|import\(|url\(", page
    )


def test_texts_of_the_run_stay_texts(run: Recording, tmp_path: Path) -> None:
    page = page_of(run, tmp_path, verdict="</script>")
    tags = Tags()
    tags.feed(page)
    assert tags.title == "find · lot </title><script>alert(2)</script> {{data}}"
    assert [tag for tag, _ in tags.seen].count("script") == 3, "the data, circuits and the page's own"
    assert "alert(" not in page.replace(_escaped_title(page), "")
    assert embedded(page)["verdict"] == "</script>"


def _escaped_title(page: str) -> str:
    return page[page.index("<title>") : page.index("</title>")]


def test_header_and_plan_text_arrive_unchanged(run: Recording, tmp_path: Path) -> None:
    assert embedded(page_of(run, tmp_path))["header"] == HEADER


def test_moving_numbers_arrive_to_the_millimetre(run: Recording, tmp_path: Path) -> None:
    packed = embedded(page_of(run, tmp_path))
    assert packed["ticks"] == 100
    assert list(np.cumsum(packed["t"])) == [n * 100 for n in range(100)]
    for name, expected in (
        ("robot", [tick(n)["world"]["robot"] for n in range(100)]),
        ("mover car", [tick(n)["world"]["movers"]["car"] for n in range(100)]),
    ):
        at, rows = track(packed, name)
        assert at == list(range(100))
        np.testing.assert_allclose(rows, expected, atol=0.00051)


def test_what_is_not_fresh_is_not_there(run: Recording, tmp_path: Path) -> None:
    packed = embedded(page_of(run, tmp_path))
    at, rows = track(packed, "sonar")
    assert at == list(range(0, 100, 3))
    np.testing.assert_allclose(rows, [tick(n)["world"]["sonar"] for n in at], atol=0.0051)
    assert track(packed, "drive")[0] == list(range(1, 100, 2))
    assert "look" in packed["tracks"]
    assert packed["tracks"]["look"]["columns"] == []


def test_a_number_that_is_missing_stays_missing(run: Recording, tmp_path: Path) -> None:
    at, rows = track(embedded(page_of(run, tmp_path)), "ir")
    assert at == list(range(0, 100, 10))
    assert rows[0] == [0.0, None, 3.0, 0.25]
    assert rows[-1] == [1.0, 0.5, 3.0, 0.25]


def test_all_else_arrives_for_every_tick(run: Recording, tmp_path: Path) -> None:
    packed = embedded(page_of(run, tmp_path))
    for name in ("contacts", "on_board", "stage"):
        assert run_of(packed, name) == [tick(n)["world"][name] for n in range(100)], name
    for name in ("inputs", "hole", "outputs", "way"):
        assert run_of(packed, name) == [tick(n)["plan"][name] for n in range(100)], name
    assert run_of(packed, "reports")[7]["(go)"]["details"]["circles"] == [[8.23, 2.0, 0.5, 0]]


def test_numbers_that_a_plan_compares_arrive_in_hundredths() -> None:
    plan: dict[str, Any] = {"inputs": "1", "outputs": {}}
    levels = [{"(battery-level)": level} for level in (0.951, 0.949, 0.938)]
    ticks = [{"t": k / 10, "world": {}, "plan": plan | {"percepts": level}} for k, level in enumerate(levels)]
    packed = dict(pack(Recording(HEADER, ticks)))
    assert run_of(packed, "percepts") == [{"(battery-level)": level} for level in (0.95, 0.95, 0.94)]


def test_equal_values_are_kept_once(run: Recording) -> None:
    packed = pack(run)
    outputs: Any = packed["runs"]
    assert len(outputs["outputs"]["values"]) == 2
    assert outputs["outputs"]["of"] == [0, 1, 0]
    assert outputs["outputs"]["at"] == [0, 30, 3]


def test_the_same_run_gives_the_same_page(run: Recording, tmp_path: Path) -> None:
    first = page_of(run, tmp_path)
    assert first == page_of(run, tmp_path)


def test_a_hand_written_brain_and_a_bare_header_are_shown_too(tmp_path: Path) -> None:
    with Recorder(tmp_path / "run.mcap", {"plan": None}) as recorder:
        recorder.tick(0.0, {"robot": [0.0, 0.0, 0.0]}, "null")
        recorder.tick(0.1, {}, "null")
    packed = embedded(page_of(read(tmp_path / "run.mcap"), tmp_path))
    assert track(packed, "robot") == ([0], [[0.0, 0.0, 0.0]])
    assert "way" not in packed["runs"]
    assert "<title>a run</title>" in (tmp_path / "run.html").read_text(encoding="utf-8")


def test_what_a_plan_said_last_stands_when_it_says_nothing(run: Recording) -> None:
    after = Recording(HEADER, [*run.ticks, {"t": 10.0, "world": {}, "plan": None}])
    packed: Any = pack(after)
    assert packed["ticks"] == 101
    assert run_of(packed, "outputs")[-2:] == [{"action": "(go)", "goal": None}] * 2


def test_twelve_minutes_of_noise_stay_small(tmp_path: Path) -> None:
    noise = np.random.default_rng(1)
    base = [tick(n % 100) for n in range(100)]
    ticks = []
    for n in range(1440):  # a fifth of twelve minutes, with sonar in every third tick and ten circles that tremble
        circles = np.round(noise.uniform(0, 9, (10, 4)), 4).tolist()
        report = {"(go)": {"details": {"circles": circles}}}
        world = base[n % 100]["world"] | {"robot": noise.uniform(0, 9, 3).tolist()}
        if n % 3 == 0:
            world = world | {"sonar": noise.uniform(0, 6, 30).tolist()}
        ticks.append({"t": n / 10, "world": world, "plan": base[n % 100]["plan"] | {"reports": report}})
    assert len(page_of(Recording(HEADER, ticks), tmp_path)) < 2_000_000 / 5


@pytest.mark.parametrize("words", ["play or pause", "Why", "Conditions", "timeline", "prefers-color-scheme", "Outputs"])
def test_the_page_has_its_parts(run: Recording, tmp_path: Path, words: str) -> None:
    assert words in page_of(run, tmp_path)


def test_a_page_that_cannot_be_written_is_an_os_error(run: Recording, tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError):
        write_replay(run, tmp_path)


# --- robots and worlds of other kinds ----------------------------------------------------------------


def scanned(ticks: int, beams: int = 400) -> Recording:
    """A robot whose lidar measures in every tick, and whose third tick lacks its reading."""
    bearings = np.linspace(-2.0, 2.0, beams)
    readings = []
    for n in range(ticks):
        ranges = np.full(beams, 1.0 + n / 100)
        ranges[0] = math.nan
        scan = Scan(n / 10, True, Pose(0.2, 0.0, 0.1), bearings, ranges, 0.1, 10.0)
        ring = Ranges(n / 10, True, np.array([0.0, 1.0]), np.array([1.0, 2.0]), 7.0, 0.45)
        if n != 2:
            readings.append(Reading(n / 10, n, Odometry(Pose(0.0, 0.0), 0.0, 0.0), sonar=ring, lidar=scan))
    return Recording(HEADER, [tick(n) for n in range(ticks)], readings=readings)


def test_scans_arrive_five_times_a_second_with_their_rays() -> None:
    packed: Any = pack(scanned(20))
    at, rows = track(packed, "scan")
    assert at == [0, 3, 5, 7, 9, 11, 13, 15, 17, 19], "the one of tick 2 is missing, so the next one comes"
    lie = packed["rays"]["scan"]
    assert lie["mount"] == [0.2, 0.0, 0.1]
    assert len(lie["bearings"]) == len(rows[0]) == 134, "every third of 400 beams"
    assert lie["bearings"][0] == -2.0
    assert rows[1][0] is None, "a beam that failed stays missing"
    assert rows[1][1:] == [pytest.approx(1.03)] * 133


def test_rays_of_sonars_lie_where_the_robot_carries_them() -> None:
    packed: Any = pack(scanned(3))
    assert packed["rays"]["sonar"] == {"bearings": [0.0, 1.0], "waist": 2, "mount": 0.45}
    assert pack(Recording(HEADER, [tick(0)]))["rays"] == {}, "an early recording does not say it"


def test_a_world_without_a_donor_arrives_with_its_shapes(tmp_path: Path) -> None:
    ring = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    world = {
        "bounds": [0, 0, 1, 1],
        "robot": {"radius": 0.5, "shape": {"polygon": ring}, "height": 0.4},
        "donor": None,
        "goal": {"at": [1, 1], "within": 0.5},
        "slopes": [{"region": [0, 0, 1, 1], "rise": 0.1, "uphill": 1.5}],
        "things": [{"id": "map", "kind": "outline", "shape": {"rings": [ring]}, "pose": [0, 0, 0], "height": 1}],
        "movers": [],
    }
    packed = embedded(page_of(Recording({**HEADER, "world": world}, [tick(0)]), tmp_path))
    assert packed["header"]["world"] == world
