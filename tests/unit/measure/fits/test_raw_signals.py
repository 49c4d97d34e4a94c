"""Raw signals: the response of a resonance, the scale and delay of an instrument."""

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.vibration import raw_signals
from squeezefilm.measure.fits.vibration.frequency_response import fit_frequency_response
from squeezefilm.measure.fits.vibration.raw_signals import _coherent, fit_raw_signals
from squeezefilm.measure.recordings.kinds import FrequencyResponse, RawSignals

RATE = 200e3
T = np.arange(1 << 15) / RATE
F0, Q = 30e3, 60.0


def resonant(noise: float = 0.02, seed: int = 1):
    """White noise through one mode: computed in the spectrum, so that it is periodic."""
    random = np.random.default_rng(seed)
    v = random.standard_normal(T.size)
    f = np.fft.rfftfreq(T.size, 1 / RATE)
    H = 1e-7 / Q / (1 + 1j / Q - (f / F0) ** 2)
    x = np.fft.irfft(np.fft.rfft(v) * H, T.size)
    return v, x + noise * np.std(x) * random.standard_normal(T.size)


def around(response: FrequencyResponse, width: float) -> FrequencyResponse:
    near = np.abs(response.frequency - F0) < width
    return FrequencyResponse(response.frequency[near], response.displacement_per_volt[near])


def test_a_resonance_is_resolved_and_fitted_from_its_response() -> None:
    v, x = resonant()
    fit = fit_raw_signals(RawSignals(T, v, x))
    assert fit.adequacy.adequate
    assert fit.observations == ()
    coherence = fit.response.coherence
    assert coherence is not None
    near = np.abs(fit.response.frequency - F0) < 500
    assert coherence[near].min() > 0.9
    own = fit_frequency_response(around(fit.response, 2e3)).modes[0]
    assert own.frequency.value == pytest.approx(F0, rel=1e-3)
    assert own.quality_factor.value == pytest.approx(Q, rel=0.05)


def test_segments_too_short_for_the_resonance_are_said() -> None:
    v, x = (signal[:512] for signal in resonant())
    fit = fit_raw_signals(RawSignals(T[:512], v, x))
    assert not fit.adequacy.adequate
    assert "too short" in fit.adequacy.sentence


def test_motion_that_does_not_come_from_the_drive_has_no_coherence() -> None:
    random = np.random.default_rng(2)
    v, x = random.standard_normal((2, T.size))
    fit = fit_raw_signals(RawSignals(T, v, 1e-6 * x))
    assert not fit.adequacy.adequate
    assert "does not come from the drive" in fit.adequacy.sentence


@pytest.mark.slow
def test_the_error_of_the_response_is_what_repetitions_scatter(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Segments of one length, whatever resonance the noise shows.
    monkeypatch.setattr(raw_signals, "_WELL_RESOLVED", 0.0)
    size, said = [], []
    for seed in range(40):
        run = fit_raw_signals(RawSignals(T, *resonant(1.0, seed)))
        near = np.abs(run.response.frequency - F0) < 1e3
        size.append(np.abs(run.response.displacement_per_volt[near]))
        said.append(run.standard_error[near])
    assert np.mean(said) == pytest.approx(np.mean(np.std(size, axis=0)), rel=0.2)


def test_a_few_missing_points_are_put_back_and_many_are_refused() -> None:
    v, x = resonant()
    keep = np.random.default_rng(4).random(T.size) > 0.01
    keep[[0, -1]] = True
    fit = fit_raw_signals(RawSignals(T[keep], v[keep], x[keep]))
    assert fit.response.frequency.size > 50
    third = slice(None, T.size // 3)
    for t, words in ((np.sort(np.random.default_rng(5).random(1000)), "evenly"), (T[third], None)):
        if words:
            with pytest.raises(InputError, match=words):
                fit_raw_signals(RawSignals(t, v[: t.size], x[: t.size]))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"voltage": np.zeros(T.size)}, "does not change"),
        ({"time": T[::-1]}, "does not rise"),
        ({"displacement": np.full(T.size, np.nan)}, "usable points"),
    ],
)
def test_signals_that_tell_nothing_are_refused(change, words: str) -> None:
    v, x = resonant()
    with pytest.raises(InputError, match=words):
        fit_raw_signals(RawSignals(**{"time": T, "voltage": v, "displacement": x} | change))


@pytest.mark.parametrize(
    ("share", "within", "adequate", "said"),
    [
        (0.85, 9.1, True, []),
        (0.75, 9.1, False, ["Most of the motion does not come from the drive"]),
        (0.85, 8.9, False, ["Segments of 20 ms are too short", "band holds 8.9 frequencies"]),
        (0.75, 8.9, False, ["Most of the motion", "Segments of 20 ms"]),
    ],
)
def test_what_is_adequate_of_a_spectrum(
    share: float, within: float, adequate: bool, said: list[str]
) -> None:
    """Half of the points have a coherence, the others less; the half-power band holds so many."""
    f, quality = np.linspace(29e3, 31e3, 41), 30e3 / within / 50.0
    coherence = np.where(np.arange(41) < 30, share, share - 0.1)
    coherence[7] = 0.3
    h = 1e-7 / (1 + 1j / quality - (f / 30e3) ** 2)
    found = _coherent(FrequencyResponse(f, h, coherence=coherence), 20e-3)
    assert found.adequate is adequate
    assert found.residual == found.noise == pytest.approx(np.sqrt(1 - coherence.mean()))
    begin = f"Coherence of motion and drive is {share:.3f} in the middle, least at 29.35 kHz, where"
    assert found.sentence.startswith(f"{begin} it is 0.300.")
    assert found.where == "at 29.35 kHz"
    assert [sentence in found.sentence for sentence in said] == [True] * len(said)
    assert ("does not come" in found.sentence, "too short" in found.sentence) == (
        share < 0.8,
        within < 9,
    )
