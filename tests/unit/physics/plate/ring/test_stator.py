"""A stator fitted to one frequency: what it refuses, by day; how good it is, in verification."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.errors import InputError, UnreachableError
from squeezefilm.physics.plate.ring import body
from squeezefilm.physics.plate.ring.body import StatorAssumptions, fit_stator, stator_section
from squeezefilm.physics.plate.ring.section import alternate_sectors


def test_a_frequency_that_no_thickness_has_is_refused_with_those_that_some_has() -> None:
    with pytest.raises(UnreachableError, match=r"no ring thickness from .* lies between") as caught:
        fit_stator(frequency=400e3)
    assert caught.value.quantity == "frequency"


class Rings:
    """Rings whose frequency is 10 MHz/m of thickness, 30 with stiff teeth, instead of solving."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked: list[tuple[Any, ...]] = []

        def section(*given: Any) -> tuple[Any, ...]:
            self.asked.append(given)
            return given

        def mode(made: tuple[Any, ...], waves: int, **rest: Any) -> SimpleNamespace:
            assert rest == {"quality_factor": made[2].quality_factor}
            return SimpleNamespace(frequency=frequency(made, waves), waves=waves)

        def frequency(made: tuple[Any, ...], waves: int) -> float:
            _, thickness, _, teeth = made
            return (30e6 if teeth == "stiff" else 10e6) * thickness

        monkeypatch.setattr(body, "stator_section", section)
        monkeypatch.setattr(body, "bending_frequency", frequency)
        monkeypatch.setattr(body, "bending_mode", mode)


def test_a_thickness_is_fitted(monkeypatch: pytest.MonkeyPatch) -> None:
    rings = Rings(monkeypatch)
    fit = fit_stator(45e3, 20e-3, 7)
    assert fit.ring_thickness == pytest.approx(4.5e-3, abs=1e-8)
    assert fit.mode.frequency == pytest.approx(45e3, rel=1e-5)
    assert fit.frequency_bounds == pytest.approx((45e3, 135e3), rel=1e-5)
    assert all(given[0] == pytest.approx(7 * 20e-3 / math.pi) for given in rings.asked)
    assert fit.assumptions == StatorAssumptions()
    # Eight sectors half a wave long.
    assert fit.drive == alternate_sectors(8, math.pi / 7)
    assert fit.section[3] == "soft"
    with pytest.raises(UnreachableError, match=r"lies between 3 kHz and 100 kHz") as caught:
        fit_stator(101e3, 20e-3, 7)
    assert caught.value.quantity == "frequency"


def test_a_ring_without_teeth_has_one_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    Rings(monkeypatch)
    fit = fit_stator(45e3, 20e-3, 7, StatorAssumptions(tooth_height=0.0))
    assert fit.frequency_bounds == pytest.approx((45e3, 45e3), rel=1e-5)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"frequency": 0.0}, "frequency"), ({"wavelength": 0.0}, "wavelength"),
        ({"waves": 1}, "waves"),
    ],
)  # fmt: skip
def test_a_fit_that_cannot_be_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        fit_stator(**changes)


@pytest.mark.parametrize("outer", [50e-3, 100e-3])
def test_an_outer_diameter_beside_the_mean_one_is_refused(outer: float) -> None:
    with pytest.raises(InputError, match="outer_diameter"):
        stator_section(50e-3, 3e-3, StatorAssumptions(outer_diameter=outer), "soft")
