"""The firmware as a program on an emulated board (QEMU's mps2-an385), by its serial port.

It runs on an emulated Cortex-M3, never on a board. Its plate is a model in integers, under a finger
of half the plate's loss and 20 Hz beside the frequency that the loops were told.

QEMU's clock either is this computer's, so that the core is late where QEMU has to wait for a
processor, or counts instructions, so that nothing is late on it and it falls behind by half.
"""

from __future__ import annotations

import contextlib
import re
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from tests.protocol.arm import symbols
from tests.protocol.builds import SOURCES, STRICT, build, tool
from tests.protocol.test_firmware_arm import FLOATING

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import Limits
from squeezefilm.instruments.bench.check import check_device
from squeezefilm.instruments.bench.conversation import Conversation
from squeezefilm.instruments.bench.timing_checks import waited_time
from squeezefilm.instruments.control.gains import IdentifiedPlate, LoopAims, loop_gains
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Reason
from squeezefilm.instruments.device.wire.streams import open_stream
from squeezefilm.physics.render.motion.estimator import SensorModel

RATIO = 2e-3
GAINS = loop_gains(
    IdentifiedPlate(30e3, 300.0, RATIO),
    LoopAims(29.2e3, 30.2e3, 2.0, 0.5, interval=2e-4, tracking_bandwidth=300.0, floor=1e-4),
)
WALL: tuple[str, ...] = ()
COUNTED = ("-icount", "shift=5")
"""How QEMU's clock goes."""
FINGER = SensorModel("the board's own", 500.0, 0.0, quantisation=1e-6)
PARTS = ("squeezefilm_fw.c", "squeezefilm_held.c", "squeezefilm_loops.c", "board_mps2.c")


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> Path:
    flags = (
        *STRICT,
        "-O2",
        "-mthumb",
        "-mcpu=cortex-m3",
        "-ffunction-sections",
        "-fdata-sections",
        "--specs=nano.specs",
        "-nostartfiles",
        f"-Wl,--gc-sections,-T,{SOURCES / 'mps2.ld'},-e,reset",
    )
    sources = tuple(SOURCES / name for name in PARTS)
    built = tmp_path_factory.mktemp("board") / "board.elf"
    return build(tool("arm-none-eabi-gcc"), flags, sources, built)


@contextlib.contextmanager
def powered(image: Path, clock: tuple[str, ...]) -> Iterator[Conversation]:
    """The board, switched on; its port is a pseudo-terminal."""
    words = [
        "-M",
        "mps2-an385",
        "-display",
        "none",
        "-monitor",
        "none",
        "-serial",
        "pty",
        *clock,
    ]
    command = [tool("qemu-system-arm"), *words, "-kernel", str(image)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as board:
        try:
            assert board.stdout is not None
            line = board.stdout.readline()
            port = re.search(r"/dev/\S+", line)
            assert port is not None, line
            with contextlib.closing(open_stream(f"serial:{port.group()}")) as stream:
                time.sleep(1.5)  # QEMU looks once a second whether somebody opened its terminal.
                yield Conversation(stream, time.monotonic, time.sleep, waited_time)
        finally:
            board.kill()


@pytest.mark.slow
def test_the_board_is_a_program_without_floating_point(image: Path) -> None:
    names = symbols(image)
    assert {"reset", "sf_tick", "sf_loop_step"} <= names.keys()
    assert [name for name in names if FLOATING.match(name)] == []


def stroke(when: si.SecondArray) -> si.MetreArray:
    """Where the board's finger is (m) at times of its clock (s): 40 mm to and fro each second."""
    part = when % 1.0
    return 0.08 * np.minimum(part, 1.0 - part)


@pytest.mark.parametrize(
    "times",
    [pytest.param(1, marks=pytest.mark.slow), pytest.param(3, marks=pytest.mark.nightly)],
)
def test_the_device_check_passes_whole_however_often(image: Path, times: int) -> None:
    """On an idle computer nothing is in doubt; on a busy one what QEMU was held up in may be."""
    for _ in range(times):
        with powered(image, WALL) as talk:
            check = check_device(talk, 30e3, drive="an emulated board", sensor=FINGER, truth=stroke)
        for result in check.results:
            print(f"{result.verdict} {result.name:30} {result.measured} | {result.doubt}")
        assert check.passed


@pytest.mark.nightly
@pytest.mark.realtime
def test_the_loops_hold_the_amplitude_on_the_emulated_board(image: Path) -> None:
    """0.6 V asked for: without loops the pickup had 0.6 V K/|1.5 + 0.4 i| = 0.77 mV."""
    wanted = round(0.6 * RATIO * 1e6)
    # A host that this machine holds up for 50 ms is stopped by the board, as it must be.
    tries = []
    for _ in range(8):
        shown = played(image)
        right = [level == pytest.approx(wanted, rel=0.02) for level in shown]
        if any(all(right[i : i + 5]) for i in range(len(right) - 5)):
            return
        tries.append(shown[::10])
    pytest.fail(f"{wanted} uV were not held: {tries}")


def played(image: Path) -> list[int]:
    """What the pickup shows (µV) in two seconds of 0.6 V."""
    with powered(image, COUNTED) as talk:
        talk.ask(m.Stop(), 2.0)
        talk.ask(m.Hello(1))
        assert accepted(talk, m.limits_message(Limits(2.0, 2000.0, 2.0, 10.0, 29e3, 31e3)))
        for message in (m.Negotiate(2), m.SetLoops(GAINS), m.SwitchLoops(1)):
            assert accepted(talk, message)
        status = talk.ask(m.KeepAlive())
        assert status is not None
        assert accepted(talk, m.Arm(status.token))
        for message in (m.Start(30_000_000), m.Envelope(1000, (0.6,)), m.Report(10_000)):
            accepted(talk, message)
        heard = talk.listen_for(2.0, keep_alive=0.01)
        talk.ask(m.Stop())
    return [one.message.pickup for one in heard if isinstance(one.message, m.Reading)]


def accepted(talk: Conversation, message: m.Message) -> bool:
    status = talk.ask(message, 2.0)
    return status is not None and status.reason == Reason.ACCEPTED
