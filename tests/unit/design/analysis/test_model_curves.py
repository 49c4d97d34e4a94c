"""The friction of one finger by every model against the amplitude, and between its points."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.design.analysis import curves as models
from squeezefilm.design.analysis.curves import COMPARED, ModelCurve, model_curves
from squeezefilm.physics.chain.friction import FrictionLaw, friction_law
from squeezefilm.physics.chain.pad_law import MODEL_KINDS, FrictionModel
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import load_display

STATOR = load_display("biet2008-stator")


def test_known_models_are_compared_the_papers_first() -> None:
    names = [model for model, _ in COMPARED]
    assert names[0] == "paper2008"
    assert set(names) < set(MODEL_KINDS) == set(get_args(FrictionModel))
    assert len(set(names)) == len(names) == 5


def test_a_curve_is_read_between_its_points_and_not_beyond() -> None:
    curve = ModelCurve(
        "paper2008", np.array([1e-6, 2e-6, 3e-6]), np.array([1.0, 0.6, np.nan])
    )  # fmt: skip
    assert curve.at(1e-6) == 1.0
    assert curve.at(1.25e-6) == pytest.approx(0.9)
    assert curve.at(2e-6) == 0.6
    for beyond in (0.99e-6, 2.5e-6, 3e-6, 3.01e-6):
        assert curve.at(beyond) is None
    assert isinstance(curve.at(1.5e-6), float)


@pytest.fixture(scope="module")
def off_centre() -> Prediction:
    return predict(STATOR, position=3e-3, normal_force=0.3, surface="bare")


def test_each_model_is_asked_at_the_predictions_point(
    off_centre: Prediction,
) -> None:
    p = off_centre
    curves = model_curves(p)
    assert [curve.model for curve in curves] == [model for model, _ in COMPARED]
    for curve, (model, points) in zip(curves, COMPARED, strict=True):
        assert curve.amplitude.size == points + 1
        assert curve.amplitude[[0, -1]] == pytest.approx([0.0, 4e-6])
        assert p.vibration_amplitude in curve.amplitude
        # The other points lie where the 1.5th power of even steps does.
        others = curve.amplitude[curve.amplitude != p.vibration_amplitude]
        assert np.diff(np.cbrt(others**2)) == pytest.approx(np.cbrt(16e-12) / (points - 1))
        law = friction_law(
            STATOR, p.mode.half_wavelength, p.frequency, surface=p.surface, normal_force=0.3,
            model=model, position=0.0 if model == "paper2008" else 3e-3,
        )  # fmt: skip
        assert curve.at(p.vibration_amplitude) == pytest.approx(law.at(p.vibration_amplitude))
        assert curve.relative_friction[0] == pytest.approx(1.0)
        assert np.all(np.isfinite(curve.relative_friction))
    default = next(one for one in curves if one.model == p.model)
    assert default.at(p.vibration_amplitude) == pytest.approx(p.relative_friction)


def test_curves_reach_a_quarter_beyond_a_large_amplitude(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(models, "COMPARED", (("paper2008", 11),))
    (curve,) = model_curves(predict(STATOR, vibration_amplitude=8e-6, model="paper2008"))
    assert curve.amplitude[-1] == pytest.approx(10e-6)


def test_a_curve_ends_where_its_model_does(
    monkeypatch: pytest.MonkeyPatch, off_centre: Prediction
) -> None:
    whole = FrictionLaw.curve

    def asked(law: FrictionLaw, amplitude: np.ndarray) -> np.ndarray:
        if np.any(amplitude > 1e-6):
            raise OutOfRangeError("too far")
        return whole(law, amplitude)

    monkeypatch.setattr(FrictionLaw, "curve", asked)
    monkeypatch.setattr(models, "COMPARED", (("paper2008", 101),))
    (curve,) = model_curves(off_centre)
    assert np.array_equal(np.isfinite(curve.relative_friction), curve.amplitude <= 1e-6)
    assert curve.at(0.5e-6) is not None
    assert curve.at(3e-6) is None
