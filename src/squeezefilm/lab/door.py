"""The door of a listener: who may be connected, how many at once, and how long to say hello.

asyncio's own server takes every connection, gives each a minute for its TLS handshake, and where
descriptors run out writes a traceback for each of the backlog. Here strangers, whose session nobody
has seen yet, are few: a newcomer takes the place of the oldest stranger of the address that has
most, so that silent connections keep nobody out, and none takes a place from those who are in.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
import time
from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si

if TYPE_CHECKING:
    import ssl

MOST_OPEN = 180
"""Connections of one listener at once; one page has up to seven."""
MOST_OF_ADDRESS = 32
"""Connections that one tablet may have at once."""
SLOWEST_HANDSHAKE: si.Second = 5.0
"""Longest time of a whole TLS handshake."""

_RESERVED = 160  # descriptors for files, databases, devices and the processes that compute
_FEWEST = 16
_RETRY: si.Second = 0.2
_QUIET: si.Second = 60.0  # between two lines in the log
_LOG = logging.getLogger("squeezefilm.lab")


class Connection(socket.socket):
    """An accepted connection; the door hears when it is closed, by whomever."""

    def __init__(
        self, accepted: socket.socket, address: str, closed: Callable[[Connection], None]
    ) -> None:
        super().__init__(fileno=accepted.detach())
        self.address = address
        self.is_stranger = True
        self._gone = closed
        # asyncio does so only where the system tells it the protocol of an accepted socket.
        self.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def close(self) -> None:
        """Close it and tell the door."""
        super().close()
        self._gone(self)

    def cut_off(self) -> None:
        """End it from below: whoever reads from it finds its end, and closes it."""
        with contextlib.suppress(OSError):
            self.shutdown(socket.SHUT_RDWR)


class Door:
    """Door for what comes to a listener, within its limits; `protocol` serves a connection.

    Args:
        most: connections at once; a third of them may be strangers.
        most_of_address: connections of one address at once.
        tls: its context, where connections are encrypted.
    """

    def __init__(
        self,
        listener: socket.socket,
        protocol: Callable[[Connection], asyncio.Protocol],
        *,
        most: int = MOST_OPEN,
        most_of_address: int = MOST_OPEN,
        tls: ssl.SSLContext | None = None,
    ) -> None:
        self.refused = 0
        self._listener = listener
        self._protocol = protocol
        self._most, self._most_of_address = most, most_of_address
        self._tls = tls
        # In the order they came in.
        self._open: dict[Connection, None] = {}
        self._beginning: dict[asyncio.Task[None], Connection] = {}
        self._spoke = -_QUIET
        listener.setblocking(False)
        self._keeper = asyncio.get_running_loop().create_task(self._keep())

    @property
    def open(self) -> list[Connection]:
        """The connections that are open now, the oldest first."""
        return list(self._open)

    def close(self) -> None:
        """Accept no more, and end what has not begun; the listener stays open."""
        self._keeper.cancel()
        for handshake in self._beginning:
            handshake.cancel()

    async def _keep(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                accepted, (address, *_) = await loop.sock_accept(self._listener)
            except OSError as error:
                # Gone before it was accepted, or no descriptor is left: that of a stranger will be.
                self._refuse(f"a connection could not be accepted ({error.strerror})")
                self._end_stranger(self._strangers())
                await asyncio.sleep(_RETRY)
                continue
            if not self._has_room(address):
                accepted.close()
                self._refuse(f"{address} has {self._most_of_address} connections, or all are taken")
                continue
            connection = Connection(accepted, address, self._forget)
            self._open[connection] = None
            task = loop.create_task(self._begin(connection))
            self._beginning[task] = connection
            task.add_done_callback(self._begun)

    async def _begin(self, connection: Connection) -> None:
        # A handshake that fails or takes too long, or a connection that is gone already.
        with contextlib.suppress(OSError):
            await asyncio.get_running_loop().connect_accepted_socket(
                lambda: self._protocol(connection),
                connection,
                ssl=self._tls,
                ssl_handshake_timeout=None if self._tls is None else SLOWEST_HANDSHAKE,
            )

    def _begun(self, task: asyncio.Task[None]) -> None:
        connection = self._beginning.pop(task)
        if task.cancelled():
            # It may not even have begun to begin.
            connection.close()

    def _has_room(self, address: str) -> bool:
        """True where a newcomer may stay; a stranger may have had to go for it."""
        own = [connection for connection in self._open if connection.address == address]
        if len(own) >= self._most_of_address:
            return self._end_stranger([connection for connection in own if connection.is_stranger])
        strangers = self._strangers()
        if len(self._open) >= self._most or len(strangers) >= self._most // 3:
            return self._end_stranger(strangers)
        return True

    def _strangers(self) -> list[Connection]:
        return [connection for connection in self._open if connection.is_stranger]

    def _end_stranger(self, strangers: list[Connection]) -> bool:
        if not strangers:
            return False
        [(crowded, _)] = Counter(stranger.address for stranger in strangers).most_common(1)
        oldest = next(stranger for stranger in strangers if stranger.address == crowded)
        self._forget(oldest)
        oldest.cut_off()
        self._refuse(f"{crowded} has {len(strangers)} connections that say nothing")
        return True

    def _forget(self, connection: Connection) -> None:
        self._open.pop(connection, None)

    def _refuse(self, why: str) -> None:
        """Count it; say so in the log, but not for each."""
        self.refused += 1
        now = time.monotonic()
        if now - self._spoke >= _QUIET:
            self._spoke = now
            _LOG.warning("%d connections were refused so far; the last: %s", self.refused, why)


def room_for(doors: int) -> int:
    """Number of connections that each of a number of doors may have, by the descriptors there are.

    The limit on descriptors is raised where it is too low for all and the system lets us.
    """
    try:
        import resource
    except ImportError:
        # Windows has no such limit.
        return MOST_OPEN
    wanted = doors * MOST_OPEN + _RESERVED
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        raised = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        with contextlib.suppress(OSError, ValueError):
            resource.setrlimit(resource.RLIMIT_NOFILE, (raised, hard))
            soft = raised
        return min(MOST_OPEN, max(_FEWEST, (soft - _RESERVED) // doors))
    return MOST_OPEN
