"""The twin behind a pty: a process of its own, an ordinary serial port, and no orphans."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import serial

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Deframer
from squeezefilm.instruments.twin.plant_kernel import COLUMNS
from squeezefilm.instruments.twin.pty_server import main, running_twin

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(sys.platform == "win32", reason="there are no ptys on Windows"),
]
PATIENCE = 60.0
DISPLAY = "biet2008-stator"


def asked(port: serial.Serial, message: m.Message, sequence: int) -> m.Status:
    """The status that answers a message; waits as long as a busy machine may need."""
    port.write(message.frame(sequence).encoded())
    deframer, end = Deframer(), time.monotonic() + PATIENCE
    while time.monotonic() < end:
        for frame in deframer.take(port.read(64)):
            if frame is not None and frame.type == m.Status.TYPE:
                status = m.Status.read(frame.payload)
                assert status is not None
                return status
    raise AssertionError(f"no answer to {message}")


def gone(pid: int) -> bool:
    """Whether a process ends in time; a zombie has ended."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
        except (FileNotFoundError, ProcessLookupError):
            return True
        if state == "Z":
            return True
        time.sleep(0.01)
    return False


@pytest.mark.slow
def test_a_host_may_leave_and_come_back_and_the_truth_is_on_disk(tmp_path: Path) -> None:
    truth = tmp_path / "truth.csv"
    with running_twin(DISPLAY, truth=truth) as name:
        for session in (1, 2, 3):
            with serial.Serial(name, timeout=0.01) as port:
                answer = asked(port, m.Hello(session), 1)
                assert (answer.reason, answer.session) == (0, session)
                assert answer.accepted == session
    rows = np.loadtxt(truth, delimiter=",", skiprows=1, ndmin=2)
    assert truth.read_text().splitlines()[0] == ",".join(COLUMNS)
    np.testing.assert_allclose(np.diff(rows[:, 0]), 1e-3, rtol=1e-6)


@pytest.mark.slow
def test_readings_come_by_the_devices_clock() -> None:
    with running_twin(DISPLAY, stroke="none") as name, serial.Serial(name, timeout=0.01) as port:
        assert asked(port, m.Hello(1), 1).reason == 0
        port.write(m.Report(2000).frame(2).encoded())
        deframer, end, times = Deframer(), time.monotonic() + PATIENCE, []
        while len(times) < 100 and time.monotonic() < end:
            for frame in deframer.take(port.read(256)):
                if frame is not None and frame.type == m.Reading.TYPE:
                    reading = m.Reading.read(frame.payload)
                    assert reading is not None
                    assert reading.touching == 0
                    times.append(reading.time)
    assert len(times) >= 100
    assert set(np.diff(times)) == {2000}


def test_what_cannot_start_says_why_and_leaves_nothing(tmp_path: Path) -> None:
    with (
        pytest.raises(InputError, match="neither a file nor a preset"),
        running_twin("biet2008-statr"),
    ):
        raise AssertionError("it started")
    assert main([DISPLAY, "--stroke", "sideways"]) == 2
    settings = tmp_path / "twin.toml"
    settings.write_text("tikc = 1\n", encoding="utf-8")
    assert main([DISPLAY, "--settings", str(settings)]) == 2


def test_sigterm_ends_it_cleanly_and_takes_the_link_away(tmp_path: Path) -> None:
    link, truth = tmp_path / "port", tmp_path / "truth.csv"
    command = [sys.executable, "-m", "squeezefilm.instruments.twin.pty_server", DISPLAY]
    command += ["--link", str(link), "--truth", str(truth), "--stroke", "none"]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as twin:
        assert twin.stdout is not None
        name = twin.stdout.readline().decode().strip()
        assert str(link.readlink()) == name
        with serial.Serial(str(link), timeout=0.01) as port:
            assert asked(port, m.Hello(1), 1).reason == 0
        twin.terminate()
        assert twin.wait(PATIENCE) == 0
    assert not link.is_symlink()
    assert truth.read_text().endswith("\n")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="children are found in Linux's /proc")
def test_it_dies_with_the_process_that_started_it() -> None:
    script = (
        "import time\nfrom squeezefilm.instruments.twin.pty_server import running_twin\n"
        f"with running_twin({DISPLAY!r}) as name:\n    print(name, flush=True)\n"
        "    time.sleep(600)\n"
    )
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        assert parent.stdout.readline().startswith(b"/dev/")
        children = Path(f"/proc/{parent.pid}/task/{parent.pid}/children").read_text().split()
        assert len(children) == 1
        parent.send_signal(signal.SIGKILL)
        parent.wait(PATIENCE)
    assert gone(int(children[0]))
