"""The pages of rplan in a browser: `python tests/experiments/viewer_in_chromium.py --shots FOLDER`.

Takes: find and fetch in the parking lot, and plans of 200 rules that it makes. Gives: a table of points, met or not,
and pictures of every page; it exits with 1 where a point is not met. Leaves alone: the tests, which need no browser.

The command `chromium` must be there. Each page is worked as a reader would, by mouse and keys; pictures are for people
to look at: light and dark, on a wide screen, a laptop and a phone.
"""

from __future__ import annotations

import argparse
import asyncio
import sys
import tempfile
from pathlib import Path

from viewer.chromium import Tab, chromium
from viewer.frames import draws
from viewer.inspected import PLANS, inspects, viewed
from viewer.large import large
from viewer.live import breaks, viewing, watched
from viewer.others import others
from viewer.pictures import everywhere, moments, opened
from viewer.points import ROOT, Points, recorded
from viewer.replayed import replay

FETCH = "plans/find_and_fetch"
SEED, LONG = 3, 12
"""Seeds of the run that is looked at, and of one of more than ten minutes."""
PARTS = ("replay", "frames", "others", "live", "inspect", "large")


async def look(parts: list[str], work: Path, shots: Path | None, points: Points) -> None:
    """Try all parts in one browser, each in a tab of its own."""
    tries = {
        "replay": _replayed,
        "frames": _drawn,
        "others": _others,
        "live": _live,
        "inspect": _inspected,
        "large": _large,
    }
    async with chromium() as browser:
        for part in parts:
            async with browser.tab() as tab:
                await tries[part](tab, work, shots, points)


async def _replayed(tab: Tab, work: Path, shots: Path | None, points: Points) -> None:
    run, page = await recorded(work, FETCH, SEED)
    await replay(tab, points, run, page)
    if shots:
        await moments(tab, shots, page)


async def _drawn(tab: Tab, work: Path, _: Path | None, points: Points) -> None:
    _, page = await recorded(work, FETCH, LONG)
    await draws(tab, points, page)


async def _others(tab: Tab, work: Path, _: Path | None, points: Points) -> None:
    await others(tab, points, work)


async def _live(tab: Tab, work: Path, shots: Path | None, points: Points) -> None:
    run = work / "watched.mcap"
    async with viewing(FETCH, "--seed", str(SEED), "--paused", "--record", str(run)) as address:
        await watched(tab, points, address)
        if shots:
            await everywhere(tab, shots, "live")
    await breaks(tab, points, ROOT / FETCH)


async def _inspected(tab: Tab, work: Path, shots: Path | None, points: Points) -> None:
    for name in PLANS:
        page = await inspects(tab, points, work, name)
        if shots:
            await opened(tab, page.as_uri())
            await everywhere(tab, shots, f"inspect-{name}")
            for drawing in sorted(work.glob(f"{name}.*.svg")):
                await tab.call("Page.navigate", url=drawing.as_uri())
                await tab.until("!!document.querySelector('text')")
                await tab.picture(shots / f"{drawing.stem}-svg.png")
    _, run = await recorded(work, str(work / "reporting.rplan"), SEED, "--scenario", f"{FETCH}/parking_lot.yaml")
    await viewed(tab, points, run)
    if shots:
        await everywhere(tab, shots, "many-rules")


async def _large(tab: Tab, work: Path, shots: Path | None, points: Points) -> None:
    page = await large(tab, points, work)
    if shots:
        for name, of in (("action", ""), ("percept", "&of=anything-is-too-close")):
            await opened(tab, f"{page.as_uri()}#t=101.6&tab=circuit{of}")
            await everywhere(tab, shots, f"large-{name}")


def main() -> int:
    """Print the table; 1 where a point is not met."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shots", type=Path, help="write pictures into this folder")
    parser.add_argument("--only", choices=PARTS, action="append", help="try this part; more than once for more")
    wanted = parser.parse_args()
    if wanted.shots:
        wanted.shots.mkdir(parents=True, exist_ok=True)
    points = Points()
    print("| part | point | | seen |\n| --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as work:
        asyncio.run(look(wanted.only or list(PARTS), Path(work), wanted.shots, points))
    print(f"\n{len(points.every) - len(points.missed)} of {len(points.every)} points met")
    return 1 if points.missed else 0


if __name__ == "__main__":
    sys.exit(main())
