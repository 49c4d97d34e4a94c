"""The committed prediction is as it was made, and its tool makes it again."""

from __future__ import annotations

import tomllib

import pytest

from predict_disc import FILE, PREDICTED, difference, is_sealed, sealed
from radial_mode import RadialPrediction
from squeezefilm.measure.fits.estimate import Estimate

TEXT = FILE.read_text(encoding="utf-8")


def test_nobody_changed_the_prediction() -> None:
    assert is_sealed(TEXT)
    assert not is_sealed(TEXT.replace("14", "15", 1))
    assert not is_sealed("value = 1\n")
    assert is_sealed(sealed("value = 1\n"))


def _as_committed() -> RadialPrediction:
    table = tomllib.loads(TEXT)["prediction"]
    estimates = {
        name: Estimate(
            table[name]["value"],
            table[name]["standard_error"],
            tuple(table[name]["interval_95"]),
            table[name]["unit"],
        )
        for name in PREDICTED
    }
    return RadialPrediction(number=2, shares={}, draws=1, seed=1, **estimates)


def test_it_has_values_within_intervals_in_the_units_that_it_names() -> None:
    one = _as_committed()
    for name, unit in zip(PREDICTED, ("Hz", "Hz", "S", "ohm"), strict=True):
        estimate = getattr(one, name)
        assert estimate.interval[0] < estimate.value < estimate.interval[1]
        assert estimate.unit == unit
    assert one.series_resonance.value < one.parallel_resonance.value


def test_a_difference_is_told_in_half_intervals() -> None:
    one = _as_committed()
    assert difference(tomllib.loads(TEXT), one) == pytest.approx(0)
    old = tomllib.loads(TEXT)
    low, high = old["prediction"]["peak_conductance"]["interval_95"]
    old["prediction"]["peak_conductance"]["value"] += (high - low) / 2
    assert difference(old, one) == pytest.approx(1)
