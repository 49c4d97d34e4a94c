"""Channels, lines and rhythms against what can be worked out by hand."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.special import ndtr

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.physics.perception.observer import (
    TUNED_AT,
    FingerClass,
    SensoryChannel,
    load_observer,
)
from squeezefilm.physics.perception.percepts import grating_percept, indentation
from squeezefilm.physics.perception.senses import (
    D_PRIME_OF_75,
    SPACING,
    Evidence,
    candidates,
    channel_gains,
    evidence,
    line_amplitudes,
    line_periods,
    percept_deviation,
    spatial_sensitivity,
)
from squeezefilm.physics.perception.stimuli import Grating

OBSERVER = load_observer()
WAY = np.arange(2e-3, 40e-3, SPACING)


def at(period: float, values: np.ndarray) -> float:
    return float(np.interp(period, line_periods(), values))


def square(period: float) -> np.ndarray:
    return np.where((WAY / period) % 1.0 < 0.5, 0.5, -0.5)


def test_every_value_of_a_preset_says_where_it_is_from() -> None:
    fields = {one.name for one in dataclasses.fields(OBSERVER)}
    fields -= {"name", "title", "channels", "provenance"}
    assert fields <= set(OBSERVER.provenance)
    assert {one.evidence for one in OBSERVER.provenance.values()} == {
        "published", "assumed", "derived",
    }  # fmt: skip


def test_an_unknown_observer_is_refused_with_those_there_are() -> None:
    with pytest.raises(ConfigError, match="fingertip"):
        load_observer("fingertop")


def test_the_median_finger_is_alone_and_six_spread_about_it() -> None:
    (alone,) = dataclasses.replace(OBSERVER, finger_classes=1).fingers()
    assert (alone.contact_length, alone.speed) == pytest.approx((10e-3, 80e-3))
    six = OBSERVER.fingers()
    assert six == OBSERVER.fingers()
    assert np.exp(np.mean(np.log([one.speed for one in six]))) == pytest.approx(80e-3)
    assert {one.moisture for one in six} == {"dry", "normal", "moist"}


def test_a_channel_has_its_corners_and_slopes() -> None:
    channel = SensoryChannel("RA", 8.0, 64.0, 1e-5)

    def gain(frequency: float, of: SensoryChannel = channel, speed: float = 0.08) -> float:
        return float(of.gain(speed / frequency, speed))

    assert gain(64.0) == pytest.approx(1 / math.sqrt(2), rel=1e-3)
    assert gain(8.0) == pytest.approx(1 / math.sqrt(2), rel=1e-3)
    assert gain(0.1) / gain(0.05) == pytest.approx(4.0, rel=1e-2)
    assert gain(5e3) / gain(1e4) == pytest.approx(4.0, rel=1e-2)
    # One that goes by the period, and one that goes half by it, answer at 50 mm/s as this one does.
    for exponent, as_at in ((0.0, TUNED_AT), (0.5, math.sqrt(TUNED_AT * 0.2))):
        tuned = dataclasses.replace(channel, speed_exponent=exponent)
        assert tuned.gain(1e-3, TUNED_AT) == pytest.approx(channel.gain(1e-3, TUNED_AT))
        assert tuned.gain(1e-3, 0.2) == pytest.approx(channel.gain(1e-3, as_at))
    with pytest.raises(InputError, match="high"):
        SensoryChannel("none", 8.0, 8.0, 1e-5)


def test_a_line_has_its_amplitude_whatever_its_phase_and_the_drift() -> None:
    for phase in (0.0, 1.0, 2.5):
        wave = 3e-6 * np.sin(2 * math.pi * WAY / 2e-3 + phase) + 1e-3 + 5e-3 * WAY
        assert at(2e-3, line_amplitudes(wave[None, :])) == pytest.approx(3e-6, rel=0.01)


def test_the_noise_of_a_channel_is_its_threshold_and_what_stretch_masks() -> None:
    channel = SensoryChannel("all", 0.0, 1e9, 3e-6, masking=0.01)
    assert channel.noise(0.0) == pytest.approx(3e-6)
    assert channel.noise(4e-4) == pytest.approx(5e-6)
    assert channel.noise(-4e-4) == pytest.approx(5e-6)
    alone = dataclasses.replace(OBSERVER, channels=(channel,), harmonics=1)
    lines = line_amplitudes(5e-6 * np.sin(2 * math.pi * WAY / 2e-3)[None, :])
    gains = channel_gains(alone, np.full(WAY.size, 0.08))
    assert evidence(alone, lines, gains, 4e-4).at(2e-3) == pytest.approx(1.0, rel=0.01)


def test_a_weber_fraction_is_told_in_three_quarters_of_two_intervals() -> None:
    assert pytest.approx(math.sqrt(2) * 0.6744897502, rel=1e-9) == D_PRIME_OF_75
    apart = math.log1p(0.2) / percept_deviation(0.2)
    assert ndtr(apart / math.sqrt(2)) == pytest.approx(0.75)
    with pytest.raises(InputError, match="weber_fraction"):
        percept_deviation(0.0)


def test_equal_ratios_of_clear_strengths_are_equally_far_apart() -> None:
    """And a faint strength is in steps of the noise of nothing."""
    step = percept_deviation(OBSERVER.strength_weber_fraction)
    faint, clear, clearer, more = (
        candidates(OBSERVER, _of_lines({4e-3: d_prime}, 1, 0.5)).d_prime[0]
        for d_prime in (0.3, 50.0, 60.0, 72.0)
    )
    assert faint == pytest.approx(0.3, rel=1e-3)
    assert clearer - clear == pytest.approx(more - clearer, rel=1e-2)
    assert clearer - clear == pytest.approx(math.log(1.2) / step, rel=1e-2)


def test_a_square_is_pi_over_four_clearer_than_a_sine_of_its_swing() -> None:
    amplitudes = [
        at(4e-3, line_amplitudes(one[None, :]))
        for one in (square(4e-3), 0.5 * np.sin(2 * math.pi * WAY / 4e-3))
    ]
    assert amplitudes[0] / amplitudes[1] == pytest.approx(4 / math.pi, rel=0.01)


def test_the_fundamental_wins_and_its_multiples_are_explained_by_it() -> None:
    gains = channel_gains(OBSERVER, np.full(WAY.size, 0.08))
    lines = line_amplitudes(2e-4 * square(2e-3)[None, :])
    found = candidates(OBSERVER, evidence(OBSERVER, lines, gains, 4e-4))
    assert found.period[0] == pytest.approx(2e-3, rel=0.01)
    assert found.d_prime[0] > 5 * found.d_prime[1]


def test_nothing_gives_no_candidate() -> None:
    gains = channel_gains(OBSERVER, np.full(WAY.size, 0.08))
    silent = line_amplitudes(np.full((2, WAY.size), 3e-4))
    found = candidates(OBSERVER, evidence(OBSERVER, silent, gains, 3e-4))
    assert np.all(np.isneginf(found.d_prime))


def test_the_published_spatial_sensitivity() -> None:
    assert spatial_sensitivity(0.7e-3) == 0.0
    assert spatial_sensitivity(0.87e-3) == pytest.approx(4.25 * 0.32)
    assert spatial_sensitivity(5e-3) == spatial_sensitivity(3e-3)


def test_skin_bulges_with_pressure_until_it_meets_the_floor() -> None:
    fine = Grating("fine", 0.4e-3, "period")
    assert indentation(fine, 5e3, 100e3) == pytest.approx(10e-6)
    assert indentation(Grating("coarse", 10e-3, "period"), 5e3, 100e3) == 70e-6
    with pytest.raises(InputError, match="pressure"):
        indentation(fine, 0.0, 100e3)


@pytest.mark.parametrize("means", ["period", "groove width"])
def test_a_real_grating_is_felt_at_its_whole_period(means: str) -> None:
    finger = OBSERVER.fingers()[0]
    for length in (0.4e-3, 2e-3, 4e-3):
        grating = Grating("one", length, means)  # type: ignore[arg-type]
        found = grating_percept(grating, OBSERVER, finger)
        assert found.candidates.period[0] == pytest.approx(grating.period, rel=0.02)
        assert found.candidates.d_prime[0] > 5.0


def _of_lines(power: dict[float, float], harmonics: int, weight: float) -> Evidence:
    """Evidence of lines that are each as clear as said, in one channel."""
    wide = SensoryChannel("all", 0.0, 1e9, 1.0)
    one = dataclasses.replace(
        OBSERVER, channels=(wide,), harmonics=harmonics, harmonic_weight=weight
    )
    periods = line_periods()
    amplitude = np.zeros_like(periods)
    for period, d_prime in power.items():
        amplitude[np.argmin(np.abs(np.log(periods / period)))] = d_prime
    return evidence(one, amplitude, np.ones((1, periods.size)), 0.0)


def test_a_rhythm_is_the_root_of_the_squares_of_its_harmonics() -> None:
    periods = line_periods()
    base = periods[np.argmin(np.abs(np.log(periods / 6e-3)))]
    found = _of_lines({base: 3.0}, 3, 0.5)
    # A line alone is as evident as a rhythm of its own period, of twice and of three times it.
    assert found.at(base) == pytest.approx(3.0)
    # Between two steps of 0.4 % the power is interpolated: at the nearest at least half is left.
    for times in (2, 3):
        near = np.abs(np.log(found.period / (times * base))) < 0.0045
        heights = (found.rhythm[near] / 3.0) ** 2
        assert heights.sum() == pytest.approx(1.0, abs=1e-6)
    # Nothing shorter is made of it, and nothing four times as long.
    assert np.all(found.rhythm[found.period < 0.99 * base] == 0)
    assert found.at(3.3 * base if 3.3 * base < 20e-3 else 19.9e-3) == 0
    alone = _of_lines({base: 3.0}, 1, 0.5)
    assert alone.at(2 * base) == 0
    # The shortest period is the rhythm: harmonics count by 0.5, 0.25 …
    assert candidates(OBSERVER, found).period[0] == pytest.approx(base)


def test_the_harmonics_of_a_rhythm_may_be_clearer_than_its_fundamental() -> None:
    """A square grating of 8 mm is felt by its edges, which the fast channel tells, and is felt as
    one of 8 mm: not as its third harmonic."""
    periods = line_periods()
    lines = {8e-3 / order: d_prime for order, d_prime in ((1, 1.0), (3, 3.5), (5, 3.0), (7, 2.0))}
    near = {periods[np.argmin(np.abs(np.log(periods / one)))]: d for one, d in lines.items()}
    found = candidates(OBSERVER, _of_lines(near, OBSERVER.harmonics, OBSERVER.harmonic_weight))
    assert found.period[0] == pytest.approx(8e-3, rel=0.01)


def test_the_lines_of_a_rhythm_add_up() -> None:
    periods = line_periods()
    base = periods[np.argmin(np.abs(np.log(periods / 8e-3)))]
    half = _of_lines({base: 3.0, base / 2: 4.0}, 2, 0.5)
    nearest = float(np.log(base / 2 / periods[np.argmin(np.abs(np.log(periods * 2 / base)))]))
    # The share of the line at half the period that falls to the base's own step.
    share = 1 - abs(nearest) / 0.004
    assert half.at(base) == pytest.approx(math.sqrt(9.0 + 16.0 * share), rel=1e-6)


def test_a_real_grating_is_refused_below_nothing() -> None:
    with pytest.raises(InputError, match="groove_width"):
        spatial_sensitivity(-1e-9)
    assert spatial_sensitivity(0.0) == 0.0
    assert spatial_sensitivity(0.7001e-3) == pytest.approx(4.25 * 0.1501)
    assert spatial_sensitivity(3e-3) == pytest.approx(4.25 * 2.45)
    assert spatial_sensitivity(2.9e-3) < spatial_sensitivity(3e-3)


@pytest.mark.parametrize("name", ["contact_length", "ridge_angle", "normal_force", "speed"])
def test_a_finger_of_nan_is_none(name: str) -> None:
    finger = FingerClass(1e-2, 0.0, "normal", 0.5, 0.08)
    with pytest.raises(InputError, match=f"{name} = nan"):
        dataclasses.replace(finger, **{name: math.nan})  # type: ignore[arg-type]
