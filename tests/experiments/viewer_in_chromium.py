"""The pages of rplan in a browser: `python tests/experiments/viewer_in_chromium.py --shots FOLDER`.

Takes: find and fetch in the parking lot, and a plan of 200 rules that it makes. Gives: a table of points, met or not,
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

from viewer.chromium import chromium
from viewer.frames import draws
from viewer.inspected import inspects
from viewer.live import watched
from viewer.points import Points, recorded
from viewer.replayed import replay

FETCH = "plans/find_and_fetch"
SEED, LONG = 3, 12
"""Seeds of the run that is looked at, and of one of more than ten minutes."""
PARTS = ("replay", "frames", "live", "inspect")


async def look(parts: list[str], work: Path, shots: Path | None, points: Points) -> None:
    """Try all parts in one browser."""
    async with chromium() as browser:
        if "replay" in parts:
            run, page = await recorded(work, FETCH, SEED)
            async with browser.tab() as tab:
                await replay(tab, points, run, page)
        if "frames" in parts:
            _, page = await recorded(work, FETCH, LONG)
            async with browser.tab() as tab:
                await draws(tab, points, page)
        if "live" in parts:
            async with browser.tab() as tab:
                await watched(tab, points, FETCH, SEED)
        if "inspect" in parts:
            async with browser.tab() as tab:
                await inspects(tab, points, work)


def main() -> int:
    """Print the table; 1 where a point is not met."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shots", type=Path, help="write pictures into this folder")
    parser.add_argument("--only", choices=PARTS, action="append", help="try this part; more than once for more")
    wanted = parser.parse_args()
    points = Points()
    print("| part | point | | seen |\n| --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as work:
        asyncio.run(look(wanted.only or list(PARTS), Path(work), wanted.shots, points))
    print(f"\n{len(points.every) - len(points.missed)} of {len(points.every)} points met")
    return 1 if points.missed else 0


if __name__ == "__main__":
    sys.exit(main())
