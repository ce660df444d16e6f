"""Watches a plan live in a headless Chromium and takes pictures: `look_view.py FOLDER`; for people, no test.

It steps, runs, drags a thing, forces a percept, stops at a rule, goes back, and says what the page showed.
"""

from __future__ import annotations

import asyncio
import base64
import json
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

from websockets.asyncio.client import ClientConnection, connect

ROOT = Path(__file__).parents[2]
ENTRY = "from rplan.apps.cli import main; main()"


class Tab:
    """A tab of a browser, by the DevTools protocol."""

    def __init__(self, connection: ClientConnection) -> None:
        self.connection, self.number = connection, 0

    async def call(self, method: str, **given: Any) -> Any:
        self.number += 1
        await self.connection.send(json.dumps({"id": self.number, "method": method, "params": given}))
        while True:
            message = json.loads(await self.connection.recv())
            if message.get("id") == self.number:
                return message.get("result", message)

    async def eval(self, script: str) -> Any:
        found = await self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        return found.get("result", {}).get("value", found.get("exceptionDetails"))

    async def size(self, width: int, height: int, dark: bool = False) -> None:
        await self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600
        )
        scheme = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
        await self.call("Emulation.setEmulatedMedia", features=scheme)
        await asyncio.sleep(0.4)

    async def picture(self, path: Path) -> None:
        shot = await self.call("Page.captureScreenshot", format="png")
        path.write_bytes(base64.b64decode(shot["data"]))

    async def drag(self, a: tuple[float, float], b: tuple[float, float]) -> None:
        for kind, (x, y) in (("mousePressed", a), ("mouseMoved", b), ("mouseReleased", b)):
            await self.call(
                "Input.dispatchMouseEvent",
                type=kind,
                x=x,
                y=y,
                button="left",
                buttons=0 if kind == "mouseReleased" else 1,
                clickCount=1,
            )


async def browser(profile: str) -> tuple[asyncio.subprocess.Process, str]:
    """A headless Chromium and the address of its first tab."""
    options = (
        f"--headless --no-sandbox --disable-gpu --no-first-run --user-data-dir={profile} --remote-debugging-port=0"
    )
    process = await asyncio.create_subprocess_exec(
        "chromium", *options.split(), "about:blank", stderr=asyncio.subprocess.PIPE
    )
    assert process.stderr is not None
    while True:
        line = (await process.stderr.readline()).decode()
        if "DevTools listening on" in line:
            break
    address = line.split()[-1]
    async with connect(address, max_size=None) as connection:
        tab = Tab(connection)
        targets = await tab.call("Target.getTargets")
        target = next(one for one in targets["targetInfos"] if one["type"] == "page")
    return process, re.sub(r"/browser/.*", f"/page/{target['targetId']}", address)


async def viewer(*arguments: str) -> tuple[asyncio.subprocess.Process, str]:
    """`rplan view`, and its address."""
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-u", "-c", ENTRY, "view", *arguments, cwd=ROOT, stdout=asyncio.subprocess.PIPE
    )
    assert process.stdout is not None
    line = (await process.stdout.readline()).decode()
    return process, re.findall(r"http://\S+", line)[0]


async def look(tab: Tab, out: Path) -> None:
    """Work the page."""
    ticks = "document.documentElement.dataset.ticks"
    await tab.size(1280, 800)
    await asyncio.sleep(1.5)
    print("fault:", await tab.eval("document.documentElement.dataset.fault"), "| ticks:", await tab.eval(ticks))
    await tab.picture(out / "live.png")
    await tab.eval("live.tell({do: 'speed', to: 50}); live.tell({do: 'run', on: true})")
    await asyncio.sleep(4)
    print("ticks after 4 s at 50x:", await tab.eval(ticks))
    await tab.eval("live.tell({do: 'run', on: false})")
    await asyncio.sleep(0.5)
    before = await tab.eval("document.getElementById('clock').textContent")
    await tab.eval("document.getElementById('back').click()")
    print("clock:", before, "| a tick back:", await tab.eval("document.getElementById('clock').textContent"))
    await tab.eval("document.getElementById('ahead').click(); document.getElementById('ahead').click()")
    await asyncio.sleep(0.5)
    print("two ahead:", await tab.eval("document.getElementById('clock').textContent"))
    place = """(id => {
        const b = document.getElementById('lot').getBoundingClientRect(), p = viewer.place(id);
        const q = viewer.px(p[0], p[1]);
        return [b.left + q[0], b.top + q[1], p[0], p[1]];
    })('trashcan-1')"""
    x, y, *was = await tab.eval(place)
    await tab.drag((x, y), (x + 30, y - 40))
    await tab.eval("live.tell({do: 'step', ticks: 2})")
    await asyncio.sleep(0.5)
    print("thing was at", was, "is at", (await tab.eval(place))[2:])
    await tab.eval("document.querySelectorAll('#live details').forEach(d => d.open = true)")
    await tab.eval("live.tell({do: 'break', rule: '(maint runaway)', on: true})")
    await tab.eval("live.tell({do: 'force', percept: 'anything-is-too-close', value: true})")
    await tab.eval("live.tell({do: 'run', on: true})")
    await asyncio.sleep(1.0)
    print("said:", await tab.eval("document.getElementById('said').textContent"))
    await tab.picture(out / "live-forced.png")
    await tab.size(1280, 800, dark=True)
    await tab.picture(out / "live-dark.png")
    await tab.size(390, 844)
    await tab.picture(out / "live-phone.png")


async def main() -> None:
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    server, address = await viewer("find_and_fetch", "--paused")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        chromium, tab = await browser(profile)
        try:
            async with connect(tab, max_size=None) as connection:
                page = Tab(connection)
                await page.call("Page.enable")
                await page.call("Page.navigate", url=address)
                await look(page, out)
        finally:
            chromium.terminate()
            server.terminate()
            await chromium.wait()
            print("rplan view ends with", await server.wait())


if __name__ == "__main__":
    asyncio.run(main())
