"""The loops on plates of first order: closed forms, drift, landings, steps, and what goes wrong."""

import math
from dataclasses import replace

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.instruments.control import plate_loop as loop
from squeezefilm.instruments.control.gains import (
    IdentifiedPlate,
    LoopAims,
    calibrated_phase,
    loop_gains,
    tracking_bandwidth,
    within_bounds,
)

from .simulated_plate import (
    FALSE,
    FLAGS,
    FREQUENCY,
    LEVEL,
    LOAD,
    LOST,
    MODE,
    RE,
    RESONANCE,
    SIZE,
    TruePlate,
    held,
)

F0, RATIO, RATE, STEP = 30e3, 2e-3, 192e3, 1e-4
QUALITIES = (20, 50, 150, 300, 1000)
AIMS = LoopAims(F0 - 800, F0 + 200, 100.0, 20.0)


def identified(quality: float) -> IdentifiedPlate:
    return IdentifiedPlate(F0, quality, RATIO, -math.pi * F0 / RATE, 0.5 / RATE)


def true(quality: float, **other: float) -> TruePlate:
    return TruePlate(quality, RATIO, 0.5 / RATE, 0.0, STEP)._replace(**other)


def run(
    quality: float,
    seconds: float,
    aims: LoopAims = AIMS,
    wanted: si.FloatArray | float = 30e6,
    shift: si.FloatArray | float = 0.0,
    load: si.FloatArray | float = 0.0,
    plate: TruePlate | None = None,
    **other: float,
) -> si.FloatArray:
    """Rows of a run; the arrays are of its steps, `other` is what the loops do not know."""
    blank = np.zeros(round(seconds / STEP))
    gains = loop_gains(identified(quality), aims)
    return held(
        gains, plate or true(quality, **other), blank + wanted, blank + F0 + shift, blank + load
    )


def detuning(rows: si.FloatArray, quality: float, load: si.FloatArray | float = 0.0) -> float:
    """The largest, over the loaded half-bandwidth."""
    apart = np.abs(rows[:, FREQUENCY] - rows[:, RESONANCE])
    return float((apart * 2 * quality / (F0 * (1 + np.asarray(load)))).max())


def transfer(answer: si.FloatArray, cause: si.FloatArray, frequency: float) -> complex:
    wave = np.exp(-2j * math.pi * frequency * STEP * np.arange(cause.size))
    return complex((answer @ wave) / (cause @ wave))


@pytest.mark.parametrize("quality", [20, 100, 1000])
@pytest.mark.parametrize("frequency", [10, 50, 100, 200])
def test_amplitude_and_frequency_follow_their_closed_forms(quality: int, frequency: int) -> None:
    gains = loop_gains(identified(quality), AIMS)
    t, last = STEP * np.arange(30_000), slice(-10_000, None)
    turn = np.exp(2j * math.pi * frequency * STEP)
    wave = np.sin(2 * math.pi * frequency * t)
    wanted = 30e6 + 1e6 * wave
    rows = run(quality, 3, wanted=wanted, at_end=True)
    pole = math.exp(-STEP / AIMS.amplitude_time)
    expected = (1 - pole) / (turn - pole) * RATIO
    assert transfer(rows[last, RE], wanted[last], frequency) == pytest.approx(expected, rel=1e-3)
    shift = 0.5 * wave
    rows = run(quality, 3, shift=shift, at_end=True)
    drive = (gains.track_share + gains.rate_share * turn / (turn - 1)) / (1 << 24)
    expected = drive / (turn - 1 + drive)
    assert transfer(rows[last, FREQUENCY] - F0, shift[last], frequency) == pytest.approx(
        expected, rel=0.02
    )


def test_the_amplitude_is_3_db_down_at_its_bandwidth() -> None:
    frequency = 1 / (2 * math.pi * AIMS.amplitude_time)
    t = STEP * np.arange(40_000)
    wanted = 30e6 + 1e6 * np.sin(2 * math.pi * frequency * t)
    rows = run(100, 4, wanted=wanted, at_end=True)
    whole = slice(-round(20 / frequency / STEP), None)
    answer = transfer(rows[whole, RE], wanted[whole], frequency) / RATIO
    assert abs(answer) == pytest.approx(math.sqrt(0.5), abs=0.01)
    # Half a step of hold beside the 45° of a first order.
    assert math.degrees(math.atan2(answer.imag, answer.real)) == pytest.approx(-45, abs=2.5)


@pytest.mark.parametrize("quality", QUALITIES)
def test_a_drift_and_a_landing_finger_leave_less_than_a_twentieth(quality: int) -> None:
    t = STEP * np.arange(30_000)
    drift = -200 * np.clip(t - 2, 0, None)
    assert detuning(run(quality, 3, shift=drift)[20_000:], quality) < 0.05
    # A finger that lowers 34.6 kHz by 150 Hz in 50 ms, and takes a Q of 150 to 110 (on 8.5 g).
    down = np.clip((t - 2) / 0.05, 0, 1)
    load = 0.36 * quality / 150 * down
    rows = run(quality, 3, wanted=20e6, shift=-150 * down, load=load)
    assert detuning(rows[20_000:], quality, load[20_000:]) < 0.05
    assert rows[-1, LOAD] == pytest.approx(load[-1], rel=1e-3)
    assert rows[-1, SIZE] == pytest.approx(20e6 * RATIO, rel=1e-3)
    assert rows[-1, LOST] == rows[-1, FALSE] == 0


def test_an_uncalibrated_hold_pulls_the_loop_most_of_a_half_bandwidth_off() -> None:
    plate = IdentifiedPlate(F0, 100, RATIO)
    blank = np.zeros(20_000)
    rows = held(loop_gains(plate, AIMS), true(100), blank + 30e6, blank + F0, blank)
    off = (rows[-1, FREQUENCY] - F0) * 200 / F0
    assert off == pytest.approx(math.tan(-math.pi * F0 / RATE), rel=0.01)


def test_the_phase_is_calibrated_over_frequency() -> None:
    frequency = np.linspace(29e3, 31e3, 21)
    turned = np.angle(np.exp(1j * (1.0 - 2 * math.pi * frequency * 40e-6)))
    middle, phase, delay, rest = calibrated_phase(frequency, turned)
    assert (middle, delay) == (pytest.approx(30e3), pytest.approx(40e-6))
    assert np.exp(1j * phase) == pytest.approx(np.exp(1j * (1.0 - 2 * math.pi * 30e3 * 40e-6)))
    assert rest < 1e-9
    with pytest.raises(InputError, match="three frequencies"):
        calibrated_phase(frequency[:2], turned[:2])


@pytest.mark.parametrize("quality", QUALITIES)
def test_a_step_takes_2_to_10_ms_within_the_voltage(quality: int) -> None:
    t = STEP * np.arange(23_000)
    wanted = np.where((t > 2) & (t < 2.15), 20e6, 10e6)
    braking = replace(AIMS, lowest_voltage=-AIMS.highest_voltage)
    for aims in (AIMS, braking):
        rows = run(quality, 2.3, aims, wanted=wanted)
        size = rows[:, SIZE] / (1e6 * RATIO)
        rise, fall = np.abs(size[20_000:21_500] - 20), np.abs(size[21_500:] - 10)
        for away in (rise, fall):
            settled = (np.flatnonzero(away > 0.5)[-1] + 1) * STEP
            assert 2e-3 <= settled <= 10e-3
        assert size.max() < 20.2
        assert rows[:, LEVEL].max() <= 100e6
        assert rows[:, LEVEL].min() >= aims.lowest_voltage * 1e6


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("late", [0, 1])
def test_no_limit_cycle_with_a_tenth_of_error_in_every_parameter(quality: int, late: int) -> None:
    """Also where the pickup is a step late."""
    for number in range(8):
        wrong = [1 + 0.1 * (1 if number >> bit & 1 else -1) for bit in range(3)]
        plate = TruePlate(
            quality * wrong[0], RATIO * wrong[1], 0.5 / RATE * wrong[2], 0.0, STEP, late=late
        )
        rows = run(quality, 2.5, shift=10.0, load=0.1, plate=plate)[-2000:]
        assert np.all(rows[:, MODE] == loop.LOCKED)
        assert np.ptp(rows[:, FREQUENCY]) * 2 * quality / F0 < 2e-3
        assert np.ptp(rows[:, SIZE]) < 1e-4 * 30e6 * RATIO
        # What the phase is wrong by leaves the cosine of it, and tan 2.8° of the half-bandwidth.
        assert rows[-1, SIZE] == pytest.approx(30e6 * RATIO, rel=2e-3)
        assert detuning(rows, quality) < 0.07


def test_what_noise_does_to_frequency_and_amplitude() -> None:
    """A pickup with a thousandth of noise in each step."""
    for quality in (50, 300):
        rows = run(quality, 3, noise=1e-3 * 30e6 * RATIO)[20_000:]
        apart = (rows[:, FREQUENCY] - F0) * 2 * quality / F0
        assert 1e-4 < apart.std() < 0.02
        assert rows[:, SIZE].std() < 2e-3 * 30e6 * RATIO


def test_a_softening_plate_is_taken_from_above() -> None:
    """It softens by 15 half-bandwidths at the level wanted, where 1.54 make two amplitudes of one
    frequency; a carrier that stays at the cold resonance gets a quarter."""
    quality, half = 300, F0 / 600
    softening = 15 * half / (30 * RATIO) ** 2
    rows = run(quality, 3, replace(AIMS, search_voltage=10.0), softening=softening)
    assert rows[-1, MODE] == loop.LOCKED
    assert rows[-1, LOST] == rows[-1, FALSE] == 0
    assert rows[-1, SIZE] == pytest.approx(30e6 * RATIO, rel=1e-3)
    assert rows[-1, RESONANCE] == pytest.approx(F0 - 15 * half, abs=0.5 * half)
    assert detuning(rows[-2000:], quality) < 0.05


def test_a_turned_pickup_is_reported_and_gets_no_voltage() -> None:
    rows = run(150, 2, ratio=-RATIO)
    assert rows[-1, MODE] == loop.WRONG_SIGN
    assert np.all(rows[rows[:, MODE] == loop.WRONG_SIGN, LEVEL] == 0)


def test_a_plate_outside_the_search_is_not_found() -> None:
    assert run(150, 2, shift=-3000.0)[-1, MODE] == loop.NOT_FOUND
    assert run(150, 2, ratio=0.0)[-1, MODE] == loop.NOT_FOUND


@pytest.mark.parametrize("leak", [RATIO / 4, RATIO])
def test_crosstalk_is_no_lock(leak: float) -> None:
    """Crosstalk in phase with the drive alone, as large as the plate's own signal or smaller."""
    rows = run(150, 2, ratio=0.0, leak=leak)
    assert rows[-1, FALSE] >= 1
    assert rows[-1, MODE] == loop.NOT_FOUND
    assert not np.any(rows[:, MODE] == loop.LOCKED)


def test_a_heavier_mode_on_the_way_is_passed_by() -> None:
    """Ten times the mass: a tenth of the amplitude at the same Q. Then the plate's own."""
    blank = np.zeros(6000)
    gains = loop_gains(identified(150), AIMS)
    rows = held(gains, true(150, ratio=RATIO / 10), blank + 30e6, blank + F0 + 50, blank)
    assert rows[-1, FALSE] == 1
    assert not np.any(rows[:, MODE] == loop.LOCKED)


def test_a_lost_lock_is_counted_and_found_again() -> None:
    t = STEP * np.arange(30_000)
    broken = run(150, 3, load=np.where((t > 1) & (t < 1.015), 5e3, 0.0))
    assert broken[-1, LOST] >= 1
    assert broken[-1, MODE] == loop.LOCKED
    assert broken[-1, SIZE] == pytest.approx(30e6 * RATIO, rel=1e-3)


def test_saturation_is_flagged_and_leaves_no_windup() -> None:
    t = STEP * np.arange(25_000)
    rows = run(150, 2.5, wanted=np.where((t > 1.5) & (t < 2), 150e6, 30e6))
    over = (t > 1.6) & (t < 2)
    assert np.all(rows[over, FLAGS] == loop.LEVEL_HELD)
    assert np.all(rows[over, LEVEL] == 100e6)
    after = rows[round(2.01 / STEP) :]
    assert np.all(after[:, FLAGS] == 0)
    assert np.abs(after[:, SIZE] / (30e6 * RATIO) - 1).max() < 0.02


def test_a_texture_is_played_under_a_finger_without_losing_the_lock() -> None:
    """Full modulation at 80 Hz, down to no drive; amplitude and phase follow the closed form."""
    t = STEP * np.arange(30_000)
    wanted = 20e6 * (1 + np.sin(2 * math.pi * 80 * t))
    braking = replace(AIMS, lowest_voltage=-AIMS.highest_voltage)
    rows = run(150, 3, braking, wanted=wanted, load=0.4, shift=-100.0)
    assert rows[-1, LOST] == rows[-1, FALSE] == 0
    last = slice(-10_000, None)
    pole = math.exp(-STEP / AIMS.amplitude_time)
    turn = np.exp(2j * math.pi * 80 * STEP)
    answer = transfer(rows[last, RE], wanted[last] - 20e6, 80) / RATIO
    assert answer == pytest.approx((1 - pole) / (turn - pole), rel=0.03)
    assert detuning(rows[last], 150) < 0.05


def test_what_cannot_be_held_is_refused() -> None:
    with pytest.raises(OutOfRangeError, match="tenth of their rate"):
        loop_gains(identified(100), replace(AIMS, tracking_bandwidth=2e3))
    with pytest.raises(OutOfRangeError, match="outside the allowed"):
        loop_gains(replace(identified(100), frequency=40e3), AIMS)
    with pytest.raises(InputError, match="which is highest_frequency"):
        replace(AIMS, lowest_frequency=40e3)
    with pytest.raises(InputError, match="search_voltage"):
        replace(AIMS, search_voltage=200.0)
    assert tracking_bandwidth(loop_gains(identified(100), AIMS), STEP) == pytest.approx(700)


def test_a_loop_of_a_tenth_of_its_rate_is_held_and_none_faster() -> None:
    aims = replace(AIMS, interval=1e-3, amplitude_time=5e-3, tracking_bandwidth=10.0)
    for name in ("tracking_bandwidth", "load_bandwidth"):
        loop_gains(identified(100), replace(aims, **{name: 100.0}))
        with pytest.raises(OutOfRangeError, match=f"{name} = 100.1 Hz is too fast .* 100 Hz"):
            loop_gains(identified(100), replace(aims, **{name: 100.1}))
    # 1/(2π 1.5 ms) is 106 Hz.
    with pytest.raises(OutOfRangeError, match=r"amplitude_time.* = 106\.1"):
        loop_gains(identified(100), replace(aims, amplitude_time=1.5e-3))


def test_what_a_device_would_refuse_is_refused_with_what_it_allows() -> None:
    aims = LoopAims(100e3, 300e3, 100.0, 20.0)
    edge = IdentifiedPlate(2 * 5.0 * 16_777.0, 5.0, RATIO)
    assert within_bounds(loop_gains(edge, aims), 100_000_000, 300_000_000, 100_000_000)
    for plate, said, says in (
        (replace(edge, frequency=170e3), aims, "half_bandwidth = 17000 Hz .* to 16777.2 Hz; it is"),
        (edge, replace(aims, highest_frequency=3e6), "highest_frequency = 3e.06 Hz .* lower it"),
        (edge, replace(aims, search_voltage=1e-7), "search_level = 0 V .* raise search_voltage"),
        (replace(edge, frequency=1.0, quality_factor=1e4), replace(aims, lowest_frequency=0.5),
         "change plate or aims"),
    ):  # fmt: skip
        with pytest.raises(OutOfRangeError, match=says):
            loop_gains(plate, said)
