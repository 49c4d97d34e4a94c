"""What a device gets: a tile that covers the way, and aims within a display's limits."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.bench import setup
from squeezefilm.instruments.bench.setup import _held, _tile
from squeezefilm.instruments.control.gains import IdentifiedPlate
from squeezefilm.instruments.device.wire.messages import LONGEST_TILE

LOOP: Any = SimpleNamespace(program="program")
PREDICTED: Any = SimpleNamespace(
    speed=0.07,
    friction="law",
    mode=SimpleNamespace(resonance_frequency=30e3, quality_factor=100.0, amplitude_per_volt=50e-9),
)


@pytest.mark.parametrize(
    "way", [None, (0.0, 0.1), (0.0204, 0.0306), (-0.05, 0.05), (0.01, 0.010001), (1e-3, 1.51e-3)]
)
def test_a_tile_covers_the_way_as_finely_as_it_can(
    way: tuple[float, float] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(setup, "tile_of", lambda *given, **more: asked.append((given, more)))
    _tile(LOOP, way, PREDICTED)
    (program, origin, pitch, size), more = asked[0]
    assert (program, more) == ("program", {"speed": 0.07, "law": "law"})
    first, last = way or (0.0, 0.1)
    for length in (origin, pitch):
        assert length * 1e6 == pytest.approx(round(length * 1e6))
    assert first - 1e-6 < origin <= first + 1e-12
    assert 2 <= size <= LONGEST_TILE
    # Up to the last micrometre, and no finer pitch would reach it.
    assert last - 1e-6 <= origin + (size - 1) * pitch + 1e-12
    assert origin + (size - 2) * pitch < last + 1e-9
    assert pitch <= 1.001e-6 or (LONGEST_TILE - 1) * (pitch - 1e-6) < last - first


@pytest.mark.parametrize("way", [(0.1, 0.0), (0.02, 0.02)])
def test_a_way_to_nowhere_has_no_tile(way: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="covers nothing"):
        _tile(LOOP, way, PREDICTED)


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
