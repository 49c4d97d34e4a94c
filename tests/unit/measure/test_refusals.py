"""What fits and calibrations refuse because it cannot be, in a word of each message."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.calibration.blind import Predicted, _scored, predict_measurement
from squeezefilm.measure.fits.ceramic.constants import compliances
from squeezefilm.measure.fits.circuit.branches import poles
from squeezefilm.measure.fits.estimate import Estimate, Observation, guarded_fit
from squeezefilm.measure.fits.friction.friction_bench import _MOST_LEVELS, _levels
from squeezefilm.measure.fits.least_squares import _least
from squeezefilm.measure.fits.vibration.frequency_response import _Band, fit_frequency_response
from squeezefilm.measure.fits.vibration.line_points import LinePoints
from squeezefilm.measure.fits.vibration.line_scan import _wave_number
from squeezefilm.measure.fits.vibration.solved_shapes import DrivenShape, line_by_shape
from squeezefilm.measure.recordings.kinds import FrequencyResponse

X = np.linspace(0, 80e-3, 9)
EVEN = np.ones((9, 9))
SHAPE = DrivenShape(X, X, EVEN, 0 * EVEN, (40e-3, 40e-3), True, 10e-3)
F = np.linspace(29e3, 31e3, 41)
RESPONSE = 1e-7 / (1 - (F / 30e3) ** 2 + 1j * F / 30e3 / 60)


def line(w: Any, x: Any = X) -> Any:
    return line_by_shape(SHAPE, x, np.asarray(w), reach=1e-3)


@pytest.mark.parametrize(
    ("build", "word"),
    [
        (lambda: compliances(np.zeros(3)), "shape"),
        (lambda: poles(np.full(9, 3e4), np.ones(9) + 0j, 1), "span a band"),
        (lambda: poles(F, np.append(RESPONSE[:-1], 0), 1), "exactly zero"),
        (lambda: poles(F, RESPONSE[:-1], 1), "response"),
        (lambda: line(0 * X), "not all of them 0"),
        (lambda: line(np.append(X[:-1], np.nan)), "finite"),
        (lambda: line(np.arange(9)), "finite displacements"),
        (lambda: line(X, X[::-1].copy()), "must rise"),
        (lambda: line(X[:1] + 1, X[:1]), "must rise"),
        (
            lambda: fit_frequency_response(FrequencyResponse(np.full(41, 3e4), RESPONSE)),
            "one frequency only",
        ),
        (lambda: fit_frequency_response(FrequencyResponse(F, np.abs(RESPONSE))), "no phase"),
    ],
)
def test_what_cannot_be_is_refused(build: Callable[[], object], word: str) -> None:
    with pytest.raises(InputError, match=word):
        build()


def test_a_prediction_is_never_overwritten(tmp_path: Path) -> None:
    there = tmp_path / "blind.json"
    there.write_text("{}")
    with pytest.raises(InputError, match="never overwritten"):
        predict_measurement("biet2008-plate", "mass", there)
    assert there.read_text() == "{}"


@pytest.mark.parametrize(
    ("answer", "relative"), [("resonance_frequency", 1 / 34), ("relative_friction", 1.0)]
)
def test_a_score_is_the_density_of_what_was_seen(answer: str, relative: float) -> None:
    foretold = Predicted(answer, {}, 35.0, (33.0, 36.5), 0.8)
    for value, inside in ((34.0, True), (33.0, True), (36.5, True), (32.9, False), (36.6, False)):
        scored = _scored(foretold, Observation(answer, value, 0.6))
        # Spread of the draws and error of the measurement: √(0.8² + 0.6²) = 1.
        density = np.exp(-((value - 35.0) ** 2) / 2) / np.sqrt(2 * np.pi)
        assert scored.log_score == pytest.approx(np.log(density))
        assert scored.inside is inside
        if value == 34.0:
            assert scored.error == pytest.approx(relative)


def test_a_band_of_frequencies_counts_from_its_middle_over_its_width() -> None:
    band = _Band.over(np.array([10.0, 11.0, 14.0, 18.0, 20.0]))
    assert (band.middle, band.width) == (14.0, 10.0)
    assert band.place == pytest.approx([-0.4, -0.3, 0.0, 0.4, 0.6])


def test_a_smoothed_line_is_the_cubic_that_it_was() -> None:
    x = np.linspace(5e-3, 75e-3, 141)
    cubic = np.polynomial.Polynomial([1e-6, -2e-5, 3e-4, 5e-3])
    places, values = LinePoints(x, cubic(x), 10e-3)._smooth
    assert (places[0], places[-1]) == pytest.approx((x[0], x[-1]))
    assert values == pytest.approx(cubic(places), rel=1e-9)
    # Where there are too few points nothing is said.
    gap = (x < 30e-3) | (x > 50e-3)
    places, _ = LinePoints(x[gap], cubic(x[gap]), 10e-3)._smooth
    assert not np.any((places > 34e-3) & (places < 46e-3))


def test_an_estimate_is_told_with_its_error_in_its_own_unit() -> None:
    assert str(Estimate(33214.56, 12.3, (33190.0, 33239.0), "Hz")) == "33.2146 kHz ± 12 Hz"


class Fitted:
    """A fit that observed this."""

    def __init__(self, value: float, error: float = 1.0) -> None:
        self.seen = value, error

    @property
    def observations(self) -> tuple[Observation, ...]:
        """What a calibration may use."""
        return (Observation("quality_factor", *self.seen),)


def test_a_fit_whose_arithmetic_ends_is_no_fit() -> None:
    def fit(of: Any) -> Any:
        if isinstance(of, Exception):
            raise of
        return of

    guarded = guarded_fit(fit)
    good = Fitted(60.0)
    assert guarded(good) is good
    for error in (ZeroDivisionError("by three"), np.linalg.LinAlgError("by three")):
        with pytest.raises(InputError, match=r"has no fit \(by three\).*measure check"):
            guarded(error)
    for bad in (Fitted(np.nan), Fitted(1.0, np.inf)):
        with pytest.raises(InputError, match=r"no fit \((value|standard_error) = (nan|inf)"):
            guarded(bad)
    # A refusal of its own is said as it is.
    with pytest.raises(InputError, match=r"^too short$"):
        guarded(InputError("too short"))


def test_what_scipy_refuses_is_arithmetic_and_what_we_refuse_is_ours() -> None:
    def least(error: Exception | None) -> Any:
        def residual(at: Any) -> Any:
            if error is not None:
                raise error
            return np.array([at[0] - 3.0, 2.0 * at[0] - 6.0])

        return _least(residual, lambda _: np.array([[1.0], [2.0]]), np.zeros(1), np.inf)

    assert least(None) == pytest.approx([3.0])
    with pytest.raises(ArithmeticError, match="its squares cannot be made least: residuals are"):
        least(ValueError("residuals are not finite"))
    with pytest.raises(InputError, match=r"^no such display$"):
        least(InputError("no such display"))


def test_amplitudes_that_were_not_set_are_not_fitted_as_levels() -> None:
    held = np.repeat(np.linspace(0.0, 2e-6, _MOST_LEVELS), 3)
    levels, number = _levels(held)
    assert levels == pytest.approx(np.linspace(0.0, 2e-6, _MOST_LEVELS), abs=1e-15)
    assert number.tolist() == np.repeat(np.arange(_MOST_LEVELS), 3).tolist()
    with pytest.raises(InputError, match=f"have {_MOST_LEVELS + 1} different amplitudes"):
        _levels(np.linspace(0.0, 2e-6, _MOST_LEVELS + 1))


def test_a_line_of_few_places_holds_no_wave() -> None:
    line_of: Any = SimpleNamespace(length=80e-3, count=2)
    with pytest.raises(InputError, match="too coarse for any wave along it"):
        _wave_number(line_of, np.array([0.0, 80e-3]), np.ones(2))
