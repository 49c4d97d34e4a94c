"""The lab's server: pages, one websocket a page, and a clean end."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import os
import socket
from collections.abc import AsyncIterator, Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.websockets import WebSocket

from squeezefilm.core.errors import InputError
from squeezefilm.lab.connections import NowPlaying, OpenPage, PageProtocol, TimedProtocol
from squeezefilm.lab.door import Connection, Door
from squeezefilm.lab.guard import CONNECTION, Guard, Keys, Places
from squeezefilm.lab.wire import LARGEST_FROM_PARTICIPANT, LARGEST_MESSAGE, Dispatcher, as_text
from squeezefilm.lab.worker import PAGE, Busy, SupersededError
from squeezefilm.physics import render

if TYPE_CHECKING:
    from starlette.types import ASGIApp


STATIC = Path(__file__).parent / "static"
RENDERER = Path(render.__file__).parent / "static" / "renderer.js"
PORT = 8631
_KINDS = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
    ".json": "application/json",
    ".txt": "text/plain; charset=utf-8",
}
MOST_WAITING = 64
"""Messages of one page being answered at once; more is no page of ours."""


@dataclass(frozen=True, slots=True)
class LanPlace:
    """Place where tablets reach the lab: its address as a link, its certificate's fingerprint."""

    link: str
    fingerprint: str


@dataclass(slots=True)
class Lab:
    """A running lab: where its files lie, its keys, who answers what.

    `quick` computes what a drag asks for, `slow` what takes seconds.
    `left` is called with each page that went away, `closing` when the lab ends.
    `lan` says where tablets reach it; None where they were not asked for.
    """

    folder: Path
    keys: Keys
    places: Places
    experimenter: Dispatcher = field(default_factory=Dispatcher)
    participant: Dispatcher = field(default_factory=lambda: Dispatcher(LARGEST_FROM_PARTICIPANT))
    # Long enough for what is compiled when it is asked for the first time.
    quick: Busy = field(default_factory=lambda: Busy(120.0))
    slow: Busy = field(default_factory=lambda: Busy(600.0))
    pages: dict[WebSocket, OpenPage] = field(default_factory=dict)
    closing: list[Callable[[], None]] = field(default_factory=list)
    left: list[Callable[[WebSocket], None]] = field(default_factory=list)
    lan: LanPlace | None = None
    playing: NowPlaying = field(init=False)

    def __post_init__(self) -> None:
        self.playing = NowPlaying(self.tell)

    def tell(self, message: dict[str, Any], *, participants: bool = False) -> None:
        """Send a message that nobody asked for to every open page of a kind; waits for none."""
        text = as_text(message)
        for page in list(self.pages.values()):
            if page.is_participant == participants:
                page.say(text)

    def cancel(self, page: WebSocket | None) -> None:
        """End a page's work that gives way."""
        self.quick.cancel(page)
        self.slow.cancel(page)

    def close(self) -> None:
        """Stop what runs: devices, searches, and what is computed."""
        for close in self.closing:
            close()
        self.quick.close()
        self.slow.close()


def application(lab: Lab) -> Guard:
    """The ASGI application of a lab, behind its guard."""

    async def page(_: Request) -> Response:
        return page_file("index.html")

    async def port_of_the_renderer(_: Request) -> Response:
        return _file(RENDERER)

    async def another(request: Request) -> Response:
        token = lab.keys.new_link("experimenter")
        return PlainTextResponse(f"/?token={token}")

    @contextlib.asynccontextmanager
    async def life(_: Starlette) -> AsyncIterator[None]:
        yield
        lab.close()

    app = Starlette(
        routes=[
            Route("/", page),
            Route("/static/renderer.js", port_of_the_renderer),
            Route("/another-station", another, methods=["POST"]),
            WebSocketRoute("/ws", lambda socket: converse(lab, lab.experimenter, socket)),
            *station_routes(lab),
        ],
        lifespan=life,
    )
    app.state.lab = lab
    return Guard(app, lab.keys, lab.places)


def station_routes(lab: Lab) -> list[BaseRoute]:
    """Routes that a participant's station may reach: its page, static files, its messages."""

    async def page(_: Request) -> Response:
        return page_file("participant.html")

    async def static(request: Request) -> Response:
        return static_file(STATIC, request.path_params["path"])

    return [
        Route("/participant", page),
        Route("/static/{path:path}", static),
        WebSocketRoute("/ws/participant", lambda socket: converse(lab, lab.participant, socket)),
    ]


def page_file(name: str) -> Response:
    """Response with one of the lab's pages."""
    return _file(STATIC / name)


def static_file(folder: Path, name: str) -> Response:
    """A file below a folder; 404 for anything else, links and climbing paths included."""
    wanted = folder / name
    try:
        real = wanted.resolve(strict=True)
    except (OSError, ValueError, RuntimeError):
        return PlainTextResponse("There is no such file.", 404)
    if not is_named(real, folder.resolve(), name) or not real.is_file():
        return PlainTextResponse("There is no such file.", 404)
    return _file(real)


def is_named(real: PurePath, folder: PurePath, name: str) -> bool:
    """True where a resolved path is the one below a resolved folder that an address names.

    A name with a slash at its end, with a backslash, or one that a link leads elsewhere is not.
    """
    return real.is_relative_to(folder) and real.relative_to(folder).as_posix() == name


def _file(path: Path) -> Response:
    kind = _KINDS.get(path.suffix)
    if kind is None:
        return PlainTextResponse("There is no such file.", 404)
    return FileResponse(path, media_type=kind)


async def converse(lab: Lab, dispatcher: Dispatcher, page: WebSocket) -> None:
    """Answer one page's messages, each as it is ready, until the page goes."""
    await page.accept()
    line = lab.pages[page] = OpenPage(page)
    PAGE.set(page)
    if not line.is_participant:
        lab.quick.begin()
    waiting: set[asyncio.Task[None]] = set()

    async def one(text: str) -> None:
        try:
            answer = await dispatcher.answer(text)
        except SupersededError as error:
            answer = {"id": error.number, "type": "error", "message": "newer work took its place"}
        line.say(as_text(answer))

    try:
        while (message := await page.receive())["type"] == "websocket.receive":
            text = message.get("text")
            if text is None:
                line.refuse(1003, "a message that is not text, which no page of the lab sends")
                continue
            if len(waiting) >= MOST_WAITING:
                line.refuse(1008, f"more than {MOST_WAITING} requests at once, which no page makes")
                continue
            task = asyncio.create_task(one(text))
            waiting.add(task)
            task.add_done_callback(waiting.discard)
    finally:
        del lab.pages[page]
        line.close()
        for told in lab.left:
            told(page)
        for task in waiting:
            task.cancel()
        lab.cancel(page)


def listening_socket(port: int, host: str = "127.0.0.1") -> socket.socket:
    """A socket bound to this computer only; the next free port where `port` is taken.

    Raises:
        InputError: no port within twenty of the wanted one is free.
        OSError: `host` is no address of this computer.
    """
    for candidate in range(port, port + 20):
        listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        if os.name == "posix":
            # Elsewhere this would let two labs have one port.
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((host, candidate))
            # A browser that is faster than the server's start waits here and is not refused.
            listener.listen()
        except OSError as error:
            listener.close()
            if error.errno == errno.EADDRNOTAVAIL:
                raise
            continue
        return listener
    raise InputError(
        f"ports {port} to {port + 19} of {host} are all in use; say another port, or stop "
        "what uses them"
    )


class UnheardServer(uvicorn.Server):
    """A server that leaves signals to who runs it: several run side by side in one process.

    At each of its listeners a `door` lets in.
    """

    def __init__(self, config: uvicorn.Config, door: Callable[..., Door]) -> None:
        super().__init__(config)
        self.doors: list[Door] = []
        self._door = door

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Capture none."""
        yield

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin, and let in at doors of our own what comes to the listeners."""
        await super().startup([])
        for listener in sockets or []:
            self.doors.append(self._door(listener, self._serving, tls=self.config.ssl))

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Let nobody in any more, and end."""
        for door in self.doors:
            door.close()
        await super().shutdown(sockets)

    def _serving(self, connection: Connection) -> asyncio.Protocol:
        state = {**self.lifespan.state, CONNECTION: connection}
        return TimedProtocol(config=self.config, server_state=self.server_state, app_state=state)


def server_of(
    lab: Lab, app: ASGIApp | None = None, *, door: Callable[..., Door] = Door, **extra: Any
) -> UnheardServer:
    """A uvicorn server for a lab, with its limits; `extra` goes to uvicorn's configuration.

    `app` is served instead of the lab's own application, `door` is made for each listener.
    """
    config = uvicorn.Config(
        app or application(lab),
        http=TimedProtocol,
        ws=PageProtocol,
        proxy_headers=False,
        ws_max_size=LARGEST_MESSAGE,
        ws_ping_interval=20.0,
        ws_ping_timeout=20.0,
        timeout_keep_alive=10,
        timeout_graceful_shutdown=3,
        limit_concurrency=200,
        h11_max_incomplete_event_size=32 * 1024,
        log_level="error",
        access_log=False,
        server_header=False,
        **extra,
    )
    return UnheardServer(config, door)
