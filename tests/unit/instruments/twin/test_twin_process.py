"""The process of a twin: what it is started with, how it says where it is, and how it ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.twin.settings import TwinSettings

if sys.platform == "win32":
    pytest.skip("needs pseudo-terminals", allow_module_level=True)

from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.twin import pty_server
from squeezefilm.instruments.twin.pty_server import PtyServer, running_twin


class Process:
    """A process that was started, and how it was ended."""

    def __init__(self, command: list[str], stubborn: bool = False, **how: Any) -> None:
        self.command, self.how, self.stubborn = command, how, stubborn
        self.stdout = SimpleNamespace(close=lambda: self.ends.append("closed"))
        self.ends: list[str] = []

    def terminate(self) -> None:
        """Keep that it was asked to end."""
        self.ends.append("terminated")

    def wait(self, limit: float | None = None) -> None:
        """Do not end when asked, where it is stubborn."""
        if self.stubborn and limit is not None:
            raise subprocess.TimeoutExpired("twin", limit)
        self.ends.append("waited for")

    def kill(self) -> None:
        """Keep that it was killed."""
        self.ends.append("killed")


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[Process]:
    """The twins that are started; each says at once where it is."""
    every: list[Process] = []

    def start(command: list[str], **how: Any) -> Process:
        every.append(Process(command, stubborn="stubborn" in command, **how))
        return every[-1]

    monkeypatch.setattr(pty_server.subprocess, "Popen", start)
    monkeypatch.setattr(pty_server, "_port_of", lambda *said: f"/dev/there within {said[2]:g} s")
    return every


def test_a_twin_is_started_as_asked_and_ends_with_the_block(started: list[Process]) -> None:
    with running_twin("biet2008-plate") as port:
        assert port == f"/dev/there within {pty_server.START_LIMIT:g} s"
        assert started[0].ends == []
    assert started[0].command == [
        sys.executable, "-m", "squeezefilm.instruments.twin.pty_server", "biet2008-plate",
        "--stroke", pty_server.EXPLORING, "--force", "0.5 N", "--lift", "0.0 s",
        "--with-parent", str(os.getpid()),
    ]  # fmt: skip
    # Ctrl-C is for the program that plays.
    assert started[0].how["start_new_session"] is True
    assert started[0].ends == ["terminated", "waited for", "closed"]
    with running_twin(
        "stubborn", Path("s.toml"), stroke="none", normal_force=0.7, lift=0.25,
        truth=Path("t.csv"), start_limit=3.0, strict=True,
    ) as port:  # fmt: skip
        assert port.endswith("within 3 s")
    _, other = started
    assert other.command[4:] == [
        "--stroke", "none", "--force", "0.7 N", "--lift", "0.25 s", "--with-parent",
        str(os.getpid()), "--settings", "s.toml", "--truth", "t.csv", "--strict",
    ]  # fmt: skip
    assert other.ends == ["terminated", "killed", "waited for", "closed"]


def test_a_twin_ends_when_the_block_fails(started: list[Process]) -> None:
    with pytest.raises(ZeroDivisionError), running_twin("biet2008-plate"):
        raise ZeroDivisionError
    assert started[0].ends == ["terminated", "waited for", "closed"]


@pytest.mark.parametrize(
    ("does", "limit", "says"),
    [
        ("echo /dev/pts/7; echo more", 30.0, "/dev/pts/7"),
        ("exec sleep 30", 0.02, "did not start within 0.02 s; give it more time"),
        ("echo error: no such display >&2", 30.0, "the twin did not start: no such display"),
        ("exit 3", 30.0, "the twin did not start: exit code 3"),
    ],
)
def test_a_twin_says_where_it_is_or_why_not(does: str, limit: float, says: str) -> None:
    with tempfile.TemporaryFile() as said:
        twin = subprocess.Popen(["sh", "-c", does], stdout=subprocess.PIPE, stderr=said)
        try:
            if says.startswith("/"):
                assert pty_server._port_of(twin, said, limit) == says
            else:
                with pytest.raises(InputError, match=says):
                    pty_server._port_of(twin, said, limit)
        finally:
            twin.kill()
            twin.communicate()


def test_a_link_leads_to_the_port_while_it_is_there(tmp_path: Path) -> None:
    link, older = tmp_path / "twin", tmp_path / "older"
    link.symlink_to(older)
    with pty_server._linked(link, "/dev/pts/7"):
        assert link.readlink() == Path("/dev/pts/7")
    assert not link.is_symlink()
    with pty_server._linked(link, "/dev/pts/7"):
        link.unlink()
        link.symlink_to(older)
    # Another's by now.
    assert link.readlink() == older
    file = tmp_path / "file"
    file.write_text("precious")
    says = f"cannot make the link {file} to /dev/pts/7: .*; give another path"
    with pytest.raises(InputError, match=says), pty_server._linked(file, "/dev/pts/7"):
        pass
    assert file.read_text() == "precious"
    with pty_server._linked(None, "/dev/pts/7"):
        pass


def server(said: int = 100, connected: bool = True) -> Any:
    made: Any = PtyServer.__new__(PtyServer)
    made._connected, made._said, made._read, made._read_at = connected, said, 0, 0
    return made


def test_a_host_that_reads_nothing_more_is_known_since_when() -> None:
    made, unread = server(), 40
    made._unread = lambda: unread
    # It has read 60 of 100 bytes, as is seen now; then nothing more.
    assert made._unread_since(1_000) == 1_000
    assert made._unread_since(2_000) == 1_000
    made._said, unread = 130, 70
    assert made._unread_since(3_000) == 1_000
    # It reads on; and has read all, which is known anew each time.
    unread = 50
    assert made._unread_since(4_000) == 4_000
    assert made._unread_since(5_000) == 4_000
    unread = 0
    assert made._unread_since(6_000) == 6_000
    assert made._unread_since(7_000) == 7_000
    made._connected, unread = False, 50
    assert made._unread_since(8_000) == 8_000


def test_time_in_which_nothing_is_read_or_carried_is_left_out_once() -> None:
    excused: list[int] = []
    made = server()
    made._device = SimpleNamespace(excuse=excused.append)
    made._excused_to = 0
    since, held = 10_000, 11_000
    made._unread_since = lambda _: since
    made._way = SimpleNamespace(held_up_since=lambda _: held)
    # 5 ms are what a host may take that is not held up.
    made._excuse_silence(15_000)
    assert excused == []
    made._excuse_silence(17_000)
    assert (excused, made._excused_to) == ([7_000], 17_000)
    made._excuse_silence(20_000)
    assert excused == [7_000, 3_000]
    since, held = 30_000, 22_000
    made._excuse_silence(30_000)
    assert excused == [7_000, 3_000, 8_000]


class Spare:
    """A twin that keeps what it is told, and when."""

    every: list[Spare]

    def __init__(self, display: Any, settings: Any, *, hand: Any = None, **more: Any) -> None:
        self.display, self.settings, self.hand, self.more = display, settings, hand, more
        self.plant = SimpleNamespace(point="the point", resonance_frequency=33e3)
        self.machine = SimpleNamespace(token=5)
        self.told: list[tuple[int, bytes]] = []
        self.advanced: list[int] = []
        self.closed = False
        self.every.append(self)

    def receive(self, data: bytes, at: int) -> None:
        """Keep it."""
        self.told.append((at, data))

    def advance(self, at: int) -> bytes:
        """Keep it."""
        self.advanced.append(at)
        return b""

    def close(self) -> None:
        """Keep that it was."""
        self.closed = True


def test_another_twin_is_told_a_whole_session_before_the_clock_starts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(pty_server, "TwinDevice", Spare)
    Spare.every = []
    own: Any = Spare("display", "settings")
    pty_server._warm_up(own, None)
    spare = Spare.every[1]
    assert (spare.display, spare.settings, spare.more) == (
        "display", "settings", {"point": "the point"},
    )  # fmt: skip
    assert spare.closed
    assert not own.told
    times = [at for at, _ in spare.told]
    assert times == [1000 * number for number in range(1, len(times) + 1)]
    assert spare.advanced == [at + 900 for at in times]
    # It is armed and started, and stopped at the end.
    arm, stop = m.Arm(5).frame(10).encoded(), m.Stop().frame(len(times)).encoded()
    assert arm in [data for _, data in spare.told]
    assert spare.told[-1][1] == stop


class Served:
    """A server of a twin, which returns at once."""

    def __init__(self, device: Any, *, patient: bool) -> None:
        self.port, self.device, self.patient = "/dev/pts/7", device, patient
        self.did: list[Any] = []

    def stop(self) -> None:
        """Keep that it was asked to."""
        self.did.append("stopped")

    def serve(self, parent: int | None) -> None:
        """Be asked to end by the system."""
        self.did.append(parent)
        os.kill(os.getpid(), signal.SIGTERM)

    def close(self) -> None:
        """Keep that it was."""
        self.did.append("closed")


@pytest.fixture
def served(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The server of `main`, and what it asked of the system."""
    Spare.every = []
    found = SimpleNamespace(servers=[], granted=[])

    def serve(device: Any, *, patient: bool) -> Served:
        found.servers.append(Served(device, patient=patient))
        return found.servers[-1]

    for name, stand_in in (
        ("PtyServer", serve), ("TwinDevice", Spare), ("_warm_up", lambda *_: None),
        ("collect_garbage_first", lambda: found.granted.append("collected")),
        ("real_time_granted", found.granted.append),
    ):  # fmt: skip
        monkeypatch.setattr(pty_server, name, stand_in)
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}
    yield found
    for number, handler in before.items():
        signal.signal(number, handler)


def test_a_twin_serves_its_parent_until_it_is_told_to_end(
    served: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert pty_server.main(["biet2008-plate", "--with-parent", "7"]) == 0
    assert capsys.readouterr().out == "/dev/pts/7\n"
    (one,) = served.servers
    assert (one.did, one.patient) == ([7, "stopped", "closed"], True)
    assert served.granted == ["collected"]
    twin = one.device
    assert (twin.display.name, twin.settings) == ("biet2008-plate", TwinSettings())
    assert (twin.hand.normal_force, twin.hand.lift) == (0.5, 0.0)
    link = tmp_path / "link"
    assert pty_server.main([
        "biet2008-plate", "--stroke", "none", "--strict", "--link", str(link),
        "--truth", "t.csv",
    ]) == 0  # fmt: skip
    other = served.servers[1]
    assert (other.patient, other.device.hand) == (False, None)
    assert other.device.more == {"truth_file": Path("t.csv")}
    assert served.granted[1:] == ["collected", pty_server.PLAYERS_PRIORITY]
    assert not link.is_symlink()


@pytest.mark.parametrize(
    ("arguments", "says", "closed"),
    [
        (["nothing-such"], "neither a file nor a preset", False),
        (["biet2008-plate", "--force", "3 kg"], "kg", False),
        (["biet2008-plate", "--link", "/nowhere/at/all"], "cannot make the link", True),
    ],
)
def test_what_cannot_be_served_is_one_line_and_code_2(
    arguments: list[str], says: str, closed: bool, served: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    assert pty_server.main(arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("error: ")
    assert says in said.err
    assert [one.did for one in served.servers] == ([["closed"]] if closed else [])
