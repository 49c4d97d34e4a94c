"""The lab's server under malformed, endless and foreign connections: none hangs, memory stays."""

import asyncio
import contextlib
import os
import random
import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from squeezefilm.lab.connections import SLOWEST_REQUEST

PROGRAM = (
    "import sys; from pathlib import Path; from squeezefilm.lab.serve import serve; "
    "serve(Path(sys.argv[1]), port=int(sys.argv[2]), browser=False, "
    "say=lambda text: print(text, flush=True))"
)


class Served:
    def __init__(self, folder: Path, port: int) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM, str(folder), str(port)],
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/\?token=(\S+)", line)
        assert found, line
        self.port, self.token = int(found[1]), found[2]

    @property
    def memory(self) -> int:
        """Bytes the server holds."""
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * resource.getpagesize()

    @property
    def files(self) -> int:
        """Open descriptors of the server."""
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))  # noqa: PTH208


@pytest.fixture
def served(tmp_path):
    one = Served(tmp_path / "lab", 8700 + random.randrange(800))
    for _ in range(100):
        try:
            asyncio.run(_talk(one.port, b"GET / HTTP/1.1\r\n\r\n"))
            break
        except ConnectionError:
            time.sleep(0.05)
    yield one
    one.process.send_signal(signal.SIGINT)
    assert one.process.wait(20) == 0
    one.process.stdout.close()
    assert not list((tmp_path / "lab").glob(".lab-*.keys"))


async def _talk(port: int, data: bytes, close: bool = True) -> bytes:
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    try:
        writer.write(data)
        await writer.drain()
        if close and writer.can_write_eof():
            writer.write_eof()
        return await reader.read(65536)
    finally:
        writer.close()
        with contextlib.suppress(ConnectionError):
            await writer.wait_closed()


def _garbage(rng: random.Random, port: int) -> tuple[bytes, bool]:
    host = f"Host: 127.0.0.1:{port}\r\n".encode()
    upgrade = (
        b"GET /ws HTTP/1.1\r\n" + host + b"Upgrade: websocket\r\nConnection: Upgrade\r\n"
        b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: " + rng.randbytes(12).hex().encode()
    )
    kinds = [
        rng.randbytes(rng.randrange(1, 3000)),
        b"GET / HTTP/1.1\r\n" + host,
        b"POST / HTTP/1.1\r\n" + host + b"Content-Length: 99999999999\r\n\r\n",
        b"POST / HTTP/1.1\r\n" + host + b"Content-Length: -1\r\n\r\n",
        b"POST / HTTP/1.1\r\n" + host + b"Transfer-Encoding: chunked\r\n\r\nFFFFFFFF\r\nx",
        b"GET /" + b"a" * rng.randrange(1, 60000) + b" HTTP/1.1\r\n" + host + b"\r\n",
        b"GET / HTTP/1.1\r\n" + host + b"X: " + b"b" * rng.randrange(1, 60000) + b"\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n",
        b"GET / HTTP/1.1\r\n" + host + b"Host: evil.example\r\n\r\n",
        upgrade + b"\r\nOrigin: http://evil.example\r\n\r\n" + rng.randbytes(50),
        upgrade + b"\r\n\r\n" + rng.randbytes(200),
        upgrade,
        b"",
        b"\x16\x03\x01" + rng.randbytes(100),
        b"GET /?token=" + rng.randbytes(8).hex().encode() + b" HTTP/1.1\r\n" + host + b"\r\n",
    ]
    whole = rng.choice(kinds)
    if rng.random() < 0.3:
        whole = whole[: rng.randrange(len(whole) + 1)]
    return whole, rng.random() < 0.9


async def _storm(port: int, count: int, seed: int) -> tuple[int, float]:
    """Send `count` fuzzed connections, 50 at once; how many had no end, and the slowest (s)."""
    rng = random.Random(seed)
    gate = asyncio.Semaphore(50)
    hung, slowest = 0, 0.0

    async def one(data: bytes, close: bool) -> None:
        nonlocal hung, slowest
        async with gate:
            began = time.monotonic()
            try:
                # Far past the server's own limit: only what never ends is counted.
                await asyncio.wait_for(_talk(port, data, close), 6 * SLOWEST_REQUEST)
            except TimeoutError:
                hung += 1
            except OSError:
                pass
            slowest = max(slowest, time.monotonic() - began)

    work = [_garbage(rng, port) for _ in range(count)]
    await asyncio.gather(*(one(data, close) for data, close in work))
    return hung, slowest


def _stormed(served: Served, count: int) -> None:
    hung, slowest = asyncio.run(_storm(served.port, count // 4, 1))
    before = served.memory
    more, later = asyncio.run(_storm(served.port, count - count // 4, 2))
    grown = served.memory - before
    print(
        f"{count} fuzzed connections: {hung + more} hung, slowest {max(slowest, later):.1f} s, "
        f"memory grew {grown / 1e6:.1f} MB, {served.files} descriptors open"
    )
    assert hung + more == 0
    assert grown < 20e6
    for _ in range(100):
        if served.files < 40:
            break
        time.sleep(0.1)
    assert served.files < 40
    # And it still lets its own page in.
    request = (
        f"GET /?token={served.token} HTTP/1.1\r\nHost: 127.0.0.1:{served.port}\r\n"
        "Connection: close\r\n\r\n"
    )
    assert b" 303 " in asyncio.run(_talk(served.port, request.encode(), close=False))


def test_fuzzed_connections_neither_hang_nor_fill_the_memory(served):
    _stormed(served, 600)


@pytest.mark.nightly
def test_ten_thousand_fuzzed_connections(served):
    _stormed(served, 10_000)
