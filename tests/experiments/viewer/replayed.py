"""The page of a recorded run: it opens, plays, steps, jumps, and says why.

Takes: a browser, a recording and its page. Gives: points. Leaves alone: frames and pictures.
"""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import Any

from viewer.chromium import Tab
from viewer.points import Points, rplan

CLOCK = "document.getElementById('clock').textContent.trim()"
PIXELS = """new Promise(drawn => requestAnimationFrame(() => setTimeout(drawn)))
    .then(() => document.getElementById('lot').toDataURL())"""
WHY = "document.getElementById('reasons').innerText"
ASKED_AT = (0.05, 0.3, 0.67, 0.705, 0.9)
"""Where the timeline is clicked to ask why, as shares of its width: both searches, both legs, and danger beside."""
LOSERS = "[...document.querySelectorAll('#losers p')].map(p => p.textContent.replace(/\\s+/g, ' ').trim())"
LIT = "(name => [...document.querySelectorAll('#code .' + name)].map(d => Number(d.dataset.n)))"
MARKED = """[...document.querySelectorAll('#code div')].filter(d => d.querySelector('b'))
    .map(d => [Number(d.dataset.n), d.querySelector('b').className === 'yes'])"""
WIRES = """({on: document.querySelectorAll('#circuit .wire.on').length,
    off: document.querySelectorAll('#circuit .wire:not(.on)').length,
    inputs: [...document.querySelectorAll('#circuit .cell.on text')].map(t => t.textContent).sort(),
    ends: [...document.querySelectorAll('#circuit .end.on text')].map(t => t.textContent).sort()})"""
HOLDING = """[...document.querySelectorAll('.lamp.on')].map(b => b.title.split(':')[0]).sort()"""


def seconds(clock: str) -> float:
    """The time [s] that a clock shows, as in "6:20.0 / 9:24.3"."""
    minutes, rest = clock.split(" / ")[0].split(":")
    return int(minutes) * 60 + float(rest)


async def now(tab: Tab) -> float:
    """The time [s] that the page shows."""
    return seconds(await tab.eval(CLOCK))


async def settles(tab: Tab) -> None:
    """After some readings of its pixels Chromium draws a canvas by another path, by shades otherwise: have it so."""
    for _ in range(4):
        for button in ("#back", "#ahead"):
            await tab.click(button)
            await tab.eval(PIXELS)


async def opens(tab: Tab, points: Points, page: Path) -> None:
    """Without errors and without a network."""
    await tab.open(page.as_uri())
    await asyncio.sleep(0.5)
    points.add("a", "opens without console errors", not tab.complaints, tab.complaints or "none")
    others = [one for one in tab.asked if not one.startswith((page.as_uri(), "data:"))]
    points.add("a", "asks nothing of a network", not others, others or f"{len(tab.asked)} request: the file itself")


async def plays(tab: Tab, points: Points) -> None:
    """Plays, pauses, changes its speed."""
    start = await now(tab)
    await tab.click("#play")
    await asyncio.sleep(2)
    at = await now(tab)
    points.add("b", "plays at 1x", 1.2 < at - start < 2.8, f"{at - start:.1f} s in 2 s")
    await tab.click("#play")
    rests = await now(tab)
    await asyncio.sleep(0.5)
    points.add("b", "pauses", rests == await now(tab), f"rests at {rests:.1f} s")
    await tab.click("#speeds [data-speed='10']")
    await tab.click("#play")
    await asyncio.sleep(2)
    await tab.click("#play")
    far = await now(tab) - rests
    points.add("b", "plays at 10x", 12 < far < 28, f"{far:.1f} s in 2 s")
    await tab.click("#speeds [data-speed='1']")


async def steps(tab: Tab, points: Points) -> None:
    """A tick forward changes the world, a tick back brings back the very same picture."""
    await tab.click("#timeline", 0.7)
    await settles(tab)
    start, picture, why = await now(tab), await tab.eval(PIXELS), await tab.eval(WHY)
    await tab.click("#ahead")
    ahead, changed = await now(tab), await tab.eval(PIXELS) != picture
    points.add("b", "steps a tick forward", round(ahead - start, 3) == 0.1 and changed, f"{start:.1f} -> {ahead:.1f} s")
    await tab.click("#back")
    same = await tab.eval(PIXELS) == picture and await tab.eval(WHY) == why
    back = await now(tab)
    points.add("b", "a tick back: same pixels, same why", same and back == start, f"{ahead:.1f} -> {back:.1f} s")
    await tab.click("#back")
    before, other = await now(tab), await tab.eval(PIXELS) != picture
    points.add("b", "another tick back", round(start - before, 3) == 0.1 and other, f"{back:.1f} -> {before:.1f} s")


async def jumps(tab: Tab, points: Points) -> None:
    """By a click, by keys."""
    length = seconds((await tab.eval(CLOCK)).split(" / ")[1] + " / ")
    seen = []
    for share in (0.25, 0.5, 0.9):
        await tab.click("#timeline", share)
        seen.append(abs(await now(tab) - share * length) < 0.005 * length + 0.2)
    points.add("c", "a click on the timeline jumps there", all(seen), "at 25, 50 and 90 % of its width")
    said = []
    for key, shift, wanted in (("Home", 0, 0.0), ("ArrowRight", 0, 0.1), ("ArrowRight", 1, 1.1), ("ArrowLeft", 0, 1.0)):
        await tab.key(key, bool(shift))
        said.append(abs(await now(tab) - wanted) < 1e-6)
    await tab.key("End")
    said.append(await now(tab) == length)
    points.add("c", "Home, arrows, shift and arrow, End", all(said), f"{len(said)} keys")
    await tab.key("p")
    switch = await now(tab)
    await tab.key("p")
    before = await now(tab)
    await tab.key("n")
    points.add("c", "n and p: switches", before < switch == await now(tab) < length, f"{before:.1f}, {switch:.1f} s")
    await tab.key("Home")
    await tab.key("+")
    await tab.key(" ")
    await asyncio.sleep(1)
    await tab.key(" ")
    rests = await now(tab)
    await tab.key("-")
    points.add("c", "space plays and pauses, + is faster", 1.0 < rests < 3.0, f"{rests:.1f} s in 1 s at 2x")
    shown = "!document.getElementById('tracks').hidden"
    was = await tab.eval(shown)
    await tab.key("d")
    points.add("c", "d: conditions below the timeline", was != await tab.eval(shown))
    await tab.key("d")


async def explains(tab: Tab, points: Points, run: Path) -> None:
    """Losers with what stood against them, the active lines, live wires: as `rplan why` has them."""
    lost = lines = wires = 0
    faults: list[str] = []
    for share in ASKED_AT:
        await tab.click("#timeline", share)
        at = await now(tab)
        why = json.loads(await rplan("why", str(run), "--at", f"{at:.1f}", "--json"))
        faults += [f"{at:.1f} s: {fault}" for fault in await _explained(tab, why)]
        lost += sum(not one["part_of"] for one in why["lost"])
        lines += len(why["way"]["branches"]) + len(why["way"]["acts"])
        await tab.key("c")
        faults += [f"{at:.1f} s: {fault}" for fault in await _wired(tab, why)]
        wires += (await tab.eval(WIRES))["on"]
        await tab.key("c")
    said = {kind: [one for one in faults if f": {kind}" in one] for kind in ("lost", "lines", "wires")}
    places = f"{len(ASKED_AT)} ticks"
    points.add("d", "each goal that lost, with the condition that `rplan why` names", not said["lost"] and lost > 5,
               said["lost"] or f"{lost} in {places}")  # fmt: skip
    points.add("e", "the plan's text with the active branch lit", not said["lines"] and lines > 5,
               said["lines"] or f"{lines} lines in {places}")  # fmt: skip
    points.add("e", "the circuit with live wires", not said["wires"] and wires > 5,
               said["wires"] or f"{wires} lit wires in {places}")  # fmt: skip


async def _explained(tab: Tab, why: Any) -> list[str]:
    told = await tab.eval(LOSERS)
    wanted = [f"{one['goal']} {one['because']}" for one in why["lost"] if not one["part_of"]]
    faults = [f"lost {one}" for one in wanted if one not in told] + [
        f"lost {one}?" for one in told if one not in wanted
    ]
    acts = sorted({act["line"] for act in why["way"]["acts"]})
    if acts != await tab.eval(f"{LIT}('act')"):
        faults.append(f"lines {acts} act")
    marks = {branch["line"]: branch["value"] for branch in reversed(why["way"]["branches"])}
    if sorted(marks.items()) != sorted(map(tuple, await tab.eval(MARKED))):
        faults.append(f"lines {marks} are asked")
    within = await tab.eval(f"{LIT}('lit')")
    places = [rule["place"] for rule in why["rules"]]
    if within != sorted({n for place in places for n in range(place["line"], place["end_line"] + 1)}):
        faults.append(f"lines {within} are lit")
    return faults


async def _wired(tab: Tab, why: Any) -> list[str]:
    seen = await tab.eval(WIRES)
    sets = sorted(f"{act['output']}={act['value']}" for act in why["way"]["acts"])
    faults = [] if seen["ends"] == sets else [f"wires lead to {seen['ends']}, not {sets}"]
    holding = await tab.eval(HOLDING)
    if not set(seen["inputs"]) <= set(holding):
        faults.append(f"wires come from {seen['inputs']}, not from {holding}")
    return faults if seen["on"] and seen["off"] else [*faults, "wires are all alike"]


async def replay(tab: Tab, points: Points, run: Path, page: Path) -> None:
    """All of it."""
    await opens(tab, points, page)
    await plays(tab, points)
    await steps(tab, points)
    await jumps(tab, points)
    await explains(tab, points, run)
    points.add("a", "and nothing of it made the console complain", not tab.complaints, tab.complaints or "none")
