"""The lab from its first line to a clean end, in this process: what it says, serves and leaves."""

from __future__ import annotations

import http.client
import os
import re
import signal
import socket
import ssl
import threading
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.lab import serve as serving
from squeezefilm.lab.door import room_for
from squeezefilm.lab.serve import serve
from squeezefilm.lab.server import Lab, UnheardServer, listening_socket, server_of

HANDLED = (signal.SIGINT, signal.SIGTERM)


class Host:
    """Hears what the lab says; ends it by a signal when it has said enough lines."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        # Any that is free, so that tests side by side do not take each other's.
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = int(free.getsockname()[1])
        self.lines: list[str] = []
        self.labs: list[Lab] = []
        self.most: list[int] = []
        self.closed = 0
        self.ending = signal.SIGINT
        self.handlers = [signal.getsignal(one) for one in HANDLED]
        monkeypatch.setattr(serving, "server_of", self._server)

    def _server(self, lab: Lab, **limits: Any) -> UnheardServer:
        self.labs.append(lab)
        self.most.append(limits["door"].keywords["most"])
        lab.closing.append(self._close)
        return server_of(lab, **limits)

    def _close(self) -> None:
        self.closed += 1

    def say(self, line: str) -> None:
        self.lines.append(line)
        if "the link works once" in line:
            # Before the server has begun: a Ctrl-C this early is no less heard.
            signal.raise_signal(self.ending)

    def left_nothing(self, folder: Path) -> bool:
        restored = [signal.getsignal(one) for one in HANDLED] == self.handlers
        return restored and self.closed >= 1 and list(folder.iterdir()) == []


@pytest.fixture
def host(monkeypatch: pytest.MonkeyPatch) -> Host:
    return Host(monkeypatch)


@pytest.mark.parametrize("ending", HANDLED)
def test_a_lab_says_its_link_and_where_files_go_and_ends_clean(
    host: Host, tmp_path: Path, ending: signal.Signals
) -> None:
    folder, host.ending = tmp_path / "a" / "lab", ending
    serve(folder, port=host.port, browser=False, say=host.say)
    link, works = host.lines
    assert re.fullmatch(
        rf"squeezefilm lab: http://127\.0\.0\.1:{host.port}/\?token=[\w-]{{43}}", link
    )
    assert works == f"the link works once; files are saved in {folder}; stop with Ctrl-C"
    assert host.left_nothing(folder)
    (lab,) = host.labs
    assert lab.places.hosts == {f"127.0.0.1:{host.port}", f"localhost:{host.port}"}
    assert lab.places.cookie == f"squeezefilm-{host.port}"
    assert lab.lan is None
    assert host.most == [room_for(1)]


def test_every_area_is_answered(host: Host, tmp_path: Path) -> None:
    serve(tmp_path, port=host.port, browser=False, say=host.say)
    (lab,) = host.labs
    assert {"ping", "textures", "studies", "drives"} <= set(lab.experimenter._known)
    assert "where" in lab.participant._known
    assert "ping" not in lab.participant._known


def test_a_taken_port_is_said(host: Host, tmp_path: Path) -> None:
    with listening_socket(host.port) as taken:
        port = int(taken.getsockname()[1])
        serve(tmp_path, port=port, browser=False, say=host.say)
    found = int(re.findall(r":(\d+)/", host.lines[0])[0])
    assert found > port
    assert host.lines[1] == f"port {port} was taken; this one is {found}"
    assert len(host.lines) == 3


def test_the_browser_opens_the_link_and_may_be_missing(
    host: Host, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []

    def missing(link: str) -> bool:
        opened.append(link)
        raise webbrowser.Error("could not locate runnable browser")

    monkeypatch.setattr(webbrowser, "open", missing)
    serve(tmp_path, port=host.port, browser=False, say=host.say)
    assert opened == []
    serve(tmp_path, port=host.port, say=host.say)
    assert [f"squeezefilm lab: {one}" for one in opened] == [host.lines[2]]


def test_a_folder_that_cannot_be_made_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=r"file/lab cannot be made: .+; give another folder$"):
        serve(tmp_path / "file" / "lab", browser=False)


def test_an_end_before_it_is_served_leaves_nothing(host: Host, tmp_path: Path) -> None:
    def fails(line: str) -> None:
        raise BrokenPipeError(line)

    with pytest.raises(BrokenPipeError):
        serve(tmp_path, port=host.port, browser=False, lan="127.0.0.2", say=fails)
    assert host.left_nothing(tmp_path)
    with listening_socket(host.port) as again:
        assert again.getsockname()[1] == host.port


def test_a_mistake_with_tablets_leaves_a_killed_labs_keys(host: Host, tmp_path: Path) -> None:
    keys = tmp_path / f".lab-{host.port}.keys"
    keys.write_text("[]")
    with pytest.raises(InputError, match="is not allowed"):
        serve(tmp_path, port=host.port, browser=False, lan="8.8.8.8", say=host.say)
    assert keys.exists()
    assert host.lines == []


class Visit(Host):
    """Visits the lab from another thread once all is said, and ends it."""

    thread: threading.Thread
    folder: Path
    seen: dict[str, Any]

    def say(self, line: str) -> None:
        self.lines.append(line)
        if "fingerprint" in line:
            self.seen = {}
            self.thread = threading.Thread(target=self._visit)
            self.thread.start()

    def _visit(self) -> None:
        try:
            _, host, path = re.findall(r"(http)://([\d.:]+)(/\S+)", self.lines[0])[0]
            self.seen["first"] = answered(
                lambda: http.client.HTTPConnection(host, timeout=10), path
            )
            self.seen["again"] = answered(
                lambda: http.client.HTTPConnection(host, timeout=10), path
            )
            self.seen["files"] = {one.name for one in self.folder.iterdir()}
            host, path = re.findall(r"https://([\d.:]+)(/\S+)", self.lines[2])[0]
            trusting = ssl._create_unverified_context()
            self.seen["pairing"] = answered(
                lambda: http.client.HTTPSConnection(host, timeout=10, context=trusting), path
            )
        finally:
            os.kill(os.getpid(), signal.SIGINT)


def answered(connect: Callable[[], http.client.HTTPConnection], path: str) -> int:
    line = connect()
    try:
        line.request("GET", path)
        answer = line.getresponse()
        answer.read()
        return answer.status
    finally:
        line.close()


def test_page_and_tablets_are_served_side_by_side_until_ctrl_c(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("cryptography")
    visit = Visit(monkeypatch)
    visit.folder = tmp_path
    serve(tmp_path, port=visit.port, browser=False, lan="127.0.0.2", say=visit.say)
    visit.thread.join()
    assert visit.seen["first"] == 303
    assert visit.seen["again"] != 303
    assert visit.seen["pairing"] == 200
    # Kept while it runs, for a lab that is killed; not after its end.
    assert visit.seen["files"] == {f".lab-{visit.port}.keys", f".lab-{visit.port}.pem"}
    assert visit.left_nothing(tmp_path)
    (lab,) = visit.labs
    assert lab.lan is not None
    assert visit.lines[2:] == [
        f"tablets, participants only: {lab.lan.link}",
        f"its certificate's SHA-256 fingerprint: {lab.lan.fingerprint}",
    ]
    assert lab.lan.link.startswith("https://127.0.0.2:")
    assert visit.most == [room_for(2)]
