"""The server of a session: one page and one websocket, for this machine alone.

Takes: a `Session`, a port. Gives: the page of sim/replay.html, fed with each tick as it happens, and the wishes of
whoever looks at it. Leaves alone: what wishes mean; see session.py.

It listens on 127.0.0.1 only. Its address has a token that nobody can guess; a request without it, for another host
name (DNS that was bent) or from the page of another origin is refused. One thread does everything, so that ticks and
wishes never meet. Nothing ticks while nobody looks.
"""

from __future__ import annotations

import asyncio
import html
import json
import logging
import secrets
from collections.abc import Awaitable, Callable
from http import HTTPStatus
from importlib.resources import files

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from rplan.apps.viewer.session import Session, WishError
from sim.recording import json_text
from sim.replay import template, title

HOST = "127.0.0.1"
FRAME = 0.04
"""[s] between two looks at what has happened."""
BUSY = 0.02
"""[s] that a frame may tick at most."""
LARGEST = 64 * 1024
"""Bytes of the longest wish."""
MOST_PAGES = 8


class Viewer:
    """A session with those who look at it."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.token = secrets.token_urlsafe(18)
        self.host, self.port = HOST, 0
        self._pages = 0
        self._changed = asyncio.Event()
        self._awake = asyncio.Event()

    @property
    def address(self) -> str:
        """Where to look."""
        return f"http://{HOST}:{self.port}/{self.token}/"

    # --- requests ---------------------------------------------------------------------------------

    def answer(self, _connection: ServerConnection, request: Request) -> Response | None:
        """The page, a refusal, or None: the websocket may open."""
        allowed = {f"{host}:{self.port}" for host in (HOST, "localhost")}
        if request.headers.get_all("Host") not in [[one] for one in allowed]:
            return _refusal(HTTPStatus.FORBIDDEN, "this page is for this machine alone")
        origins = request.headers.get_all("Origin")
        if any(origin not in {f"http://{one}" for one in allowed} for origin in origins):
            return _refusal(HTTPStatus.FORBIDDEN, "this page answers no other origin")
        given, _, rest = request.path.partition("?")[0].removeprefix("/").partition("/")
        if not secrets.compare_digest(given.encode(), self.token.encode()):
            return _refusal(HTTPStatus.NOT_FOUND, "there is nothing here: use the whole address that rplan view prints")
        if rest == "":
            return _response(HTTPStatus.OK, "text/html; charset=utf-8", self._page(), self.port)
        if rest != "live":
            return _refusal(HTTPStatus.NOT_FOUND, "there is nothing here")
        if not origins:
            return _refusal(HTTPStatus.FORBIDDEN, "a websocket says where it comes from")
        if self._pages >= MOST_PAGES:
            return _refusal(HTTPStatus.SERVICE_UNAVAILABLE, f"{MOST_PAGES} pages look already")
        return None

    def _page(self) -> str:
        tag = '<script type="application/octet-stream" id="data">{{data}}</script>'
        script = files("rplan.apps.viewer").joinpath("live.js").read_text(encoding="utf-8")
        page = template().replace(tag, f"<script>\n{script}</script>", 1)
        return page.replace("{{title}}", html.escape(title(self.session.header())), 1)

    # --- pages ------------------------------------------------------------------------------------

    async def attend(self, connection: ServerConnection) -> None:
        """One page, for as long as it looks."""
        self._pages += 1
        self._awake.set()
        telling = asyncio.create_task(self._tell(connection))
        try:
            async for message in connection:
                said = self._hear(message)
                if said:
                    await connection.send(json_text({"refused": said}))
                self._stir()
        except ConnectionClosed:
            pass
        finally:
            telling.cancel()
            self._pages -= 1

    def _hear(self, message: str | bytes) -> str:
        """Do what a page wishes; gives why not, "" if it is done."""
        try:
            self.session.wish(json.loads(message))
        except WishError as error:
            return str(error)
        except (ValueError, RecursionError):
            return "a wish is a JSON object"
        return ""

    async def _tell(self, connection: ServerConnection) -> None:
        session, seen, run, state = self.session, 0, 0, ""
        while True:
            changed = self._changed
            behind, more = session.ticks - seen, dict[str, object]()
            now = json_text(session.state())
            if run != session.run_number or behind > len(session.rows):
                run = session.run_number
                more = {"open": session.data(), "fixed": session.fixed()}
                message = json_text(more | {"state": session.state()})
            elif behind or now != state:
                rows = list(session.rows)[len(session.rows) - behind :]
                message = f'{{"grow":[{",".join(rows)}],"state":{now}}}'
            else:
                await changed.wait()
                continue
            seen, state = session.ticks, now
            await connection.send(message)

    def _stir(self) -> None:
        """Something has changed."""
        self._changed.set()
        self._changed = asyncio.Event()
        self._awake.set()

    # --- time -------------------------------------------------------------------------------------

    async def drive(self) -> None:
        """Tick as fast as is wished while somebody looks."""
        session, clock = self.session, asyncio.get_running_loop().time
        owed, last = 0.0, clock()
        while True:
            if not (session.wishes.running and self._pages):
                self._awake.clear()
                await self._awake.wait()
                owed, last = 0.0, clock()
                await asyncio.sleep(0)
                continue
            now = clock()
            owed, last = owed + (now - last) * session.wishes.speed / session.compiled.goals.period, now
            stepped = False
            while owed >= 1 and session.wishes.running and clock() - now < BUSY:
                stepped, owed = session.step() or stepped, owed - 1
            owed = min(owed, 1.0 + session.wishes.speed)  # what this machine cannot do is not made up for
            if stepped or not session.wishes.running:
                self._stir()
            await asyncio.sleep(FRAME)


def _refusal(status: HTTPStatus, said: str) -> Response:
    return _response(status, "text/plain; charset=utf-8", f"{said}\n", 0)


def _response(status: HTTPStatus, kind: str, body: str, port: int) -> Response:
    data = body.encode()
    policy = (
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; "
        f"connect-src ws://{HOST}:{port} ws://localhost:{port}; frame-ancestors 'none'; base-uri 'none'"
    )
    headers = {
        "Content-Type": kind,
        "Content-Length": str(len(data)),
        "Content-Security-Policy": policy,
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
        "Cache-Control": "no-store",
        "Connection": "close",
    }
    return Response(status.value, status.phrase, Headers(headers), data)


def _quiet() -> logging.Logger:
    """What the library would log goes nowhere: a refused request is no news."""
    logger = logging.getLogger("rplan.view")
    logger.addHandler(logging.NullHandler())
    logger.propagate = False
    return logger


async def watch(
    session: Session, port: int, ready: Callable[[Viewer], Awaitable[None] | None], stop: asyncio.Event
) -> None:
    """Serve the session until `stop` is set; `ready` is called once the address holds.

    port: 0 for any that is free. Raises OSError where the port is taken.
    """
    viewer = Viewer(session)
    server: Server = await serve(
        viewer.attend,
        HOST,
        port,
        process_request=viewer.answer,
        max_size=LARGEST,
        max_queue=16,
        logger=_quiet(),
        server_header=None,
        compression=None,
        close_timeout=1,
    )
    driving = asyncio.create_task(viewer.drive())
    try:
        viewer.host, viewer.port = next(iter(server.sockets)).getsockname()[:2]
        waiting = ready(viewer)
        if waiting is not None:
            await waiting
        stopped = asyncio.create_task(stop.wait())
        await asyncio.wait({stopped, driving}, return_when=asyncio.FIRST_COMPLETED)
        stopped.cancel()
        if driving.done():
            driving.result()
    finally:
        driving.cancel()
        server.close()
        await server.wait_closed()
        session.close()
