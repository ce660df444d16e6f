"""The page of `rplan view`: it runs, stops, steps, obeys whoever looks, and refuses others.

Takes: a browser and a plan. Gives: points. Leaves alone: what a recorded run shows as well.
"""

from __future__ import annotations

import asyncio
import http.client
import json
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch
from urllib.parse import urlsplit

from viewer.chromium import Tab, line_with
from viewer.points import ROOT, RPLAN, Points
from viewer.replayed import PIXELS, now, settles
from websockets.asyncio.client import connect
from websockets.asyncio.server import ServerConnection
from websockets.exceptions import InvalidStatus
from websockets.typing import Origin

from rplan.apps.simulation import load_world
from rplan.apps.viewer import server
from rplan.apps.viewer.session import Session
from rplan.apps.wiring import compile_file

TICKS = "viewer.ticks"
SAID = "document.getElementById('said').textContent"
NEEDLE = "document.getElementById('timeline').toDataURL()"
ROW = "[...document.querySelectorAll('#live .row')].findIndex(r => r.textContent.startsWith('{}'))"
THING = """(id => { const b = document.getElementById('lot').getBoundingClientRect(), p = viewer.place(id);
    const q = viewer.px(p[0], p[1]); return [b.left + q[0], b.top + q[1], p[0], p[1]]; })('trashcan-2')"""
CLOSE, RUNAWAY = "anything-is-too-close", "(maint runaway)"


@asynccontextmanager
async def viewing(*arguments: str) -> AsyncIterator[str]:
    """`rplan view` while it runs: its address."""
    pipe = asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(*RPLAN, "view", *arguments, cwd=ROOT, stdout=pipe)
    assert process.stdout is not None
    try:
        line = await line_with(process.stdout, lambda line: "http://" in line)
        yield re.findall(r"http://\S+", line)[0]
    finally:
        process.terminate()
        await process.wait()


async def watched(tab: Tab, points: Points, address: str) -> None:
    """All of it, on a page that waits."""
    await tab.open(address)
    sign = await tab.eval("document.getElementById('recording').textContent")
    points.add("h", "says that it records, and where to", sign == "recording watched.mcap", sign)
    await runs(tab, points)
    await meddles(tab, points)
    others = [one for one in tab.asked if urlsplit(one).hostname != "127.0.0.1"]
    points.add("h", "asks nothing but the loopback address", not others, others or f"{len(tab.asked)} requests")
    points.add("h", "no console errors", not tab.complaints, tab.complaints or "none")
    await refuses(points, address)


async def runs(tab: Tab, points: Points) -> None:
    """Starts, pauses, steps forward and backwards."""
    first = await tab.eval(TICKS)
    await asyncio.sleep(0.5)
    waits = await tab.eval(TICKS) == first
    await tab.click("#play")
    started = await tab.until(f"{TICKS} > {first} + 15")
    points.add("h", "waits, and starts when told to", waits and started, f"tick {first}, then {await tab.eval(TICKS)}")
    await tab.click("#play")
    await asyncio.sleep(0.5)
    stands = await tab.eval(TICKS)
    await asyncio.sleep(0.5)
    points.add("h", "pauses", stands == await tab.eval(TICKS), f"rests at tick {stands}")
    await settles(tab)
    await tab.click("#ahead")
    stepped = await tab.until(f"{TICKS} === {stands} + 1")
    at, picture, needle = await now(tab), await tab.eval(PIXELS), await tab.eval(NEEDLE)
    points.add("h", "steps a tick forward", stepped, f"tick {await tab.eval(TICKS)}")
    await tab.click("#back")
    before, changed = await now(tab), await tab.eval(NEEDLE) != needle  # the robot may stand still meanwhile
    await tab.click("#ahead")
    same = await now(tab) == at and await tab.eval(PIXELS) == picture and await tab.eval(TICKS) == stands + 1
    seen = f"{at:.1f} -> {before:.1f} -> {await now(tab):.1f} s"
    points.add(
        "h", "steps back and forth with the same pixels", round(at - before, 3) == 0.1 and changed and same, seen
    )


async def meddles(tab: Tab, points: Points) -> None:
    """Drags an obstacle, forces a percept, stops at a rule."""
    x, y, *was = await tab.eval(THING)
    await tab.drag((x, y), (x + 30, y - 40))
    await tab.click("#ahead")
    await asyncio.sleep(0.5)
    shown = await tab.eval(THING)
    moved = abs(shown[0] - x - 30) < 2 and abs(shown[1] - y + 40) < 2
    points.add("h", "drags an obstacle", moved, f"{_pair(was)} -> {_pair(shown[2:])} m")
    await tab.click("#live details:nth-of-type(1) summary")
    await tab.click("#live details:nth-of-type(2) summary")
    await _press(tab, RUNAWAY, "button")
    await _press(tab, CLOSE, "[data-value=true]")
    forced = await tab.until(f"!!document.querySelector(\"#live .forced[data-percept*='{CLOSE}']\")")
    points.add("h", "forces a percept", forced, f"({CLOSE}) is true")
    await tab.click("#play")
    fired = await tab.until(f"{SAID}.includes('fires')", 5)
    points.add("h", "stops where a rule fires", fired, await tab.eval(SAID))
    lamp = await tab.eval(f"[...document.querySelectorAll('.lamp.on')].some(b => b.title.includes('{CLOSE}'))")
    acts = await tab.eval("document.getElementById('now').innerText.trim()")
    points.add("h", "and the plan obeys the forced percept", lamp and acts == "(move-away-from-danger)", acts)


async def _press(tab: Tab, row: str, button: str) -> None:
    await tab.eval(f"document.querySelectorAll('#live .row')[{ROW.format(row)}].id = 'wanted'")
    await tab.click(f"#wanted {button}")
    await tab.eval("document.getElementById('wanted').id = ''")


async def breaks(tab: Tab, points: Points, plan: Path) -> None:
    """A connection that is lost is told and made again; the end of the simulation is told as its end."""
    stop, connections = asyncio.Event(), list[ServerConnection]()

    class Cutting(server.Viewer):
        async def attend(self, connection: ServerConnection) -> None:
            connections.append(connection)
            await super().attend(connection)

    async def ready(viewer: server.Viewer) -> None:
        await tab.open(viewer.address)
        await tab.click("#ahead")
        await tab.until(f"{TICKS} === 2")
        await tab.eval(f"new MutationObserver(() => sessionStorage.said = {SAID})"
                       ".observe(document.getElementById('said'), {childList: true})")  # fmt: skip
        connections[0].transport.abort()
        again = await tab.until(
            "!!sessionStorage.said && !document.documentElement.dataset.lost && !!window.viewer", 10
        )
        said, ticks = await tab.eval("sessionStorage.said"), await tab.eval(TICKS)
        points.add("h", "a lost connection is told and made again", again and ticks == 2, f"{said}; {ticks} ticks")
        stop.set()

    session = Session(compile_file(plan / f"{plan.name}.rplan"), load_world(plan / "parking_lot.yaml"), 0)
    with patch.object(server, "Viewer", Cutting):
        await server.watch(session, 0, ready, stop)
    ended = await tab.until(f"{SAID} === 'the simulation has ended'", 5)
    points.add("h", "the end of the simulation is told", ended, await tab.eval(SAID))


def _pair(numbers: list[float]) -> str:
    return ", ".join(f"{number:.2f}" for number in numbers)


async def refuses(points: Points, address: str) -> None:
    """Other origins, and who has no token."""
    url = urlsplit(address)
    live, own = f"ws://{url.netloc}{url.path}live", f"http://{url.netloc}"
    tried: dict[str, tuple[str, str | None]] = {
        "a foreign origin": (live, "https://example.org"),
        "no origin": (live, None),
        "no token": (f"ws://{url.netloc}/live", own),
        "a wrong token": (f"ws://{url.netloc}/{'x' * 24}/live", own),
    }
    for name, (where, origin) in tried.items():
        status = await _websocket(where, origin)
        points.add("h", f"a websocket with {name} is refused", status in (403, 404), status)
    for name, path, host in (("no token", "/", url.netloc), ("another host name", url.path, "example.org")):
        status = _page(url.netloc, path, host)
        points.add("h", f"a request with {name} is refused", status in (403, 404), status)
    opened = await _websocket(live, own)
    points.add("h", "the page's own websocket is not", opened == 101, opened)


async def _websocket(address: str, origin: str | None) -> int:
    try:
        async with connect(address, origin=Origin(origin) if origin else None, max_size=None) as connection:
            first: Any = json.loads(await connection.recv())
            return 101 if "open" in first else 0
    except InvalidStatus as refused:
        return refused.response.status_code


def _page(netloc: str, path: str, host: str) -> int:
    connection = http.client.HTTPConnection(netloc, timeout=5)
    connection.request("GET", path, headers={"Host": host})
    status = connection.getresponse().status
    connection.close()
    return status
