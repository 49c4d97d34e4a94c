"""What a device gets: a tile that covers the way, and aims within a display's limits."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.bench import setup
from squeezefilm.instruments.bench.setup import _held
from squeezefilm.instruments.control.gains import IdentifiedPlate

PREDICTED: Any = SimpleNamespace(
    mode=SimpleNamespace(resonance_frequency=30e3, quality_factor=100.0, amplitude_per_volt=50e-9),
)


@pytest.mark.parametrize(("highest", "begins"), [(40e3, 30e3 + 8 * 150), (30.5e3, 30.5e3)])
def test_a_search_begins_just_above_the_resonance(highest: float, begins: float) -> None:
    limits: Any = SimpleNamespace(lowest_frequency=28e3, highest_frequency=highest, voltage=60.0)
    device: Any = SimpleNamespace(amplitude_per_pickup=2e-6, identified=None)
    (plate, aims), per_volt = _held(PREDICTED, device, limits)
    assert (plate.frequency, plate.quality_factor) == (30e3, 100.0)
    assert (plate.ratio, per_volt) == pytest.approx((0.025, 50e-9))
    assert (aims.lowest_frequency, aims.highest_frequency) == pytest.approx((28e3, begins))
    assert (aims.highest_voltage, aims.search_voltage) == pytest.approx((60.0, 6.0))
    unknown: Any = SimpleNamespace(amplitude_per_pickup=None)
    with pytest.raises(InputError, match="amplitude_per_pickup"):
        _held(PREDICTED, unknown, limits)


def test_a_plate_that_was_swept_takes_the_place_of_the_predicted_one() -> None:
    limits: Any = SimpleNamespace(lowest_frequency=28e3, highest_frequency=40e3, voltage=60.0)
    swept = IdentifiedPlate(29e3, 145.0, 0.04)
    for noise, counted in ((5e-3, 5e-3), (1e-4, setup._PICKUP_NOISE)):
        device: Any = SimpleNamespace(amplitude_per_pickup=2e-6, identified=(swept, noise))
        (plate, aims), per_volt = _held(PREDICTED, device, limits)
        assert plate is swept
        assert aims.highest_frequency == pytest.approx(29e3 + 8 * 100)
        assert aims.noise == counted
        assert per_volt == pytest.approx(80e-9)
