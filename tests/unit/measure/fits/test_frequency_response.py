"""Modes out of a frequency response, beside the circle's."""

from types import SimpleNamespace

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.vibration import frequency_response
from squeezefilm.measure.fits.vibration.frequency_response import (
    fit_frequency_response,
    modal_circle,
)
from squeezefilm.measure.recordings.kinds import FrequencyResponse

F = np.linspace(29e3, 31.5e3, 200)
PEAK = (30.2e3, 60.0, 2e-9 * np.exp(0.3j))
NEXT = (30.9e3, 80.0, 0.8e-9)


def response(*modes, noise: float = 0.005, seed: int = 1):
    H = sum(A * f0**2 / (f0**2 * (1 + 1j / Q) - F**2) for f0, Q, A in modes)
    random = np.random.default_rng(seed)
    parts = noise * np.abs(H).max() / np.sqrt(2) * random.standard_normal((2, F.size))
    return H + parts[0] + 1j * parts[1]


def test_a_circle_without_noise_is_exact() -> None:
    circle = modal_circle(F, response(PEAK, noise=0.0) + 3e-9j)
    assert circle is not None
    assert circle.frequency == pytest.approx(PEAK[0], rel=1e-8)
    assert circle.quality_factor == pytest.approx(PEAK[1], rel=1e-6)
    assert circle.roundness < 1e-6


def test_one_mode_and_what_a_calibration_may_use_of_it() -> None:
    fit = fit_frequency_response(FrequencyResponse(F, response(PEAK), 2.0, place=(1e-3, 2e-3)))
    assert len(fit.modes) == 1
    assert fit.adequacy.adequate
    answers = {one.answer: one for one in fit.observations}
    assert answers.keys() == {"resonance_frequency", "quality_factor", "amplitude_per_volt"}
    assert answers["quality_factor"].value == pytest.approx(60, rel=0.02)
    assert answers["amplitude_per_volt"].conditions == {"voltage": 2.0, "x": 1e-3, "y": 2e-3}


def test_a_second_mode_is_found_or_its_lack_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    recording = FrequencyResponse(F, response(PEAK, NEXT))
    assert len(fit_frequency_response(recording).modes) == 2
    monkeypatch.setattr(frequency_response, "_TRIED_MODES", 1)
    alone = fit_frequency_response(recording)
    assert not alone.adequacy.adequate
    assert "kHz" in alone.adequacy.where
    assert alone.observations == ()
    low, high = alone.modes[0].frequency.interval
    assert low < PEAK[0] < high


def test_a_phase_of_the_other_sign_is_noticed_and_said() -> None:
    H = response(PEAK)
    fit, other = (fit_frequency_response(FrequencyResponse(F, one)) for one in (H, H.conj()))
    assert not fit.phase_reversed
    assert other.phase_reversed
    assert "other sign" in other.adequacy.sentence
    assert other.modes[0].frequency.value == pytest.approx(fit.modes[0].frequency.value, rel=1e-9)


def test_points_that_are_no_numbers_are_left_out() -> None:
    H = response(PEAK)
    H[50:60] = np.nan
    fit = fit_frequency_response(FrequencyResponse(F, H))
    assert fit.frequency.size == F.size - 10


@pytest.mark.parametrize(
    ("f", "H", "words"),
    [
        (F[:8], response(PEAK)[:8], "at least 12"),
        (F, np.abs(response(PEAK)), "no phase"),
        (np.linspace(1e3, 50e3, 200), response(PEAK), "cut out the band"),
    ],
)
def test_what_cannot_be_fitted_is_refused(f, H, words: str) -> None:
    with pytest.raises(InputError, match=words):
        fit_frequency_response(FrequencyResponse(f, H))


@pytest.mark.parametrize(
    ("circle", "tried"),
    [(F[0], False), (F[1], True), (30.9e3, True), (F[-2], True), (F[-1], False), (None, False)],
)
def test_a_mode_more_starts_at_the_residual_and_at_a_circle_within_the_band(
    circle: float | None, tried: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    band, starts = frequency_response._Band.over(F), []

    def fitted(columns, H, start, *, reach):
        starts.append(start[2:])
        return SimpleNamespace(shape=start, residual=np.ones(F.size))

    noticed = None if circle is None else SimpleNamespace(frequency=circle, quality_factor=-50.0)
    monkeypatch.setattr(frequency_response, "fit_separable", fitted)
    monkeypatch.setattr(frequency_response, "modal_circle", lambda *_: noticed)
    residual = np.ones(F.size)
    residual[70] = 2.0
    first = SimpleNamespace(shape=np.array([0.0, 0.03]), residual=residual)
    assert frequency_response._one_more(band, residual, first) is not None
    expected = [(F[70], 0.03), *([(circle, 0.02)] if tried else [])]
    assert starts == [pytest.approx(band.shape_of([mode])) for mode in expected]
