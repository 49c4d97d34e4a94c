"""Run the lab until it is stopped: port, link, browser, and a clean end."""

from __future__ import annotations

import contextlib
import webbrowser
from collections.abc import Callable
from pathlib import Path

from squeezefilm.errors import InputError
from squeezefilm.lab.design_area import add_design
from squeezefilm.lab.device_area import add_device
from squeezefilm.lab.feel_area import add_feel
from squeezefilm.lab.guard import Places
from squeezefilm.lab.keys import Keys
from squeezefilm.lab.server import PORT, Lab, listening_socket, server_of
from squeezefilm.lab.study_area import add_study


def serve(
    folder: Path,
    *,
    port: int = PORT,
    browser: bool = True,
    say: Callable[[str], None] = print,
) -> None:
    """Serve the lab on this computer only, until Ctrl-C; files are saved below `folder`.

    `say` gets the lines a person reads: the one-time link first. Where the lab was killed, pages
    that were open go on with the lab that is started next in the same folder at the same port.

    Raises:
        InputError: a folder that cannot be written, or no free port.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be made: {error.strerror}; say --folder") from error
    listener = listening_socket(port)
    found = int(listener.getsockname()[1])
    hosts = frozenset({f"127.0.0.1:{found}", f"localhost:{found}"})
    keys = Keys(folder / f".lab-{found}.keys")
    lab = Lab(folder, keys, Places(hosts, cookie=f"squeezefilm-{found}"))
    add_design(lab)
    add_feel(lab)
    add_study(lab)
    add_device(lab)
    link = f"http://127.0.0.1:{found}/?token={keys.new_link()}"
    server = server_of(lab)
    say(f"squeezefilm lab: {link}")
    if found != port:
        say(f"port {port} was taken; this one is {found}")
    say("the link works once; files are saved in " + str(folder.resolve()) + "; stop with Ctrl-C")
    if browser:
        with contextlib.suppress(webbrowser.Error):
            webbrowser.open(link)
    try:
        server.run(sockets=[listener])
    except KeyboardInterrupt:
        pass
    finally:
        lab.close()
        keys.forget()
        listener.close()
