"""A headless Chromium, driven over its DevTools protocol.

Takes: the command `chromium`. Gives: tabs that open pages, press keys, use the mouse, and keep what a page asked of the
network and what it complained of. Leaves alone: what a page should do.
"""

from __future__ import annotations

import asyncio
import base64
import json
import re
import tempfile
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Any

from websockets.asyncio.client import ClientConnection, connect

QUIET = ("--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync")
OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", *QUIET, "--hide-scrollbars")
CODES = {" ": ("Space", 32), "ArrowLeft": ("ArrowLeft", 37), "ArrowRight": ("ArrowRight", 39)}
CODES |= {"Enter": ("Enter", 13), "Home": ("Home", 36), "End": ("End", 35), "Escape": ("Escape", 27)}
WIDE, LAPTOP, PHONE = (1440, 900), (1280, 720), (390, 844)
SHIFT = 8
PATIENCE_S = 20.0


@dataclass(slots=True)
class Tab:
    """A tab. asked: addresses that it asked of the network; complaints: errors and warnings of its console."""

    connection: ClientConnection
    asked: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)
    _answers: dict[int, asyncio.Future[Any]] = field(default_factory=dict)
    _numbers: Iterator[int] = field(default_factory=count)

    async def listen(self) -> None:
        """Take what comes until the tab is closed."""
        async for text in self.connection:
            message = json.loads(text)
            waiting = self._answers.pop(message.get("id", -1), None)
            if waiting is not None and not waiting.done():
                waiting.set_result(message)
            elif "method" in message:
                self._event(message["method"], message["params"])

    def _event(self, method: str, given: Any) -> None:
        match method:
            case "Network.requestWillBeSent":
                self.asked.append(given["request"]["url"])
            case "Network.webSocketCreated":
                self.asked.append(given["url"])
            case "Runtime.exceptionThrown":
                self.complaints.append(given["exceptionDetails"].get("exception", {}).get("description", "exception"))
            case "Runtime.consoleAPICalled" if given["type"] in ("error", "warning", "assert"):
                self.complaints.append(" ".join(str(one.get("value", "")) for one in given["args"]))
            case "Log.entryAdded" if given["entry"]["level"] in ("error", "warning"):
                self.complaints.append(given["entry"]["text"])

    async def call(self, method: str, **given: Any) -> Any:
        """Ask the browser; RuntimeError with what it says where it cannot."""
        number = next(self._numbers)
        answer = self._answers[number] = asyncio.get_running_loop().create_future()
        await self.connection.send(json.dumps({"id": number, "method": method, "params": given}))
        message = await asyncio.wait_for(answer, 60)
        if "error" in message:
            raise RuntimeError(f"{method}: {message['error']['message']}")
        return message["result"]

    async def eval(self, script: str) -> Any:
        """What a script gives; RuntimeError where it throws."""
        found = await self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in found:
            raise RuntimeError(f"{script}: {found['exceptionDetails']['exception'].get('description')}")
        return found["result"].get("value")

    async def until(self, script: str, seconds: float = PATIENCE_S) -> bool:
        """Whether a script comes true in time."""
        clock = asyncio.get_running_loop().time
        end = clock() + seconds
        while not (true := bool(await self.eval(script))) and clock() < end:
            await asyncio.sleep(0.03)
        return true

    async def open(self, address: str) -> None:
        """Go there and wait until the page says that it is ready."""
        self.asked.clear()
        self.complaints.clear()
        await self.call("Page.navigate", url=address)
        if not await self.until("document.readyState === 'complete' && !!document.documentElement.dataset.ready"):
            raise RuntimeError(f"{address} did not get ready: {self.complaints}")

    async def size(self, wide: tuple[int, int], dark: bool = False) -> None:
        """A screen of so many pixels, light or dark."""
        phone = wide[0] < 600
        given = {"width": wide[0], "height": wide[1], "deviceScaleFactor": 2 if phone else 1, "mobile": phone}
        await self.call("Emulation.setDeviceMetricsOverride", **given)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        await self.call("Emulation.setEmulatedMedia", features=[scheme])
        await asyncio.sleep(0.3)

    async def picture(self, path: Path) -> None:
        """What is on the screen, as a PNG file."""
        shot = await self.call("Page.captureScreenshot", format="png")
        path.write_bytes(base64.b64decode(shot["data"]))

    # --- hands ------------------------------------------------------------------------------------

    async def key(self, key: str, shift: bool = False) -> None:
        """Press and release a key."""
        code, number = CODES.get(key, ("", ord(key.upper()) if len(key) == 1 else 0))
        given: dict[str, Any] = {"key": key, "code": code, "windowsVirtualKeyCode": number}
        given |= {"modifiers": SHIFT if shift else 0}
        typed = {"text": {"Enter": "\r"}.get(key, key)} if len(key) == 1 or key == "Enter" else {}
        await self.call("Input.dispatchKeyEvent", type="keyDown", **given, **typed)
        await self.call("Input.dispatchKeyEvent", type="keyUp", **given)

    async def mouse(self, kind: str, at: tuple[float, float], down: bool) -> None:
        """An event of the left button."""
        given = {"x": at[0], "y": at[1], "button": "left", "buttons": int(down), "clickCount": 1}
        await self.call("Input.dispatchMouseEvent", type=kind, **given)

    async def press(self, at: tuple[float, float]) -> None:
        """A click at a place of the screen."""
        await self.drag(at, at)

    async def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """From a place to another with the button down."""
        await self.mouse("mousePressed", start, True)
        if end != start:
            await self.mouse("mouseMoved", ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2), True)
            await self.mouse("mouseMoved", end, True)
        await self.mouse("mouseReleased", end, False)

    async def click(self, selector: str, along: float = 0.5) -> None:
        """A click on an element, `along` of its width; it is brought into view first, as a reader would."""
        place = """(node => { if (!node) return null; node.scrollIntoView({block: "nearest"});
            const b = node.getBoundingClientRect(); return [b.left + b.width * ALONG, b.top + b.height / 2]; })"""
        found = await self.eval(f"{place.replace('ALONG', str(along))}(document.querySelector({json.dumps(selector)}))")
        if found is None:
            raise RuntimeError(f"there is no {selector}")
        await self.press((found[0], found[1]))


@dataclass(frozen=True, slots=True)
class Browser:
    """A Chromium that runs. address: that of its DevTools."""

    address: str
    root: Tab

    @asynccontextmanager
    async def tab(self) -> AsyncIterator[Tab]:
        """A new tab, closed at the end."""
        target = (await self.root.call("Target.createTarget", url="about:blank"))["targetId"]
        async with _listening(re.sub(r"/browser/.*", f"/page/{target}", self.address)) as tab:
            for domain in ("Page", "Network", "Runtime", "Log"):
                await tab.call(f"{domain}.enable")
            await tab.size(WIDE)
            yield tab
        await self.root.call("Target.closeTarget", targetId=target)


@asynccontextmanager
async def _listening(address: str) -> AsyncIterator[Tab]:
    async with connect(address, max_size=None) as connection:
        tab = Tab(connection)
        ears = asyncio.create_task(tab.listen())
        try:
            yield tab
        finally:
            ears.cancel()


async def line_with(stream: asyncio.StreamReader, wanted: Callable[[str], bool]) -> str:
    """The first line that is wanted; RuntimeError with all lines where the stream ends before."""
    said = []
    while line := (await stream.readline()).decode():
        said.append(line)
        if wanted(line):
            return line
    raise RuntimeError("".join(said))


@asynccontextmanager
async def chromium() -> AsyncIterator[Browser]:
    """A headless Chromium with a profile of its own, ended at the end."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        process = await asyncio.create_subprocess_exec(
            "chromium",
            *OPTIONS,
            "--remote-debugging-port=0",
            f"--user-data-dir={profile}",
            "about:blank",
            stderr=asyncio.subprocess.PIPE,
        )
        assert process.stderr is not None
        try:
            address = (await line_with(process.stderr, lambda line: "DevTools listening on" in line)).split()[-1]
            async with _listening(address) as root:
                rest = asyncio.create_task(process.stderr.read())  # a full pipe would halt it
                yield Browser(address, root)
                rest.cancel()
        finally:
            process.terminate()
            await process.wait()
