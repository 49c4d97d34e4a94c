"""Thresholds that were kept back are predicted in a sealed file, by the senses as they are
fitted."""

from __future__ import annotations

import math
import tomllib

import numpy as np
import pytest

from predict_disc import is_sealed, sealed
from predict_thresholds import FILE, PERIODS, text
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.validation.populations import METHOD_RATIO, RIVALS, detection_medians
from threshold_fit import fitted, method_ratio, published


def test_the_predictions_are_as_they_were_sealed() -> None:
    written = FILE.read_text(encoding="utf-8")
    assert is_sealed(written)
    assert "threshold" in FILE.name
    assert "100 mm/s" in written
    made = tomllib.loads(written)
    assert made["spatial_period_mm"] == pytest.approx(1e3 * PERIODS)
    assert list(made["threshold"]) == [*RIVALS, "mixture"]
    for name, rows in made["threshold"].items():
        quantiles = np.array(rows["friction_coefficient_amplitude_5_50_95"])
        assert quantiles.shape == (6, 3)
        assert np.all(np.diff(quantiles, axis=1) > 0), name
        # Nothing is known to better than what the fit leaves open.
        assert np.all(quantiles[:, 2] / quantiles[:, 0] > 2.0)


@pytest.mark.slow
def test_the_preset_is_the_fit_and_its_predictions_come_out_again() -> None:
    measured, observer = published(), load_observer()
    best = fitted(observer, measured)
    for channel, preset in zip(best.channels, observer.channels, strict=True):
        assert channel.masking == pytest.approx(preset.masking, rel=0.01)
    assert sealed(text()) == FILE.read_text(encoding="utf-8")


@pytest.mark.slow
def test_each_threshold_is_predicted_from_the_others() -> None:
    """Within a factor of 2 inside, and of 4 at the two ends."""
    measured, observer = published(), load_observer()
    last = measured.period.size - 1
    for k in range(measured.period.size):
        alone = detection_medians(fitted(observer, measured, k), measured)[k]
        limit = 4.0 if k in (0, last) else 2.0
        assert abs(math.log(alone / measured.amplitude[k])) < math.log(limit)


@pytest.mark.slow
def test_the_published_method_gives_more_than_the_amplitude_with_a_d_prime_of_one() -> None:
    found, spread = method_ratio(people=500)
    assert found == pytest.approx(METHOD_RATIO, rel=0.05)
    assert 0.1 < spread < 0.4
    # People who differ have their own thresholds in the middle of which the median lies.
    assert method_ratio(people=500, spread=0.4)[0] == pytest.approx(METHOD_RATIO, rel=0.08)
