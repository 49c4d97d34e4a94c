"""The firmware's Arm machine code does what the Python twin does, and no call of it is long."""

import ctypes
import random
import re
from collections.abc import Callable
from dataclasses import astuple
from pathlib import Path

import pytest

from squeezefilm.instruments.control.plate_loop import LOCKED
from squeezefilm.instruments.device.machine.limits import DeviceLimits

from .arm import Arm, ArmMachine, firmware_alone, instruction_counter
from .recording import (
    SESSIONS,
    Recording,
    adversarial,
    mauled,
    noise,
)
from .test_device_check import checked, failed

MOST_INSTRUCTIONS = {"cortex-m0plus": 25_000, "cortex-m3": 10_000, "cortex-m4": 10_000}
"""Of one call: at 125 MHz, and up to two cycles for an instruction, within the 1 ms of a tick."""
# The same C on this machine's own processor is what `make test` runs.
CORES = [pytest.param(core, marks=pytest.mark.slow) for core in MOST_INSTRUCTIONS]
FLOATING = re.compile(r"__aeabi_(c?[df]\w+|\w+2[dfh])|__\w+[sd]f([23]|[ds]i)?$")
"""What a compiler calls floating point by, where a core has none."""


@pytest.fixture(scope="module")
def counter(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    return instruction_counter(tmp_path_factory.mktemp("counter"))


@pytest.fixture(scope="module", params=CORES)
def arm(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, counter: ctypes.CDLL
) -> Arm:
    return Arm(request.param, tmp_path_factory.mktemp(request.param), counter)


def check(arm: Arm, recording: Recording) -> None:
    assert arm.record(recording) == recording.record
    work = arm.work
    print(f"{arm.core}: at most {work.receive} instructions a byte and {work.tick} a tick,")
    print(f"{work.stack} bytes of stack (the harness's own among them)")
    assert max(work.receive, work.tick) <= MOST_INSTRUCTIONS[arm.core]


@pytest.mark.parametrize("made", SESSIONS, ids=lambda m: m.__name__)
def test_what_the_twin_did_on_arm(arm: Arm, made: Callable[[], Recording]) -> None:
    check(arm, made())


def test_adversarial_streams_on_arm(arm: Arm) -> None:
    for seed in (0, 11):  # without a sensor, and with one and loops that lock
        check(arm, adversarial(seed, 1_500))
    locked = adversarial(11, 1_500).seen["loops", LOCKED]
    print(f"locked in {locked} of 1500 steps")
    assert locked > 50
    check(arm, noise(9, 2_000))


@pytest.mark.parametrize(
    "times", [pytest.param(1, marks=pytest.mark.slow), pytest.param(3, marks=pytest.mark.nightly)]
)
def test_the_device_check_passes_whole_so_often_in_a_row(arm: Arm, times: int) -> None:
    """On the emulated core's own clock: watchdog, limits and stop as Arm code has them."""
    machine = ArmMachine(arm, astuple(DeviceLimits()), 100)
    for attempt in range(times):
        check = checked(machine)  # type: ignore[arg-type]
        assert check.passed, (attempt, failed(check))


@pytest.mark.nightly
def test_many_adversarial_streams_on_arm(arm: Arm) -> None:
    first = random.SystemRandom().randrange(2**31)
    print(f"seeds {first} ... {first + 19}")
    for seed in range(first, first + 20):
        check(arm, adversarial.__wrapped__(seed, 3_000))
    check(arm, mauled.__wrapped__(first, 2_000_000))


def test_the_image_is_small_and_holds_no_floating_point(arm: Arm, tmp_path: Path) -> None:
    names, flash = firmware_alone(arm.core, tmp_path)
    _, ram = arm.symbols["machine"]
    print(f"{arm.core}: {flash} bytes of flash, {ram} of RAM")
    assert "sf_receive" in names
    assert [name for name in names if FLOATING.match(name)] == []
    assert flash <= 8 * 1024
    assert ram <= 7 * 1024


def test_floating_point_would_be_found() -> None:
    for name in ("__aeabi_dmul", "__aeabi_f2d", "__aeabi_d2lz", "__aeabi_cdcmple", "__aeabi_ui2d"):
        assert FLOATING.match(name)
    for name in ("__muldf3", "__floatsidf", "__fixunsdfdi"):
        assert FLOATING.match(name)
    for name in ("__aeabi_uidivmod", "__aeabi_ldivmod", "__aeabi_lmul", "__aeabi_llsl", "__clzdi2"):
        assert not FLOATING.match(name)
