"""Who is let in at a listener: no silent stranger keeps anybody out, no page waits for another."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import json
import logging
import socket
import ssl
from collections.abc import AsyncIterator, Callable, Coroutine
from pathlib import Path
from typing import Any

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed
from websockets.typing import Origin

from squeezefilm.lab import connections
from squeezefilm.lab import door as doors
from squeezefilm.lab.door import Connection, Door, room_for
from squeezefilm.lab.guard import Keys, Places
from squeezefilm.lab.lan import certificate
from squeezefilm.lab.server import Lab, UnheardServer, listening_socket, server_of

ADDRESSES = ("127.0.0.2", "127.0.0.3", "127.0.0.4")


def play(work: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(work, 60))


async def until(condition: Callable[[], bool]) -> None:
    while not condition():
        await asyncio.sleep(0.005)


class Silent(asyncio.Protocol):
    """Says nothing; ends when the other side does."""


class Visitor(socket.socket):
    """A connection that says nothing."""

    async def hears(self) -> bytes:
        """What comes next; nothing at its end, also where it was torn off."""
        with contextlib.suppress(ConnectionError):
            return await asyncio.get_running_loop().sock_recv(self, 1000)
        return b""

    @property
    def has_ended(self) -> bool:
        try:
            return self.recv(1) == b""
        except BlockingIOError:
            return False


class Visits:
    """A door, and those who come to it from addresses of this computer."""

    def __init__(self, listener: socket.socket, limits: dict[str, Any]) -> None:
        self.port = listener.getsockname()[1]
        self.door = Door(listener, lambda _: Silent(), **limits)
        self.visitors: list[Visitor] = []

    async def comes(self, address: str = "127.0.0.1") -> Visitor:
        visitor = Visitor()
        self.visitors.append(visitor)
        visitor.setblocking(False)
        visitor.bind((address, 0))
        await asyncio.get_running_loop().sock_connect(visitor, ("127.0.0.1", self.port))
        return visitor

    async def open(self, count: int) -> list[Connection]:
        """The door's connections, once there are as many."""
        await until(lambda: len(self.door.open) == count)
        return self.door.open


@contextlib.asynccontextmanager
async def door_of(**limits: Any) -> AsyncIterator[Visits]:
    with listening_socket(8900) as listener:
        visits = Visits(listener, limits)
        try:
            yield visits
        finally:
            visits.door.close()
            for one in visits.visitors:
                one.close()
            await visits.open(0)


def test_a_newcomer_takes_the_place_of_the_oldest_stranger_of_who_has_most() -> None:
    async def work() -> None:
        async with door_of(most=9) as at:
            crowd = [await at.comes(ADDRESSES[0]) for _ in range(2)]
            await at.open(2)
            lone = await at.comes(ADDRESSES[1])
            await at.open(3)
            for k in range(2):
                crowd.append(await at.comes(ADDRESSES[2]))
                assert await crowd[k].hears() == b""
            assert not lone.has_ended
            assert {one.address for one in await at.open(3)} == {ADDRESSES[1], ADDRESSES[2]}

    play(work())


def test_those_who_are_in_keep_their_places() -> None:
    async def work() -> None:
        async with door_of(most=6, most_of_address=4) as at:
            inside = []
            for k in range(6):
                inside.append(await at.comes(ADDRESSES[k % 2]))
                for one in await at.open(k + 1):
                    one.is_stranger = False
            before = at.door.open
            # The door is full of those who are in: whoever comes is refused.
            assert await (await at.comes(ADDRESSES[2])).hears() == b""
            inside.pop(0).close()
            await at.open(5)
            # Now there is one place again, for three strangers one after the other.
            strangers = [await at.comes(ADDRESSES[2]) for _ in range(3)]
            assert [await one.hears() for one in strangers[:2]] == [b"", b""]
            assert (await at.open(6))[:5] == before[1:]
            assert not any(one.has_ended for one in [*inside, strangers[2]])

    play(work())


def test_one_address_has_a_few_connections() -> None:
    async def work() -> None:
        async with door_of(most_of_address=4) as at:
            for _ in range(12):
                await at.comes(ADDRESSES[0])
            other = await at.comes(ADDRESSES[1])
            for one in await at.open(5):
                one.is_stranger = False
            assert at.door.refused == 8
            assert await (await at.comes(ADDRESSES[0])).hears() == b""
            assert not other.has_ended

    play(work())


def test_a_handshake_has_a_deadline(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert doors.SLOWEST_HANDSHAKE <= 5.0
    monkeypatch.setattr(doors, "SLOWEST_HANDSHAKE", 0.05)
    file = tmp_path / "key.pem"
    certificate("127.0.0.1", file)
    tls = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    tls.load_cert_chain(file)

    async def work() -> None:
        async with door_of(tls=tls) as at:
            for words in (b"", b"\x16\x03\x01", b"GET / HTTP/1.1\r\n\r\n"):
                visitor = await at.comes()
                visitor.send(words)
                while await visitor.hears():
                    pass
                await at.open(0)

    play(work())


def test_without_a_descriptor_the_door_waits_and_ends_a_stranger(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(doors, "_RETRY", 0.01)
    asked = 0

    async def work() -> None:
        nonlocal asked
        async with door_of() as at:
            stranger = await at.comes()
            await at.open(1)
            loop = asyncio.get_running_loop()
            accept = loop.sock_accept

            async def none_left(listener: socket.socket) -> Any:
                nonlocal asked
                asked += 1
                if asked <= 5:
                    raise OSError(errno.EMFILE, "Too many open files")
                return await accept(listener)

            monkeypatch.setattr(loop, "sock_accept", none_left)
            # The door waits in the accept that it began with.
            first = await at.comes()
            assert await stranger.hears() == b""
            assert await first.hears() == b""
            await at.comes()
            await at.open(1)

    with caplog.at_level(logging.WARNING, "squeezefilm.lab"):
        play(work())
    assert 6 <= asked <= 8
    assert len(caplog.records) == 1


def test_doors_leave_descriptors_for_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    resource = pytest.importorskip("resource")
    limits = [64, 1024]
    monkeypatch.setattr(resource, "getrlimit", lambda _: tuple(limits))

    def refused(*_: object) -> None:
        raise ValueError

    for soft, hard, room in ((64, 4096, 180), (256, 400, 120), (1024, 1024, 180), (64, 64, 16)):
        limits[:] = soft, hard
        monkeypatch.setattr(resource, "setrlimit", lambda _, new: limits.__setitem__(0, new[0]))
        assert room_for(2) == room
        assert limits[0] <= hard
    limits[:] = 256, 4096
    monkeypatch.setattr(resource, "setrlimit", refused)
    assert room_for(2) == 48


class Served:
    """A lab served within the test's own event loop."""

    def __init__(self, folder: Path) -> None:
        self.listener = listening_socket(8930)
        self.port = int(self.listener.getsockname()[1])
        own = f"127.0.0.1:{self.port}"
        self.lab = Lab(folder, Keys(), Places(frozenset({own}), cookie="c"))
        self.server: UnheardServer = server_of(self.lab)
        entered = self.lab.keys.use_link(self.lab.keys.new_link())
        assert entered
        self.cookie = f"c={entered[0].secret}"
        # These pages compute nothing.
        self.lab.quick.begin = lambda: None  # type: ignore[method-assign]

    async def __aenter__(self) -> Served:
        self.task = asyncio.create_task(self.server.serve([self.listener]))
        await until(lambda: self.server.started)
        return self

    async def __aexit__(self, *_: object) -> None:
        self.server.should_exit = True
        await self.task
        assert not self.server.server_state.connections

    def page(self, path: str = "/ws", **options: Any) -> connect:
        own = f"127.0.0.1:{self.port}"
        return connect(
            f"ws://{own}{path}", origin=Origin(f"http://{own}"), max_size=None, compression=None,
            additional_headers={"Cookie": self.cookie}, **options,
        )  # fmt: skip

    async def closed(self, page: ClientConnection) -> tuple[int, str]:
        """Code and reason with which a page was closed."""
        with contextlib.suppress(ConnectionClosed):
            while True:
                await page.recv()
        assert page.close_code is not None
        return page.close_code, str(page.close_reason)


def test_an_accepted_connection_is_told_so_itself() -> None:
    # On Linux asyncio finds the protocol out for itself, elsewhere it does not.
    gone: list[Connection] = []
    with listening_socket(8920) as listener, socket.create_connection(listener.getsockname()):
        accepted, (address, _) = listener.accept()
        connection = Connection(accepted, address, gone.append)
        assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
        connection.close()
    assert gone == [connection]


def test_what_is_written_goes_out_at_once(tmp_path: Path) -> None:
    async def work() -> None:
        async with Served(tmp_path) as served, served.page():
            [door] = served.server.doors
            [connection] = door.open
            assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
            assert isinstance(connection, Connection)
            # Who has a session is no stranger.
            assert not connection.is_stranger
            with socket.create_connection(("127.0.0.1", served.port)):
                await until(lambda: len(door.open) == 2)
                assert door.open[1].is_stranger

    play(work())


def test_a_page_may_be_silent_for_longer_than_a_request_may_take(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "SLOWEST_REQUEST", 0.15)

    async def work() -> None:
        async with Served(tmp_path) as served, served.page() as page:

            async def answer() -> dict[str, Any]:
                return {"type": "here"}

            served.lab.experimenter.add("ask", answer)
            await asyncio.sleep(0.5)
            await page.send(json.dumps({"id": 1, "type": "ask"}))
            said = [json.loads(await page.recv())["type"]]
            while said[-1] == "alive":
                said.append(json.loads(await page.recv())["type"])
            assert said[-1] == "here"
            # Who has not asked for anything by then is cut off.
            with socket.create_connection(("127.0.0.1", served.port)) as silent:
                silent.setblocking(False)
                end = await asyncio.get_running_loop().sock_recv(silent, 10)
                assert end == b""

    play(work())


@pytest.mark.parametrize("kind", ["told", "asks"])
def test_a_page_that_does_not_read_is_dropped_and_delays_nobody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    # Each by one of the two reasons for which a page is dropped.
    monkeypatch.setattr(connections, "SLOWEST_PAGE", 0.2 if kind == "asks" else 600.0)
    monkeypatch.setattr(connections, "MOST_UNREAD", 10**6 if kind == "asks" else 64)
    large = "x" * 200_000

    async def work() -> None:
        async with Served(tmp_path) as served, served.page() as good, served.page() as bad:
            lab = served.lab

            async def answer() -> dict[str, Any]:
                lab.tell({"type": "told", "text": large if kind == "told" else ""})
                return {"type": "answered", "text": large if kind == "asks" else ""}

            lab.experimenter.add("ask", answer)
            await until(lambda: len(lab.pages) == 2)
            # This client stops reading from its socket after some messages of its own accord.
            told = 0
            for number in range(1000):
                if len(lab.pages) < 2:
                    break
                if kind == "asks" and number < 60:
                    await bad.send(json.dumps({"id": 1, "type": "ask"}))
                await good.send(json.dumps({"id": number, "type": "ask"}))
                while (message := json.loads(await good.recv()))["type"] == "told":
                    told += 1
                assert message["type"] == "answered"
            assert len(lab.pages) == 1
            assert told > 0
            code, reason = await served.closed(bad)
            assert code == 1013
            assert "did not read" in reason

    play(work())


@pytest.mark.parametrize(
    ("frame", "code", "words"),
    [(b"\xff\xfe", 1007, "not UTF-8"), (b"{", 1003, "not text")],
)
def test_what_is_no_text_is_refused_with_words(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, frame: bytes, code: int, words: str
) -> None:
    async def work() -> None:
        async with Served(tmp_path) as served:
            for split in (False, True):
                async with served.page() as page:
                    await page.send([frame[:1], frame[1:]] if split else frame, text=code == 1007)
                    found, reason = await served.closed(page)
                    assert found == code
                    assert words in reason
            async with served.page() as page:
                await page.send('{"id": 1, "type": "?"}')
                assert json.loads(await page.recv())["type"] == "error"

    play(work())
    assert not caplog.records


def test_a_page_that_asks_without_end_is_closed_with_words(tmp_path: Path) -> None:
    async def work() -> None:
        async with Served(tmp_path) as served, served.page() as page:

            async def never() -> dict[str, Any]:
                await asyncio.sleep(3600)
                return {}

            served.lab.experimenter.add("never", never)
            for number in range(65):
                await page.send(json.dumps({"id": number, "type": "never"}))
            assert await served.closed(page) == (
                1008,
                "more than 64 requests at once, which no page makes",
            )

    play(work())


def test_a_participant_s_message_is_short(tmp_path: Path) -> None:
    async def work() -> None:
        async with Served(tmp_path) as served, served.page("/ws/participant") as page:
            await page.send('{"id": 1, "type": "' + "x" * 70_000 + '"}')
            assert "at most 65536" in json.loads(await page.recv())["message"]

    play(work())
