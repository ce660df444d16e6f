"""How fast the page of a run opens and draws.

Takes: a browser and the page of a run of more than ten minutes. Gives: points. Leaves alone: what is drawn.

A frame is timed within the page: from the call of its animation frame to the first task after its paint. Where no
graphics card is used, that includes putting the pixels of the canvas together.
"""

from __future__ import annotations

import asyncio
from itertools import pairwise
from pathlib import Path
from statistics import median

from viewer.chromium import WIDE, Tab
from viewer.points import Points

BUDGET_MS, OPEN_MS, LONG_S = 16.0, 2000.0, 600.0
TRIES = 3
"""So often at most, since others may use the machine; the best try counts."""
Frames = list[tuple[float, float, float]]
"""Of each frame its beginning, the end of the page's script, and the end of its paint [ms]."""
STOPWATCH = """(() => {
  const frames = window.frames_seen = [], next = requestAnimationFrame.bind(window), channel = new MessageChannel();
  let open = null;
  channel.port1.onmessage = () => { if (open) { open.push(performance.now()); frames.push(open); open = null; } };
  window.requestAnimationFrame = call => next(now => {
    const began = performance.now(); call(now); open = [began, performance.now()]; channel.port2.postMessage(0);
  });
  const seen = () => next(() => setTimeout(() => { window.seen_at = performance.now(); }));
  const ready = () => document.documentElement?.dataset.ready ? seen() : setTimeout(ready, 5);
  ready();
})()"""


async def draws(tab: Tab, points: Points, page: Path) -> None:
    """Opens within two seconds; frames cost less than a sixtieth of a second."""
    hook = (await tab.call("Page.addScriptToEvaluateOnNewDocument", source=STOPWATCH))["identifier"]
    await tab.size(WIDE)
    await tab.call("Page.navigate", url="about:blank")
    await tab.open(page.as_uri())
    await tab.until("window.seen_at > 0")
    length, opened = await tab.eval("document.getElementById('timeline').ariaValueMax"), await tab.eval("seen_at")
    points.add(
        "g", f"opens a run of {length} s within 2 s", opened < OPEN_MS and float(length) > LONG_S, f"{opened:.0f} ms"
    )
    for speed, share in ((1, 0.7), (10, 0.6), (50, 0.2)):
        await tab.click(f"#speeds [data-speed='{speed}']")
        tries = [await _played(tab, share)]
        while _cost(tries[-1]) >= BUDGET_MS and len(tries) < TRIES:
            tries.append(await _played(tab, share))
        _measured(points, speed, min(tries, key=_cost), len(tries))
    await tab.call("Page.removeScriptToEvaluateOnNewDocument", identifier=hook)


async def _played(tab: Tab, share: float) -> Frames:
    """Four seconds of frames from some place of the timeline on."""
    await tab.click("#timeline", share)
    await tab.eval("frames_seen.length = 0")
    await tab.key(" ")
    await asyncio.sleep(4)
    await tab.key(" ")
    found: Frames = await tab.eval("frames_seen")
    return found


def _cost(frames: Frames) -> float:
    return median(painted - begin for begin, _, painted in frames)


def _measured(points: Points, speed: int, frames: Frames, tries: int) -> None:
    script = median(end - begin for begin, end, _ in frames)
    costs = sorted(painted - begin for begin, _, painted in frames)
    apart = median(b[0] - a[0] for a, b in pairwise(frames))
    worst, cost = costs[int(0.95 * len(costs))], _cost(frames)
    said = f"script {script:.1f}, with paint {cost:.1f} (95 %: {worst:.1f}) ms; {1000 / apart:.0f} frames a second"
    said += "" if tries == 1 else f"; best of {tries} tries"
    points.add("g", f"at {speed}x a frame costs less than {BUDGET_MS:.0f} ms", cost < BUDGET_MS, said)
