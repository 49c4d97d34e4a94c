"""What is on its way to an open page, and what plays, which every page's stop bar shows and stops.

Each page has a bounded queue, written by a task of its own. Nobody who tells all pages something
waits for one of them; a page that does not read is dropped.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from squeezefilm.core import quantities as si
from squeezefilm.lab.connections import CLOSE

MOST_UNREAD = 256
"""Messages that may wait for one page."""
SLOWEST_PAGE: si.Second = 10.0
"""For a page to take one message."""
BEAT: si.Second = 0.5
"""A page that there is nothing to tell hears so often that the lab is alive."""
Message = dict[str, Any]
_ALIVE = '{"type":"alive"}'
_TOO_SLOW = "this page did not read what the lab said to it; reload it"


class OpenPage:
    """One page and the messages on their way to it."""

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
class _Held:
    text: str
    plays: bool
    stop: Callable[[], None]


class Playing:
    """What plays or may play, each by a key, with how it is stopped.

    `tell` sends a message to the experimenters' pages; they are told of every change. Its methods
    are called on the server's loop.
    """

    def __init__(self, tell: Callable[[Message], None]) -> None:
        self._tell = tell
        self._held: dict[str, _Held] = {}

    def note(self, key: str, text: str, stop: Callable[[], None], *, plays: bool) -> None:
        """`text` names what plays, or where `plays` is false may begin to at any moment.

        `stop` silences it and returns at once.
        """
        before = self._held.get(key)
        self._held[key] = _Held(text, plays, stop)
        if before is None or before.plays is not plays:
            self._changed()

    def forget(self, key: str) -> None:
        """It cannot play any more."""
        if self._held.pop(key, None) is not None:
            self._changed()

    def stop(self) -> None:
        """Silence everything; whoever holds it notes when it is silent."""
        for one in list(self._held.values()):
            one.stop()

    def message(self) -> Message:
        """What a page is told."""
        now = [
            {"key": key, "text": one.text, "plays": one.plays} for key, one in self._held.items()
        ]
        return {"type": "playing", "now": now}

    def _changed(self) -> None:
        self._tell(self.message())
