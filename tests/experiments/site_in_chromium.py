"""The site in a browser: `python tests/experiments/site_in_chromium.py --shots FOLDER`.

Takes: the pages of docs/, built into a temporary folder and served on loopback, and the command `chromium`. Gives: each
page that asks for something from elsewhere, complains, or is wider than a phone; pictures where wanted; exit code 1 if
there is such a page. Leaves alone: the tests, which need no browser.
"""

from __future__ import annotations

import argparse
import asyncio
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

from viewer.chromium import PHONE, WIDE, Tab, chromium

ROOT = Path(__file__).parents[2]
LOOKS = (("light", WIDE, False), ("dark", WIDE, True), ("phone", PHONE, False))
SHOWN = (
    "index.html",
    "tutorial/1_first_plan.html",
    "tutorial/3_in_a_world.html",
    "tutorial/6_own_words.html",
    "how-to/test_a_plan.html",
    "reference/commands.html",
    "reference/libraries.html",
    "reference/language.html",
    "ARCHITECTURE.html",
    "experiments/find-and-fetch.html",
    "sources/plans/find_and_fetch/find_and_fetch.rplan.html",
)
"""Pages of which pictures are made."""
READY = "document.readyState === 'complete'"
TOO_WIDE = "Math.max(document.documentElement.scrollWidth, document.body.scrollWidth) - innerWidth"


class Quiet(SimpleHTTPRequestHandler):
    """Files of a folder, without a log."""

    def log_message(self, *_: object) -> None:
        """Nothing is said of a request."""


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address at which the folder is served."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(folder)))
    Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/"
    finally:
        server.shutdown()


async def opened(tab: Tab, address: str) -> None:
    """Go there, and wait until everything has come."""
    tab.asked.clear()
    tab.complaints.clear()
    await tab.call("Page.navigate", url=address)
    await asyncio.sleep(0.15)
    await tab.until(READY)
    await asyncio.sleep(0.15)


async def faults(tab: Tab, home: str) -> list[str]:
    """What is wrong with the page that is open."""
    elsewhere = [asked for asked in tab.asked if not asked.startswith((home, "data:", "blob:", "about:"))]
    wide = await tab.eval(TOO_WIDE)
    return [*elsewhere, *tab.complaints, *([f"{wide} pixels too wide"] if wide > 0 else [])]


async def look(site: Path, shots: Path | None) -> int:
    """How many pages have faults; each is opened on a phone, some also elsewhere."""
    pages = sorted(path.relative_to(site).as_posix() for path in site.rglob("*.html"))
    wrong = 0
    with served(site) as home:
        async with chromium() as browser, browser.tab() as tab:
            for name, size, dark in LOOKS:
                await tab.size(size, dark)
                for page in pages if size == PHONE else SHOWN:
                    await opened(tab, home + page)
                    for fault in await faults(tab, home):
                        wrong += 1
                        print(f"{page} ({name}): {fault}")
                    if shots and page in SHOWN:
                        await tab.picture(shots / f"{page.removesuffix('.html').replace('/', '-')}-{name}.png")
    print(f"{len(pages)} pages, {wrong} faults")
    return wrong


def main() -> int:
    """Build, serve, look."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--shots", type=Path, help="a folder for pictures")
    given = parser.parse_args()
    if given.shots:
        given.shots.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        build = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "-f", "docs/site/mkdocs.yml", "-d"]
        subprocess.run([*build, folder], cwd=ROOT, check=True)
        return 1 if asyncio.run(look(Path(folder), given.shots)) else 0


if __name__ == "__main__":
    sys.exit(main())
