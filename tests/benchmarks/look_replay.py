"""Looks at the replay page in a browser: `python tests/benchmarks/look_replay.py OUT_DIR [RUN.mcap]`.

Takes: a folder for pictures and, if given, a recording; else it makes one of twelve minutes that has everything in it.
Gives: the page, pictures of it (laptop, phone, dark), its size and costs; exit code 1 where the page reports a fault.
Leaves alone: the tests, which need no browser. Chromium must be installed: its absence is an error here, not a skip.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from rplan.apps.viewer.page import write_page
from sim.recording import Recorder, read

PLAN = """\
; Find and fetch, after Bonasso, Antonisse and Slack 1992, Figure 1.
(plan find-and-fetch "Find the donor, fetch the widget, go home." :period 0.1s)
(use outdoor :danger-radius 0.2m)
(defoutput goal pose :hold)
(defoutput action command :idle (stand-still))
(defoutput rpt-ir-failure? bool :idle false)
(defoutput rpt-prism-failure? bool :idle false)

(defgoalr (maint runaway)
  (if (anything-is-too-close)
      (do action (move-away-from-danger))
      (do anything)))

(defgoalr (ach move-to-goal)
  (if (or (anything-is-too-close)
          (not (there-is-a-goal))
          (we-are-at-the-goal))
      (do anything)
      (do action (move-according-to-NaT-plan))))

(defgoalr (ach retrieve-widget-from-donor)
  (if (anything-is-too-close)
      (do goal (remember-the-current-goal-if-any))
      (if (donor-has-been-located)
          (ach fetch-widget&go-home)
          (ach find-donor))))

(defgoalr (ach fetch-widget&go-home)
  (if (we-already-have-the-widget)
      (do goal the-robots-home-position)
      (do goal (set-goal-as-the-donors-location))))

(defgoalr (ach find-donor)
  (if (we-know-the-donor-direction)
      (ach find-donor-location)
      (maint find-donor-direction)))

(defgoalr (maint find-donor-direction)
  (if (ir-search-has-been-started)
      (do action (continue-ir-search))
      (if (and (the-ir-search-is-finished)
               (the-returned-angle-is-no-good))
          (do rpt-ir-failure? true)
          (do action (start-ir-search)))))

(defgoalr (ach find-donor-location)
  (if (stereo-ranging-is-started)
      (if (a-range-value-has-been-returned)
          (if (the-range-value-is-no-good)
              (do rpt-prism-failure? true)
              (do anything))
          (do action (continue-stereo-search)))
      (do action (start-stereo-ranging))))

; hostile text for the page: </script><img src=x onerror=alert(1)> <!--
(goalem (and (prio-and (maint runaway)
                       (ach retrieve-widget-from-donor))
             (ach move-to-goal)))
"""
ASKED = """anything-is-too-close there-is-a-goal we-are-at-the-goal donor-has-been-located we-already-have-the-widget
we-know-the-donor-direction ir-search-has-been-started the-ir-search-is-finished the-returned-angle-is-no-good
stereo-ranging-is-started a-range-value-has-been-returned the-range-value-is-no-good"""
INPUTS = ASKED.split()
HOME, DONOR = (-8.0, -4.0, 0.4), (7.0, 3.6, 3.4)
CIRCLES = {
    "trashcan 1": (-2.0, 0.2, 0.3),
    "trashcan 2": (1.5, 2.4, 0.3),
    "tree": (3.6, -0.6, 0.45),
    "post": (-5.2, -2.2, 0.12),
}
CARS = {"car A": (-3.5, 4.5, 1.57), "car B": (-0.8, 4.6, 1.57), "car C": (2.0, -4.6, 1.6), "car D": (4.8, -4.7, 1.5)}


TRY = """<script>
"use strict";
(async () => {
  const root = document.documentElement, said = [], clock = () => document.getElementById("clock").textContent.trim();
  const press = (key, more) => dispatchEvent(new KeyboardEvent("keydown", {key, ...more}));
  const wait = ms => new Promise(done => setTimeout(done, ms));
  addEventListener("error", e => { root.dataset.fault = e.message; });
  while (!root.dataset.ready) await wait(10);
  for (const key of ["Home", "ArrowRight", "Shift", "n", "p", "End", "Home"]) {
    key === "Shift" ? press("ArrowRight", {shiftKey: true}) : press(key);
    said.push(clock());
  }
  const line = document.getElementById("timeline"), box = line.getBoundingClientRect();
  line.setPointerCapture = () => {};
  const middle = {pointerId: 1, clientX: box.left + box.width / 2, clientY: box.top + 30};
  line.dispatchEvent(new PointerEvent("pointerdown", middle));
  said.push(clock());
  for (let k = 0; k < STEPS; k++) press("ArrowRight");
  press("Home"); press("+"); press("+"); press("+"); press(" "); await wait(1000); press(" "); said.push(clock());
  root.dataset.tried = said.join(" | ");
})();
</script></body>"""
"""Steps, jumps, scrubs and plays, and leaves what the clock said on the page's root element."""
BLANK = "<!doctype html><title>blank</title>"


def _line(text: str) -> int:
    return next(k for k, line in enumerate(PLAN.splitlines(), 1) if text in line)


def _rules() -> list[dict[str, object]]:
    starts = [k for k, line in enumerate(PLAN.splitlines(), 1) if line.startswith("(defgoalr")]
    lines = PLAN.splitlines()
    ends = [next(k for k in range(start, len(lines)) if not lines[k].strip()) for start in starts]
    names = [lines[start - 1].removeprefix("(defgoalr ") for start in starts]
    return [{"rule": n, "line": s, "end_line": e} for n, s, e in zip(names, starts, ends, strict=True)]


def header() -> dict[str, object]:
    def thing(name: str, kind: str, shape: object, pose: object, height: float) -> dict[str, object]:
        return {"id": name, "kind": kind, "shape": shape, "pose": pose, "height": height, "static": True}

    box = [[-2.2, -0.9], [2.2, -0.9], [2.2, 0.9], [-2.2, 0.9]]
    things = [thing(n, n.split()[0], {"circle": r}, [x, y, 0], 1.0) for n, (x, y, r) in CIRCLES.items()]
    things += [thing(n, "car", {"polygon": box}, list(pose), 1.5) for n, pose in CARS.items()]
    wall = [[-12, -0.15], [12, -0.15], [12, 0.15], [-12, 0.15]]
    things += [thing("wall", "wall", {"polygon": wall}, [0, 7.6, 0], 2.5)]
    things += [thing("hero", "robot", {"circle": 0.35}, list(DONOR), 0.9)]
    movers = [
        {"id": "passing car", "kind": "car", "shape": {"polygon": box}, "pose": [-11, 1.2, 0], "static": False},
        {"id": "person", "kind": "person", "shape": {"circle": 0.25}, "pose": [0, -2, 0], "static": False},
    ]
    rule_names = {"name": "find-and-fetch", "text": PLAN, "sha256": "0" * 64, "file": "plans/find_and_fetch.rplan"}
    plan = {
        **rule_names,
        "inputs": [f"({n})" for n in INPUTS],
        "outputs": ["goal", "action", "rpt-ir-failure?", "rpt-prism-failure?"],
        "rules": _rules(),
    }
    world = {"bounds": [-12, -8, 12, 8], "robot": {"radius": 0.35}, "things": things, "movers": movers}
    world |= {"donor": "hero", "home": list(HOME)}
    return {
        "format": 1,
        "plan": plan,
        "scenario": {"name": "parking lot </title>", "text": "…"},
        "seed": 7,
        "versions": {"rplan": "0.1.0"},
        "period": 0.1,
        "world": world,
    }


def _sonar(x: float, y: float, theta: float, obstacles: np.ndarray) -> list[float]:
    bearings = np.concatenate([np.arange(24) * math.tau / 24, np.arange(6) * math.tau / 6]) + theta
    away = obstacles[:, :2] - (x, y)
    along = np.cos(bearings)[:, None] * away[:, 0] + np.sin(bearings)[:, None] * away[:, 1]
    across = np.abs(-np.sin(bearings)[:, None] * away[:, 0] + np.cos(bearings)[:, None] * away[:, 1])
    hit = (across < obstacles[:, 2] + 0.1 * along) & (along > 0)
    ranges = np.where(hit, along - obstacles[:, 2] - 0.35, 6.0).min(axis=1)
    return [float(v) for v in np.clip(ranges, 0.15, 6.0)]


def _obstacles() -> np.ndarray:
    rows = [list(c) for c in CIRCLES.values()] + [[DONOR[0], DONOR[1], 0.35]]
    for x, y, theta in CARS.values():
        rows += [[x + d * math.cos(theta), y + d * math.sin(theta), 0.9] for d in (-1.3, 0, 1.3)]
    return np.array(rows)


class Script:
    """A drive that has everything in it: searches, legs, a runaway, a contact, a hole, the hand-over."""

    def __init__(self, seed: int = 7) -> None:
        self.rng = np.random.default_rng(seed)
        self.pose = np.array(HOME)
        self.odometry = np.zeros(3)
        self.bits = dict.fromkeys(INPUTS, False)
        self.legs = [
            (-4.5, -3.0),
            (-1.0, -1.2),
            (2.5, 1.0),
            (5.9, 3.2),
            (2.6, 1.2),
            (-0.5, -1.4),
            (-5.0, -3.4),
            HOME[:2],
        ]
        self.leg = 0
        self.on_board = False
        self.obstacles = _obstacles()

    def stage(self, t: float) -> str:
        if t < 150:
            return "searching" if t < 90 else "ranging"
        return "to the donor" if self.leg < 4 else ("loading" if not self.on_board else "home")

    def drive(self, t: float) -> tuple[float, float]:
        b = self.bits
        if b["anything-is-too-close"]:
            return -0.15, 0.1
        if t < 150 or b["we-are-at-the-goal"] or self.leg >= len(self.legs):
            return 0.0, 0.0
        dx, dy = self.legs[self.leg] - self.pose[:2]
        if math.hypot(dx, dy) < 0.25:
            self.leg += 1
            return 0.1, 0.0
        turn = math.remainder(math.atan2(dy, dx) - self.pose[2], math.tau)
        return 0.12 * max(0.1, math.cos(turn)), float(np.clip(1.2 * turn, -0.6, 0.6))

    def step(self, tick: int) -> tuple[dict[str, object], dict[str, object]]:
        t = tick / 10
        b = self.bits
        b["anything-is-too-close"] = 214 < t < 219 or 470 < t < 472.5
        b["ir-search-has-been-started"] = 0.3 < t < 90
        b["the-ir-search-is-finished"] = t >= 90
        b["we-know-the-donor-direction"] = t >= 90
        b["stereo-ranging-is-started"] = t > 91
        b["a-range-value-has-been-returned"] = b["donor-has-been-located"] = t >= 150
        b["we-are-at-the-goal"] = (self.leg == 4 and not self.on_board) or self.leg >= len(self.legs)
        b["there-is-a-goal"] = t >= 150.1
        if b["we-are-at-the-goal"] and not self.on_board and getattr(self, "arrived", None) is None:
            self.arrived = t
        if getattr(self, "arrived", None) is not None and t > self.arrived + 25:
            self.on_board = True
        b["we-already-have-the-widget"] = self.on_board
        v, w = self.drive(t)
        self._move(v, w)
        return self._world(tick, t, v, w), self._note(t)

    def _move(self, v: float, w: float) -> None:
        dt = 0.1
        self.pose += (v * math.cos(self.pose[2]) * dt, v * math.sin(self.pose[2]) * dt, w * dt)
        v, w = v * (1.02 + 0.02 * self.rng.standard_normal()), w + 0.0008 * np.sign(v)
        theta = self.odometry[2]
        self.odometry += (v * math.cos(theta) * dt, v * math.sin(theta) * dt, w * dt)

    def _world(self, tick: int, t: float, v: float, w: float) -> dict[str, object]:
        x, y, theta = map(float, self.pose)
        pan, tilt = (1.4 * math.sin(t / 6), 0.1) if t < 90 else (0.75 + 0.03 * math.sin(t), 0.2 + 0.2 * math.sin(t / 9))
        world: dict[str, object] = {"t": t, "robot": [x, y, theta], "odometry": list(map(float, self.odometry))}
        car = [-14 + ((t * 0.8) % 60) * 0.6, 1.1, 0.02]
        world["movers"] = {"passing car": car, "person": [3 * math.sin(t / 20), -2 + math.cos(t / 13), t / 20]}
        world["contacts"] = [{"thing": "trashcan 1", "driven_into": True}] if 471 < t < 471.5 else []
        world["head"] = [pan, tilt]
        if tick % 3 == 0:
            ranges = _sonar(x, y, theta, self.obstacles)
            noise = 0.01 * self.rng.standard_normal(30)
            world["sonar"] = [r if r >= 6 else r + float(n) for r, n in zip(ranges, noise, strict=True)]
        if t < 90 and tick % 5 == 0:
            seen = abs(pan - 0.75) < 0.2
            world["ir"] = {"detected": seen, "offset": 0.75 - pan if seen else math.nan, "strength": 4.2, "pan": pan}
        if 91 < t < 150 and tick % 8 == 0:
            world["stereo"] = {"pan": pan, "tilt": tilt, "range": 3.0 + (t - 91) / 8}
        world |= {"command": {"drive": [v, w], "head": [pan, tilt] if t < 150 else None}}
        return world | {"on_board": self.on_board, "stage": self.stage(t)}

    def _action(self) -> tuple[str | None, str, str]:
        b = self.bits
        if b["anything-is-too-close"]:
            return "(move-away-from-danger)", "(maint runaway)", "(do action (move-away"
        if not b["we-know-the-donor-direction"]:
            word = "(continue-ir-search)" if b["ir-search-has-been-started"] else "(start-ir-search)"
            return word, "(maint find-donor-direction)", f"(do action {word}"
        if not b["donor-has-been-located"]:
            word = "(continue-stereo-search)" if b["stereo-ranging-is-started"] else "(start-stereo-ranging)"
            return word, "(ach find-donor-location)", f"(do action {word}"
        if b["there-is-a-goal"] and not b["we-are-at-the-goal"]:
            return "(move-according-to-NaT-plan)", "(ach move-to-goal)", "(do action (move-according"
        return None, "", ""

    def _note(self, t: float) -> dict[str, object]:
        b = self.bits
        action, rule, text = self._action()
        hole = 300 < t < 300.4
        branches = [_branch("(anything-is-too-close)", b["anything-is-too-close"], "(maint runaway)", "(if (anything")]
        rules = ["(maint runaway)", "(ach move-to-goal)"]
        acts, given_up = [], []
        if rule:
            acts.append({"output": "action", "value": action, "rule": rule, "line": _line(text)})
        if b["anything-is-too-close"]:
            why = "two values for `action`"
            given_up.append(
                {"member": "(ach retrieve-widget-from-donor)", "line": _line("(goalem") + 1, "because": why}
            )
        else:
            rules += ["(ach retrieve-widget-from-donor)"]
            located = b["donor-has-been-located"]
            branches.append(_branch("(donor-has-been-located)", located, rules[-1], "(if (donor-has"))
            rules += [rule] if rule and rule not in rules else []
        goal = None
        if b["donor-has-been-located"] and not b["anything-is-too-close"]:
            goal = "(the-robots-home-position)" if self.on_board else "(set-goal-as-the-donors-location)"
            rules.append("(ach fetch-widget&go-home)")
            acts.append(
                {
                    "output": "goal",
                    "value": goal,
                    "rule": rules[-1],
                    "line": _line("(do goal the-robots" if self.on_board else "(do goal (set"),
                }
            )
            branches.append(_branch("(we-already-have-the-widget)", self.on_board, rules[-1], "(if (we-already"))
        way = {"rules": rules, "branches": branches, "acts": acts, "given_up": given_up}
        outputs = {
            "goal": goal,
            "action": None if hole else action,
            "rpt-ir-failure?": None,
            "rpt-prism-failure?": None,
        }
        note = {"inputs": "".join("01"[b[n]] for n in INPUTS), "registers": "", "hole": hole, "outputs": outputs}
        note |= {"sent": {**outputs, "action": outputs["action"] or "(stand-still)"}, "way": None if hole else way}
        note |= {"started": [], "stopped": [], "faults": [], "reports": {}}
        if action == "(move-according-to-NaT-plan)":
            note["reports"] = {action: {"status": "running", "details": self._nat(t)}}
        return note

    def _nat(self, t: float) -> dict[str, object]:
        seen = [o for o in self.obstacles if math.hypot(*(o[:2] - self.pose[:2])) < 4][:10]
        turn = float(self.odometry[2] - self.pose[2])
        circles = []
        for k, (x, y, r) in enumerate(seen):
            dx, dy = x - self.pose[0], y - self.pose[1]
            wobble = 0.02 * self.rng.standard_normal(2)
            ox = self.odometry[0] + math.cos(turn) * dx - math.sin(turn) * dy + wobble[0]
            oy = self.odometry[1] + math.sin(turn) * dx + math.cos(turn) * dy + wobble[1]
            circles.append([float(ox), float(oy), float(r) + 0.1, k % 3])
        goal = DONOR if not self.on_board else HOME
        dx, dy = goal[0] - HOME[0], goal[1] - HOME[1]
        c, s = math.cos(-HOME[2]), math.sin(-HOME[2])
        groups = [{"spin": "cw"}, {"spin": "ccw"}, {"spin": "cw"}]
        return {"circles": circles, "groups": groups, "goal": [c * dx - s * dy, s * dx + c * dy], "speed": 0.12}


def _branch(condition: str, value: bool, rule: str, text: str) -> dict[str, object]:
    return {"condition": condition, "value": bool(value), "rule": rule, "line": _line(text)}


def record(path: Path, ticks: int = 7200) -> None:
    """The scripted run, as a recording."""
    script = Script()
    spent = 0.0
    with Recorder(path, header()) as recorder:
        for tick in range(ticks):
            world, note = script.step(tick)
            text = json.dumps(note)
            begin = time.perf_counter()
            recorder.tick(tick / 10, world, text)
            spent += time.perf_counter() - begin
    print(f"recording: {path.stat().st_size / 1e6:.2f} MB, {spent / ticks * 1e6:.0f} us a tick")


def browse(url: str, *options: str) -> str:
    """Run Chromium once, in virtual time; what it writes to stdout."""
    with tempfile.TemporaryDirectory() as profile:
        quiet = (
            "--no-first-run --disable-background-networking --disable-component-update --disable-sync --disable-quic"
        )
        command = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", *quiet.split(), "--hide-scrollbars"]
        command += [f"--user-data-dir={profile}", "--virtual-time-budget=5000", *options, url]
        return subprocess.run(command, check=True, capture_output=True, text=True, timeout=120).stdout


def main() -> int:
    """Make the page and the pictures."""
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    run = Path(sys.argv[2]) if len(sys.argv) > 2 else out / "run.mcap"
    if len(sys.argv) <= 2:
        record(run)
    begin = time.perf_counter()
    page = out / "run.html"
    why_not = write_page(read(run), page)
    print(f"the page has no circuit: {why_not}" if why_not else "the page has its circuit")
    print(f"page: {page.stat().st_size / 1e6:.2f} MB, written in {time.perf_counter() - begin:.2f} s")
    url = page.resolve().as_uri()
    shots = {
        "laptop": ("1280,800", "#t=205"),
        "dark": ("1280,800", "?theme=dark#t=215.5"),
        "search": ("1280,800", "#t=40"),
        "follow": ("1280,800", "?theme=dark#t=250&follow=1"),
        "end": ("1280,800", "#t=719"),
        "circuit": ("1280,800", "#t=205&tab=circuit"),
        "circuit-dark": ("1280,800", "?theme=dark#t=215.5&tab=circuit"),
    }
    for name, (size, where) in shots.items():
        browse(url + where, f"--window-size={size}", f"--screenshot={out / name}.png")
    for name, where, height in (("phone", "#t=205", 844), ("phone-all", "?theme=dark#t=215.5", 2300)):
        inside = f'<iframe src="{url}{where}" width="390" height="{height}" style="border:0"></iframe>'
        frame = out / f"{name}.html"  # a window is never so narrow: a frame in it is
        frame.write_text(f'<body style="margin:0">{inside}', encoding="utf-8")
        browse(frame.resolve().as_uri(), f"--window-size=500,{height}", f"--screenshot={out / name}.png")
    return try_out(page)


def try_out(page: Path) -> int:
    """Work the page's keys and its timeline; 1 where it reports a fault. Costs are differences of wall time."""
    walls, dom = [], ""
    pages = [BLANK, page.read_text(encoding="utf-8")]
    pages += [pages[1].replace("</body>", TRY.replace("STEPS", steps)) for steps in ("0", "1000")]
    for number, text in enumerate(pages):
        tried = page.with_name(f"tried-{number}.html")
        tried.write_text(text, encoding="utf-8")
        begin = time.perf_counter()
        dom = browse(tried.resolve().as_uri(), "--window-size=1280,800", "--dump-dom")
        walls.append(time.perf_counter() - begin)
    print(f"opens in {walls[1] - walls[0]:.2f} s, shows a tick in {walls[3] - walls[2]:.2f} ms")
    fault, clock = _attribute(dom, "fault"), _attribute(dom, "tried")
    print(f"clock: {clock}" if clock and not fault else f"fault: {fault or 'the page did not get ready'}")
    return 0 if clock and not fault else 1


def _attribute(dom: str, key: str) -> str:
    return dom.split(f'data-{key}="', 1)[1].split('"', 1)[0] if f'data-{key}="' in dom else ""


if __name__ == "__main__":
    sys.exit(main())
