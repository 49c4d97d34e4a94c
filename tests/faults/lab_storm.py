"""A lab of its own, and fuzzed connections to it: malformed, endless and foreign."""

from __future__ import annotations

import asyncio
import contextlib
import os
import random
import re
import resource
import signal
import ssl
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from squeezefilm.lab.connections import SLOWEST_REQUEST

PROGRAM = (
    "import sys; from pathlib import Path; from squeezefilm.lab.serve import serve; "
    "serve(Path(sys.argv[1]), port=int(sys.argv[2]), browser=False, lan=sys.argv[3] or None, "
    "say=lambda text: print(text, flush=True))"
)


class Served:
    """A lab in a process of its own; with `lan`, also for tablets at that address."""

    def __init__(
        self,
        folder: Path,
        port: int | None = None,
        lan: str = "",
        prepare: Callable[[], None] | None = None,
    ) -> None:
        self.folder, self.complaints = folder, folder.with_suffix(".said")
        with self.complaints.open("w") as said:
            self.process = subprocess.Popen(
                [sys.executable, "-c", PROGRAM, str(folder),
                 str(port or 8700 + random.randrange(800)), lan],
                stdout=subprocess.PIPE, stderr=said, text=True, preexec_fn=prepare,
            )  # fmt: skip
        assert self.process.stdout is not None
        line = ""
        while ("fingerprint" if lan else "files are saved") not in line:
            line = self.process.stdout.readline()
            assert line, self.complaints.read_text()
            if found := re.search(r"http://127\.0\.0\.1:(\d+)/\?token=(\S+)", line):
                self.port, self.token = int(found[1]), found[2]
            if found := re.search(r"https://([\d.]+):(\d+)/pair", line):
                self.lan = found[1], int(found[2])
        for _ in range(200):
            try:
                asyncio.run(self.talk(b"GET / HTTP/1.1\r\n\r\n"))
                break
            except ConnectionError:
                time.sleep(0.05)

    @property
    def memory(self) -> int:
        """Bytes the server holds."""
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * resource.getpagesize()

    @property
    def files(self) -> int:
        """Open descriptors of the server."""
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))  # noqa: PTH208

    @property
    def connections(self) -> int:
        """Its open sockets, but for those it listens at."""
        folder = Path(f"/proc/{self.process.pid}/fd")
        links = []
        for one in folder.iterdir():
            # One may be closed while they are counted.
            with contextlib.suppress(OSError):
                links.append(os.readlink(one))  # noqa: PTH115
        return sum(one.startswith("socket:") for one in links)

    async def talk(self, data: bytes, close: bool = True, tablets: bool = False) -> bytes:
        """The first of what the lab, or its place for tablets by TLS, answers to bytes."""
        context = None
        if tablets:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
            context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
        host, port = self.lan if tablets else ("127.0.0.1", self.port)
        return await _talk(host, port, data, close, context)

    def comes_in(self) -> bytes:
        """The answer to a browser with the one-time link."""
        request = (
            f"GET /?token={self.token} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n"
            "Connection: close\r\n\r\n"
        )
        return asyncio.run(self.talk(request.encode(), close=False))

    def end(self) -> int:
        """End it as Ctrl-C does; its exit code."""
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(30)
        assert self.process.stdout is not None
        self.process.stdout.close()
        return code


async def _talk(
    host: str, port: int, data: bytes, close: bool, context: ssl.SSLContext | None
) -> bytes:
    reader, writer = await asyncio.open_connection(host, port, ssl=context)
    try:
        writer.write(data)
        await writer.drain()
        if close and writer.can_write_eof():
            writer.write_eof()
        return await reader.read(65536)
    finally:
        writer.close()
        with contextlib.suppress(OSError):
            await writer.wait_closed()


def garbage(rng: random.Random, host: str) -> tuple[bytes, bool]:
    """Bytes for a connection, and whether it says that no more will come."""
    own = f"Host: {host}\r\n".encode()
    upgrade = (
        b"GET /ws HTTP/1.1\r\n" + own + b"Upgrade: websocket\r\nConnection: Upgrade\r\n"
        b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: " + rng.randbytes(12).hex().encode()
    )
    kinds = [
        rng.randbytes(rng.randrange(1, 3000)),
        b"GET / HTTP/1.1\r\n" + own,
        b"POST / HTTP/1.1\r\n" + own + b"Content-Length: 99999999999\r\n\r\n",
        b"POST / HTTP/1.1\r\n" + own + b"Content-Length: -1\r\n\r\n",
        b"POST / HTTP/1.1\r\n" + own + b"Transfer-Encoding: chunked\r\n\r\nFFFFFFFF\r\nx",
        b"GET /" + b"a" * rng.randrange(1, 60000) + b" HTTP/1.1\r\n" + own + b"\r\n",
        b"GET / HTTP/1.1\r\n" + own + b"X: " + b"b" * rng.randrange(1, 60000) + b"\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n",
        b"GET / HTTP/1.1\r\n" + own + b"Host: evil.example\r\n\r\n",
        upgrade + b"\r\nOrigin: http://evil.example\r\n\r\n" + rng.randbytes(50),
        upgrade + b"\r\n\r\n" + rng.randbytes(200),
        upgrade,
        b"",
        b"\x16\x03\x01" + rng.randbytes(100),
        b"GET /?token=" + rng.randbytes(8).hex().encode() + b" HTTP/1.1\r\n" + own + b"\r\n",
    ]
    whole = rng.choice(kinds)
    if rng.random() < 0.3:
        whole = whole[: rng.randrange(len(whole) + 1)]
    return whole, rng.random() < 0.9


def hello() -> bytes:
    """What a TLS client says first."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    sent = ssl.MemoryBIO()
    with contextlib.suppress(ssl.SSLWantReadError):
        context.wrap_bio(ssl.MemoryBIO(), sent).do_handshake()
    return sent.read()


def garbled_hello(rng: random.Random, whole: bytes) -> bytes:
    """A TLS client's first words, cut, changed, or with noise behind them."""
    changed = bytearray(whole)
    for _ in range(rng.choice((0, 1, 1, 3, 30))):
        changed[rng.randrange(len(changed))] = rng.randrange(256)
    cut = changed[: rng.randrange(1, len(changed) + 1)] if rng.random() < 0.4 else changed
    return bytes(cut) + rng.randbytes(rng.choice((0, 0, 20, 3000)))


async def storm(served: Served, count: int, seed: int, tablets: bool = False) -> tuple[int, float]:
    """Send `count` fuzzed connections, 50 at once; how many had no end, and the slowest (s).

    To the place for tablets, half of them are no whole TLS handshake, and half begin with one.
    """
    rng = random.Random(seed)
    gate = asyncio.Semaphore(50)
    first = hello()
    hung, slowest = 0, 0.0

    async def one(data: bytes, close: bool, encrypted: bool) -> None:
        nonlocal hung, slowest
        async with gate:
            began = time.monotonic()
            host, port = served.lan if tablets else ("127.0.0.1", served.port)
            talk = (
                served.talk(data, close, tablets=True)
                if encrypted
                else _talk(host, port, data, close, None)
            )
            try:
                # Far past the server's own limit: only what never ends is counted.
                await asyncio.wait_for(talk, 6 * SLOWEST_REQUEST)
            except TimeoutError:
                hung += 1
            except OSError:
                pass
            slowest = max(slowest, time.monotonic() - began)

    work = []
    host = "{}:{}".format(*served.lan) if tablets else f"127.0.0.1:{served.port}"
    for _ in range(count):
        data, close = garbage(rng, host)
        encrypted = tablets and rng.random() < 0.5
        if tablets and not encrypted and rng.random() < 0.8:
            data = garbled_hello(rng, first)
        work.append((data, close, encrypted))
    await asyncio.gather(*(one(*each) for each in work))
    return hung, slowest
