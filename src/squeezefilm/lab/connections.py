"""Connections that do not hang, and what is on its way to an open page.

uvicorn has a limit for idle connections after an answer, none for a request that never ends: here a
request not whole within ten seconds is cut off. A websocket leaves this protocol when it opens, so
its silence is not limited here; it is closed with a reason that the page can show, also where the
page reads nothing any more. Each page has a bounded queue, written by a task of its own: nobody who
tells all pages something waits for one of them.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import h11
from starlette.websockets import WebSocket, WebSocketDisconnect
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.http11 import Request

from squeezefilm.core import quantities as si

SLOWEST_REQUEST: si.Second = 10.0
CLOSE = "squeezefilm.close"
"""The name in a websocket's scope, below its extensions, of its `PageProtocol.refuse`."""
_LAST_WORD: si.Second = 2.0
_NO_TEXT = "a message that is not UTF-8 text"


class TimedProtocol(H11Protocol):
    """uvicorn's HTTP protocol with a deadline from the first byte (or none) to a whole request."""

    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: Any) -> None:
        """Start the clock."""
        super().connection_made(transport)
        self._start_clock()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop the clock."""
        self._stop_clock()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Read; bytes of a next request on a kept connection start the clock again."""
        if self._deadline is None and not self._answering():
            self._start_clock()
        super().data_received(data)

    def handle_events(self) -> None:
        """Act on what was read; what is being answered has no deadline here any more."""
        super().handle_events()
        if self._answering():
            self._stop_clock()

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Hand the connection to the websocket's own protocol, which has its own limits."""
        self._stop_clock()
        super().handle_websocket_upgrade(event)

    def _answering(self) -> bool:
        return self.cycle is not None and not self.cycle.response_complete

    def _start_clock(self) -> None:
        self._deadline = self.loop.call_later(SLOWEST_REQUEST, self._cut_off)

    def _stop_clock(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _cut_off(self) -> None:
        self._deadline = None
        if self.transport is not None and not self.transport.is_closing():
            self.transport.abort()


class PageProtocol(WebSocketsSansIOProtocol):
    """uvicorn's websocket, which closes with a reason and waits for no page that does not read."""

    def handle_connect(self, event: Request) -> None:
        """Begin; whoever answers may close it at once by what the scope holds."""
        super().handle_connect(event)
        if self.response.status_code == 101:
            extensions: dict[str, Any] = self.scope["extensions"]
            extensions[CLOSE] = self.refuse

    def send_receive_event_to_app(self) -> None:
        """Hand a whole message on; one that is no text is refused, without a traceback."""
        if self.curr_msg_data_type == "text":
            try:
                b"".join(self.frames).decode()
            except UnicodeDecodeError:
                self.refuse(1007, _NO_TEXT)
                return
        super().send_receive_event_to_app()

    def keepalive_timeout(self) -> None:
        """End a page that answered no ping."""
        self.pong_timer = None
        self.refuse(1011, "the page did not answer")

    def shutdown(self) -> None:
        """Close as the server ends; for no page longer than a moment."""
        super().shutdown()
        self.loop.call_later(_LAST_WORD, self.transport.abort)

    def refuse(self, code: int, reason: str) -> None:
        """Close with a reason; what the page has not read two seconds later is dropped."""
        if self.transport.is_closing():
            return
        if not self.close_sent:
            self.queue.put_nowait({"type": "websocket.disconnect", "code": code, "reason": reason})
            self.conn.send_close(code, reason)
            self.transport.write(b"".join(self.conn.data_to_send()))
            self.close_sent = True
        self.loop.call_later(_LAST_WORD, self.transport.abort)


MOST_UNREAD = 256
"""Messages that may wait for one page."""
SLOWEST_PAGE: si.Second = 10.0
"""Longest time for a page to take one message."""
BEAT: si.Second = 0.5
"""A page that there is nothing to tell hears so often that the lab is alive."""
Message = dict[str, Any]
_ALIVE = '{"type":"alive"}'
_TOO_SLOW = "this page did not read what the lab said to it; reload it"


class OpenPage:
    """A page and the messages on their way to it."""

    def __init__(self, page: WebSocket) -> None:
        self.is_participant = page.url.path == "/ws/participant"
        self._page = page
        self._unread: asyncio.Queue[str] = asyncio.Queue(MOST_UNREAD)
        self._writer = asyncio.get_running_loop().create_task(self._write())

    def say(self, text: str) -> None:
        """Send a message, in its turn; a page with too many that it did not read is dropped."""
        try:
            self._unread.put_nowait(text)
        except asyncio.QueueFull:
            self.drop()

    def drop(self) -> None:
        """Close the page with the reason, whether it reads or not."""
        self._writer.cancel()
        self.refuse(1013, _TOO_SLOW)

    def refuse(self, code: int, reason: str) -> None:
        """Close the page with a websocket's code and the reason in words."""
        close: Callable[[int, str], None] = self._page.scope["extensions"][CLOSE]
        close(code, reason)

    def close(self) -> None:
        """The page is gone: nothing more is written."""
        self._writer.cancel()

    async def _next(self) -> str:
        try:
            async with asyncio.timeout(BEAT):
                return await self._unread.get()
        except TimeoutError:
            return _ALIVE

    async def _write(self) -> None:
        try:
            while True:
                text = await self._next()
                async with asyncio.timeout(SLOWEST_PAGE):
                    await self._page.send_text(text)
        except TimeoutError:
            self.drop()
        except (RuntimeError, WebSocketDisconnect):
            # It closed meanwhile; whoever reads from it hears that too.
            return


@dataclass(frozen=True, slots=True)
class _Stoppable:
    text: str
    plays: bool
    stop: Callable[[], None]


class NowPlaying:
    """Things that play or may play, each by a key, with how it is stopped.

    `tell` sends a message to the experimenters' pages; they are told of every change. Its methods
    are called on the server's loop.
    """

    def __init__(self, tell: Callable[[Message], None]) -> None:
        self._tell = tell
        self._held: dict[str, _Stoppable] = {}

    def note(self, key: str, text: str, stop: Callable[[], None], *, plays: bool) -> None:
        """`text` names what plays, or where `plays` is false may begin to at any moment.

        `stop` silences it and returns at once.
        """
        before = self._held.get(key)
        self._held[key] = _Stoppable(text, plays, stop)
        if before is None or before.plays is not plays:
            self._changed()

    def forget(self, key: str) -> None:
        """Forget what cannot play any more."""
        if self._held.pop(key, None) is not None:
            self._changed()

    def stop(self) -> None:
        """Silence everything; whoever holds it notes when it is silent."""
        for playing in list(self._held.values()):
            playing.stop()

    def message(self) -> Message:
        """Message that a page gets."""
        now = [
            {"key": key, "text": held.text, "plays": held.plays} for key, held in self._held.items()
        ]
        return {"type": "playing", "now": now}

    def _changed(self) -> None:
        self._tell(self.message())
