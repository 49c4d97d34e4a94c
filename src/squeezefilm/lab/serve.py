"""Run the lab until it is stopped: port, link, browser, and a clean end."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import webbrowser
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from squeezefilm.core.errors import InputError
from squeezefilm.lab.areas.design import DesignArea
from squeezefilm.lab.areas.device import DeviceArea
from squeezefilm.lab.areas.feel import FeelArea
from squeezefilm.lab.areas.search import SearchArea
from squeezefilm.lab.areas.study import StudyArea
from squeezefilm.lab.door import Door, room_for
from squeezefilm.lab.guard import Keys, Places
from squeezefilm.lab.server import PORT, Lab, listening_socket, server_of

if TYPE_CHECKING:
    import socket

    from squeezefilm.lab.server import UnheardServer


def serve(
    folder: Path,
    *,
    port: int = PORT,
    browser: bool = True,
    lan: str | None = None,
    say: Callable[[str], None] = print,
) -> None:
    """Serve the lab on this computer only, until Ctrl-C; files are saved below `folder`.

    With `lan`, an address of this computer in a private network, tablets reach the participant's
    page there by TLS, each after it was paired with a code; nothing else is served there.

    `say` gets the lines a person reads: the one-time link first. Where the lab was killed, pages
    that were open go on with the lab that is started next in the same folder at the same port.

    Raises:
        InputError: a folder that cannot be written, no free port, or what `lan` may not be.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{folder} cannot be made: {error.strerror}; give another folder"
        ) from error
    with contextlib.ExitStack() as opened:
        listener = opened.enter_context(listening_socket(port))
        bound = int(listener.getsockname()[1])
        lab = _lab_at(folder, bound)
        link = f"http://127.0.0.1:{bound}/?token={lab.keys.new_link()}"
        secret = folder / f".lab-{bound}.pem"
        most = room_for(1 if lan is None else 2)
        servers = [(server_of(lab, door=partial(Door, most=most)), listener)]
        if lan is not None:
            from squeezefilm.lab.lan import lan_listener, lan_server

            # A mistake here leaves the keys of a lab that was killed as they are.
            beside = opened.enter_context(lan_listener(lan))
            servers.append((lan_server(lab, beside, secret, most), beside))
        # From here on an end, however early, leaves no key behind.
        opened.callback(secret.unlink, missing_ok=True)
        opened.callback(lab.keys.forget)
        opened.callback(lab.close)
        opened.enter_context(_ended_by_signals(servers[0][0]))
        say(f"squeezefilm lab: {link}")
        if bound != port:
            say(f"port {port} was taken; this one is {bound}")
        say(f"the link works once; files are saved in {folder.resolve()}; stop with Ctrl-C")
        if lab.lan is not None:
            say(f"tablets, participants only: {lab.lan.link}")
            say(f"its certificate's SHA-256 fingerprint: {lab.lan.fingerprint}")
        if browser:
            with contextlib.suppress(webbrowser.Error):
                webbrowser.open(link)
        asyncio.run(_run(servers))


def _lab_at(folder: Path, port: int) -> Lab:
    """A lab that is reached at a port of this computer, with all its areas."""
    hosts = frozenset({f"127.0.0.1:{port}", f"localhost:{port}"})
    keys = Keys(folder / f".lab-{port}.keys")
    lab = Lab(folder, keys, Places(hosts, cookie=f"squeezefilm-{port}"))
    DesignArea(lab)
    SearchArea(lab)
    FeelArea(lab)
    StudyArea(lab)
    DeviceArea(lab)
    return lab


@contextlib.contextmanager
def _ended_by_signals(server: UnheardServer) -> Iterator[None]:
    """Let Ctrl-C and SIGTERM end a server, also one that has not begun.

    asyncio's own handling cancels the first task wherever it is, uvicorn's begins only when the
    server runs: a Ctrl-C between the two was lost, or ended in a traceback.
    """
    signals = (signal.SIGINT, signal.SIGTERM)
    before = [(number, signal.signal(number, server.handle_exit)) for number in signals]
    try:
        yield
    finally:
        for number, handler in before:
            signal.signal(number, handler)


async def _run(servers: list[tuple[UnheardServer, socket.socket]]) -> None:
    """Run the first server until it is told to exit, and the others as long."""
    (first, listener), *others = servers
    beside = [asyncio.create_task(server.serve(sockets=[at])) for server, at in others]
    await first.serve(sockets=[listener])
    for server, _ in others:
        server.should_exit = True
    await asyncio.gather(*beside)
