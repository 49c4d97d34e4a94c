"""The loops in the firmware's C, on this machine and as Arm code, give the integers of Python."""

from __future__ import annotations

import ctypes
import math
import subprocess
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.friction_loop import (
    FrictionState,
    friction_gains,
    friction_step,
)

from squeezefilm.core.compiled import compiled
from squeezefilm.instruments.control import plate_loop as loop
from squeezefilm.instruments.control.gains import IdentifiedPlate, LoopAims, loop_gains
from squeezefilm.instruments.control.plate_loop import (
    QUARTER,
    LoopGains,
    first_state,
    plate_step,
    quotient,
    scaled,
    sine,
)

from .arm import Arm, instruction_counter
from .builds import LOOPS, STRICT, build, tool
from .test_firmware_arm import CORES, FLOATING, MOST_INSTRUCTIONS

STEP = 1e-4
Integers = NDArray[np.int64]


# The same C; under a sanitizer CI runs it.
@pytest.fixture(scope="module", params=["plain", pytest.param("sanitized", marks=pytest.mark.slow)])
def loops(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A program that reads gains and steps and writes states and commands."""
    folder = tmp_path_factory.mktemp("loops")
    flags: tuple[str, ...] = (*STRICT, "-O2")
    if request.param == "sanitized":
        flags = (*STRICT, "-O1", "-fsanitize=undefined", "-fno-sanitize-recover=all")
    return build(tool("cc", "gcc", "clang"), flags, LOOPS, folder / request.param)


def as_bytes(gains: LoopGains, steps: Integers) -> bytes:
    return np.array(gains, np.int64).tobytes() + steps.tobytes()


def in_c(program: Path, gains: LoopGains, steps: Integers) -> Integers:
    given = as_bytes(gains, steps)
    done = subprocess.run([program], input=given, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode(errors="replace")
    return np.frombuffer(done.stdout, np.int64).reshape(len(steps), -1)


@compiled()
def in_python(gains: LoopGains, steps: Integers) -> Integers:
    """State and command after each step of (in phase, quadrature, wanted, applied)."""
    rows = np.empty((len(steps), 15), np.int64)
    state = first_state(gains)
    for n in range(len(steps)):
        p, q, wanted, applied = steps[n]
        state, command = plate_step(gains, state, (p, q), wanted, applied)
        rows[n, 0], rows[n, 1], rows[n, 2], rows[n, 3] = state[0], state[1], state[2], state[3]
        rows[n, 4], rows[n, 5], rows[n, 6], rows[n, 7] = state[4], state[5], state[6], state[7]
        rows[n, 8], rows[n, 9], rows[n, 10], rows[n, 11] = state[8], state[9], state[10], state[11]
        rows[n, 12], rows[n, 13], rows[n, 14] = command
    return rows


def some_gains(pick: np.random.Generator) -> LoopGains:
    quality = float(np.exp(pick.uniform(math.log(5), math.log(1e4))))
    frequency = pick.uniform(2e4, 8e4)
    ratio = float(np.exp(pick.uniform(math.log(4e-5), math.log(4))))
    phase, delay = pick.uniform(-9, 9), pick.uniform(0, 1.95e-3)
    plate = IdentifiedPlate(frequency, quality, ratio, phase, delay)
    aims = LoopAims(
        frequency - pick.uniform(10, 1e4),
        frequency + pick.uniform(10, 5e3),
        100.0,
        20.0,
        lowest_voltage=-float(pick.choice([0, 100])),
        noise=float(pick.choice([0, 10 ** pick.uniform(-6, 0)])),
        floor=float(10 ** pick.uniform(-6, 0)),
        heaviest_load=float(pick.uniform(0, 60)),
    )
    return loop_gains(plate, aims)


def some_steps(pick: np.random.Generator, gains: LoopGains, count: int) -> Integers:
    """A plate near resonance most of the time, and whatever an input can show now and then."""
    applied = np.repeat(pick.integers(-100_000_000, 100_000_001, count // 50 + 1), 50)[:count]
    share = gains.ratio / (1 << 24)
    z = share * applied * (1 + 0.2 * np.cumsum(pick.normal(size=(2, count)), axis=1) / 50)
    angle = 2 * math.pi * gains.turn / (1 << 32) + 0.1 * pick.normal(size=count)
    p, q = z[0] * np.cos(angle), z[0] * np.sin(angle)
    odd = pick.random(count) < 0.01
    p[odd] = pick.choice([0, 1, -1, 2**31 - 1, -(2**31)], odd.sum())
    q[odd] = pick.choice([0, 1, -1, 2**31 - 1, -(2**31)], odd.sum())
    wanted = np.where(odd, pick.integers(0, 2**31, count), np.abs(applied))
    low, high = -(2**31), 2**31 - 1
    columns = (np.clip(p, low, high), np.clip(q, low, high), wanted, applied)
    return np.stack(columns, axis=1).astype(np.int64)


def test_random_streams_give_the_same_integers_in_c(loops: Path) -> None:
    pick = np.random.default_rng(51)
    seen = Counter[int]()
    for number in range(60):
        gains = some_gains(pick)
        steps = some_steps(pick, gains, 4000)
        expected = in_python(gains, steps)
        assert np.array_equal(in_c(loops, gains, steps), expected), number
        seen.update(expected[:, 0].tolist())
    assert all(seen[mode] > 100 for mode in range(5)), seen


def test_a_plate_that_is_found_locked_and_lost_in_c(loops: Path) -> None:
    """Fed with what it asked for: a plate of Q 150 that breaks for 15 ms."""
    gains = loop_gains(IdentifiedPlate(30e3, 150.0, 2e-3), LoopAims(29.2e3, 30.2e3, 100.0, 20.0))
    steps = closed_loop(gains, 8000)
    expected = in_python(gains, steps)
    assert expected[-1, 0] == loop.LOCKED
    assert expected[-1, 9] == 1
    assert np.array_equal(in_c(loops, gains, steps), expected)


def test_the_friction_loop_gives_the_same_integers_in_c(tmp_path: Path) -> None:
    flags = (*STRICT, "-O2", "-shared", "-fPIC")
    compiler = tool("cc", "gcc", "clang")
    built = ctypes.CDLL(str(build(compiler, flags, LOOPS[:1], tmp_path / "loops.so")))
    in_c = built.sf_friction_step
    in_c.restype = wide = ctypes.c_int64
    pick = np.random.default_rng(53)
    voltage = np.linspace(0, 100, 50)
    gains, levels = friction_gains(
        voltage, 0.6 * np.exp(-voltage / 40), 40.0, 1.5e-3, 2e-4, 1e-3, 0.2
    )
    state, other = FrictionState(), np.zeros(3, np.int64)
    given, flag = np.array(gains, np.int64), wide()
    seen = Counter[int]()
    for n in range(20_000):
        if n % 500 == 0:
            wanted = int(pick.choice([0, 200_000, 300_000, 700_000, 2**30]))
        measured = int(pick.integers(0, 600_000) if n % 97 else pick.integers(-(2**31), 2**31))
        fresh = n % 5 == 0
        state, command = friction_step(gains, levels, state, wanted, measured, fresh)
        level = in_c(
            given.ctypes.data_as(ctypes.c_void_p),
            levels.ctypes.data_as(ctypes.c_void_p),
            other.ctypes.data_as(ctypes.c_void_p),
            wide(wanted),
            wide(measured),
            ctypes.c_int(fresh),
            ctypes.byref(flag),
        )
        assert (level, flag.value, other.tolist()) == (*command, list(state)), n
        seen[command.flags] += 1
    assert all(seen[flags] > 20 for flags in range(4)), seen


@pytest.mark.parametrize("core", CORES)
def test_the_loops_on_arm_are_the_same_and_short(core: str, tmp_path: Path) -> None:
    """On an emulated core, never on a board; the tick of the state machine takes its part too,
    which `test_firmware_arm` counts."""
    arm = Arm(core, tmp_path, instruction_counter(tmp_path), "host_loops")
    pick = np.random.default_rng(52)
    for number in range(6):
        gains = some_gains(pick)
        steps = some_steps(pick, gains, 1500) if number else closed_loop(gains, 1500)
        done = np.frombuffer(arm.loop_steps(as_bytes(gains, steps), len(steps)), np.int64)
        assert np.array_equal(done.reshape(len(steps), -1), in_python(gains, steps)), number
    print(f"{core}: at most {arm.work.step} instructions a step, {arm.work.stack} bytes of stack")
    assert arm.work.step <= MOST_INSTRUCTIONS[core] // 2
    assert [name for name in arm.symbols if FLOATING.match(name)] == []


@compiled()
def closed_loop(gains: LoopGains, count: int) -> Integers:
    """The steps of a plate that answers what the loops ask."""
    steps = np.empty((count, 4), np.int64)
    state = first_state(gains)
    z, level, carrier = 0j, 0, gains.highest_frequency
    tau = 1.0 / (2.0 * math.pi * gains.half_bandwidth * 1e-3)
    for n in range(count):
        load = 5e3 if 5000 < n < 5150 else 0.3
        rate = complex(1.0 + load, (carrier - gains.reference) / gains.half_bandwidth)
        rest = gains.ratio / (1 << 24) * level / rate
        z = rest + (z - rest) * np.exp(-rate * STEP / tau)
        p, q = round(z.real), round(z.imag)
        steps[n, 0], steps[n, 1], steps[n, 2], steps[n, 3] = p, q, 30_000_000, level
        state, command = plate_step(gains, state, (p, q), 30_000_000, level)
        level, carrier = command.level, command.frequency
    return steps


def test_the_arithmetic() -> None:
    turns = np.linspace(-2, 2, 4001)
    sines = [sine(round(turn * 4 * QUARTER)) / QUARTER for turn in turns]
    assert np.abs(sines - np.sin(2 * math.pi * turns)).max() < 1e-6
    for value in (0, 1, 2, 3, 5, 6, 7, 1000, 2**61):
        assert scaled(value, 2) == -scaled(-value, 2) == math.floor(value / 4 + 0.5)
        assert quotient(-value, 4) == -(value // 4)
