"""Every measured number beside the model alone, before and after."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.measure.calibration.calibration import UNITS, compared, said_of
from squeezefilm.measure.calibration.discrepancy import BELIEVED
from squeezefilm.measure.calibration.solved_answers import Asked
from squeezefilm.measure.fits.estimate import Observation

MASS = Observation("mass", 0.2, 0.01, recording="a.csv")
FRICTION = Observation("relative_friction", 0.5, 0.05, {"vibration_amplitude": 1e-6})


class Plate:
    """Its mass is 0.2 kg at a score of 0, and changes in proportion: exp(0.1 score)."""

    observations, columns = (MASS,), [0]
    scores = SimpleNamespace(parameters=("thickness",))
    asked = (Asked("mass"),)

    def answers(self, scores: np.ndarray) -> np.ndarray:
        return np.asarray(np.log(0.2) + 0.1 * scores)


def test_a_plate_is_drawn_from_its_priors_and_from_its_posterior() -> None:
    exact: Any = SimpleNamespace(
        problem=Plate(), posterior=SimpleNamespace(scores=np.zeros((100, 1)))
    )
    (one,) = compared((MASS,), exact, None, 0, seed=1)
    assert (one.said, one.measured, one.recording) == ("mass", "0.2 kg", "a.csv")
    assert one.error == pytest.approx(0.05)
    assert one.after == (1.0, 1.0, 1.0)
    # 90 % of a normal score lie within 1.645.
    assert one.before == pytest.approx([np.exp(-0.1645), 1.0, np.exp(0.1645)], rel=3e-3)
    assert one.relative_friction is None


def test_friction_has_the_draws_of_the_priors_first() -> None:
    curves = np.concatenate([np.full(50, 0.25), np.full(70, 0.5)])[:, None]
    posterior = SimpleNamespace(curves=curves, likelihood=SimpleNamespace(observations=(FRICTION,)))
    draws: Any = SimpleNamespace(posterior=posterior, curves=np.full((30, 1), 0.6))
    (one,) = compared((FRICTION,), None, draws, 50, seed=1)
    assert one.before == (0.5, 0.5, 0.5)
    assert one.after == (1.2, 1.2, 1.2)
    assert (one.relative_friction, one.vibration_amplitude) == (0.5, 1e-6)
    assert one.said == said_of(FRICTION) == "relative friction at 1 µm"
    refused: Any = SimpleNamespace(posterior=posterior, curves=np.full((30, 1), np.nan))
    assert compared((FRICTION,), None, refused, 50, seed=1)[0].after == ()


def test_every_answer_has_a_unit_or_none() -> None:
    assert set(UNITS) <= set(BELIEVED)
    assert set(BELIEVED) - set(UNITS) == {
        "coupling_coefficient", "quality_factor", "relative_friction"
    }  # fmt: skip
