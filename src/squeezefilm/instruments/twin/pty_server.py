"""The twin behind a serial port: a process of its own, in real time, over a pseudo-terminal.

    python -m squeezefilm.instruments.twin.pty_server DISPLAY [--link PATH] [--truth FILE] [--stroke
    TEXT] …

It prints the port's name on the first line and runs until SIGTERM or SIGINT. A host may close the
port and open it again; what the device says meanwhile is lost, as on a wire. The clock starts when
the name is printed. Where the process falls behind the wall clock it catches up tick by tick, so
that the device's own clock has no gap. What waits in the port then came at some time of the gap,
nobody knows when: it is heard evenly over it, as a device that was not held up would have heard it.

A computer that is busy holds up programs for longer than a device waits for its host. Its twin's
watchdog therefore counts the twin's own time: neither that for which this process was held up, nor
that for which the host leaves unread what it was told, nor that for which the system does not carry
what was said, up to a second. A real device waits 50 ms.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import select
import signal
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.instruments.control.gains import IdentifiedPlate, LoopAims, loop_gains
from squeezefilm.instruments.device.priority import (
    PLAYERS_PRIORITY,
    collect_garbage_first,
    real_time_granted,
)
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.twin.device import TwinDevice
from squeezefilm.instruments.twin.hand import EXPLORING, Hand, hand_from
from squeezefilm.instruments.twin.settings import TwinSettings, load_settings
from squeezefilm.physics.display import load_display

_PAUSE = 1.0  # ms between looks at the port
_UNCONNECTED_PAUSE = 5.0
_MOST_BYTES = 4096
_HELD_UP = 20_000  # µs behind the wall clock, from which on the process was held up
_SLICE = 1_000  # µs of catching up at once
_READS_WITHIN = 5_000  # µs after which a host that is not held up has read what it was told
START_LIMIT: si.Second = 120.0
"""How long a twin may take to start: it solves its plate and compiles."""


class PtyServer:
    """A twin's pseudo-terminal and its clock. `serve` returns after `stop`.

    Args:
        device: what answers.
        patient: whether its watchdog counts the twin's own time (see the module), or all time, as
            a real device's does.

    Raises `InputError` on a system without pseudo-terminals.
    """

    def __init__(self, device: TwinDevice, *, patient: bool = False) -> None:
        require_pseudo_terminals()
        import tty

        self._device, self._patient = device, patient
        self._master, slave = os.openpty()
        tty.setraw(slave)
        self.port = os.ttyname(slave)
        # The last host's end is closed, so that its going away shows as a hang-up.
        os.close(slave)
        os.set_blocking(self._master, False)
        self._poll = select.poll()
        self._poll.register(self._master, select.POLLIN)
        self._running = True
        self._connected = False
        self.longest_behind = 0
        self._said = self._read = self._read_at = self._heard_at = self._excused_to = 0
        self._way = _Way()

    def stop(self) -> None:
        """End `serve` soon; may be called from a signal handler."""
        self._running = False

    def serve(self, parent: int | None = None) -> None:
        """Run in real time until `stop`, or until the process `parent` is no longer the parent."""
        began = time.monotonic_ns()
        heard = b""
        while self._running and (parent is None or os.getppid() == parent):
            wall = (time.monotonic_ns() - began) // 1000
            behind = wall - self._device.now
            self.longest_behind = max(self.longest_behind, behind)
            if behind > _HELD_UP:
                self._connected = not self._flags(0.0) & select.POLLHUP
                self._catch_up(wall, heard)
                heard = b""
                continue
            if heard:
                self._heard_at = self._excused_to = wall
                self._device.receive(heard, wall)
            elif self._patient and wall - self._heard_at > _READS_WITHIN:
                self._excuse_silence(wall)
            self._say(self._device.advance(wall))
            flags = self._flags(_PAUSE)
            self._connected = not flags & select.POLLHUP
            heard = self._hear() if flags & select.POLLIN else b""
            if not heard and not self._connected:
                time.sleep(_UNCONNECTED_PAUSE * 1e-3)

    def _catch_up(self, wall: int, heard: bytes) -> None:
        """Hear evenly, up to `wall`, what was `heard` and what waits in the port."""
        began = self._device.now
        # Left out below: not to be left out again as time in which nothing was carried.
        self._excused_to = wall
        waiting = heard + b"".join(iter(self._hear, b""))
        slices = -(-(wall - began) // _SLICE)
        for k in range(slices):
            if not self._running:
                return
            at = began + (wall - began) * (k + 1) // slices
            if self._patient:
                self._device.excuse(at - self._device.now)
            self._say(self._device.advance(at))
            part = waiting[len(waiting) * k // slices : len(waiting) * (k + 1) // slices]
            if part:
                self._device.receive(part, at)

    def close(self) -> None:
        """Hang up and write the truth out."""
        os.close(self._master)
        self._way.close()
        self._device.close()

    def _flags(self, wait: float) -> int:
        """Events of the port within `wait` (ms)."""
        return dict(self._poll.poll(wait)).get(self._master, 0)

    def _excuse_silence(self, wall: int) -> None:
        """Leave out the time since the host reads no more, or since nothing is carried to it."""
        since = min(self._unread_since(wall), self._way.held_up_since(wall))
        if wall - since > _READS_WITHIN:
            since = max(since, self._excused_to)
            self._device.excuse(wall - since)
            self._excused_to = wall

    def _unread_since(self, wall: int) -> int:
        """Time since which the host leaves unread what it was told, or now: one that is silent on
        purpose reads on."""
        if not self._connected:
            return wall
        unread = self._unread()
        if unread == 0 or self._said - unread != self._read:
            self._read, self._read_at = self._said - unread, wall
        return self._read_at

    def _unread(self) -> int:
        """Bytes that the host has not read yet; 0 where the system does not tell."""
        import fcntl
        import termios

        try:
            port = os.open(self.port, os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)
        except OSError:
            return 0
        try:
            (count,) = struct.unpack("i", fcntl.ioctl(port, termios.FIONREAD, bytes(4)))
        except OSError:
            return 0
        finally:
            os.close(port)
        return int(count)

    def _hear(self) -> bytes:
        try:
            return os.read(self._master, _MOST_BYTES)
        except (BlockingIOError, OSError):
            # Nothing there, or no host: a hang-up reads as an error.
            return b""

    def _say(self, data: bytes) -> None:
        if not data or not self._connected:
            return
        # What a full wire or an absent host does not take is lost, as on a real one.
        with contextlib.suppress(OSError):
            self._said += os.write(self._master, data)


class _Way:
    """Measures the time that a byte takes through a pseudo-terminal: one is sent again and
    again. Linux carries them in a worker of ordinary priority, which a busy machine holds up for
    hundreds of milliseconds while both programs run before ordinary work.
    """

    def __init__(self) -> None:
        import tty

        self._near, self._far = os.openpty()
        tty.setraw(self._far)
        os.set_blocking(self._near, False)
        self._sent_at: int | None = None

    def held_up_since(self, wall: int) -> int:
        """Time at which the byte was sent that is still on its way, or now."""
        if self._sent_at is not None:
            try:
                os.read(self._near, 1)
            except BlockingIOError:
                return self._sent_at
        os.write(self._far, bytes(1))
        self._sent_at = wall
        return wall

    def close(self) -> None:
        os.close(self._near)
        os.close(self._far)


def main(arguments: Sequence[str] | None = None) -> int:
    """Serve a twin; see the module. Returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m squeezefilm.instruments.twin.pty_server")
    parser.add_argument("display", help="a preset's name or a TOML file")
    parser.add_argument("--link", type=Path, help="a symbolic link to make to the port")
    parser.add_argument("--truth", type=Path, help="a CSV for what really happens")
    parser.add_argument("--settings", type=Path, help="a TOML file of twin settings")
    parser.add_argument("--stroke", default=EXPLORING, help="the finger's motion, or 'none'")
    parser.add_argument("--force", default="0.5 N", help="it presses with")
    parser.add_argument("--lift", default="0 s", help="time in the air between strokes")
    parser.add_argument(
        "--strict", action="store_true", help="a watchdog that counts all time, as a real device's"
    )
    parser.add_argument("--with-parent", type=int, help="end when this process is not the parent")
    options = parser.parse_args(arguments)
    try:
        settings = load_settings(options.settings) if options.settings else TwinSettings()
        hand = None
        if options.stroke != "none":
            force = si.parse_quantity(options.force, si.Unit("N"))
            lift = si.parse_quantity(options.lift, si.Unit("s"))
            hand = hand_from(options.stroke, normal_force=force, lift=lift)
        display = load_display(options.display)
        device = TwinDevice(display, settings, hand=hand, truth_file=options.truth)
        _warm_up(device, hand)
        server = PtyServer(device, patient=not options.strict)
    except SqueezefilmError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: server.stop())
    try:
        with _linked(options.link, server.port):
            # A device does not stand still while a solver's garbage is collected, and a strict one
            # has its processor for itself; as near to that as the system allows. Another waits for
            # a busy computer, and leaves it to those who play.
            collect_garbage_first()
            print(server.port, flush=True)
            if options.strict:
                real_time_granted(PLAYERS_PRIORITY)
            server.serve(options.with_parent)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    finally:
        server.close()
    return 0


def _warm_up(device: TwinDevice, hand: Hand | None) -> None:
    """Compile whatever a session calls before the clock starts: no stall may look like a host that
    fell silent. Another device does it, so that this one's is untouched."""
    spare = TwinDevice(device.display, device.settings, hand=hand, point=device.plant.point)
    # As little as any display may have: nothing of this leaves the process.
    limits = m.SetLimits(1.0, 1000, 1.0, 1000, 1000, 1_000_000_000, 1000, 1000, 0)
    start = m.Start(round(1e3 * device.plant.resonance_frequency))
    session = [m.Hello(1), m.AskInfo(), m.Report(1000), limits]
    gains = loop_gains(IdentifiedPlate(30e3, 100.0, 0.01), LoopAims(29e3, 31e3, 1.0, 0.5))
    session += [m.Negotiate(m.REVISION), m.SetLoops(gains), m.SwitchLoops(1)]
    session += [m.TileBegin(0, 1000, 2), m.TileData(0, (0.5, 1.0))]
    session += [m.Arm(spare.machine.token), start, m.TimedEnvelope(15_000, 200, (0.5, 1.0))]
    session += [m.Envelope(200, (0.5, 1.0)), m.Follow(), m.AskLoops(), m.Stop()]
    for number, message in enumerate(session, start=1):
        spare.receive(message.frame(number).encoded(), 1000 * number)
        spare.advance(1000 * number + 900)
    spare.close()


@contextlib.contextmanager
def _linked(link: Path | None, port: str) -> Iterator[None]:
    if link is None:
        yield
        return
    if link.is_symlink():
        link.unlink()
    try:
        link.symlink_to(port)
    except OSError as error:
        raise InputError(
            f"cannot make the link {link} to {port}: {error.strerror}; give another path"
        ) from error
    try:
        yield
    finally:
        if link.is_symlink() and str(link.readlink()) == port:
            link.unlink()


def require_pseudo_terminals() -> None:
    """Raise `InputError` on a system without pseudo-terminals, as Windows is."""
    if not hasattr(os, "openpty"):
        raise InputError(
            "a twin stands behind a pseudo-terminal, which this system does not have; use Linux or "
            "macOS (on Windows: its subsystem for Linux), or a device at a serial port"
        )


@contextlib.contextmanager
def running_twin(
    display: str | Path,
    settings: str | Path | None = None,
    *,
    stroke: str = EXPLORING,
    normal_force: si.Newton = 0.5,
    lift: si.Second = 0.0,
    truth: Path | None = None,
    start_limit: si.Second = START_LIMIT,
    strict: bool = False,
) -> Iterator[str]:
    """A twin in a process of its own; yields the name of its serial port.

    `display` is a preset's name or a file, `settings` a TOML file, `stroke` "none" for no finger,
    `lift` the time in the air between strokes, `strict` for a watchdog that counts all time.
    The process ends with the block, and on its own if this process dies.

    Raises:
        InputError: the twin refused to start (its message), was not there in `start_limit` (s), or
            the system has no pseudo-terminals.
    """
    require_pseudo_terminals()
    command = [sys.executable, "-m", "squeezefilm.instruments.twin.pty_server", str(display)]
    command += ["--stroke", stroke, "--force", f"{normal_force!r} N", "--lift", f"{lift!r} s"]
    command += ["--with-parent", str(os.getpid())]
    command += [] if settings is None else ["--settings", str(settings)]
    command += [] if truth is None else ["--truth", str(truth)]
    command += ["--strict"] if strict else []
    with tempfile.TemporaryFile() as said:
        # In a session of its own: Ctrl-C is for the program that plays, not for its device.
        twin = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=said, start_new_session=True
        )
        try:
            yield _port_of(twin, said, start_limit)
        finally:
            twin.terminate()
            try:
                twin.wait(10)
            except subprocess.TimeoutExpired:
                twin.kill()
                twin.wait()
            if twin.stdout is not None:
                twin.stdout.close()


def _port_of(twin: subprocess.Popen[bytes], said: IO[bytes], limit: si.Second) -> str:
    assert twin.stdout is not None
    there, _, _ = select.select([twin.stdout], [], [], limit)
    line = twin.stdout.readline().decode().strip() if there else ""
    if line:
        return line
    if not there:
        raise InputError(f"the twin did not start within {limit:g} s; give it more time")
    twin.wait()
    said.seek(0)
    why = said.read().decode(errors="replace").strip().removeprefix("error: ")
    raise InputError(f"the twin did not start: {why or f'exit code {twin.returncode}'}")


if __name__ == "__main__":
    sys.exit(main())
