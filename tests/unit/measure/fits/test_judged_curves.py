"""When a friction curve is described within its spread, and populations' decays beside models'."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.circuit.impedance import _wider
from squeezefilm.measure.fits.estimate import Estimate
from squeezefilm.measure.fits.friction.friction_curve import _adequacy
from squeezefilm.measure.fits.friction.friction_scores import SHAPES, ModelScore
from squeezefilm.measure.recordings.kinds import FrictionCurve, FrictionDecays, Told
from squeezefilm.physics.chain.friction import where_known
from squeezefilm.physics.chain.pad_law import MODEL_KINDS
from squeezefilm.physics.display import load_display
from squeezefilm.validation import populations

CURVE = FrictionCurve(
    np.array([0.0, 1e-6, 2e-6]), np.array([0.8, 0.6, 0.3]), 3e4, 0.5, 0.05, np.full(3, 0.02)
)
LIMIT = float(np.sqrt(chi2.ppf(0.99, 2) / 3))


def score(in_spreads: float | None, *friction: float) -> ModelScore:
    return ModelScore("a law", 1, np.array(friction), 0.123, in_spreads)


@pytest.mark.parametrize(
    ("in_spreads", "adequate", "said"),
    [
        (0.999 * LIMIT, True, "a law describes the curve within its spread"),
        (1.001 * LIMIT, False, "a law does not describe the curve"),
        (None, False, "a law cannot be judged, since the curve has no spread"),
    ],
)
def test_a_curve_is_described_within_what_chance_leaves(
    in_spreads: float | None, adequate: bool, said: str
) -> None:
    found = _adequacy(CURVE, score(in_spreads, 0.8, 0.5, 0.34), 0.8)
    assert found.adequate is adequate
    assert found.sentence.startswith(f"{said}: it is off by 0.123 ")
    assert "most at 1 µm, by 0.125; the friction at rest alone was fitted" in found.sentence
    assert found.where == "at 1 µm"
    assert found.residual == pytest.approx((0.0 + 0.125 + 0.05) / 3)
    assert found.noise == pytest.approx(0.02 / 0.8)


def test_a_model_without_friction_somewhere_describes_no_curve() -> None:
    missing = _adequacy(CURVE, score(0.5, 0.8, np.nan, 0.3), 0.8)
    assert not missing.adequate
    assert missing.residual == pytest.approx(0.0)
    nowhere = _adequacy(CURVE, score(None, np.nan, np.nan, np.nan), 0.8)
    assert (nowhere.adequate, nowhere.where) == (False, "everywhere")
    # One point with a spread has no degree of freedom left.
    alone = replace(CURVE, spread=np.array([0.02, 0.0, 0.0]))
    assert not _adequacy(alone, score(0.1, 0.8, 0.6, 0.3), 0.8).adequate


def test_a_law_that_refuses_one_amplitude_answers_at_the_others() -> None:
    def at(amplitude: float) -> float:
        if amplitude > 1.5e-6:
            raise InputError("too much")
        return 1 - amplitude * 1e5

    def curve(amplitude: np.ndarray) -> np.ndarray:
        return np.array([at(value) for value in amplitude])

    known = CURVE.vibration_amplitude
    np.testing.assert_allclose(where_known(curve, known), [1.0, 0.9, np.nan])
    np.testing.assert_allclose(where_known(curve, known[:2]), [1.0, 0.9])


def test_models_decays_are_fitted_like_the_published_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[str, Any] = {}

    def predicted(display: object, **given: Any) -> Any:
        asked.update(given)
        law = SimpleNamespace(by=lambda model: SimpleNamespace(curve=partial(curve, model)))
        return SimpleNamespace(law=law, normal_force=0.4, speed=0.025)

    hardly, silent, *_, last = MODEL_KINDS

    def curve(model: str, amplitude: np.ndarray) -> np.ndarray:
        if model == silent:
            return np.full(amplitude.size, np.nan)
        return SHAPES["gaussian"](amplitude / (60e-6 if model == hardly else 1.5e-6))

    monkeypatch.setattr(populations, "predict", predicted)
    decays = FrictionDecays(
        np.linspace(1e-6, 2e-6, 101), np.full(101, 0.5), 35e3, told=Told(name="people")
    )
    said: list[str] = []
    found = populations.compare_decays(decays, load_display("biet2008-plate"), said.append)
    # Up to twice what all but a twentieth of the people have.
    assert asked["vibration_amplitude"] == pytest.approx(3.9e-6)
    assert (asked["frequency"], asked["normal_force"], asked["speed"]) == (35e3, None, None)
    assert said == [f"people: {model}" for model in MODEL_KINDS]
    decay = dict(found.models)
    assert (decay[hardly], decay[silent]) == (None, None)
    assert decay[last] == pytest.approx(1.5e-6, rel=1e-3)
    assert found.conditions == "35000 Hz, 0.4 N, 25 mm/s, assumed"
    told = replace(decays, normal_force=0.4, speed=0.025)
    again = populations.compare_decays(told, load_display("biet2008-plate"))
    assert again.conditions == "35000 Hz, 0.4 N, 25 mm/s"
    assert again.measured is decays.decay_amplitude


def test_two_circuits_as_likely_widen_what_they_say() -> None:
    ours, theirs = (Estimate(value, 0.3, (value - 0.6, value + 0.6), "Hz") for value in (5.0, 5.4))
    wider = _wider(ours, theirs)
    # The variance of one of two normal distributions around the first: half of the distance².
    assert wider.standard_error**2 == pytest.approx(0.3**2 + 0.4**2 / 2)
    times = wider.standard_error / 0.3
    assert wider.interval == pytest.approx((5.0 - 0.6 * times, 5.0 + 0.6 * times))
    sure = replace(ours, standard_error=0.0, interval=(5.0, 5.0))
    assert _wider(sure, theirs).interval == (5.0, 5.0)
