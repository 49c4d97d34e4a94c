"""A decay: one mode, two that beat, one whose loss depends on its amplitude."""

import numpy as np
import pytest
from tests.made_bench.duffing import SofteningResonance

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.least_squares import fit_separable
from squeezefilm.measure.fits.vibration.ring_down import (
    _Bent,
    _Decay,
    _strongest_line,
    fit_ring_down,
)
from squeezefilm.measure.recordings.kinds import RingDown

T = np.arange(1500) / 500e3
F, Q, A = 33.2e3, 60.0, 1.5e-6


def decay(f: float = F, quality: float = Q, size: float = A, noise: float = 0.01):
    w = size * np.exp(-np.pi * f / quality * T) * np.cos(2 * np.pi * f * T + 0.4)
    return w + noise * size * np.random.default_rng(1).standard_normal(T.size)


def test_one_decay() -> None:
    fit = fit_ring_down(RingDown(T, decay()))
    assert fit.adequacy.adequate
    assert fit.damping_rise is None
    assert fit.second is None
    assert fit.frequency.value == pytest.approx(F, rel=2e-4)
    assert fit.quality_factor.value == pytest.approx(Q, rel=0.02)
    assert fit.amplitude.value == pytest.approx(A, rel=0.02)
    assert [one.answer for one in fit.observations] == ["resonance_frequency", "quality_factor"]


def test_a_beat_is_two_modes_or_a_misfit_that_is_said() -> None:
    recording = RingDown(T, decay() + decay(F + 900, 70.0, 0.3e-6, 0.0))
    fit = fit_ring_down(recording)
    assert fit.second is not None
    assert fit.second[0].value == pytest.approx(F + 900, rel=1e-3)
    assert fit.frequency.interval[0] < F < fit.frequency.interval[1]
    third = decay(F + 2100, 60.0, 0.3e-6, 0.0)
    alone = fit_ring_down(RingDown(T, recording.displacement + third))
    assert not alone.adequacy.adequate
    assert "ms after the start" in alone.adequacy.where
    assert alone.observations == ()


def test_a_loss_that_rises_with_the_amplitude_is_found_and_said() -> None:
    resonance = SofteningResonance(F, Q, 1e-7, -0.004 / A**2, 0.3 / A)
    w = resonance.ringing(T, A, 0.3)
    w = w + 0.005 * A * np.random.default_rng(2).standard_normal(T.size)
    fit = fit_ring_down(RingDown(T, w))
    assert fit.damping_rise is not None
    assert fit.frequency_rise is not None
    assert fit.damping_rise.value == pytest.approx(0.3 / A, rel=0.15)
    assert fit.frequency_rise.value == pytest.approx(-0.004 / A**2, rel=0.15)
    assert "depend on the amplitude" in fit.adequacy.sentence


def test_the_march_of_the_bench_is_the_closed_form_without_dependence() -> None:
    w = SofteningResonance(F, Q, 1e-7, 0.0, 0.0).ringing(T, A, 0.4)
    assert w == pytest.approx(decay(noise=0.0), abs=1e-6 * A)


@pytest.mark.parametrize(
    ("t", "w", "words"),
    [
        (T[:20], T[:20], "at least 40"),
        (T, np.ones(T.size), "does not move"),
        (T[:50] / 100, decay()[:50] + np.linspace(0, A, 50), "periods"),
    ],
)
def test_what_is_no_decay_is_refused(t, w, words: str) -> None:
    with pytest.raises(InputError, match=words):
        fit_ring_down(RingDown(t, w))


@pytest.mark.parametrize("between", [0.0, 0.3, 0.5, 0.8])
def test_the_first_guess_lies_between_the_lines_of_the_spectrum(between: float) -> None:
    t = np.arange(2000) / 1e5
    spacing = 1 / 20e-3
    frequency = (40 + between) * spacing
    found = _strongest_line(t, np.sin(2 * np.pi * frequency * t))
    assert found == pytest.approx(frequency, abs=0.05 * spacing)


def test_the_chance_of_a_bend_is_that_of_two_numbers_more() -> None:
    """The F distribution of 2 and ν degrees of freedom in closed form: (after/before)^(ν/2)."""
    decay_of = _Decay(T, decay(noise=0.05) / A, A)
    straight = fit_separable(decay_of.columns, decay_of.w, decay_of.start, reach=decay_of.reach)
    bent = _Bent.of(decay_of, straight)
    before, after = (np.sum(row**2) for row in (straight.residual, bent.fit.residual))
    assert after < before
    assert bent.fit.freedom == T.size - 8
    assert bent.chance == pytest.approx((after / before) ** (bent.fit.freedom / 2), rel=1e-6)
    assert bent.model - decay_of.w == pytest.approx(bent.fit.residual)
