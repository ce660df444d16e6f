"""The pictures of the tutorial, made anew: `python tests/experiments/tutorial_pictures.py`.

Takes: the pages of docs/tutorial, which are followed from the first to the last in a temporary folder, and the command
`chromium`. Gives: docs/pictures/tutorial_*.png, of the pages that the commands have written. Leaves alone: the texts.
"""

from __future__ import annotations

import asyncio
import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from repo.following import ROOT, Reader
from viewer.chromium import Browser, chromium

from rplan.apps.commands.new import project

SIZE = (1280, 720)
PICTURES = {
    2: ("tutorial_2_inspect", "plan.html"),
    3: ("tutorial_3_replay", "run.html#t=13&conditions=0"),
    4: ("tutorial_4_why", "run.html#t=25"),
    6: ("tutorial_6_replay", "run.html#t=14"),
}
"""By step: the name of the picture, and the page as it is then."""


async def picture(browser: Browser, name: str, page: str) -> None:
    """A page of the folder we are in, light, at one size."""
    target = ROOT / "docs" / "pictures" / f"{name}.png"
    async with browser.tab() as tab:
        await tab.size(SIZE)
        file, _, place = page.partition("#")
        await tab.open(f"{Path(file).resolve().as_uri()}?theme=light#{place}")
        await asyncio.sleep(0.5)
        if tab.complaints or any(not asked.startswith(("file:", "data:", "blob:")) for asked in tab.asked):
            raise RuntimeError(f"{page}: {tab.complaints} {tab.asked}")
        await tab.picture(target)
    print(target.relative_to(ROOT))


async def main() -> None:
    """Follow the steps, and look at what there is after each."""
    reader = Reader(project("shy"))
    async with chromium() as browser:
        for page in sorted((ROOT / "docs" / "tutorial").glob("[0-9]_*.md")):
            reader.follow(page.read_text(encoding="utf-8"))
            if (step := int(page.name[0])) in PICTURES:
                await picture(browser, *PICTURES[step])


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        before = Path.cwd()
        os.chdir(folder)
        try:
            asyncio.run(main())
        finally:
            os.chdir(before)
