"""Predictions over arrays: every point is that of `predict`, and each axis has its unit."""

from typing import Any

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.core.errors import InputError
from squeezefilm.physics.chain import prediction_grid

STATOR = "biet2008-stator"


def test_every_point_is_that_of_a_prediction() -> None:
    told: list[str] = []
    grid = sf.predict_grid(
        STATOR, voltage=["20 V", "60 V"], speed=np.array([0.02, 0.08]), progress=told.append
    )
    assert told == [f"prediction {number} of 4" for number in (1, 2, 3, 4)]
    assert grid.relative_friction.dims == ("voltage", "speed")
    assert grid.voltage.attrs["units"] == "V"
    for volts in (20.0, 60.0):
        for speed in (0.02, 0.08):
            alone = sf.predict(STATOR, voltage=volts, speed=speed)
            point = grid.sel(voltage=volts, speed=speed)
            assert float(point.relative_friction) == alone.relative_friction
            assert float(point.tangential_force) == alone.tangential_force
            assert float(point.amplitude_under_pad) == alone.amplitude_under_pad
    assert grid.attrs["display"] == STATOR
    assert grid.attrs["warnings"] == list(alone.warnings)


def test_places_are_numbered_and_keep_both_coordinates() -> None:
    grid = sf.predict_grid(STATOR, place=["20 mm, 2 mm", (0.022, 0.002)], normal_force=[0.3])
    assert grid.relative_friction.shape == (1, 2)
    assert grid.place_x.values.tolist() == [0.02, 0.022]
    assert grid.place_y.attrs["units"] == "m"
    assert np.ptp(grid.relative_friction.values) > 0


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({}, "give at least one of voltage"),
        ({"voltage": []}, "a grid of 0 of voltage"),
        ({"voltage": np.ones((2, 2))}, "voltage has 2 dimensions"),
        ({"voltage": "20 V"}, "voltage has 0 dimensions"),
        ({"voltage": np.ones(200), "speed": np.ones(200)}, "200 of voltage × 200 of speed; allow"),
    ],
)
def test_a_grid_that_cannot_be_is_refused_before_anything_is_solved(
    given: dict[str, Any], says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(prediction_grid, "predict", lambda *_, **__: pytest.fail("solved"))
    with pytest.raises(InputError, match=says):
        sf.predict_grid(STATOR, **given)
