"""Pictures of every page, for people to look at.

Takes: a browser and pages. Gives: PNG files: light and dark, on a wide screen, a laptop and a phone. Leaves alone:
whether they are beautiful.
"""

from __future__ import annotations

import asyncio
from pathlib import Path

from viewer.chromium import LAPTOP, PHONE, WIDE, Tab

SCREENS = {"wide": WIDE, "laptop": LAPTOP, "phone": PHONE}
MOMENTS = {"driving": "#t=380", "searching": "#t=40", "circuit": "#t=380&tab=circuit"}
PHONE_LENGTH = 2600


async def everywhere(tab: Tab, folder: Path, name: str) -> None:
    """What a tab shows, on each screen, light and dark."""
    for screen, wide in SCREENS.items():
        for dark in (False, True):
            await tab.size(wide, dark)
            await tab.picture(folder / f"{name}-{screen}-{'dark' if dark else 'light'}.png")
    await tab.size(WIDE)


async def moments(tab: Tab, folder: Path, page: Path) -> None:
    """A run's page at some moments, opened anew on each screen; on the phone also all of it."""
    for screen, wide in SCREENS.items():
        for dark in (False, True):
            await tab.size(wide, dark)
            for moment, where in MOMENTS.items():
                await opened(tab, f"{page.as_uri()}{where}")
                await tab.picture(folder / f"{moment}-{screen}-{'dark' if dark else 'light'}.png")
    await tab.size((PHONE[0], PHONE_LENGTH))
    await opened(tab, f"{page.as_uri()}{MOMENTS['driving']}")
    await tab.picture(folder / "driving-phone-whole.png")
    await tab.size(WIDE)


async def opened(tab: Tab, address: str) -> None:
    """A page opened anew: another `#` alone would not do that."""
    await tab.call("Page.navigate", url="about:blank")
    await tab.open(address)
    await asyncio.sleep(0.3)
